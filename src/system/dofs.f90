!> Unknowns of the current step: which nodal displacements are free, held, or follow others.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_dofs
   use coulter_algebra_sparse, only: element_dofs_type
   use coulter_base_kinds, only: wp
   use coulter_grid, only: grid_type
   use coulter_grid_cells, only: cells_type
   use coulter_grid_shape, only: shape_values_2d
   use coulter_model, only: fixity_type
   use coulter_system_leading_cell, only: nearest_leading_cell
   implicit none(type, external)
   private
   public :: dofs_type, number_dofs, nodes_of_filled_cells, couple_cells, expand, reduce

   !> Numbering of the nodal displacements, with aggregation: an outer node, one that no filled cell
   !> touches (points) or that carries too little area (tiles), follows by extrapolation from the
   !> nearest cell that may lead (theory, section 3, trap 3, and section 4).
   type :: dofs_type
      !> Number of unknowns.
      integer :: n_dofs = 0
      !> Unknown of every nodal component, 0 if it is held, -k if it follows as the k-th outer
      !> node, shape (2, n_nodes).
      integer, allocatable :: dof(:, :)
      !> Fixity that holds the component, or 0, shape (2, n_nodes).
      integer, allocatable :: fixity(:, :)
      !> Number of outer nodes.
      integer :: n_outer = 0
      !> Outer nodes, shape (n_outer).
      integer, allocatable :: outer(:)
      !> Nodes that an outer node follows, shape (4, n_outer).
      integer, allocatable :: master(:, :)
      !> Their shares, shape (4, n_outer).
      real(wp), allocatable :: share(:, :)
   end type dofs_type

contains

   !> Number the unknowns of all active nodes.
   pure subroutine number_dofs(dofs, grid, cells, is_core, may_lead, fill, fixities)
      !> Numbering to make.
      type(dofs_type), intent(out) :: dofs
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Active cells with numbered nodes.
      type(cells_type), intent(in) :: cells
      !> Is a node an unknown of its own, or else an outer node, shape (n_nodes)?
      logical, intent(in) :: is_core(:)
      !> May outer nodes follow the nodes of a cell, shape (<= n_cells)? All of them are core then.
      logical, intent(in) :: may_lead(:)
      !> Share of these cells that is filled.
      real(wp), intent(in) :: fill(:)
      !> Conforming boundary conditions.
      type(fixity_type), intent(in) :: fixities(:)
      integer :: node, i

      allocate (dofs%dof(2, cells%n_nodes), source=1)
      call list_outer_nodes(dofs, is_core)
      call hold_nodes(dofs, grid, cells, fixities)
      call follow_cells(dofs, grid, cells, may_lead, fill)
      do node = 1, cells%n_nodes
         do i = 1, 2
            if (dofs%dof(i, node) <= 0) cycle
            dofs%n_dofs = dofs%n_dofs + 1
            dofs%dof(i, node) = dofs%n_dofs
         end do
      end do
   end subroutine number_dofs

   !> The unknowns that every cell couples, for the sparsity pattern. A cell with outer nodes
   !> couples the unknowns of all their masters.
   pure subroutine couple_cells(dofs, cells, elements, transform_start, transform)
      !> Numbering.
      type(dofs_type), intent(in) :: dofs
      !> Active cells.
      type(cells_type), intent(in) :: cells
      !> Unknowns of every cell; in the order of its nodes if the cell has no outer node.
      type(element_dofs_type), intent(out) :: elements
      !> First column of every cell in `transform`, shape (n_cells + 1); none for plain cells.
      integer, allocatable, intent(out) :: transform_start(:)
      !> Nodal components (rows) in terms of the unknowns of the cell (columns), shape (8, n).
      real(wp), allocatable, intent(out) :: transform(:, :)
      integer :: c, m, n_columns, n_outer_cells, coupled(40)
      real(wp) :: shares(8, 40)
      logical :: is_plain

      elements%n_elements = cells%n_cells
      allocate (elements%start(cells%n_cells + 1), transform_start(cells%n_cells + 1))
      n_outer_cells = count_outer_cells(dofs, cells)
      allocate (elements%dof(8*cells%n_cells + 40*n_outer_cells), transform(8, 40*n_outer_cells))
      elements%start(1) = 1
      transform_start(1) = 1
      do c = 1, cells%n_cells
         call couple_cell(dofs, cells%node(:, c), coupled, m, shares, is_plain)
         elements%start(c + 1) = elements%start(c) + m
         elements%dof(elements%start(c):elements%start(c + 1) - 1) = coupled(:m)
         n_columns = merge(0, m, is_plain)
         transform_start(c + 1) = transform_start(c) + n_columns
         transform(:, transform_start(c):transform_start(c + 1) - 1) = shares(:, :n_columns)
      end do
      elements%dof = elements%dof(:elements%start(cells%n_cells + 1) - 1)
      transform = transform(:, :transform_start(cells%n_cells + 1) - 1)
   end subroutine couple_cells

   !> Nodal values from the unknowns.
   pure subroutine expand(dofs, unknowns, nodal)
      !> Numbering.
      type(dofs_type), intent(in) :: dofs
      !> Values of the unknowns, shape (n_dofs).
      real(wp), intent(in) :: unknowns(:)
      !> Values at the nodes, shape (2, n_nodes).
      real(wp), intent(out) :: nodal(:, :)
      integer :: node, i, k

      do node = 1, size(nodal, 2)
         do i = 1, 2
            nodal(i, node) = 0.0_wp
            if (dofs%dof(i, node) > 0) nodal(i, node) = unknowns(dofs%dof(i, node))
         end do
      end do
      do k = 1, dofs%n_outer
         node = dofs%outer(k)
         do i = 1, 2
            if (dofs%dof(i, node) < 0) then
               nodal(i, node) = dot_product(dofs%share(:, k), nodal(i, dofs%master(:, k)))
            end if
         end do
      end do
   end subroutine expand

   !> Forces on the unknowns from nodal forces, the transpose of `expand`. On return the nodal
   !> forces of outer nodes have moved to their masters.
   pure subroutine reduce(dofs, nodal, reduced)
      !> Numbering.
      type(dofs_type), intent(in) :: dofs
      !> Forces on the nodes, shape (2, n_nodes).
      real(wp), intent(inout) :: nodal(:, :)
      !> Forces on the unknowns, shape (n_dofs).
      real(wp), intent(out) :: reduced(:)
      integer :: node, i, j, k

      do k = 1, dofs%n_outer
         node = dofs%outer(k)
         do i = 1, 2
            if (dofs%dof(i, node) >= 0) cycle
            do j = 1, 4
               nodal(i, dofs%master(j, k)) = nodal(i, dofs%master(j, k)) &
                  + dofs%share(j, k)*nodal(i, node)
            end do
            nodal(i, node) = 0.0_wp
         end do
      end do
      do node = 1, size(nodal, 2)
         do i = 1, 2
            if (dofs%dof(i, node) > 0) reduced(dofs%dof(i, node)) = nodal(i, node)
         end do
      end do
   end subroutine reduce

   !> Nodes that touch a filled cell.
   pure function nodes_of_filled_cells(cells, is_filled) result(is_core)
      !> Active cells with numbered nodes.
      type(cells_type), intent(in) :: cells
      !> Does a cell hold enough material, shape (<= n_cells)?
      logical, intent(in) :: is_filled(:)
      logical :: is_core(cells%n_nodes)
      integer :: c

      is_core = .false.
      do c = 1, size(is_filled)
         if (is_filled(c)) is_core(cells%node(:, c)) = .true.
      end do
   end function nodes_of_filled_cells

   !> Mark the outer nodes.
   pure subroutine list_outer_nodes(dofs, is_core)
      type(dofs_type), intent(inout) :: dofs
      logical, intent(in) :: is_core(:)
      integer :: node, k

      dofs%n_outer = count(.not. is_core)
      dofs%outer = pack([(node, node=1, size(is_core))], .not. is_core)
      do k = 1, dofs%n_outer
         dofs%dof(:, dofs%outer(k)) = -k
      end do
   end subroutine list_outer_nodes

   !> Take the held components out; they win over aggregation.
   pure subroutine hold_nodes(dofs, grid, cells, fixities)
      type(dofs_type), intent(inout) :: dofs
      type(grid_type), intent(in) :: grid
      type(cells_type), intent(in) :: cells
      type(fixity_type), intent(in) :: fixities(:)
      real(wp) :: position(2), slack
      integer :: node, f

      allocate (dofs%fixity(2, cells%n_nodes), source=0)
      slack = 1.0e-6_wp*grid%smallest_spacing()
      do f = 1, size(fixities)
         if (.not. fixities(f)%is_active) cycle
         do node = 1, cells%n_nodes
            position = grid%node_position(cells%node_index(:, node))
            if (any(position < fixities(f)%lower - slack)) cycle
            if (any(position > fixities(f)%upper + slack)) cycle
            where (fixities(f)%is_held)
               dofs%dof(:, node) = 0
               dofs%fixity(:, node) = f
            end where
         end do
      end do
   end subroutine hold_nodes

   !> Extrapolate every outer node from the nearest cell that may lead.
   pure subroutine follow_cells(dofs, grid, cells, may_lead, fill)
      type(dofs_type), intent(inout) :: dofs
      type(grid_type), intent(in) :: grid
      type(cells_type), intent(in) :: cells
      logical, intent(in) :: may_lead(:)
      real(wp), intent(in) :: fill(:)
      integer :: k, c

      allocate (dofs%master(4, dofs%n_outer), dofs%share(4, dofs%n_outer))
      do k = 1, dofs%n_outer
         associate (index => cells%node_index(:, dofs%outer(k)))
            c = nearest_leading_cell(grid, cells, may_lead, fill, dofs%outer(k))
            if (c == 0) then
               call set_free(dofs, k)
               cycle
            end if
            dofs%master(:, k) = cells%node(:, c)
            dofs%share(:, k) = shape_values_2d(real(index - cells%cell_index(:, c), wp))
         end associate
      end do
   end subroutine follow_cells

   !> Make an outer node that has nothing to follow an unknown of its own.
   pure subroutine set_free(dofs, k)
      type(dofs_type), intent(inout) :: dofs
      integer, intent(in) :: k

      associate (dof => dofs%dof(:, dofs%outer(k)))
         where (dof < 0) dof = 1
      end associate
      dofs%master(:, k) = dofs%outer(k)
      dofs%share(:, k) = 0.0_wp
   end subroutine set_free

   !> Number of cells with at least one outer node.
   pure function count_outer_cells(dofs, cells) result(n)
      type(dofs_type), intent(in) :: dofs
      type(cells_type), intent(in) :: cells
      integer :: n
      integer :: c

      n = 0
      if (dofs%n_outer == 0) return
      do c = 1, cells%n_cells
         if (any(dofs%dof(:, cells%node(:, c)) < 0)) n = n + 1
      end do
   end function count_outer_cells

   !> Unknowns of one cell, and its nodal components in terms of them if it is not plain.
   pure subroutine couple_cell(dofs, node, coupled, m, shares, is_plain)
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: node(4)
      integer, intent(out) :: coupled(40), m
      real(wp), intent(out) :: shares(8, 40)
      logical, intent(out) :: is_plain
      integer :: row, a, i, j, dof

      ! rows: components first, nodes last
      coupled(:8) = reshape(dofs%dof(:, node), [8])
      m = 8
      is_plain = all(coupled(:8) >= 0)
      if (is_plain) return
      m = 0
      shares = 0.0_wp
      row = 0
      do a = 1, 4
         do i = 1, 2
            row = row + 1
            dof = dofs%dof(i, node(a))
            if (dof >= 0) then
               call add_share(dof, 1.0_wp, row, coupled, m, shares)
               cycle
            end if
            do j = 1, 4
               call add_share(dofs%dof(i, dofs%master(j, -dof)), dofs%share(j, -dof), row, &
                              coupled, m, shares)
            end do
         end do
      end do
   end subroutine couple_cell

   !> Let a nodal component depend on an unknown, unless that is held.
   pure subroutine add_share(dof, share, row, coupled, m, shares)
      integer, intent(in) :: dof, row
      real(wp), intent(in) :: share
      integer, intent(inout) :: coupled(40), m
      real(wp), intent(inout) :: shares(8, 40)
      integer :: column

      if (dof == 0) return
      column = findloc(coupled(:m), dof, dim=1)
      if (column == 0) then
         m = m + 1
         coupled(m) = dof
         column = m
      end if
      shares(row, column) = shares(row, column) + share
   end subroutine add_share

end module coulter_system_dofs
