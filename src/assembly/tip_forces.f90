!> Force and tangent of a sharp corner of a tool that presses on an edge of a tile.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly_tip_forces
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_contact, only: contact_type
   use coulter_contact_friction, only: friction_of, outer, rub_type, shear_capacity
   use coulter_contact_tip, only: edge_place_type
   implicit none(type, external)
   private
   public :: turn_slope, add_tip

contains

   !> Derivative of the traction by the angle of the edge that a tip presses on.
   pure function turn_slope(boundary, place, answer, material, penalty, lag) result(slope)
      !> The tool.
      type(boundary_type), intent(in) :: boundary
      !> Place of the tip.
      type(edge_place_type), intent(in) :: place
      !> Its traction.
      type(rub_type), intent(in) :: answer
      !> Traction of the material, stress units; penalties along normal and tangent, stress per
      !> length; way from where the tip sticks, length units.
      real(wp), intent(in) :: material(2), penalty(2), lag(2)
      real(wp) :: slope(2)
      real(wp) :: across, along, capacity, by_normal

      associate (n => place%normal, t => place%tangent)
         ! the tip stays where it is: its foot has no component along the edge
         across = -dot_product(t, material)*dot_product(n, answer%normal_by_stress)
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
      !> The station.
      type(contact_type), intent(in) :: contact
      !> Its place on the edge.
      type(edge_place_type), intent(in) :: place
      !> Its traction.
      type(rub_type), intent(in) :: answer
      !> Derivatives of the traction without friction by the place, and of all of it by the angle of
      !> the edge; of the material's by the vertices of the tile, shape (2, 2, 4 or 5).
      real(wp), intent(in) :: by_gap(2, 2), by_angle(2), by_vertices(:, :, :)
      !> Those of the tile, shapes (2, 4) and (2, 4, 2, 4 or 5).
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

end module coulter_assembly_tip_forces
