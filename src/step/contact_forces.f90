!> Forces and tangent of the contacts on the outer edges of tiled bodies.
!>
!> A station pushes its corner along the face's normal by t = s + k g: the penalty k on the gap g at
!> the end of the step, and either the nominal traction s = n . P n of the material itself (Nitsche;
!> exact, unsymmetric) or what earlier rounds of the augmented Lagrangian method left (symmetric);
!> theory, section 4.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_contact_forces
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: formulation_augmented, formulation_nitsche
   use coulter_boundary_contact, only: contact_type
   use coulter_boundary_ibm, only: band_stiffness_factor
   use coulter_model, only: model_type, point_moduli
   use coulter_step_point_kernel, only: point_response_type
   use coulter_step_system, only: system_type
   use coulter_step_tile_scatter, only: add_at_corners, respond_tile, scatter_tile
   implicit none(type, external)
   private
   public :: add_contacts, augment_contacts

   !> Gaps below this share of the spacing count as closed: round-off of a body that starts on a
   !> wall.
   real(wp), parameter :: touching = 1.0e-10_wp
   !> A face reaches this far beyond its ends, over the spacing: a corner that sits at an end must
   !> not come and go with round-off.
   real(wp), parameter :: end_slack = 0.05_wp

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
      real(wp) :: force(2, 4), stiffness(2, 4, 2, 4), reaction(2)
      integer :: k, tile
      logical :: has_failed, is_acting

      tile = 0
      do k = 1, system%contacts%n
         associate (contact => system%contacts%item(k))
            if (contact%tile /= tile) then
               tile = contact%tile
               force = 0.0_wp
               stiffness = 0.0_wp
               call respond_tile(system, model, tile, response, has_failed)
            end if
            call add_contact(system, model, contact, response, force, stiffness, reaction, &
                             is_acting)
            associate (total => system%boundary_reaction(:, contact%boundary), &
                       length => system%loaded_length(contact%boundary))
               total = total + reaction
               if (is_acting) length = length + contact%weight
            end associate
         end associate
         if (k < system%contacts%n) then
            if (system%contacts%item(k + 1)%tile == tile) cycle
         end if
         call add_at_corners(model%tiling%corner(:, tile), force, at_corners)
         call scatter_tile(system, tile, stiffness)
      end do
   end subroutine add_contacts

   !> One station, if it acts: the traction along the normal, and for fixed kinds along the tangent.
   subroutine add_contact(system, model, contact, response, force, stiffness, reaction, is_acting)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      type(contact_type), intent(inout) :: contact
      type(point_response_type), intent(in) :: response
      real(wp), intent(inout) :: force(2, 4), stiffness(2, 4, 2, 4)
      real(wp), intent(out) :: reaction(2)
      logical, intent(out) :: is_acting
      real(wp) :: penalty(2), slide, by_vertices(2, 4)

      reaction = 0.0_wp
      contact%traction = 0.0_wp
      penalty = penalties(model, contact)
      associate (moved => system%map%increment(:, contact%corner))
         slide = dot_product(contact%tangent, moved)
         call find_traction(contact%normal, contact%gap + dot_product(contact%normal, moved), 1)
      end associate
      is_acting = acts(contact, contact%traction(1)/penalty(1), slide, dot_product( &
                       contact%tangent, system%map%increment(:, contact%other_corner)), &
                       model%grid%smallest_spacing())
      if (.not. is_acting) then
         contact%traction = 0.0_wp
         return
      end if
      call push(contact%normal, 1)
      if (.not. contact%is_fixed) return
      call find_traction(contact%tangent, contact%slide + slide, 2)
      call push(contact%tangent, 2)

   contains

      !> Traction component i along a direction and its derivative by the vertices: with Nitsche
      !> that of the material plus penalty, else what earlier rounds left plus penalty.
      subroutine find_traction(direction, gap, i)
         real(wp), intent(in) :: direction(2), gap
         integer, intent(in) :: i

         if (model%boundaries(contact%boundary)%formulation == formulation_nitsche) then
            call nominal_traction(response, model%points%reference_volume(contact%tile) &
                                  /system%map%area(contact%tile), direction, contact%normal, &
                                  contact%traction(i), by_vertices)
         else
            contact%traction(i) = contact%memory(i)
            by_vertices = 0.0_wp
         end if
         contact%traction(i) = contact%traction(i) + penalty(i)*gap
         by_vertices(:, contact%vertex) = by_vertices(:, contact%vertex) + penalty(i)*direction
      end subroutine find_traction

      !> Add the traction along a direction to force and stiffness.
      subroutine push(direction, i)
         real(wp), intent(in) :: direction(2)
         integer, intent(in) :: i
         integer :: k, b

         force(:, contact%vertex) = force(:, contact%vertex) &
            + contact%weight*contact%traction(i)*direction
         reaction = reaction - contact%weight*contact%traction(i)*direction
         do b = 1, 4
            do k = 1, 2
               stiffness(:, contact%vertex, k, b) = stiffness(:, contact%vertex, k, b) &
                  + contact%weight*by_vertices(k, b)*direction
            end do
         end do
      end subroutine push

   end subroutine add_contact

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
   !> Where a face ends, it acts on edges whose middle it reaches: those beyond belong to the next
   !> face, and the corner between them must not be pushed twice.
   pure function acts(contact, overlap, slide, other_slide, spacing) result(answer)
      type(contact_type), intent(in) :: contact
      !> Traction over the penalty, and how far both ends of the edge move along the face, length
      !> units.
      real(wp), intent(in) :: overlap, slide, other_slide
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      logical :: answer
      real(wp) :: distance, middle, slack

      answer = contact%is_bilateral
      if (answer .or. .not. overlap < touching*spacing) return
      slack = end_slack*spacing
      distance = contact%distance + slide
      middle = 0.5_wp*(distance + contact%other_distance + other_slide)
      answer = distance >= -slack .and. distance <= contact%length + slack
      if (distance < slack) answer = answer .and. middle > 0.0_wp
      if (distance > contact%length - slack) answer = answer .and. middle < contact%length
   end function acts

   !> Component of the nominal traction P N, P = tau dF^-T V0/A, and its derivative by the vertices
   !> of the tile.
   pure subroutine nominal_traction(response, share, direction, normal, traction, by_vertices)
      type(point_response_type), intent(in) :: response
      real(wp), intent(in) :: share, direction(2), normal(2)
      real(wp), intent(out) :: traction, by_vertices(2, 4)
      real(wp) :: pulled(2), stress(2, 2), slope(2, 2)
      integer :: k, l

      pulled = share*matmul(normal, response%inverse)
      stress = reshape(response%stress([1, 4, 4, 2]), [2, 2])
      traction = dot_product(direction, matmul(stress, pulled))
      do l = 1, 2
         do k = 1, 2
            slope(k, l) = dot_product(direction, matmul(response%moduli(:, :, k, l), pulled))
         end do
      end do
      by_vertices = matmul(slope, response%gradient)
   end subroutine nominal_traction

end module coulter_step_contact_forces
