!> Plane polygons: clipping, area and centroid, overlap, distance.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_polygon
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: polygon_type, clip_half_plane, clip_box, area_and_centroid, overlap_area, &
      find_overlap
   public :: append, polyline_distance, contains_point, distance_to_segment, turn, winding_number

   !> A polygon that can shrink and grow; corners beyond `n` are not meaningful.
   type :: polygon_type
      !> Number of corners.
      integer :: n = 0
      !> Corners, counter-clockwise for a positive area, shape (2, >= n).
      real(wp), allocatable :: corner(:, :)
   end type polygon_type

contains

   !> Keep the part with normal . x >= offset (Sutherland & Hodgman, 1974). The part of a
   !> non-convex polygon may hang together by edges without area.
   pure subroutine clip_half_plane(polygon, normal, offset, kept)
      !> Polygon to clip.
      type(polygon_type), intent(in) :: polygon
      !> Normal of the clipping line, pointing to the side that is kept.
      real(wp), intent(in) :: normal(2)
      !> Value of normal . x on the line.
      real(wp), intent(in) :: offset
      !> The part that is kept; no corners if there is none.
      type(polygon_type), intent(inout) :: kept
      real(wp) :: here, next
      integer :: i, j

      kept%n = 0
      if (polygon%n == 0) return
      call make_room(kept, 2*polygon%n)
      next = dot_product(normal, polygon%corner(:, 1)) - offset
      do i = 1, polygon%n
         here = next
         j = merge(1, i + 1, i == polygon%n)
         next = dot_product(normal, polygon%corner(:, j)) - offset
         if (here >= 0.0_wp) call append(kept, polygon%corner(:, i))
         if (min(here, next) < 0.0_wp .and. max(here, next) > 0.0_wp) then
            call append(kept, polygon%corner(:, i) &
                        + (polygon%corner(:, j) - polygon%corner(:, i))*(here/(here - next)))
         end if
      end do
   end subroutine clip_half_plane

   !> Keep the part between two lines of equal coordinate.
   pure subroutine clip_box(polygon, axis, lower, upper, kept)
      !> Polygon to clip.
      type(polygon_type), intent(in) :: polygon
      !> Coordinate that is bounded: 1 for x, 2 for y.
      integer, intent(in) :: axis
      !> Bounds of the coordinate.
      real(wp), intent(in) :: lower, upper
      !> The part that is kept.
      type(polygon_type), intent(inout) :: kept
      type(polygon_type) :: half
      real(wp) :: normal(2)

      normal = 0.0_wp
      normal(axis) = 1.0_wp
      call clip_half_plane(polygon, normal, lower, half)
      call clip_half_plane(half, -normal, -upper, kept)
   end subroutine clip_box

   !> Signed area (positive for counter-clockwise corners) and centroid.
   pure subroutine area_and_centroid(corner, area, centroid)
      !> Corners, shape (2, n).
      real(wp), intent(in) :: corner(:, :)
      !> Signed area.
      real(wp), intent(out) :: area
      !> Centroid; the first corner if the area vanishes.
      real(wp), intent(out) :: centroid(2)
      real(wp) :: edge(2), next(2), twice, moment(2)
      integer :: i

      area = 0.0_wp
      moment = 0.0_wp
      centroid = 0.0_wp
      if (size(corner, 2) == 0) return
      ! relative to the first corner, so that far from the origin no digits are lost
      do i = 2, size(corner, 2) - 1
         edge = corner(:, i) - corner(:, 1)
         next = corner(:, i + 1) - corner(:, 1)
         twice = edge(1)*next(2) - edge(2)*next(1)
         area = area + 0.5_wp*twice
         moment = moment + twice*(edge + next)/6.0_wp
      end do
      centroid = corner(:, 1)
      if (abs(area) > 0.0_wp) centroid = centroid + moment/area
   end subroutine area_and_centroid

   !> Area that two simple polygons share.
   pure function overlap_area(first, second) result(area)
      !> Corners of the polygons, counter-clockwise, shape (2, n).
      real(wp), intent(in) :: first(:, :), second(:, :)
      real(wp) :: area
      real(wp) :: centroid(2)

      call find_overlap(first, second, area, centroid)
   end function overlap_area

   !> Area that two simple polygons share, convex or not, and its centroid: both are fans of signed
   !> triangles.
   pure subroutine find_overlap(first, second, area, centroid)
      !> Corners of the polygons, counter-clockwise, shape (2, n).
      real(wp), intent(in) :: first(:, :), second(:, :)
      !> Area that they share.
      real(wp), intent(out) :: area
      !> Centroid of that; the first corner if there is none.
      real(wp), intent(out) :: centroid(2)
      real(wp) :: part, place(2), moment(2)
      integer :: i, j

      area = 0.0_wp
      moment = 0.0_wp
      do i = 2, size(first, 2) - 1
         do j = 2, size(second, 2) - 1
            call overlap_triangles(first(:, [1, i, i + 1]), second(:, [1, j, j + 1]), part, place)
            area = area + part
            moment = moment + part*(place - first(:, 1))
         end do
      end do
      centroid = first(:, 1)
      if (area > 0.0_wp) centroid = centroid + moment/area
   end subroutine find_overlap

   !> Signed area shared by two triangles of any orientation, and its centroid.
   pure subroutine overlap_triangles(first, second, area, centroid)
      real(wp), intent(in) :: first(2, 3), second(2, 3)
      real(wp), intent(out) :: area, centroid(2)
      type(polygon_type) :: part, rest
      real(wp) :: edge(2), normal(2), orientation
      integer :: i

      call area_and_centroid(second, orientation, centroid)
      call area_and_centroid(first, area, centroid)
      if (.not. abs(orientation*area) > 0.0_wp) area = 0.0_wp
      if (.not. abs(area) > 0.0_wp) return
      area = 0.0_wp
      part%n = 3
      part%corner = first
      do i = 1, 3
         edge = second(:, modulo(i, 3) + 1) - second(:, i)
         normal = sign(1.0_wp, orientation)*[-edge(2), edge(1)]
         call clip_half_plane(part, normal, dot_product(normal, second(:, i)), rest)
         part = rest
         if (part%n < 3) return
      end do
      call area_and_centroid(part%corner(:, :part%n), area, centroid)
      area = area*sign(1.0_wp, orientation)
   end subroutine overlap_triangles

   !> Least distance between an open polyline and a polygon with its interior.
   pure function polyline_distance(polyline, corner) result(distance)
      !> Points of the polyline, shape (2, >= 2).
      real(wp), intent(in) :: polyline(:, :)
      !> Corners of the polygon, shape (2, >= 3).
      real(wp), intent(in) :: corner(:, :)
      real(wp) :: distance
      integer :: i, j, k

      distance = huge(distance)
      if (contains_point(corner, polyline(:, 1))) distance = 0.0_wp
      do i = 1, size(polyline, 2) - 1
         j = size(corner, 2)
         do k = 1, size(corner, 2)
            distance = min(distance, segment_distance(polyline(:, i), polyline(:, i + 1), &
                                                      corner(:, j), corner(:, k)))
            j = k
         end do
      end do
   end function polyline_distance

   !> Least distance between the segments a-b and c-d.
   pure function segment_distance(a, b, c, d) result(distance)
      real(wp), intent(in) :: a(2), b(2), c(2), d(2)
      real(wp) :: distance

      distance = 0.0_wp
      if (turn(a, b, c)*turn(a, b, d) < 0.0_wp .and. turn(c, d, a)*turn(c, d, b) < 0.0_wp) return
      distance = min(distance_to_segment(a, c, d), distance_to_segment(b, c, d), &
                     distance_to_segment(c, a, b), distance_to_segment(d, a, b))
   end function segment_distance

   !> Is a point inside a simple polygon (corners counter-clockwise or not)?
   pure function contains_point(corner, position) result(is_inside)
      !> Corners, shape (2, n).
      real(wp), intent(in) :: corner(:, :)
      !> The point.
      real(wp), intent(in) :: position(2)
      logical :: is_inside
      integer :: i, j
      real(wp) :: crossing

      is_inside = .false.
      j = size(corner, 2)
      do i = 1, size(corner, 2)
         if ((corner(2, i) > position(2)) .neqv. (corner(2, j) > position(2))) then
            crossing = corner(1, i) + (corner(1, j) - corner(1, i)) &
               *(position(2) - corner(2, i))/(corner(2, j) - corner(2, i))
            if (position(1) < crossing) is_inside = .not. is_inside
         end if
         j = i
      end do
   end function contains_point

   !> Distance of a point from a segment.
   pure function distance_to_segment(position, first, last) result(distance)
      !> The point.
      real(wp), intent(in) :: position(2)
      !> Ends of the segment.
      real(wp), intent(in) :: first(2), last(2)
      real(wp) :: distance
      real(wp) :: along(2), share

      along = last - first
      share = 0.0_wp
      if (any(abs(along) > 0.0_wp)) then
         share = dot_product(position - first, along)/dot_product(along, along)
         share = min(max(share, 0.0_wp), 1.0_wp)
      end if
      distance = norm2(position - first - share*along)
   end function distance_to_segment

   !> Add a corner; there must be room for it.
   pure subroutine append(polygon, position)
      type(polygon_type), intent(inout) :: polygon
      real(wp), intent(in) :: position(2)

      polygon%n = polygon%n + 1
      polygon%corner(:, polygon%n) = position
   end subroutine append

   !> Let a polygon hold at least `n` corners; what it held is lost.
   pure subroutine make_room(polygon, n)
      type(polygon_type), intent(inout) :: polygon
      integer, intent(in) :: n

      if (allocated(polygon%corner)) then
         if (size(polygon%corner, 2) >= n) return
         deallocate (polygon%corner)
      end if
      allocate (polygon%corner(2, n))
   end subroutine make_room

   !> Twice the signed area of a triangle: positive for a left turn.
   pure function turn(first, second, third) result(value)
      !> Its corners, length units.
      real(wp), intent(in) :: first(2), second(2), third(2)
      real(wp) :: value

      value = (second(1) - first(1))*(third(2) - first(2)) &
         - (second(2) - first(2))*(third(1) - first(1))
   end function turn

   !> How often closed loops of segments run round a position, counter-clockwise.
   pure function winding_number(first, last, position) result(winding)
      !> Ends of the segments, in any order, length units, shape (2, n).
      real(wp), intent(in) :: first(:, :), last(:, :)
      !> The position, length units.
      real(wp), intent(in) :: position(2)
      integer :: winding
      integer :: k

      winding = 0
      do k = 1, size(first, 2)
         associate (a => first(:, k), b => last(:, k))
            if ((a(2) > position(2)) .eqv. (b(2) > position(2))) cycle
            if (position(1) < a(1) + (b(1) - a(1))*(position(2) - a(2))/(b(2) - a(2))) then
               winding = winding + merge(1, -1, b(2) > a(2))
            end if
         end associate
      end do
   end function winding_number

end module coulter_base_polygon
