!> Forces and tangent of the contacts on the outer edges of tiled bodies.
!>
!> A station pushes its corner along the face's normal by t = s + k g: the penalty k on the gap g at
!> the end of the step, and either the nominal traction s of the material itself (Nitsche; exact,
!> unsymmetric) or what earlier rounds of the augmented Lagrangian method left (symmetric). Friction
!> acts along the face. Theory, section 4.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly_contact_forces
   use coulter_assembly_tile_scatter, only: add_at_corners, respond_tile, scatter_tile
   use coulter_assembly_tip_forces, only: add_tip, turn_slope
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type, formulation_nitsche
   use coulter_boundary_face, only: place_on, place_type
   use coulter_boundary_ibm, only: band_stiffness_factor
   use coulter_boundary_motion, only: turn_matrix
   use coulter_contact, only: contact_type, untouched
   use coulter_contact_friction, only: cut_off, friction_of, friction_type, press, rub, rub_type
   use coulter_contact_limit, only: lean_press, limit_press, limit_rub, limit_type
   use coulter_contact_tip, only: edge_place_type, place_on_edge
   use coulter_model, only: model_type, point_moduli
   use coulter_system, only: system_type
   use coulter_system_border, only: add_station, clear_border, mode_at
   use coulter_system_contact_state, only: decide, motion_of
   use coulter_system_point_kernel, only: point_response_type
   use coulter_system_tile_map, only: spread_to_nodes
   use coulter_system_tile_patches, only: add_by_mean, add_mean_slopes, stress_by_mean
   implicit none(type, external)
   private
   public :: add_contacts, band_penalties, nominal_traction, penalties

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
      integer :: first, last, j

      call clear_border(system%border)
      first = 1
      do while (first <= system%contacts%n)
         associate (tile => system%contacts%item(:system%contacts%n)%tile)
            last = first
            do while (last < size(tile))
               if (tile(last + 1) /= tile(first)) exit
               last = last + 1
            end do
         end associate
         call add_contacts_of_tile(system, model, first, last, at_corners)
         first = last + 1
      end do
      do j = 1, system%border%n
         call spread_to_nodes(system%map, system%border%corner_column(:, :, j), &
                              system%border%column(:, :, j))
         call spread_to_nodes(system%map, system%border%corner_row(:, :, j), &
                              system%border%row(:, :, j))
      end do
   end subroutine add_contacts

   !> All stations of one tile.
   subroutine add_contacts_of_tile(system, model, first, last, at_corners)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      !> First and last station.
      integer, intent(in) :: first, last
      real(wp), intent(inout) :: at_corners(:, :)
      type(point_response_type) :: response
      real(wp) :: force(2, 4), own_force(2, 4)
      ! where tiles share volume changes, derivatives by these follow those by the vertices
      real(wp), dimension(2, 4, 2, merge(5, 4, allocated(system%tile_patches))) :: stiffness, &
         own_stiffness
      integer :: k, tile
      logical :: has_failed

      tile = system%contacts%item(first)%tile
      force = 0.0_wp
      stiffness = 0.0_wp
      call respond_tile(system, model, tile, response, has_failed)
      do k = first, last
         own_force = 0.0_wp
         own_stiffness = 0.0_wp
         call add_contact(system, model, system%contacts%item(k), response, own_force, &
                          own_stiffness)
         system%contacts%item(k)%has_landed = .false.
         if (.not. system%contacts%item(k)%is_acting) cycle
         force = force + own_force
         stiffness = stiffness + own_stiffness
         call add_to_boundary(system, model, system%contacts%item(k), own_force, own_stiffness)
      end do
      call add_at_corners(model%tiling%corner(:, tile), force, at_corners)
      call scatter_tile(system, tile, stiffness(:, :, :, :4))
      if (allocated(system%tile_patches)) then
         call add_by_mean(system%tile_patches, tile, stiffness(:, :, :, 5))
      end if
   end subroutine add_contacts_of_tile

   !> What a station adds to the reaction and the loaded length of its boundary.
   subroutine add_to_boundary(system, model, contact, force, stiffness)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      type(contact_type), intent(in) :: contact
      real(wp), intent(in) :: force(2, 4), stiffness(:, :, :, :)

      if (system%border%n > 0) call add_to_border(system, model, contact, force, stiffness)
      associate (b => contact%boundary)
         system%boundary_reaction(:, b) = system%boundary_reaction(:, b) - sum(force, dim=2)
         system%loaded_length(b) = system%loaded_length(b) + contact%weight
      end associate
   end subroutine add_to_boundary

   !> What a station adds to the balance of a tool that moves freely. Where volume changes are
   !> shared, that depends on all corners of the patches that its stations touch.
   subroutine add_to_border(system, model, contact, force, stiffness)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      type(contact_type), intent(in) :: contact
      real(wp), intent(in) :: force(2, 4), stiffness(:, :, :, :)
      real(wp) :: position(2, 4), by_mean(2)
      integer :: j, k, v

      associate (corner => model%tiling%corner(:, contact%tile), border => system%border)
         position = model%tiling%position(:, corner) + system%map%increment(:, corner)
         call add_station(border, contact%boundary, corner, position, force, &
                          stiffness(:, :, :, :4))
         if (.not. allocated(system%tile_patches)) return
         do j = 1, border%n
            if (border%boundary(j) /= contact%boundary) cycle
            do k = 1, 2
               by_mean(k) = sum([(dot_product(mode_at(border, j, position(:, v)), &
                                              stiffness(:, v, k, 5)), v=1, 4)])
            end do
            call add_mean_slopes(system%tile_patches, model%tiling%patch(contact%tile), by_mean, &
                                 border%corner_row(:, :, j))
         end do
      end associate
   end subroutine add_to_border

   !> One station, if it acts: what presses against the face and, unless that is smooth, rubs along.
   !> All is reckoned by one who moves freely with the tool, then turned to where the tool is.
   subroutine add_contact(system, model, contact, response, force, stiffness)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      type(contact_type), intent(inout) :: contact
      type(point_response_type), intent(in) :: response
      real(wp), intent(inout) :: force(2, 4), stiffness(:, :, :, :)
      type(edge_place_type) :: place
      type(rub_type) :: answer
      real(wp) :: penalty(2), material(2), moved(2, 2), lag(2), by_gap(2, 2)
      real(wp) :: by_vertices(2, 2, size(stiffness, 4)), angle, overlap

      moved = motion_of(system, contact)
      if (contact%tip > 0) then
         place = place_on_edge(reshape([contact%offset, contact%other_offset], [2, 2]) + moved)
      else
         place%place_type = place_on(contact%face, contact%offset, moved(:, 1))
      end if
      lag = contact%lag + (1.0_wp - contact%share)*moved(:, 1) + contact%share*moved(:, 2)
      ! nothing below asks for the gap but to press with
      place%gap = place%gap + contact%shift
      penalty = penalties(model, contact)
      call find_material_traction(system, model, contact, response, material, by_vertices)
      angle = system%border%motion(contact%boundary)%rotation
      if (abs(angle) > 0.0_wp) call turn_material(-angle, material, by_vertices)
      call press(answer, place%place_type, material, penalty(1))
      call limit_traction(system, model, contact, place%place_type, moved, material, penalty(1), &
                          answer)
      overlap = answer%traction(1)/penalty(1)
      if (contact%opening > untouched) then
         call hold_back(system, model%boundaries(contact%boundary), contact, place%place_type, &
                        answer, overlap)
      end if
      by_gap = answer%by_place
      call decide(system, model, contact, place, overlap)
      if (.not. contact%is_acting) return
      if (contact%is_fixed) then
         call rub(answer, place%place_type, material, penalty, lag, friction_type(), 0)
      else if (contact%rubs .and. .not. system%is_smooth) then
         call rub_along(system, model, contact, place%place_type, material, penalty, lag, answer)
      end if
      contact%traction = answer%traction
      if (contact%tip > 0) then
         call add_tip(contact, place, answer, by_gap, turn_slope( &
                      model%boundaries(contact%boundary), place, answer, material, penalty, lag), &
                      by_vertices, force, stiffness)
      else
         call add_answer(contact, answer, by_vertices, force, stiffness)
      end if
      if (abs(angle) > 0.0_wp) call turn_station(angle, contact, force, stiffness)
   end subroutine add_contact

   !> Limit the normal traction near an open end of the face.
   pure subroutine limit_traction(system, model, contact, place, moved, material, penalty, answer)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      type(contact_type), intent(in) :: contact
      type(place_type), intent(in) :: place
      real(wp), intent(in) :: moved(2, 2), material(2), penalty
      type(rub_type), intent(inout) :: answer
      type(place_type) :: other

      if (contact%leans) then
         other = place_on(contact%face, contact%other_offset, moved(:, 2))
         call lean_press(answer, place, other%gap, material, penalty, contact%hold)
      else if (contact%give > 0.0_wp) then
         call limit_press(answer, place, limit_of(system, model, contact, place), penalty)
      end if
   end subroutine limit_traction

   !> Tension of a station that has touched. A prediction opens nothing that has not opened before.
   pure subroutine hold_back(system, boundary, contact, place, answer, overlap)
      type(system_type), intent(in) :: system
      type(boundary_type), intent(in) :: boundary
      type(contact_type), intent(inout) :: contact
      type(place_type), intent(in) :: place
      type(rub_type), intent(inout) :: answer
      !> Becomes that of a station that presses if it holds tension.
      real(wp), intent(inout) :: overlap
      logical :: holds

      holds = system%is_predicting .and. .not. contact%opening > 0.0_wp
      if (.not. holds) call cut_off(answer, place, friction_of(boundary), contact%opening, &
                                    contact%new_opening, holds)
      if (holds) overlap = -huge(overlap)
   end subroutine hold_back

   !> Turn the traction of the material and its derivatives by the vertices.
   pure subroutine turn_material(angle, material, by_vertices)
      real(wp), intent(in) :: angle
      real(wp), intent(inout) :: material(2), by_vertices(:, :, :)
      real(wp) :: turn(2, 2)
      integer :: b

      turn = turn_matrix(angle)
      material = matmul(turn, material)
      do b = 1, size(by_vertices, 3)
         by_vertices(:, :, b) = matmul(turn, by_vertices(:, :, b))
         if (b < 5) by_vertices(:, :, b) = matmul(by_vertices(:, :, b), transpose(turn))
      end do
   end subroutine turn_material

   !> Turn force, tangent and memory of a station.
   pure subroutine turn_station(angle, contact, force, stiffness)
      real(wp), intent(in) :: angle
      type(contact_type), intent(inout) :: contact
      real(wp), intent(inout) :: force(2, 4), stiffness(:, :, :, :)
      real(wp) :: turn(2, 2)
      integer :: a, b

      turn = turn_matrix(angle)
      force = matmul(turn, force)
      contact%new_lag = matmul(turn, contact%new_lag)
      do b = 1, size(stiffness, 4)
         do a = 1, 4
            stiffness(:, a, :, b) = matmul(turn, stiffness(:, a, :, b))
            if (b < 5) stiffness(:, a, :, b) = matmul(stiffness(:, a, :, b), transpose(turn))
         end do
      end do
   end subroutine turn_station

   !> Limits of a station near an open end of its face, from the nominal traction of its tile at the
   !> start of the step.
   pure function limit_of(system, model, contact, place) result(limit)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      type(contact_type), intent(in) :: contact
      type(place_type), intent(in) :: place
      type(limit_type) :: limit
      real(wp) :: stress(2, 2)

      stress = reshape(model%points%converged%kirchhoff_stress([1, 4, 4, 2], contact%tile), &
                       [2, 2])
      stress = model%points%reference_volume(contact%tile)/system%map%area(contact%tile)*stress
      associate (n => place%normal, t => place%tangent)
         limit%traction = [dot_product(n, matmul(stress, n)), dot_product(t, matmul(stress, n))]
         limit%along = dot_product(t, matmul(stress, t))
      end associate
      limit%margin = contact%hold*max(0.0_wp, -limit%traction(1))
      limit%give = contact%give
      limit%recedes = contact%recedes
   end function limit_of

   !> Friction, and where the station will stick from now on.
   subroutine rub_along(system, model, contact, place, material, penalty, lag, answer)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      type(contact_type), intent(inout) :: contact
      type(place_type), intent(in) :: place
      real(wp), intent(in) :: material(2), penalty(2), lag(2)
      type(rub_type), intent(inout) :: answer

      associate (friction => friction_of(model%boundaries(contact%boundary)))
         if (contact%has_landed .or. (system%is_predicting .and. contact%was_acting)) then
            call rub(answer, place, material, penalty, lag, friction, contact%last_slip)
         else if (system%is_sticking) then
            call rub(answer, place, material, penalty, lag, friction, 0)
         else
            call rub(answer, place, material, penalty, lag, friction)
         end if
      end associate
      if (contact%give > 0.0_wp) call limit_rub(answer, place, limit_of(system, model, contact, &
                                                                        place), &
                                                friction_of(model%boundaries(contact%boundary)))
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
         if (contact%leans) then
            associate (o => contact%other_vertex)
               stiffness(:, v, :, o) = stiffness(:, v, :, o) + w*answer%by_other
            end associate
         end if
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

      if (model%boundaries(contact%boundary)%formulation /= formulation_nitsche) then
         material = contact%memory(1)*contact%face%normal + contact%memory(2)*contact%face%tangent
         by_vertices = 0.0_wp
         return
      end if
      call nominal_traction(system, model, contact%tile, contact%inward, response, material, &
                            by_vertices)
   end subroutine find_material_traction

   !> Nominal traction of a tile on a surface, P times a unit vector with P = tau dF^-T V0/A, and
   !> its derivative by the vertices of the tile, and by mean volume change and pressure of its
   !> patch where volume changes are shared.
   pure subroutine nominal_traction(system, model, tile, inward, response, material, by_vertices)
      !> System at the present unknowns.
      type(system_type), intent(in) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Number of the tile.
      integer, intent(in) :: tile
      !> The unit vector, against the outward normal at the start of the step.
      real(wp), intent(in) :: inward(2)
      !> What the tile answers.
      type(point_response_type), intent(in) :: response
      !> Traction, stress units, and its derivative, shape (2, 2, 4 or 5).
      real(wp), intent(out) :: material(2), by_vertices(:, :, :)
      real(wp) :: pulled(2), slope(2, 2)
      integer :: i, k, l

      pulled = model%points%reference_volume(tile)/system%map%area(tile) &
         *matmul(inward, response%inverse)
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
      by_vertices(:, :, 5) = stress_by_mean(system%tile_patches, tile, pulled)
   end subroutine nominal_traction

   !> Penalty stiffness along normal and tangent, stress per length: that of the paper's band.
   pure function penalties(model, contact) result(penalty)
      !> Scene with the tiles of the station.
      type(model_type), intent(in) :: model
      !> The station.
      type(contact_type), intent(in) :: contact
      real(wp) :: penalty(2)

      penalty = band_penalties(model, contact%tile, &
                               model%boundaries(contact%boundary)%band_ratio)
   end function penalties

   !> Penalty stiffness along normal and tangent of a band along the edge of a tile, stress per
   !> length.
   pure function band_penalties(model, tile, band_ratio) result(penalty)
      !> Scene.
      type(model_type), intent(in) :: model
      !> Number of the tile.
      integer, intent(in) :: tile
      !> Width of the band over the grid spacing.
      real(wp), intent(in) :: band_ratio
      real(wp) :: penalty(2)
      real(wp) :: lame_lambda, shear_modulus

      call point_moduli(model, tile, lame_lambda, shear_modulus)
      penalty = band_stiffness_factor*[lame_lambda + 2.0_wp*shear_modulus, shear_modulus] &
         /(band_ratio*model%grid%smallest_spacing())
   end function band_penalties

end module coulter_assembly_contact_forces
