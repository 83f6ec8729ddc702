!> The active part of the grid: cells that hold material, their nodes, and who sits where.
!>
!> Everything lives in a window around the material, so that a larger background grid costs nothing.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_grid_cells
   use coulter_base_kinds, only: wp
   use coulter_base_sorting, only: sort_by_number
   use coulter_grid, only: cell_nodes_2d, grid_type
   use coulter_grid_box, only: box_reach
   implicit none(type, external)
   private
   public :: cells_type, bridge_corners, find_cells, locate_boxes, locate_points, number_cells, &
      number_nodes

   !> Active cells and nodes, numbered row by row.
   type :: cells_type
      !> Number of active cells.
      integer :: n_cells = 0
      !> How many of them, the first ones, hold points or parts of their boxes.
      integer :: n_with_points = 0
      !> Number of active nodes.
      integer :: n_nodes = 0
      !> Grid index of every active cell, shape (2, >= n_cells).
      integer, allocatable :: cell_index(:, :)
      !> Nodes of every active cell, counter-clockwise, shape (4, n_cells).
      integer, allocatable :: node(:, :)
      !> Grid index of every active node, shape (2, n_nodes).
      integer, allocatable :: node_index(:, :)
      !> First entry of every cell in `point`, shape (n_with_points + 1).
      integer, allocatable :: point_start(:)
      !> Points ordered by cell, shape (n_points); more if boxes reach into several cells.
      integer, allocatable :: point(:)
      !> Number of the active cell, or 0, at every cell of the window.
      integer, allocatable :: cell_at(:, :)
      !> Where a cell of the grid is there several times, as sheets with nodes of their own, the
      !> next one behind every cell, or 0, shape (n_cells); unallocated where none is.
      integer, allocatable :: next_sheet(:)
   contains
      procedure :: number_at
      procedure :: append_cell
      procedure :: local_position
      procedure :: next_beside
      procedure :: has_beside
   end type cells_type

   !> Cells around the material that the window covers, for boundaries that act beside it.
   integer, parameter :: window_margin = 2

contains

   !> Find the cell of every point and collect the points of every cell.
   pure subroutine locate_points(cells, grid, position, first_outside)
      !> Active cells to make; nodes are numbered later by `number_nodes`.
      type(cells_type), intent(out) :: cells
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Positions of the points, inside the grid, shape (2, n_points).
      real(wp), intent(in) :: position(:, :)
      !> First point that is outside the grid (or not a number), else 0; then nothing is made.
      integer, intent(out) :: first_outside
      integer :: index(2, size(position, 2))

      call find_cells(grid, position, index, first_outside)
      if (first_outside > 0) return
      call number_cells(cells, grid, index)
      call sort_points(cells, index)
   end subroutine locate_points

   !> Find the cells that the box of every point covers, and collect the boxes in every cell.
   pure subroutine locate_boxes(cells, grid, position, box, first_outside)
      !> Active cells to make; nodes are numbered later by `number_nodes`.
      type(cells_type), intent(out) :: cells
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Positions of the points, inside the grid, and edges of their boxes, shape (2, n_points).
      real(wp), intent(in) :: position(:, :), box(:, :)
      !> First point that is outside the grid (or not a number), else 0; then nothing is made.
      integer, intent(out) :: first_outside
      integer :: home(2, size(position, 2)), index(2, 9*size(position, 2))
      integer :: owner(9*size(position, 2)), first(2), last(2), p, i, j, n

      call find_cells(grid, position, home, first_outside)
      if (first_outside > 0) return
      n = 0
      do p = 1, size(position, 2)
         call box_reach((position(:, p) - grid%origin)/grid%spacing - real(home(:, p) - 1, wp), &
                        box(:, p)/grid%spacing, home(:, p), grid%n_cells, first, last)
         do j = first(2), last(2)
            do i = first(1), last(1)
               n = n + 1
               index(:, n) = home(:, p) + [i, j]
               owner(n) = p
            end do
         end do
      end do
      call number_cells(cells, grid, index(:, :n))
      call sort_points(cells, index(:, :n))
      cells%point = owner(cells%point)
   end subroutine locate_boxes

   !> Grid index of the cell of every position: `grid%cell_of` in constant size.
   pure subroutine find_cells(grid, position, index, first_outside)
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Positions, shape (2, n).
      real(wp), intent(in) :: position(:, :)
      !> Grid index of their cells, shape (2, n).
      integer, intent(out) :: index(:, :)
      !> First position that is outside the grid (or not a number), else 0.
      integer, intent(out) :: first_outside
      real(wp) :: lower(2), upper(2), spacing(2)
      integer :: p, i, n_cells(2)

      lower = grid%origin
      upper = grid%upper_corner()
      spacing = grid%spacing
      n_cells = grid%n_cells
      do p = 1, size(position, 2)
         do i = 1, 2
            first_outside = p
            if (.not. (position(i, p) >= lower(i) .and. position(i, p) <= upper(i))) return
            index(i, p) = min(int((position(i, p) - lower(i))/spacing(i)) + 1, n_cells(i))
         end do
      end do
      first_outside = 0
   end subroutine find_cells

   !> Number the cells that hold points, row by row.
   pure subroutine number_cells(cells, grid, index)
      !> Active cells to make.
      type(cells_type), intent(inout) :: cells
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Grid index of the cells, shape (2, n).
      integer, intent(in) :: index(:, :)
      integer :: p, i, j, lower(2), upper(2)

      lower = max(minval(index, dim=2) - window_margin, 1)
      upper = min(maxval(index, dim=2) + window_margin, grid%n_cells)
      allocate (cells%cell_at(lower(1):upper(1), lower(2):upper(2)), source=0)
      do p = 1, size(index, 2)
         cells%cell_at(index(1, p), index(2, p)) = 1
      end do
      cells%n_cells = count(cells%cell_at > 0)
      cells%n_with_points = cells%n_cells
      allocate (cells%cell_index(2, cells%n_cells + 16))
      cells%n_cells = 0
      do j = lbound(cells%cell_at, 2), ubound(cells%cell_at, 2)
         do i = lbound(cells%cell_at, 1), ubound(cells%cell_at, 1)
            if (cells%cell_at(i, j) == 0) cycle
            cells%n_cells = cells%n_cells + 1
            cells%cell_at(i, j) = cells%n_cells
            cells%cell_index(:, cells%n_cells) = [i, j]
         end do
      end do
   end subroutine number_cells

   !> Collect the points of every cell.
   pure subroutine sort_points(cells, index)
      type(cells_type), intent(inout) :: cells
      integer, intent(in) :: index(:, :)
      integer :: cell(size(index, 2)), p

      do p = 1, size(cell)
         cell(p) = cells%cell_at(index(1, p), index(2, p))
      end do
      allocate (cells%point_start(cells%n_cells + 1), cells%point(size(cell)))
      call sort_by_number(cell, cells%point_start, cells%point)
   end subroutine sort_points

   !> Number of the active cell with a grid index, or 0.
   pure function number_at(self, index) result(number)
      class(cells_type), intent(in) :: self
      !> Grid index of a cell, anywhere.
      integer, intent(in) :: index(2)
      integer :: number

      number = 0
      if (any(index < lbound(self%cell_at) .or. index > ubound(self%cell_at))) return
      number = self%cell_at(index(1), index(2))
   end function number_at

   !> Make a cell without points active and give its number; 0 outside the window.
   pure subroutine append_cell(self, index, number)
      class(cells_type), intent(inout) :: self
      !> Grid index of a cell that is not active yet.
      integer, intent(in) :: index(2)
      !> Its number from now on.
      integer, intent(out) :: number
      integer, allocatable :: grown(:, :)

      number = 0
      if (any(index < lbound(self%cell_at) .or. index > ubound(self%cell_at))) return
      if (self%n_cells == size(self%cell_index, 2)) then
         allocate (grown(2, 2*self%n_cells))
         grown(:, :self%n_cells) = self%cell_index
         call move_alloc(grown, self%cell_index)
      end if
      self%n_cells = self%n_cells + 1
      self%cell_index(:, self%n_cells) = index
      self%cell_at(index(1), index(2)) = self%n_cells
      number = self%n_cells
   end subroutine append_cell

   !> Where two active cells meet at a corner only, make the other two cells at it active as well:
   !> no face would hold their nodes together.
   pure subroutine bridge_corners(cells)
      !> Active cells, not numbered row by row any more.
      type(cells_type), intent(inout) :: cells
      integer :: c, side, n, added
      integer :: at(2)

      n = cells%n_cells
      do c = 1, n
         at = cells%cell_index(:, c)
         do side = -1, 1, 2
            if (cells%number_at(at + [side, 1]) == 0) cycle
            if (cells%number_at(at + [side, 0]) + cells%number_at(at + [0, 1]) > 0) cycle
            call cells%append_cell(at + [side, 0], added)
            call cells%append_cell(at + [0, 1], added)
         end do
      end do
   end subroutine bridge_corners

   !> Number the nodes of all active cells, row by row.
   pure subroutine number_nodes(cells)
      !> Active cells; gets `node`, `n_nodes` and `node_index`.
      type(cells_type), intent(inout) :: cells
      integer, allocatable :: node_at(:, :)
      integer :: c, i, j, k, corner(2)

      associate (lower => lbound(cells%cell_at), upper => ubound(cells%cell_at))
         allocate (node_at(lower(1):upper(1) + 1, lower(2):upper(2) + 1), source=0)
      end associate
      do c = 1, cells%n_cells
         do k = 1, 4
            corner = cells%cell_index(:, c) + cell_nodes_2d(:, k)
            node_at(corner(1), corner(2)) = 1
         end do
      end do
      cells%n_nodes = count(node_at > 0)
      allocate (cells%node_index(2, cells%n_nodes), cells%node(4, cells%n_cells))
      cells%n_nodes = 0
      do j = lbound(node_at, 2), ubound(node_at, 2)
         do i = lbound(node_at, 1), ubound(node_at, 1)
            if (node_at(i, j) == 0) cycle
            cells%n_nodes = cells%n_nodes + 1
            node_at(i, j) = cells%n_nodes
            cells%node_index(:, cells%n_nodes) = [i, j]
         end do
      end do
      do c = 1, cells%n_cells
         do k = 1, 4
            corner = cells%cell_index(:, c) + cell_nodes_2d(:, k)
            cells%node(k, c) = node_at(corner(1), corner(2))
         end do
      end do
   end subroutine number_nodes

   !> The next active cell a step away from a cell that hangs together with it: the only one there
   !> is, or, among sheets, one with the same nodes where both places touch.
   pure function next_beside(self, cell, step, last) result(beside)
      class(cells_type), intent(in) :: self
      !> Number of a cell; way to the other place, each component from -1 to 1.
      integer, intent(in) :: cell, step(2)
      !> The last one that was found, 0 for the first.
      integer, intent(in) :: last
      !> Its number, 0 if there is none or no other.
      integer :: beside

      if (.not. allocated(self%next_sheet)) then
         beside = 0
         if (last == 0) beside = self%number_at(self%cell_index(:, cell) + step)
         return
      end if
      if (last == 0) then
         beside = self%number_at(self%cell_index(:, cell) + step)
      else
         beside = self%next_sheet(last)
      end if
      do while (beside > 0)
         if (hang_together(self%node(:, cell), self%node(:, beside), step)) exit
         beside = self%next_sheet(beside)
      end do
   end function next_beside

   !> Is there a cell a step away that hangs together with a cell?
   pure function has_beside(self, cell, step) result(answer)
      class(cells_type), intent(in) :: self
      !> See `next_beside`.
      integer, intent(in) :: cell, step(2)
      logical :: answer

      answer = self%next_beside(cell, step, 0) > 0
   end function has_beside

   !> Have two cells, of which the second is a step away, the same nodes where they touch?
   pure function hang_together(own, other, step) result(answer)
      !> Nodes of both.
      integer, intent(in) :: own(4), other(4)
      integer, intent(in) :: step(2)
      logical :: answer
      integer :: k, l

      answer = .true.
      do k = 1, 4
         do l = 1, 4
            if (any(cell_nodes_2d(:, k) /= cell_nodes_2d(:, l) + step)) cycle
            answer = answer .and. own(k) == other(l)
         end do
      end do
   end function hang_together

   !> Position in a cell over its edge lengths: 0 to 1 inside, shape (2).
   pure function local_position(self, grid, cell, position) result(local)
      class(cells_type), intent(in) :: self
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Number of the active cell.
      integer, intent(in) :: cell
      !> Position, length units.
      real(wp), intent(in) :: position(2)
      real(wp) :: local(2)

      local = (position - grid%origin)/grid%spacing - real(self%cell_index(:, cell) - 1, wp)
   end function local_position

end module coulter_grid_cells
