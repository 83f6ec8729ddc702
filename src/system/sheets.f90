!> Nodes and cells that are there several times, one for every part of the material around them.
!>
!> What a node carries is its part of the material in the cells around it. Where that hangs together
!> there, as nearly everywhere, the node is one; where surfaces face each other across less than
!> that, every side gets a node of its own, so that both move as they like. Cells follow: one sheet
!> for every set of nodes that tiles in it hang on (theory, section 8). Compare the virtual nodes of
!> Molino, N., Bao, Z. and Fedkiw, R. (2004), ACM Trans. Graph. 23, 385-392.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_sheets
   use coulter_base_sets, only: join_sets, root_of
   use coulter_base_sorting, only: sort_by_number
   use coulter_grid, only: cell_nodes_2d
   use coulter_grid_cells, only: cells_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: split_sheets, bridge_sheets

   !> What of every tile is in every cell.
   type :: pieces_type
      !> Number of pieces.
      integer :: n = 0
      !> Cell and tile of every piece, and the nodes of the cell that it hangs on, shapes (n) and
      !> (4, n).
      integer, allocatable :: cell(:), tile(:), node(:, :)
      !> Pieces by cell, in ragged rows.
      integer, allocatable :: start(:), item(:)
      !> Piece of every vertex of every tile, shape (4, n_tiles), and of every sample.
      integer, allocatable :: of_vertex(:, :), of_sample(:)
   end type pieces_type

contains

   !> Give every part of the material nodes and cells of its own.
   pure subroutine split_sheets(cells, home, tiling, tile_of_sample, is_loose)
      !> Active cells with numbered nodes; get sheets where there are several parts.
      type(cells_type), intent(inout) :: cells
      !> Cell of every corner, then of every sample; on return their sheets.
      integer, intent(inout) :: home(:)
      !> Tiles.
      type(tiling_type), intent(in) :: tiling
      !> Tile of every sample.
      integer, intent(in) :: tile_of_sample(:)
      !> Does a tile hang together with those of its displacement field by common corners only? Else
      !> with all that share a node.
      logical, intent(in) :: is_loose(:)
      type(pieces_type) :: pieces
      integer :: p, v, n_before

      n_before = cells%n_nodes
      call list_pieces(pieces, home, tiling, tile_of_sample, cells%n_cells)
      call split_nodes(cells, pieces, tiling, is_loose)
      if (cells%n_nodes == n_before) return
      call split_cells(cells, pieces)
      do p = 1, size(tiling%corner, 2)
         do v = 1, 4
            home(tiling%corner(v, p)) = pieces%cell(pieces%of_vertex(v, p))
         end do
      end do
      home(tiling%n_corners + 1:) = pieces%cell(pieces%of_sample)
   end subroutine split_sheets

   !> Find the cells that tiles have corners or samples in.
   pure subroutine list_pieces(pieces, home, tiling, tile_of_sample, n_cells)
      type(pieces_type), intent(out) :: pieces
      integer, intent(in) :: home(:), tile_of_sample(:), n_cells
      type(tiling_type), intent(in) :: tiling
      integer :: p, v, k, first

      allocate (pieces%cell(size(tiling%corner) + size(tile_of_sample)))
      allocate (pieces%tile(size(pieces%cell)))
      allocate (pieces%of_vertex(4, size(tiling%corner, 2)), pieces%of_sample(size(tile_of_sample)))
      k = 0
      do p = 1, size(tiling%corner, 2)
         first = pieces%n + 1
         do v = 1, 4
            call find_piece(pieces, first, home(tiling%corner(v, p)), p, pieces%of_vertex(v, p))
         end do
         do while (k < size(tile_of_sample))
            if (tile_of_sample(k + 1) /= p) exit
            k = k + 1
            call find_piece(pieces, first, home(tiling%n_corners + k), p, pieces%of_sample(k))
         end do
      end do
      allocate (pieces%start(n_cells + 1), pieces%item(pieces%n))
      call sort_by_number(pieces%cell(:pieces%n), pieces%start, pieces%item)
   end subroutine list_pieces

   !> The piece of a tile in a cell, made if need be; those of the tile begin with `first`.
   pure subroutine find_piece(pieces, first, cell, tile, piece)
      type(pieces_type), intent(inout) :: pieces
      integer, intent(in) :: first, cell, tile
      integer, intent(inout) :: piece

      do piece = first, pieces%n
         if (pieces%cell(piece) == cell) return
      end do
      pieces%n = piece
      pieces%cell(piece) = cell
      pieces%tile(piece) = tile
   end subroutine find_piece

   !> Give every part of the material around a node a node of its own; the first keeps the old one.
   pure subroutine split_nodes(cells, pieces, tiling, is_loose)
      type(cells_type), intent(inout) :: cells
      !> Pieces; get `node`.
      type(pieces_type), intent(inout) :: pieces
      type(tiling_type), intent(in) :: tiling
      logical, intent(in) :: is_loose(:)
      integer :: around(cells%n_nodes + 1), place(size(cells%node)), old(pieces%n)
      integer :: at(tiling%n_corners), node, n_new, n_parts
      logical :: has_surface(cells%n_cells)

      allocate (pieces%node(4, pieces%n))
      pieces%node = cells%node(:, pieces%cell(:pieces%n))
      call find_surface(has_surface, pieces, tiling)
      call sort_by_number(reshape(cells%node, [size(cells%node)]), around, place)
      at = 0
      n_new = 0
      do node = 1, cells%n_nodes
         associate (mine => place(around(node):around(node + 1) - 1))
            if (.not. any(has_surface((mine + 3)/4))) cycle
            call split_node(pieces, mine, cells%n_nodes + n_new, tiling, is_loose, at, n_parts)
         end associate
         old(n_new + 1:n_new + n_parts - 1) = node
         n_new = n_new + max(n_parts - 1, 0)
      end do
      cells%node_index = cells%node_index(:, [[(node, node=1, cells%n_nodes)], old(:n_new)])
      cells%n_nodes = cells%n_nodes + n_new
   end subroutine split_nodes

   !> Number the parts of the material around a node.
   pure subroutine split_node(pieces, mine, n_nodes, tiling, is_loose, at, n_parts)
      type(pieces_type), intent(inout) :: pieces
      !> Where the node stands in `node` of the cells, taken as one row; the last node so far.
      integer, intent(in) :: mine(:), n_nodes
      type(tiling_type), intent(in) :: tiling
      logical, intent(in) :: is_loose(:)
      !> See `join_pieces`.
      integer, intent(inout) :: at(:)
      !> Number of parts.
      integer, intent(out) :: n_parts
      integer, allocatable :: list(:), vertex(:), parent(:), number(:)
      integer :: i, k

      allocate (list(0), vertex(0))
      do k = 1, size(mine)
         associate (c => (mine(k) + 3)/4)
            list = [list, pieces%item(pieces%start(c):pieces%start(c + 1) - 1)]
            vertex = [vertex, spread(mine(k) - 4*c + 4, 1, size(list) - size(vertex))]
         end associate
      end do
      call join_pieces(parent, pieces%tile(list), tiling, is_loose, at)
      n_parts = 0
      allocate (number(size(list)))
      do i = 1, size(list)
         if (root_of(parent, i) == i) n_parts = n_parts + 1
         number(i) = n_parts
         if (root_of(parent, i) /= i) number(i) = number(root_of(parent, i))
         if (number(i) > 1) pieces%node(vertex(i), list(i)) = n_nodes + number(i) - 1
      end do
   end subroutine split_node

   !> Cells with tiles that own outer edges.
   pure subroutine find_surface(has_surface, pieces, tiling)
      logical, intent(out) :: has_surface(:)
      type(pieces_type), intent(in) :: pieces
      type(tiling_type), intent(in) :: tiling
      logical :: is_outer(size(tiling%corner, 2))
      integer :: k

      is_outer = .false.
      is_outer(tiling%outer_edge(3, :)) = .true.
      has_surface = .false.
      do k = 1, pieces%n
         if (is_outer(pieces%tile(k))) has_surface(pieces%cell(k)) = .true.
      end do
   end subroutine find_surface

   !> Which tiles around a node hang together?
   pure subroutine join_pieces(parent, tile, tiling, is_loose, at)
      !> Disjoint sets of the tiles (`coulter_base_sets`); their roots are the first members.
      integer, allocatable, intent(out) :: parent(:)
      !> The tiles; one may be there several times.
      integer, intent(in) :: tile(:)
      type(tiling_type), intent(in) :: tiling
      logical, intent(in) :: is_loose(:)
      !> Zeros, shape (n_corners), on return as well.
      integer, intent(inout) :: at(:)
      integer :: anchor(size(tile)), i, v

      parent = [(i, i=1, size(tile))]
      do i = 1, size(tile)
         do v = 1, 4
            associate (last => at(tiling%corner(v, tile(i))))
               if (last > 0) call join_sets(parent, last, i)
               last = i
            end associate
         end do
      end do
      at(reshape(tiling%corner(:, tile), [4*size(tile)])) = 0
      ! what is not loose holds together all of its field, with the first of that
      anchor = [(first_fast(i), i=1, size(tile))]
      do i = 1, size(tile)
         if (anchor(i) > 0) call join_sets(parent, anchor(i), i)
      end do

   contains

      !> First member of the field of a member that is not loose, 0 if there is none.
      pure function first_fast(member) result(first)
         integer, intent(in) :: member
         integer :: first

         do first = 1, size(tile)
            if (.not. is_loose(tile(first)) .and. field_of(first) == field_of(member)) return
         end do
         first = 0
      end function first_fast

      !> Displacement field of a member.
      pure function field_of(member) result(field)
         integer, intent(in) :: member
         integer :: field

         field = 1
         if (allocated(tiling%field)) field = tiling%field(tile(member))
      end function field_of

   end subroutine join_pieces

   !> Give every set of nodes that pieces of a cell hang on a sheet of its own.
   pure subroutine split_cells(cells, pieces)
      type(cells_type), intent(inout) :: cells
      !> Pieces with nodes; on return their cells are the sheets.
      type(pieces_type), intent(inout) :: pieces
      integer :: node(4, cells%n_cells + pieces%n), index(2, cells%n_cells + pieces%n), &
         next(cells%n_cells + pieces%n), c, i, k, n, sheet

      node(:, :cells%n_cells) = cells%node(:, :cells%n_cells)
      index(:, :cells%n_cells) = cells%cell_index(:, :cells%n_cells)
      next = 0
      n = cells%n_cells
      do c = 1, cells%n_cells
         do k = pieces%start(c), pieces%start(c + 1) - 1
            i = pieces%item(k)
            if (k == pieces%start(c)) node(:, c) = pieces%node(:, i)
            sheet = c
            do while (any(node(:, sheet) /= pieces%node(:, i)))
               if (next(sheet) == 0) then
                  n = n + 1
                  next(sheet) = n
                  node(:, n) = pieces%node(:, i)
                  index(:, n) = index(:, c)
               end if
               sheet = next(sheet)
            end do
            pieces%cell(i) = sheet
         end do
      end do
      cells%n_cells = n
      cells%node = node(:, :n)
      cells%cell_index = index(:, :n)
      cells%next_sheet = next(:n)
   end subroutine split_cells

   !> Where two cells hang together at one node only, add sheets at the other two places around it:
   !> no face would hold their nodes together (`bridge_corners`).
   pure subroutine bridge_sheets(cells)
      !> Active cells with numbered nodes, with or without sheets.
      type(cells_type), intent(inout) :: cells
      integer :: c, other, side

      do c = 1, size(cells%node, 2)
         do side = -1, 1, 2
            other = cells%next_beside(c, [side, 1], 0)
            if (other == 0) cycle
            if (cells%has_beside(c, [side, 0]) .or. cells%has_beside(c, [0, 1])) cycle
            call add_bridge(cells, c, other, cells%cell_index(:, c) + [side, 0])
            call add_bridge(cells, c, other, cells%cell_index(:, c) + [0, 1])
         end do
      end do
   end subroutine bridge_sheets

   !> Add a sheet that has nodes with two cells in common, and one of its own.
   pure subroutine add_bridge(cells, first, second, index)
      type(cells_type), intent(inout) :: cells
      !> The two cells, and the place of the sheet.
      integer, intent(in) :: first, second, index(2)
      integer :: node(4), k, last

      if (any(index < lbound(cells%cell_at) .or. index > ubound(cells%cell_at))) return
      do k = 1, 4
         node(k) = max(node_at(first, index + cell_nodes_2d(:, k)), &
                       node_at(second, index + cell_nodes_2d(:, k)))
         if (node(k) > 0) cycle
         cells%n_nodes = cells%n_nodes + 1
         node(k) = cells%n_nodes
         cells%node_index = reshape([cells%node_index, index + cell_nodes_2d(:, k)], &
                                    [2, cells%n_nodes])
      end do
      if (.not. allocated(cells%next_sheet)) cells%next_sheet = spread(0, 1, cells%n_cells)
      last = cells%cell_at(index(1), index(2))
      cells%cell_index = reshape([cells%cell_index(:, :cells%n_cells), index], &
                                 [2, cells%n_cells + 1])
      cells%n_cells = cells%n_cells + 1
      cells%node = reshape([cells%node, node], [4, cells%n_cells])
      cells%next_sheet = [cells%next_sheet, 0]
      if (last == 0) then
         cells%cell_at(index(1), index(2)) = cells%n_cells
         return
      end if
      do while (cells%next_sheet(last) > 0)
         last = cells%next_sheet(last)
      end do
      cells%next_sheet(last) = cells%n_cells

   contains

      !> Node of a cell at a place, 0 if it has none there.
      pure function node_at(cell, place) result(number)
         integer, intent(in) :: cell, place(2)
         integer :: number
         integer :: j

         number = 0
         do j = 1, 4
            if (any(cells%cell_index(:, cell) + cell_nodes_2d(:, j) /= place)) cycle
            number = cells%node(j, cell)
         end do
      end function node_at

   end subroutine add_bridge

end module coulter_system_sheets
