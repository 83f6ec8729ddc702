!> Where the corners of tiles sit in the grid of the current step, and what that makes of the grid.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_tile_map
   use coulter_base_kinds, only: wp
   use coulter_grid, only: grid_type
   use coulter_grid_cells, only: bridge_corners, cells_type, find_cells, number_cells, number_nodes
   use coulter_grid_shape, only: shape_values_2d
   use coulter_points_tiling, only: corner_gradients, tiling_type, values_at
   use coulter_system_sheets, only: bridge_sheets, split_sheets
   implicit none(type, external)
   private
   public :: tile_map_type, map_tiles, interpolate, spread_to_nodes

   !> Corner-to-node map of a step, with the geometry of the tiles at its start.
   type :: tile_map_type
      !> Cell of every corner, shape (n_corners).
      integer, allocatable :: cell(:)
      !> Nodes of the cell of every corner, shape (4, n_corners).
      integer, allocatable :: node(:, :)
      !> Shape functions of these nodes at the corner, shape (4, n_corners).
      real(wp), allocatable :: shape(:, :)
      !> Gradients of the corner functions of every tile, per length, shape (2, 4, n_tiles).
      real(wp), allocatable :: gradient(:, :, :)
      !> Area of every tile, shape (n_tiles).
      real(wp), allocatable :: area(:)
      !> Displacement increments of the corners, length units, shape (2, n_corners).
      real(wp), allocatable :: increment(:, :)
      !> Share of every active cell that tiles fill, from nine samples a tile, shape (n_cells).
      real(wp), allocatable :: fill(:)
      !> A tile in every active cell, or beside it where it is empty, shape (n_cells).
      integer, allocatable :: tile_in_cell(:)
      !> Area that every node carries over that of a cell, shape (n_nodes).
      real(wp), allocatable :: node_area(:)
   end type tile_map_type

   !> How far corners are moved towards their tiles to find their cell, as a share of the way: this
   !> decides for corners on grid lines.
   real(wp), parameter :: nudge = 1.0e-7_wp
   !> Shape functions smaller than this are round-off of corners on grid lines.
   real(wp), parameter :: smallest_shape = 1.0e-13_wp
   !> Samples per direction and tile for the share of cells that is filled.
   integer, parameter :: n_samples = 3
contains

   !> Locate all tiles; number cells and nodes.
   pure subroutine map_tiles(map, cells, tiling, grid, first_outside, is_loose)
      !> Map to make.
      type(tile_map_type), intent(out) :: map
      !> Active cells and nodes to make.
      type(cells_type), intent(out) :: cells
      !> Tiles at the start of the step.
      type(tiling_type), intent(in) :: tiling
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> First corner outside the grid, else 0; then nothing is made.
      integer, intent(out) :: first_outside
      !> Where surfaces of bodies move apart: do tiles hang together by common corners only, shape
      !> (n_tiles)? Else with all of their displacement field that share a node with them.
      logical, intent(in), optional :: is_loose(:)
      real(wp), allocatable :: samples(:, :)
      real(wp) :: inside(2, tiling%n_corners)
      integer, allocatable :: index(:, :), of_corners(:, :), home(:)
      logical :: is_straddling(size(tiling%corner, 2))
      integer :: n, k, p

      n = tiling%n_corners
      call move_inside(tiling, inside)
      allocate (of_corners(2, n))
      call find_cells(grid, inside, of_corners, first_outside)
      if (first_outside > 0) return
      call find_straddling(tiling, of_corners, is_straddling)
      allocate (samples(2, n_samples**2*count(is_straddling)))
      call sample_tiles(tiling, is_straddling, samples)
      allocate (index(2, n + size(samples, 2)))
      index(:, :n) = of_corners
      call find_cells(grid, samples, index(:, n + 1:), first_outside)
      if (first_outside > 0) return
      call number_cells(cells, grid, index)
      if (.not. present(is_loose)) call bridge_corners(cells)
      call number_nodes(cells)
      home = [(cells%cell_at(index(1, k), index(2, k)), k=1, size(index, 2))]
      if (present(is_loose)) then
         associate (straddling => pack([(p, p=1, size(is_straddling))], is_straddling))
            call split_sheets(cells, home, tiling, [(spread(straddling(p), 1, n_samples**2), &
                                                     p=1, size(straddling))], is_loose)
         end associate
         call bridge_sheets(cells)
      end if
      call measure_tiles(map, tiling)
      call measure_fill(map, cells, grid, tiling, is_straddling, home)
      call map_corners(map, cells, tiling, grid, home)
      call measure_nodes(map, cells, tiling, grid)
   end subroutine map_tiles

   !> Displacement increments of the corners from those of the nodes.
   pure subroutine interpolate(map, nodal)
      !> Map; gets `increment`.
      type(tile_map_type), intent(inout) :: map
      !> Increments of the nodes, length units, shape (2, n_nodes).
      real(wp), intent(in) :: nodal(:, :)
      real(wp) :: sum(2)
      integer :: c, k

      do c = 1, size(map%node, 2)
         sum = 0.0_wp
         do k = 1, 4
            sum = sum + map%shape(k, c)*nodal(:, map%node(k, c))
         end do
         map%increment(:, c) = sum
      end do
   end subroutine interpolate

   !> Add forces on the corners to those on the nodes, the transpose of `interpolate`.
   pure subroutine spread_to_nodes(map, at_corners, nodal)
      !> Map.
      type(tile_map_type), intent(in) :: map
      !> Forces on the corners, shape (2, n_corners).
      real(wp), intent(in) :: at_corners(:, :)
      !> Forces on the nodes, shape (2, n_nodes).
      real(wp), intent(inout) :: nodal(:, :)
      integer :: c, k

      do c = 1, size(map%node, 2)
         do k = 1, 4
            nodal(:, map%node(k, c)) = nodal(:, map%node(k, c)) + map%shape(k, c)*at_corners(:, c)
         end do
      end do
   end subroutine spread_to_nodes

   !> Corners, moved a little towards the tiles that they belong to.
   pure subroutine move_inside(tiling, inside)
      type(tiling_type), intent(in) :: tiling
      real(wp), intent(out) :: inside(:, :)
      real(wp) :: centre(2)
      integer :: owners(tiling%n_corners), p, k

      inside = 0.0_wp
      owners = 0
      do p = 1, size(tiling%corner, 2)
         associate (corner => tiling%corner(:, p))
            centre = 0.25_wp*sum(tiling%position(:, corner), dim=2)
            do k = 1, 4
               inside(:, corner(k)) = inside(:, corner(k)) + centre
               owners(corner(k)) = owners(corner(k)) + 1
            end do
         end associate
      end do
      do k = 1, tiling%n_corners
         inside(:, k) = (1.0_wp - nudge)*tiling%position(:, k) &
            + nudge*inside(:, k)/real(owners(k), wp)
      end do
   end subroutine move_inside

   !> Tiles whose corners are in different cells.
   pure subroutine find_straddling(tiling, index, is_straddling)
      type(tiling_type), intent(in) :: tiling
      !> Grid index of the cells of all corners.
      integer, intent(in) :: index(:, :)
      logical, intent(out) :: is_straddling(:)
      integer :: p, v

      is_straddling = .false.
      do p = 1, size(is_straddling)
         associate (corner => tiling%corner(:, p))
            do v = 2, 4
               if (any(index(:, corner(v)) /= index(:, corner(1)))) is_straddling(p) = .true.
            end do
         end associate
      end do
   end subroutine find_straddling

   !> Nine samples in every tile that straddles, tile by tile.
   pure subroutine sample_tiles(tiling, is_straddling, samples)
      type(tiling_type), intent(in) :: tiling
      logical, intent(in) :: is_straddling(:)
      real(wp), intent(out) :: samples(:, :)
      real(wp) :: share(4, n_samples**2), position(2, 4)
      integer :: p, i, j, k, n

      do j = 1, n_samples
         do i = 1, n_samples
            share(:, i + n_samples*(j - 1)) = &
               shape_values_2d((real([i, j], wp) - 0.5_wp)/real(n_samples, wp))
         end do
      end do
      n = 0
      do p = 1, size(tiling%corner, 2)
         if (.not. is_straddling(p)) cycle
         position = values_at(tiling%corner(:, p), tiling%position)
         do k = 1, n_samples**2
            n = n + 1
            samples(:, n) = position(:, 1)*share(1, k) + position(:, 2)*share(2, k) &
               + position(:, 3)*share(3, k) + position(:, 4)*share(4, k)
         end do
      end do
   end subroutine sample_tiles

   !> Gradients and areas at the start of the step.
   pure subroutine measure_tiles(map, tiling)
      type(tile_map_type), intent(inout) :: map
      type(tiling_type), intent(in) :: tiling
      integer :: p

      allocate (map%gradient(2, 4, size(tiling%corner, 2)), map%area(size(tiling%corner, 2)))
      do p = 1, size(tiling%corner, 2)
         call corner_gradients(values_at(tiling%corner(:, p), tiling%position), &
                               map%gradient(:, :, p), map%area(p))
      end do
   end subroutine measure_tiles

   !> Share of every cell that is filled.
   pure subroutine measure_fill(map, cells, grid, tiling, is_straddling, home)
      type(tile_map_type), intent(inout) :: map
      type(cells_type), intent(in) :: cells
      type(grid_type), intent(in) :: grid
      type(tiling_type), intent(in) :: tiling
      logical, intent(in) :: is_straddling(:)
      !> Cells of all corners, then of all samples.
      integer, intent(in) :: home(:)
      integer :: p, k, n

      allocate (map%fill(cells%n_cells), source=0.0_wp)
      call choose_tiles(map, cells, tiling, home)
      n = tiling%n_corners
      do p = 1, size(map%area)
         if (.not. is_straddling(p)) then
            call add_area(map, p, home(tiling%corner(1, p)), map%area(p))
            cycle
         end if
         do k = 1, n_samples**2
            n = n + 1
            call add_area(map, p, home(n), map%area(p)/real(n_samples**2, wp))
         end do
      end do
      map%fill = map%fill/grid%cell_volume()
   end subroutine measure_fill

   !> A tile with a corner in every cell; cells that only bridge corners take one of a cell beside
   !> them. Tiles that fill a cell replace it later.
   pure subroutine choose_tiles(map, cells, tiling, home)
      type(tile_map_type), intent(inout) :: map
      type(cells_type), intent(in) :: cells
      type(tiling_type), intent(in) :: tiling
      !> Cells of all corners, and of samples.
      integer, intent(in) :: home(:)
      integer, parameter :: beside(2, 4) = reshape([-1, 0, 1, 0, 0, -1, 0, 1], [2, 4])
      integer :: p, v, c, other

      allocate (map%tile_in_cell(cells%n_cells), source=0)
      do p = 1, size(map%area)
         do v = 1, 4
            map%tile_in_cell(home(tiling%corner(v, p))) = p
         end do
      end do
      do c = 1, cells%n_cells
         do v = 1, 4
            if (map%tile_in_cell(c) > 0) exit
            other = cells%next_beside(c, beside(:, v), 0)
            if (other > 0) map%tile_in_cell(c) = map%tile_in_cell(other)
         end do
      end do
   end subroutine choose_tiles

   !> Let a tile fill a part of a cell.
   pure subroutine add_area(map, tile, cell, area)
      type(tile_map_type), intent(inout) :: map
      integer, intent(in) :: tile, cell
      real(wp), intent(in) :: area

      map%fill(cell) = map%fill(cell) + area
      map%tile_in_cell(cell) = tile
   end subroutine add_area

   !> Nodes and shape functions of all corners.
   pure subroutine map_corners(map, cells, tiling, grid, home)
      type(tile_map_type), intent(inout) :: map
      type(cells_type), intent(in) :: cells
      type(tiling_type), intent(in) :: tiling
      type(grid_type), intent(in) :: grid
      !> Cells of all corners.
      integer, intent(in) :: home(:)
      real(wp) :: origin(2), spacing(2)
      integer :: k

      origin = grid%origin
      spacing = grid%spacing
      allocate (map%node(4, tiling%n_corners), map%shape(4, tiling%n_corners))
      allocate (map%increment(2, tiling%n_corners), source=0.0_wp)
      map%cell = home(:tiling%n_corners)
      do k = 1, tiling%n_corners
         map%node(:, k) = cells%node(:, map%cell(k))
         map%shape(:, k) = shape_values_2d((tiling%position(:, k) - origin)/spacing &
                                           - real(cells%cell_index(:, map%cell(k)) - 1, wp))
         where (abs(map%shape(:, k)) < smallest_shape) map%shape(:, k) = 0.0_wp
      end do
   end subroutine map_corners

   !> Area that hangs on every node.
   pure subroutine measure_nodes(map, cells, tiling, grid)
      type(tile_map_type), intent(inout) :: map
      type(cells_type), intent(in) :: cells
      type(tiling_type), intent(in) :: tiling
      type(grid_type), intent(in) :: grid
      integer :: corner, p, k, a

      allocate (map%node_area(cells%n_nodes), source=0.0_wp)
      do p = 1, size(tiling%corner, 2)
         do k = 1, 4
            corner = tiling%corner(k, p)
            do a = 1, 4
               map%node_area(map%node(a, corner)) = map%node_area(map%node(a, corner)) &
                  + 0.25_wp*map%area(p)*map%shape(a, corner)
            end do
         end do
      end do
      map%node_area = map%node_area/grid%cell_volume()
   end subroutine measure_nodes

end module coulter_system_tile_map
