!> Regions without what tools take up that are embedded in them.
!>
!> Edges of both polygons are cut where they meet; pieces with the difference on one side only bound
!> it. Corners on edges and edges that run along each other are no exceptions.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_cutting
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid, contains_point, distance_to_segment
   use coulter_grid, only: grid_type
   use coulter_points_body, only: region_type
   use coulter_points_outline, only: outline_type, trace_outline
   implicit none(type, external)
   private
   public :: cut_out

   !> Corners nearer than this are one, over the spacing.
   real(wp), parameter :: merging = 1.0e-9_wp
   !> Lines of the grid this near to the middle of a tool split regions, over its width.
   real(wp), parameter :: well_inside = 0.4_wp
   !> How far beside an edge it is asked what is there, over that.
   real(wp), parameter :: beside = 10.0_wp

   !> What bounds a difference.
   type :: pieces_type
      !> Number of corners.
      integer :: n_corners = 0
      !> Corners, length units, shape (2, >= n_corners).
      real(wp), allocatable :: corner(:, :)
      !> First and last corner of every edge, difference on the left, shape (2, n_edges).
      integer, allocatable :: edge(:, :)
      !> Corners nearer than this are one, length units.
      real(wp) :: tolerance = 0.0_wp
   end type pieces_type

contains

   !> Replace regions by what is left of them outside a polygon. One that would get a hole is split
   !> along a line of the grid.
   recursive pure subroutine cut_out(regions, tool, grid)
      !> Regions; may become more or fewer.
      type(region_type), allocatable, intent(inout) :: regions(:)
      !> Corners of the polygon, counter-clockwise, length units, shape (2, n).
      real(wp), intent(in) :: tool(:, :)
      !> The grid.
      type(grid_type), intent(in) :: grid
      type(region_type), allocatable :: all_of_them(:), parts(:)
      logical :: has_hole
      integer :: k

      allocate (all_of_them(0))
      do k = 1, size(regions)
         call subtract(parts, has_hole, regions(k)%vertices, tool, grid%smallest_spacing())
         if (has_hole) then
            call split(parts, regions(k)%vertices, tool, grid)
            if (size(parts) > 1) call cut_out(parts, tool, grid)
         end if
         call append(all_of_them, parts)
      end do
      call move_alloc(all_of_them, regions)
   end subroutine cut_out

   !> Split a polygon where a line of the grid, or one between two, passes through the middle of
   !> another one.
   pure subroutine split(parts, polygon, tool, grid)
      type(region_type), allocatable, intent(out) :: parts(:)
      real(wp), intent(in) :: polygon(:, :), tool(:, :)
      type(grid_type), intent(in) :: grid
      type(region_type), allocatable :: left(:)
      real(wp) :: at, line, lower(2), upper(2)
      logical :: has_hole

      lower = minval(polygon, dim=2) - grid%spacing
      upper = maxval(polygon, dim=2) + grid%spacing
      at = 0.5_wp*(minval(tool(1, :)) + maxval(tool(1, :)))
      associate (x => grid%origin(1), h => grid%spacing(1))
         line = x + h*anint((at - x)/h)
      end associate
      if (abs(line - at) < well_inside*(maxval(tool(1, :)) - minval(tool(1, :)))) at = line
      call subtract(left, has_hole, polygon, box([at, lower(2)], upper), grid%smallest_spacing())
      call subtract(parts, has_hole, polygon, box(lower, [at, upper(2)]), grid%smallest_spacing())
      call append(parts, left)
   end subroutine split

   !> Add regions to a list.
   pure subroutine append(list, more)
      type(region_type), allocatable, intent(inout) :: list(:)
      type(region_type), intent(in) :: more(:)
      type(region_type), allocatable :: grown(:)

      allocate (grown(size(list) + size(more)))
      grown(:size(list)) = list
      grown(size(list) + 1:) = more
      call move_alloc(grown, list)
   end subroutine append

   !> Corners of a rectangle.
   pure function box(lower, upper) result(corner)
      real(wp), intent(in) :: lower(2), upper(2)
      real(wp) :: corner(2, 4)

      corner = reshape([lower(1), lower(2), upper(1), lower(2), upper(1), upper(2), &
                        lower(1), upper(2)], [2, 4])
   end function box

   !> What is left of a polygon without another one: simple polygons, unless there is a hole.
   pure subroutine subtract(parts, has_hole, first, second, spacing)
      type(region_type), allocatable, intent(out) :: parts(:)
      logical, intent(out) :: has_hole
      !> Corners of both, counter-clockwise, and spacing of the grid, length units.
      real(wp), intent(in) :: first(:, :), second(:, :), spacing
      type(pieces_type) :: pieces
      type(outline_type) :: outline

      pieces%tolerance = merging*spacing
      call add_corners(pieces, first, second)
      call add_edges(pieces, first, first, second)
      call add_edges(pieces, second, first, second)
      call trace_outline(outline, pieces%corner(:, :pieces%n_corners), pieces%edge, &
                         pieces%tolerance*spacing)
      call list_loops(parts, has_hole, outline)
   end subroutine subtract

   !> Corners of two polygons, and where their edges cross.
   pure subroutine add_corners(pieces, first, second)
      type(pieces_type), intent(inout) :: pieces
      real(wp), intent(in) :: first(:, :), second(:, :)
      real(wp) :: along(2), across(2), from(2), cross, share(2)
      integer :: i, j

      associate (n => size(first, 2), m => size(second, 2))
         allocate (pieces%corner(2, n + m + n*m), pieces%edge(2, 0))
         do i = 1, n
            call add_corner(pieces, first(:, i))
         end do
         do j = 1, m
            call add_corner(pieces, second(:, j))
         end do
         do i = 1, n
            along = first(:, modulo(i, n) + 1) - first(:, i)
            do j = 1, m
               across = second(:, modulo(j, m) + 1) - second(:, j)
               from = second(:, j) - first(:, i)
               cross = along(1)*across(2) - along(2)*across(1)
               if (.not. abs(cross) > epsilon(cross)*norm2(along)*norm2(across)) cycle
               share = [from(1)*across(2) - from(2)*across(1), &
                        from(1)*along(2) - from(2)*along(1)]/cross
               if (any(share < 0.0_wp .or. share > 1.0_wp)) cycle
               call add_corner(pieces, first(:, i) + share(1)*along)
            end do
         end do
      end associate
   end subroutine add_corners

   !> Add a corner unless there is one.
   pure subroutine add_corner(pieces, position)
      type(pieces_type), intent(inout) :: pieces
      real(wp), intent(in) :: position(2)
      integer :: k

      do k = 1, pieces%n_corners
         if (norm2(pieces%corner(:, k) - position) <= pieces%tolerance) return
      end do
      pieces%n_corners = pieces%n_corners + 1
      pieces%corner(:, pieces%n_corners) = position
   end subroutine add_corner

   !> Add the pieces of the edges of a polygon that bound the difference of two.
   pure subroutine add_edges(pieces, polygon, first, second)
      type(pieces_type), intent(inout) :: pieces
      real(wp), intent(in) :: polygon(:, :), first(:, :), second(:, :)
      real(wp) :: ends(2, 2), way(pieces%n_corners)
      integer :: i, k, last, next

      do i = 1, size(polygon, 2)
         ends = polygon(:, [i, modulo(i, size(polygon, 2)) + 1])
         way = huge(1.0_wp)
         do k = 1, pieces%n_corners
            associate (x => pieces%corner(:, k))
               if (distance_to_segment(x, ends(:, 1), ends(:, 2)) > pieces%tolerance) cycle
               way(k) = dot_product(x - ends(:, 1), ends(:, 2) - ends(:, 1))
            end associate
         end do
         last = minloc(way, dim=1)
         way(last) = huge(1.0_wp)
         do while (any(way < huge(1.0_wp)))
            next = minloc(way, dim=1)
            way(next) = huge(1.0_wp)
            call add_edge(pieces, [last, next], first, second)
            last = next
         end do
      end do
   end subroutine add_edges

   !> Add an edge, in the sense that has the difference on the left, if it bounds that.
   pure subroutine add_edge(pieces, edge, first, second)
      type(pieces_type), intent(inout) :: pieces
      integer, intent(in) :: edge(2)
      real(wp), intent(in) :: first(:, :), second(:, :)
      real(wp) :: along(2), middle(2), aside(2)
      logical :: is_left, is_right
      integer :: k

      do k = 1, size(pieces%edge, 2)
         if (all(pieces%edge(:, k) == edge) .or. all(pieces%edge(:, k) == edge([2, 1]))) return
      end do
      middle = 0.5_wp*sum(pieces%corner(:, edge), dim=2)
      along = pieces%corner(:, edge(2)) - pieces%corner(:, edge(1))
      aside = beside*pieces%tolerance*[-along(2), along(1)]/norm2(along)
      is_left = is_in_difference(middle + aside, first, second)
      is_right = is_in_difference(middle - aside, first, second)
      if (is_left .eqv. is_right) return
      pieces%edge = reshape([pieces%edge, merge(edge, edge([2, 1]), is_left)], &
                            [2, size(pieces%edge, 2) + 1])
   end subroutine add_edge

   !> Is a position in the first polygon, but not in the second?
   pure function is_in_difference(position, first, second) result(answer)
      real(wp), intent(in) :: position(2), first(:, :), second(:, :)
      logical :: answer

      answer = contains_point(first, position)
      if (answer) answer = .not. contains_point(second, position)
   end function is_in_difference

   !> Loops of an outline as regions; does any run round a hole?
   pure subroutine list_loops(parts, has_hole, outline)
      type(region_type), allocatable, intent(out) :: parts(:)
      logical, intent(out) :: has_hole
      type(outline_type), intent(in) :: outline
      type(region_type) :: part(1)
      real(wp) :: area, centroid(2)
      integer :: first, last

      allocate (parts(0))
      has_hole = .false.
      first = 1
      do while (first <= outline%n)
         last = outline%previous(first)
         part(1)%vertices = outline%corner(:, first:last)
         call area_and_centroid(part(1)%vertices, area, centroid)
         has_hole = has_hole .or. area < 0.0_wp
         call append(parts, part)
         first = last + 1
      end do
   end subroutine list_loops

end module coulter_points_cutting
