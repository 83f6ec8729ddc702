!> Shapes of tools: chains of straight faces and arcs with the material on their left.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_tool_shape
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: rectangle_corners, wedge_corners, fluke_corners, close_outline, close_circle
   public :: turned_to

contains

   !> Corners of a footing, blade or wall: the middle of its lower side is at the origin.
   pure function rectangle_corners(size_of) result(corner)
      !> Width and height, length units.
      real(wp), intent(in) :: size_of(2)
      real(wp) :: corner(2, 4)

      corner(1, :) = size_of(1)*[-0.5_wp, 0.5_wp, 0.5_wp, -0.5_wp]
      corner(2, :) = size_of(2)*[0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp]
   end function rectangle_corners

   !> Corners of a wedge with its tip at the origin, its back above.
   pure function wedge_corners(size_of) result(corner)
      !> Width of the back and height, length units.
      real(wp), intent(in) :: size_of(2)
      real(wp) :: corner(2, 3)

      corner(1, :) = size_of(1)*[0.0_wp, 0.5_wp, -0.5_wp]
      corner(2, :) = size_of(2)*[0.0_wp, 1.0_wp, 1.0_wp]
   end function wedge_corners

   !> Corners of an anchor's fluke: a level plate around the origin, pointed at both ends at right
   !> angles.
   pure function fluke_corners(size_of) result(corner)
      !> Length and thickness, length units; the length is more than the thickness.
      real(wp), intent(in) :: size_of(2)
      real(wp) :: corner(2, 6)
      real(wp) :: shoulder

      shoulder = 0.5_wp*(size_of(1) - size_of(2))
      corner(1, [1, 4]) = 0.5_wp*size_of(1)*[-1.0_wp, 1.0_wp]
      corner(1, [2, 3, 5, 6]) = shoulder*[-1.0_wp, 1.0_wp, 1.0_wp, -1.0_wp]
      corner(2, :) = 0.5_wp*size_of(2)*[0.0_wp, -1.0_wp, -1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp]
   end function fluke_corners

   !> Corners turned about the origin, then shifted.
   pure function turned_to(corner, angle, position) result(moved)
      !> Corners, length units, shape (2, n).
      real(wp), intent(in) :: corner(:, :)
      !> Angle, counter-clockwise, radians.
      real(wp), intent(in) :: angle
      !> Where the origin goes, length units.
      real(wp), intent(in) :: position(2)
      real(wp) :: moved(2, size(corner, 2))
      real(wp) :: turn(2, 2)

      turn = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
      moved = spread(position, 2, size(corner, 2))
      if (abs(angle) > 0.0_wp) then
         moved = moved + matmul(turn, corner)
      else
         moved = moved + corner
      end if
   end function turned_to

   !> Chain of faces along a polygon, its convex corners rounded.
   pure subroutine close_outline(corner, rounding, is_inside, vertices, bulges, fits)
      !> Corners, counter-clockwise, length units, shape (2, n).
      real(wp), intent(in) :: corner(:, :)
      !> Radius of the rounding, 0 for sharp corners.
      real(wp), intent(in) :: rounding
      !> Is the material inside the polygon?
      logical, intent(in) :: is_inside
      !> Ends of the faces, length units, shape (2, n_faces + 1); the last is the first.
      real(wp), allocatable, intent(out) :: vertices(:, :)
      !> Bulges of the faces, shape (n_faces).
      real(wp), allocatable, intent(out) :: bulges(:)
      !> Do the roundings leave something of every side?
      logical, intent(out) :: fits
      real(wp) :: chain(2, 2*size(corner, 2) + 1), bulge(2*size(corner, 2))
      real(wp) :: to(2), from(2), turn, cut(size(corner, 2))
      integer :: i, k, n

      n = size(corner, 2)
      k = 0
      bulge = 0.0_wp
      do i = 1, n
         to = direction(corner, modulo(i - 2, n) + 1)
         from = direction(corner, i)
         turn = atan2(to(1)*from(2) - to(2)*from(1), dot_product(to, from))
         cut(i) = max(0.0_wp, rounding*tan(0.5_wp*turn))
         k = k + 1
         chain(:, k) = corner(:, i) - cut(i)*to
         if (.not. cut(i) > 0.0_wp) cycle
         bulge(k) = tan(0.25_wp*turn)
         k = k + 1
         chain(:, k) = corner(:, i) + cut(i)*from
      end do
      chain(:, k + 1) = chain(:, 1)
      vertices = chain(:, :k + 1)
      bulges = bulge(:k)
      fits = all(cut + cshift(cut, 1) < norm2(cshift(corner, 1, dim=2) - corner, dim=1))
      if (.not. is_inside) call reverse(vertices, bulges)
   end subroutine close_outline

   !> Circle as two arcs.
   pure subroutine close_circle(centre, radius, is_inside, vertices, bulges)
      !> Centre and radius, length units.
      real(wp), intent(in) :: centre(2), radius
      !> Is the material inside the circle?
      logical, intent(in) :: is_inside
      !> Ends of the arcs, length units, shape (2, 3); the last is the first.
      real(wp), allocatable, intent(out) :: vertices(:, :)
      !> Bulges of the arcs, shape (2).
      real(wp), allocatable, intent(out) :: bulges(:)

      vertices = spread(centre, 2, 3)
      vertices(1, :) = centre(1) + radius*[-1.0_wp, 1.0_wp, -1.0_wp]
      bulges = spread(merge(1.0_wp, -1.0_wp, is_inside), 1, 2)
   end subroutine close_circle

   !> Unit vector from a corner to the next.
   pure function direction(corner, i)
      real(wp), intent(in) :: corner(:, :)
      integer, intent(in) :: i
      real(wp) :: direction(2)

      direction = corner(:, modulo(i, size(corner, 2)) + 1) - corner(:, i)
      direction = direction/norm2(direction)
   end function direction

   !> The same chain, walked the other way.
   pure subroutine reverse(vertices, bulges)
      real(wp), intent(inout) :: vertices(:, :), bulges(:)

      vertices = vertices(:, size(vertices, 2):1:-1)
      bulges = -bulges(size(bulges):1:-1)
   end subroutine reverse

end module coulter_boundary_tool_shape
