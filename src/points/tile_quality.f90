!> How far tiles are from their undeformed shape.
!>
!> A tile that is nearly a bow-tie still has the right area, and Newton's method still converges,
!> but its forces are wrong (theory, section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_tile_quality
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: corner_jacobians, aspect_ratio, relative_jacobian, is_distorted, is_worn

   !> Tiles are distorted when the relative Jacobian of a corner is less than this, ...
   real(wp), parameter :: least_jacobian = 0.2_wp
   !> ... or when the aspect is more than this multiple of the first one.
   real(wp), parameter :: largest_aspect = 5.0_wp
   !> The same for tiles that are no longer good.
   real(wp), parameter :: worn_jacobian = 0.9_wp, worn_aspect = 1.3_wp

contains

   !> Scaled Jacobian of every corner: the parallelogram of the edges that meet there over the area
   !> of the tile. No affine map changes it: 1 for parallelograms, <= 0 for bow-ties and darts; all
   !> corners of a triangle count as 1.
   pure function corner_jacobians(corner) result(jacobian)
      !> Corners, counter-clockwise, a triangle repeats one; area > 0.
      real(wp), intent(in) :: corner(2, 4)
      real(wp) :: jacobian(4)
      real(wp) :: edge(2, 0:4), twice_area
      integer :: v

      edge = edges(corner)
      do v = 1, 4
         jacobian(v) = edge(1, v - 1)*edge(2, v) - edge(2, v - 1)*edge(1, v)
      end do
      twice_area = 0.5_wp*sum(jacobian)
      if (any(all(.not. abs(edge) > 0.0_wp, dim=1))) then
         jacobian = 1.0_wp
      else
         jacobian = 2.0_wp*jacobian/twice_area
      end if
   end function corner_jacobians

   !> Edges from every corner to the next one; the last one comes first, too.
   pure function edges(corner) result(edge)
      real(wp), intent(in) :: corner(2, 4)
      real(wp) :: edge(2, 0:4)

      edge(:, 1:3) = corner(:, 2:4) - corner(:, 1:3)
      edge(:, 4) = corner(:, 1) - corner(:, 4)
      edge(:, 0) = edge(:, 4)
   end function edges

   !> Square of the longest edge over the area; half the square of a longer diagonal counts too.
   !> 1 for a square.
   pure function aspect_ratio(corner) result(aspect)
      !> Corners, counter-clockwise; area > 0.
      real(wp), intent(in) :: corner(2, 4)
      real(wp) :: aspect
      real(wp) :: edge(2, 0:4), diagonal(2, 2), area

      edge = edges(corner)
      diagonal = corner(:, 3:4) - corner(:, 1:2)
      area = 0.5_wp*(diagonal(1, 1)*diagonal(2, 2) - diagonal(2, 1)*diagonal(1, 2))
      aspect = max(maxval(sum(edge**2, dim=1)), 0.5_wp*maxval(sum(diagonal**2, dim=1)))/area
   end function aspect_ratio

   !> Least Jacobian of the corners relative to the first ones: 1 plus the largest loss, so that a
   !> corner that is flat from the start may stay so; 1 for every affine map.
   pure function relative_jacobian(jacobian, first) result(least)
      !> Jacobians of the corners, now and of the undeformed tile.
      real(wp), intent(in) :: jacobian(4), first(4)
      real(wp) :: least

      least = 1.0_wp + minval(jacobian - first)
   end function relative_jacobian

   !> Are tiles so far from their first shape that their forces cannot be trusted?
   pure function is_distorted(worst_corner, worst_aspect) result(answer)
      !> Least relative Jacobian, and largest aspect over the first one.
      real(wp), intent(in) :: worst_corner, worst_aspect
      logical :: answer

      answer = worst_corner < least_jacobian .or. worst_aspect > largest_aspect
   end function is_distorted

   !> Are tiles so far from their first shape that they are worth making anew where material flows?
   pure function is_worn(worst_corner, worst_aspect) result(answer)
      !> Least relative Jacobian, and largest aspect over the first one.
      real(wp), intent(in) :: worst_corner, worst_aspect
      logical :: answer

      answer = worst_corner < worn_jacobian .or. worst_aspect > worn_aspect
   end function is_worn

end module coulter_points_tile_quality
