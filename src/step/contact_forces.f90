!> Forces and tangent of the contacts on the outer edges of tiled bodies.
!>
!> A station pushes its corner along the face's normal by t = s + k g: the penalty k on the gap g at
!> the end of the step, and either the nominal traction s of the material itself (Nitsche; exact,
!> unsymmetric) or what earlier rounds of the augmented Lagrangian method left (symmetric). Friction
!> acts along the face. Theory, section 4.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_contact_forces
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type, formulation_augmented, formulation_nitsche
   use coulter_boundary_contact, only: contact_type, end_slack
   use coulter_boundary_face, only: place_on, place_type, reaches
   use coulter_boundary_friction, only: friction_of, friction_type, outer, press, rub, &
      rub_type, shear_capacity
   use coulter_boundary_ibm, only: band_stiffness_factor
   use coulter_boundary_tip, only: edge_place_type, place_on_edge
   use coulter_model, only: model_type, point_moduli
   use coulter_step_border, only: add_station, clear_border
   use coulter_step_point_kernel, only: point_response_type
   use coulter_step_system, only: system_type
   use coulter_step_tile_map, only: spread_to_nodes
   use coulter_step_tile_patches, only: add_by_mean, add_mean_slopes, stress_by_mean
   use coulter_step_tile_scatter, only: add_at_corners, respond_tile, scatter_tile
   implicit none(type, external)
   private
   public :: add_contacts, augment_contacts, motion_of, land_free_tools

   !> Gaps below this share of the spacing count as closed: round-off of a body that starts on a
   !> wall.
   real(wp), parameter :: touching = 1.0e-10_wp
   !> A tip may slide this far beyond the ends of its edge within a step, over the length of that.
   real(wp), parameter :: tip_slack = 0.5_wp

contains

   !> Traction of all contacts. Successive stations of one tile share its response and are
   !> scattered together.
   subroutine add_contacts(system, model, at_corners)
      !> System of the step; gets reactions, loaded lengths and `values`.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Forces on the corners, shape (2, n_corners).
      real(wp), intent(inout) :: at_corners(:, :)
      type(point_response_type) :: response
      real(wp) :: force(2, 4), own_force(2, 4)
      ! where tiles share volume changes, derivatives by these follow those by the vertices
      real(wp), dimension(2, 4, 2, merge(5, 4, allocated(system%tile_patches))) :: stiffness, &
         own_stiffness
      integer :: k, j, tile
      logical :: has_failed

      tile = 0
      call clear_border(system%border)
      do k = 1, system%contacts%n
         associate (contact => system%contacts%item(k))
            if (contact%tile /= tile) then
               tile = contact%tile
               force = 0.0_wp
               stiffness = 0.0_wp
               call respond_tile(system, model, tile, response, has_failed)
            end if
            own_force = 0.0_wp
            own_stiffness = 0.0_wp
            call add_contact(system, model, contact, response, own_force, own_stiffness)
            if (contact%is_acting) then
               force = force + own_force
               stiffness = stiffness + own_stiffness
               call add_station(system%border, contact%boundary, model%tiling%corner(:, tile), &
                                own_force, own_stiffness(:, :, :, :4))
               if (allocated(system%tile_patches)) then
                  call add_patch_rows(system, contact%boundary, model%tiling%patch(tile), &
                                      own_stiffness(:, :, :, 5))
               end if
               associate (total => system%boundary_reaction(:, contact%boundary), &
                          length => system%loaded_length(contact%boundary))
                  total = total - sum(own_force, dim=2)
                  length = length + contact%weight
               end associate
            end if
         end associate
         if (k < system%contacts%n) then
            if (system%contacts%item(k + 1)%tile == tile) cycle
         end if
         call add_at_corners(model%tiling%corner(:, tile), force, at_corners)
         call scatter_tile(system, tile, stiffness(:, :, :, :4))
         if (allocated(system%tile_patches)) then
            call add_by_mean(system%tile_patches, tile, stiffness(:, :, :, 5))
         end if
      end do
      do j = 1, system%border%n
         call spread_to_nodes(system%map, system%border%corner_column(:, :, j), &
                              system%border%column(:, :, j))
         call spread_to_nodes(system%map, system%border%corner_row(:, :, j), &
                              system%border%row(:, :, j))
      end do
   end subroutine add_contacts

   !> The balance of a free tool depends on all corners of the patches that its stations touch.
   pure subroutine add_patch_rows(system, boundary, patch, by_mean)
      type(system_type), intent(inout) :: system
      integer, intent(in) :: boundary, patch
      !> Derivatives of the force of a station by mean volume change and pressure.
      real(wp), intent(in) :: by_mean(2, 4, 2)
      integer :: j

      do j = 1, system%border%n
         if (system%border%boundary(j) /= boundary) cycle
         call add_mean_slopes(system%tile_patches, patch, &
                              sum(by_mean(system%border%direction(j), :, :), dim=1), &
                              system%border%corner_row(:, :, j))
      end do
   end subroutine add_patch_rows

   !> One station, if it acts: what presses against the face and, unless that is smooth, rubs along.
   subroutine add_contact(system, model, contact, response, force, stiffness)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      type(contact_type), intent(inout) :: contact
      type(point_response_type), intent(in) :: response
      real(wp), intent(inout) :: force(2, 4), stiffness(:, :, :, :)
      type(edge_place_type) :: place
      type(rub_type) :: answer
      real(wp) :: penalty(2), material(2), moved(2, 2), lag(2), by_gap(2, 2)
      real(wp) :: by_vertices(2, 2, size(stiffness, 4))

      moved = motion_of(system, contact)
      if (contact%tip > 0) then
         place = place_on_edge(reshape([contact%offset, contact%other_offset], [2, 2]) + moved)
      else
         place%place_type = place_on(contact%face, contact%offset, moved(:, 1))
      end if
      lag = contact%lag + (1.0_wp - contact%share)*moved(:, 1) + contact%share*moved(:, 2)
      penalty = penalties(model, contact)
      call find_material_traction(system, model, contact, response, material, by_vertices)
      call press(answer, place%place_type, material, penalty(1))
      by_gap = answer%by_place
      call decide(system, model, contact, place, answer%traction(1)/penalty(1))
      if (.not. contact%is_acting) return
      if (contact%is_fixed) then
         call rub(answer, place%place_type, material, penalty, lag, friction_type(), 0)
      else if (contact%rubs .and. .not. system%is_smooth) then
         call rub_along(system, model%boundaries(contact%boundary), contact, place%place_type, &
                        material, penalty, lag, answer)
      end if
      contact%traction = answer%traction
      if (contact%tip > 0) then
         call add_tip(contact, place, answer, by_gap, turn_slope( &
                      model%boundaries(contact%boundary), place, answer, material, penalty, lag), &
                      by_vertices, force, stiffness)
      else
         call add_answer(contact, answer, by_vertices, force, stiffness)
      end if
   end subroutine add_contact

   !> Motion of both ends of an edge against a tool that may move freely.
   pure function motion_of(system, contact) result(moved)
      !> System at the present unknowns.
      type(system_type), intent(in) :: system
      !> The station.
      type(contact_type), intent(in) :: contact
      !> Motion of its corner and of the other end of the edge, length units.
      real(wp) :: moved(2, 2)

      moved = system%map%increment(:, [contact%corner, contact%other_corner])
      if (system%border%n == 0) return
      moved = moved - spread(system%border%motion(:, contact%boundary), 2, 2)
   end function motion_of

   !> Let the nearest stations of free tools that touch nothing act, as if they had before: they
   !> must carry the load.
   pure subroutine land_free_tools(system, has_changed)
      !> System whose contacts have been evaluated.
      type(system_type), intent(inout) :: system
      !> Was there such a tool?
      logical, intent(out) :: has_changed
      type(place_type) :: place(system%contacts%n)
      real(wp) :: moved(2, 2)
      integer :: j, k

      has_changed = .false.
      do j = 1, system%border%n
         associate (contacts => system%contacts%item(:system%contacts%n), &
                    b => system%border%boundary(j))
            if (any(contacts%is_acting .and. contacts%boundary == b)) cycle
            if (.not. any(contacts%boundary == b .and. contacts%tip == 0)) cycle
            do k = 1, size(contacts)
               moved = motion_of(system, contacts(k))
               place(k) = place_on(contacts(k)%face, contacts(k)%offset, moved(:, 1))
            end do
            k = minloc(place%gap, dim=1, mask=contacts%boundary == b .and. contacts%tip == 0)
            system%contacts%item(k)%was_acting = .true.
            has_changed = .true.
         end associate
      end do
   end subroutine land_free_tools

   !> Does the station act? A prediction keeps what acted in the last step.
   subroutine decide(system, model, contact, place, overlap)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      type(contact_type), intent(inout) :: contact
      type(edge_place_type), intent(in) :: place
      real(wp), intent(in) :: overlap

      contact%slip = 0
      contact%traction = 0.0_wp
      contact%is_acting = system%is_predicting .and. contact%was_acting
      if (contact%is_acting) return
      if (contact%tip > 0) then
         contact%is_acting = overlap < touching*model%grid%smallest_spacing() &
            .and. abs(place%share - 0.5_wp) <= 0.5_wp + tip_slack
      else
         contact%is_acting = acts(system, contact, place%place_type, overlap, &
                                  model%grid%smallest_spacing())
      end if
   end subroutine decide

   !> Derivative of the traction by the angle of the edge that a tip presses on.
   pure function turn_slope(boundary, place, answer, material, penalty, lag) result(slope)
      type(boundary_type), intent(in) :: boundary
      type(edge_place_type), intent(in) :: place
      type(rub_type), intent(in) :: answer
      real(wp), intent(in) :: material(2), penalty(2), lag(2)
      real(wp) :: slope(2)
      real(wp) :: across, along, capacity, by_normal

      associate (n => place%normal, t => place%tangent)
         ! the tip stays where it is: its foot has no component along the edge
         across = -dot_product(t, material)
         along = 0.0_wp
         if (answer%slip /= 0) then
            call shear_capacity(friction_of(boundary), answer%traction(1), capacity, by_normal)
            along = real(answer%slip, wp)*by_normal*across
         else if (answer%sticks) then
            along = dot_product(n, material + penalty(2)*lag)
         end if
         slope = (across + answer%traction(2))*n + (along - answer%traction(1))*t
      end associate
   end function turn_slope

   !> Add force and tangent of a tip, which both ends of its edge share. What sticks hangs on the
   !> place where the tip was, all else on its foot.
   pure subroutine add_tip(contact, place, answer, by_gap, by_angle, by_vertices, force, stiffness)
      type(contact_type), intent(in) :: contact
      type(edge_place_type), intent(in) :: place
      type(rub_type), intent(in) :: answer
      real(wp), intent(in) :: by_gap(2, 2), by_angle(2), by_vertices(:, :, :)
      real(wp), intent(inout) :: force(2, 4), stiffness(:, :, :, :)
      real(wp), parameter :: sign_of(2) = [-1.0_wp, 1.0_wp]
      real(wp) :: share(2), foot(2), held(2), slope(2, 2), block(2, 2)
      integer :: v(2), r, c

      v = [contact%vertex, contact%other_vertex]
      share(2) = min(max(place%share, 0.0_wp), 1.0_wp)
      share(1) = 1.0_wp - share(2)
      slope = place%share_slope
      if (abs(place%share - share(2)) > 0.0_wp) slope = 0.0_wp
      ! the gap belongs to the line of the edge, not to a clamped foot
      foot = [1.0_wp - place%share, place%share]
      held = foot
      if (answer%sticks) held = [1.0_wp - contact%share, contact%share]
      do r = 1, 2
         force(:, v(r)) = force(:, v(r)) + contact%weight*share(r)*answer%vector
         do c = 1, 2
            block = foot(c)*by_gap + held(c)*(answer%by_place - by_gap) &
               + sign_of(c)/place%length*outer(by_angle, place%normal)
            block = share(r)*block + sign_of(r)*outer(answer%vector, slope(:, c))
            stiffness(:, v(r), :, v(c)) = stiffness(:, v(r), :, v(c)) + contact%weight*block
         end do
         do c = 1, size(by_vertices, 3)
            stiffness(:, v(r), :, c) = stiffness(:, v(r), :, c) &
               + contact%weight*share(r)*matmul(answer%by_stress, by_vertices(:, :, c))
         end do
      end do
   end subroutine add_tip

   !> Friction, and where the station will stick from now on.
   subroutine rub_along(system, boundary, contact, place, material, penalty, lag, answer)
      type(system_type), intent(in) :: system
      type(boundary_type), intent(in) :: boundary
      type(contact_type), intent(inout) :: contact
      type(place_type), intent(in) :: place
      real(wp), intent(in) :: material(2), penalty(2), lag(2)
      type(rub_type), intent(inout) :: answer

      if (system%is_predicting .and. contact%was_acting) then
         call rub(answer, place, material, penalty, lag, friction_of(boundary), contact%last_slip)
      else
         call rub(answer, place, material, penalty, lag, friction_of(boundary))
      end if
      contact%slip = answer%slip
      contact%new_lag = (answer%traction(2) - dot_product(place%tangent, material))/penalty(2) &
         *place%tangent
   end subroutine rub_along

   !> Add force and tangent of a station to those of its tile.
   pure subroutine add_answer(contact, answer, by_vertices, force, stiffness)
      type(contact_type), intent(in) :: contact
      type(rub_type), intent(in) :: answer
      real(wp), intent(in) :: by_vertices(:, :, :)
      real(wp), intent(inout) :: force(2, 4), stiffness(:, :, :, :)
      integer :: b

      associate (v => contact%vertex, w => contact%weight)
         force(:, v) = force(:, v) + w*answer%vector
         stiffness(:, v, :, v) = stiffness(:, v, :, v) + w*answer%by_place
         do b = 1, size(by_vertices, 3)
            stiffness(:, v, :, b) = stiffness(:, v, :, b) &
               + w*matmul(answer%by_stress, by_vertices(:, :, b))
         end do
      end associate
   end subroutine add_answer

   !> Traction of the material on the face and its derivative by the vertices of the tile, and by
   !> mean volume change and pressure of its patch where volume changes are shared: nominal
   !> with Nitsche, P times the inward vector with P = tau dF^-T V0/A; else what earlier rounds
   !> left.
   pure subroutine find_material_traction(system, model, contact, response, material, by_vertices)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      type(contact_type), intent(in) :: contact
      type(point_response_type), intent(in) :: response
      real(wp), intent(out) :: material(2), by_vertices(:, :, :)
      real(wp) :: pulled(2), slope(2, 2)
      integer :: i, k, l

      if (model%boundaries(contact%boundary)%formulation /= formulation_nitsche) then
         material = contact%memory(1)*contact%face%normal + contact%memory(2)*contact%face%tangent
         by_vertices = 0.0_wp
         return
      end if
      pulled = model%points%reference_volume(contact%tile)/system%map%area(contact%tile) &
         *matmul(contact%inward, response%inverse)
      material = matmul(reshape(response%stress([1, 4, 4, 2]), [2, 2]), pulled)
      do i = 1, 2
         do l = 1, 2
            do k = 1, 2
               slope(k, l) = dot_product(response%moduli(i, :, k, l), pulled)
            end do
         end do
         by_vertices(i, :, :4) = matmul(slope, response%gradient)
      end do
      if (size(by_vertices, 3) == 4) return
      by_vertices(:, :, 5) = stress_by_mean(system%tile_patches, contact%tile, pulled)
   end subroutine find_material_traction

   !> Penalty stiffness along normal and tangent, stress per length: that of the paper's band.
   pure function penalties(model, contact) result(penalty)
      type(model_type), intent(in) :: model
      type(contact_type), intent(in) :: contact
      real(wp) :: penalty(2)
      real(wp) :: lame_lambda, shear_modulus

      call point_moduli(model, contact%tile, lame_lambda, shear_modulus)
      penalty = band_stiffness_factor*[lame_lambda + 2.0_wp*shear_modulus, shear_modulus] &
         /(model%boundaries(contact%boundary)%band_ratio*model%grid%smallest_spacing())
   end function penalties

   !> End a round of the augmented Lagrangian method: what the penalty carries is remembered, so
   !> that it can relax.
   pure subroutine augment_contacts(system, model, has_changed)
      !> System in equilibrium.
      type(system_type), intent(inout) :: system
      !> Scene.
      type(model_type), intent(in) :: model
      !> Does any boundary remember?
      logical, intent(out) :: has_changed
      integer :: k

      has_changed = .false.
      do k = 1, system%contacts%n
         associate (contact => system%contacts%item(k))
            if (model%boundaries(contact%boundary)%formulation /= formulation_augmented) cycle
            contact%memory = contact%traction
            has_changed = .true.
         end associate
      end do
   end subroutine augment_contacts

   !> Does the face act on the corner: held for good, or pressed while it slides along the face?
   pure function acts(system, contact, place, overlap, spacing) result(answer)
      type(system_type), intent(in) :: system
      type(contact_type), intent(in) :: contact
      !> Place of the corner.
      type(place_type), intent(in) :: place
      !> Traction over the penalty, and grid spacing, length units.
      real(wp), intent(in) :: overlap, spacing
      logical :: answer
      type(place_type) :: other
      real(wp) :: slack, moved(2, 2)

      answer = contact%is_bilateral
      if (answer .or. .not. overlap < touching*spacing) return
      slack = end_slack*spacing
      answer = contact%is_settled .or. (place%distance >= slack &
                                        .and. place%distance <= contact%face%length - slack)
      if (answer) return
      moved = motion_of(system, contact)
      other = place_on(contact%face, contact%other_offset, moved(:, 2))
      answer = reaches(contact%face, place%distance, other%distance, slack)
   end function acts

end module coulter_step_contact_forces
