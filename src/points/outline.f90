!> The outline of tiled bodies: closed loops of their outer edges.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_outline
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid, winding_number
   implicit none(type, external)
   private
   public :: outline_type, trace_outline, sharp_corners, insert_corner, encloses, edges_of

   !> Closed loops, material on the left, one after the other.
   type :: outline_type
      !> Number of corners and of edges: an edge starts at every corner.
      integer :: n = 0
      !> Corners, length units, shape (2, n).
      real(wp), allocatable :: corner(:, :)
      !> Corners after and before every corner, shape (n).
      integer, allocatable :: next(:), previous(:)
      !> Must a corner be kept however little the outline turns there? Shape (n).
      logical, allocatable :: is_feature(:)
      !> Corners that are roots of cuts ahead of tools, or held beside one: kept beside others, too.
      integer, allocatable :: roots(:)
      !> Does a corner lie beside a slit that is left open? Unallocated where none is, shape (n).
      logical, allocatable :: is_slit(:)
   end type outline_type

contains

   !> Join edges to loops, and leave out those that enclose less than some area: specks and
   !> pin-holes.
   pure subroutine trace_outline(outline, position, edge, least_area)
      !> Outline to make.
      type(outline_type), intent(out) :: outline
      !> Positions that edges refer to, length units, shape (2, n).
      real(wp), intent(in) :: position(:, :)
      !> First and last position of every edge, material on the left; together they are closed,
      !> shape (>= 2, n_edges).
      integer, intent(in) :: edge(:, :)
      !> Smallest area of a loop that is kept.
      real(wp), intent(in) :: least_area
      integer :: loop(size(edge, 2)), leaving(size(position, 2)), after(size(edge, 2))
      logical :: is_used(size(edge, 2))
      real(wp) :: area, centroid(2)
      integer :: e, n, k

      ! edges that leave a position, as linked lists
      leaving = 0
      do e = size(edge, 2), 1, -1
         after(e) = leaving(edge(1, e))
         leaving(edge(1, e)) = e
      end do
      allocate (outline%corner(2, size(edge, 2)))
      allocate (outline%next(size(edge, 2)), outline%previous(size(edge, 2)))
      is_used = .false.
      do e = 1, size(edge, 2)
         if (is_used(e)) cycle
         call follow(position, edge, leaving, after, e, is_used, loop, n)
         call area_and_centroid(position(:, loop(:n)), area, centroid)
         if (abs(area) < least_area) cycle
         associate (first => outline%n + 1)
            outline%corner(:, first:first + n - 1) = position(:, loop(:n))
            outline%next(first:first + n - 1) = [(k, k=first + 1, first + n - 1), first]
            outline%previous(first:first + n - 1) = [first + n - 1, (k, k=first, first + n - 2)]
         end associate
         outline%n = outline%n + n
      end do
      outline%corner = outline%corner(:, :outline%n)
      outline%next = outline%next(:outline%n)
      outline%previous = outline%previous(:outline%n)
      allocate (outline%is_feature(outline%n), source=.false.)
   end subroutine trace_outline

   !> First positions of a chain of unused edges, up to where it closes. Parts that touch at one
   !> position are parted there.
   pure subroutine follow(position, edge, leaving, after, start, is_used, loop, n)
      real(wp), intent(in) :: position(:, :)
      integer, intent(in) :: edge(:, :), leaving(:), after(:), start
      logical, intent(inout) :: is_used(:)
      integer, intent(inout) :: loop(:)
      integer, intent(out) :: n
      integer :: e, next, k

      n = 0
      e = start
      do
         is_used(e) = .true.
         n = n + 1
         loop(n) = edge(1, e)
         next = 0
         k = leaving(edge(2, e))
         do while (k > 0)
            if (.not. is_used(k) .or. k == start) then
               if (next == 0) then
                  next = k
               else if (wedge(e, k) < wedge(e, next)) then
                  next = k
               end if
            end if
            k = after(k)
         end do
         e = next
         if (e == 0 .or. e == start) return
      end do

   contains

      !> Angle of the material between an edge that arrives and one that leaves, 0 to 2 pi.
      pure function wedge(first, second) result(angle)
         integer, intent(in) :: first, second
         real(wp) :: angle
         real(wp) :: back(2), ahead(2)

         back = position(:, edge(1, first)) - position(:, edge(2, first))
         ahead = position(:, edge(2, second)) - position(:, edge(1, second))
         angle = modulo(atan2(ahead(1)*back(2) - ahead(2)*back(1), dot_product(ahead, back)), &
                        2.0_wp*acos(-1.0_wp))
      end function wedge

   end subroutine follow

   !> First and last corner of every edge of an outline.
   pure function edges_of(outline) result(edge)
      !> The outline.
      type(outline_type), intent(in) :: outline
      integer :: edge(2, outline%n)
      integer :: c

      edge = reshape([(c, outline%next(c), c=1, outline%n)], [2, outline%n])
   end function edges_of

   !> How far the outline turns at every corner between the chords to the places at some distance
   !> along it: 0 to pi, shape (n).
   pure function sharp_corners(outline, distance) result(turn)
      !> The outline.
      type(outline_type), intent(in) :: outline
      !> Length of outline that a chord spans, so that small kinks do not count.
      real(wp), intent(in) :: distance
      real(wp), allocatable :: turn(:)
      real(wp) :: before(2), behind(2)
      integer :: c

      allocate (turn(outline%n))
      do c = 1, outline%n
         before = outline%corner(:, c) - place_along(outline, c, outline%previous, distance)
         behind = place_along(outline, c, outline%next, distance) - outline%corner(:, c)
         turn(c) = abs(atan2(before(1)*behind(2) - before(2)*behind(1), &
                             dot_product(before, behind)))
      end do
   end function sharp_corners

   !> Place at a distance along the outline from a corner, in one of both senses.
   pure function place_along(outline, start, next, distance) result(place)
      type(outline_type), intent(in) :: outline
      integer, intent(in) :: start, next(:)
      real(wp), intent(in) :: distance
      real(wp) :: place(2)
      real(wp) :: rest, length
      integer :: c

      rest = distance
      c = start
      do
         place = outline%corner(:, next(c))
         length = norm2(place - outline%corner(:, c))
         if (length >= rest .or. next(c) == start) exit
         rest = rest - length
         c = next(c)
      end do
      if (length > rest) place = outline%corner(:, c) + (place - outline%corner(:, c))*(rest/length)
   end function place_along

   !> Put a new corner, the last in number, on the edge that starts at another.
   pure subroutine insert_corner(outline, edge, position)
      !> Outline that gets the corner.
      type(outline_type), intent(inout) :: outline
      !> Corner at which the edge starts.
      integer, intent(in) :: edge
      !> Position of the new corner, length units.
      real(wp), intent(in) :: position(2)
      integer :: after

      after = outline%next(edge)
      outline%n = outline%n + 1
      outline%corner = reshape([outline%corner, position], [2, outline%n])
      outline%next = [outline%next, after]
      outline%previous = [outline%previous, edge]
      outline%is_feature = [outline%is_feature, .false.]
      outline%next(edge) = outline%n
      outline%previous(after) = outline%n
   end subroutine insert_corner

   !> Does the outline run round a position?
   pure function encloses(outline, position) result(answer)
      !> The outline.
      type(outline_type), intent(in) :: outline
      !> The position, length units.
      real(wp), intent(in) :: position(2)
      logical :: answer

      associate (corner => outline%corner(:, :outline%n))
         answer = winding_number(corner, outline%corner(:, outline%next(:outline%n)), position) > 0
      end associate
   end function encloses

end module coulter_points_outline
