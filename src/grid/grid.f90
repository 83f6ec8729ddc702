!> The regular background grid: pure geometry, nothing is stored per cell or node.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_grid
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: grid_type, new_grid, cell_nodes_2d

   !> A box of equal cells. Cell (i, j) spans node (i, j) to node (i + 1, j + 1); both count from 1.
   type :: grid_type
      !> Number of space dimensions.
      integer :: n_dim = 2
      !> Position of node (1, 1), length units, shape (n_dim).
      real(wp), allocatable :: origin(:)
      !> Edge lengths of a cell, length units, shape (n_dim).
      real(wp), allocatable :: spacing(:)
      !> Number of cells per direction, shape (n_dim).
      integer, allocatable :: n_cells(:)
   contains
      procedure :: upper_corner
      procedure :: node_position
      procedure :: cell_of
      procedure :: contains_position
      procedure :: cell_volume
      procedure :: smallest_spacing
   end type grid_type

   !> Offsets of the four nodes of a cell in counter-clockwise order, shape (2, 4).
   integer, parameter :: cell_nodes_2d(2, 4) = reshape([0, 0, 1, 0, 1, 1, 0, 1], [2, 4])

contains

   !> Make a grid; all arrays have shape (n_dim).
   pure subroutine new_grid(grid, origin, spacing, n_cells, error)
      !> Grid to make.
      type(grid_type), intent(out) :: grid
      !> Position of the lower corner, length units.
      real(wp), intent(in) :: origin(:)
      !> Edge lengths of a cell, > 0.
      real(wp), intent(in) :: spacing(:)
      !> Number of cells per direction, >= 1.
      integer, intent(in) :: n_cells(:)
      !> Set when a value is out of range.
      type(error_type), allocatable, intent(out) :: error

      if (size(spacing) /= size(origin) .or. size(n_cells) /= size(origin)) then
         call fatal_error(error, "grid: origin, spacing and cells differ in dimension")
      else if (.not. all(spacing > 0.0_wp)) then
         call fatal_error(error, "grid: the spacing must be positive")
      else if (any(n_cells < 1)) then
         call fatal_error(error, "grid: at least one cell is needed in every direction")
      end if
      if (allocated(error)) return
      grid%n_dim = size(origin)
      grid%origin = origin
      grid%spacing = spacing
      grid%n_cells = n_cells
   end subroutine new_grid

   !> Position of the last node, shape (n_dim).
   pure function upper_corner(self) result(position)
      class(grid_type), intent(in) :: self
      real(wp) :: position(self%n_dim)

      position = self%origin + real(self%n_cells, wp)*self%spacing
   end function upper_corner

   !> Position of a node, shape (n_dim).
   pure function node_position(self, node) result(position)
      class(grid_type), intent(in) :: self
      !> Node index per direction, from 1, shape (n_dim).
      integer, intent(in) :: node(self%n_dim)
      real(wp) :: position(self%n_dim)

      position = self%origin + real(node - 1, wp)*self%spacing
   end function node_position

   !> Cell that holds a position, shape (n_dim); a position on the upper faces of the grid belongs
   !> to the last cell. The position must lie in the grid.
   pure function cell_of(self, position) result(cell)
      class(grid_type), intent(in) :: self
      !> Position, length units, shape (n_dim).
      real(wp), intent(in) :: position(self%n_dim)
      integer :: cell(self%n_dim)

      cell = min(max(floor((position - self%origin)/self%spacing) + 1, 1), self%n_cells)
   end function cell_of

   !> Is the position inside the grid or on its faces? False for NaN.
   pure function contains_position(self, position) result(is_inside)
      class(grid_type), intent(in) :: self
      !> Position, length units, shape (n_dim).
      real(wp), intent(in) :: position(self%n_dim)
      logical :: is_inside
      integer :: i

      is_inside = .true.
      do i = 1, self%n_dim
         is_inside = is_inside .and. position(i) >= self%origin(i) &
            .and. position(i) <= self%origin(i) + real(self%n_cells(i), wp)*self%spacing(i)
      end do
   end function contains_position

   !> Volume of a cell (area per unit thickness in plane strain).
   pure function cell_volume(self) result(volume)
      class(grid_type), intent(in) :: self
      real(wp) :: volume

      volume = product(self%spacing)
   end function cell_volume

   !> The length h of the theory: the shortest edge of a cell.
   pure function smallest_spacing(self) result(spacing)
      class(grid_type), intent(in) :: self
      real(wp) :: spacing

      spacing = minval(self%spacing)
   end function smallest_spacing

end module coulter_grid
