!> Straight boundary segments: pure geometry.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_segment
   use coulter_base_kinds, only: wp
   use coulter_grid, only: grid_type
   implicit none(type, external)
   private
   public :: segment_type, new_segment, cut_segment, lies_on

   !> A segment with the material on its left.
   type :: segment_type
      !> First end, length units.
      real(wp) :: first(2) = 0.0_wp
      !> Unit vector from the first end to the last.
      real(wp) :: tangent(2) = 0.0_wp
      !> Unit normal into the material.
      real(wp) :: normal(2) = 0.0_wp
      !> Length.
      real(wp) :: length = 0.0_wp
   contains
      procedure :: position_at
   end type segment_type

   !> Pieces shorter than this share of the grid spacing are left out.
   real(wp), parameter :: shortest_piece = 1.0e-10_wp

contains

   !> Make a segment from its ends, which must differ.
   pure subroutine new_segment(segment, first, last)
      !> Segment to make.
      type(segment_type), intent(out) :: segment
      !> Ends; looking from the first to the last, the material is on the left.
      real(wp), intent(in) :: first(2), last(2)

      segment%first = first
      segment%length = norm2(last - first)
      segment%tangent = (last - first)/segment%length
      segment%normal = [-segment%tangent(2), segment%tangent(1)]
   end subroutine new_segment

   !> Position at a distance from the first end.
   pure function position_at(self, distance) result(position)
      class(segment_type), intent(in) :: self
      !> Distance along the segment, length units.
      real(wp), intent(in) :: distance
      real(wp) :: position(2)

      position = self%first + distance*self%tangent
   end function position_at

   !> Does an edge lie on a segment?
   pure function lies_on(segment, ends, tolerance) result(answer)
      !> The segment.
      type(segment_type), intent(in) :: segment
      !> Ends of the edge, length units.
      real(wp), intent(in) :: ends(2, 2)
      !> Largest accepted distance, length units.
      real(wp), intent(in) :: tolerance
      logical :: answer
      real(wp) :: offset(2, 2), distance(2)

      offset = ends - spread(segment%first, 2, 2)
      distance = matmul(segment%tangent, offset)
      answer = all(abs(matmul(segment%normal, offset)) <= tolerance) .and. &
         all(distance >= -tolerance .and. distance <= segment%length + tolerance)
   end function lies_on

   !> Cut a segment at the grid lines, so that each piece lies in one cell.
   pure subroutine cut_segment(segment, grid, from, to)
      !> Segment to cut.
      type(segment_type), intent(in) :: segment
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Distances of the ends of every piece from the first end, length units, shape (n_pieces).
      real(wp), allocatable, intent(out) :: from(:), to(:)
      real(wp), allocatable :: cut(:), upright(:), level(:)
      logical, allocatable :: is_long_enough(:)
      integer :: n

      call crossings(segment, grid, 1, upright)
      call crossings(segment, grid, 2, level)
      n = size(upright) + size(level) + 1
      allocate (cut(0:n), is_long_enough(n))
      cut(0) = 0.0_wp
      cut(1:n - 1) = merge_sorted(upright, level)
      cut(n) = segment%length
      is_long_enough = cut(1:) - cut(:n - 1) > shortest_piece*grid%smallest_spacing()
      from = pack(cut(:n - 1), is_long_enough)
      to = pack(cut(1:), is_long_enough)
   end subroutine cut_segment

   !> Distances at which a segment crosses grid lines of one coordinate, ascending.
   pure subroutine crossings(segment, grid, axis, crossing)
      type(segment_type), intent(in) :: segment
      type(grid_type), intent(in) :: grid
      integer, intent(in) :: axis
      real(wp), allocatable, intent(out) :: crossing(:)
      real(wp) :: ends(2)
      integer :: line, lowest, highest

      allocate (crossing(0))
      if (abs(segment%tangent(axis)) <= 1.0e-12_wp) return
      ends = ([segment%first(axis), segment%first(axis) + segment%length*segment%tangent(axis)] &
              - grid%origin(axis))/grid%spacing(axis)
      lowest = max(floor(minval(ends)) + 1, 0)
      highest = min(ceiling(maxval(ends)) - 1, grid%n_cells(axis))
      crossing = [((grid%origin(axis) + real(line, wp)*grid%spacing(axis) - segment%first(axis)) &
                   /segment%tangent(axis), line=lowest, highest)]
      if (segment%tangent(axis) < 0.0_wp) crossing = crossing(size(crossing):1:-1)
      crossing = pack(crossing, crossing > 0.0_wp .and. crossing < segment%length)
   end subroutine crossings

   !> Merge two ascending lists.
   pure function merge_sorted(first, second) result(merged)
      real(wp), intent(in) :: first(:), second(:)
      real(wp) :: merged(size(first) + size(second))
      integer :: i, j, k

      i = 1
      j = 1
      do k = 1, size(merged)
         if (j > size(second)) then
            merged(k) = first(i)
            i = i + 1
         else if (i > size(first)) then
            merged(k) = second(j)
            j = j + 1
         else if (first(i) <= second(j)) then
            merged(k) = first(i)
            i = i + 1
         else
            merged(k) = second(j)
            j = j + 1
         end if
      end do
   end function merge_sorted

end module coulter_boundary_segment
