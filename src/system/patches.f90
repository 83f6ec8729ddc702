!> Patches: the points of one cell, with all nodes that they hang on.
!>
!> Needed where a cell's own four nodes are not enough, because boxes of points reach into its
!> neighbours (GIMP), and where points of a cell share their volume change. Plain quadrature points
!> do without.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_patches
   use coulter_algebra_sparse, only: add_element_matrix, pattern_type
   use coulter_base_kinds, only: long, wp
   use coulter_grid, only: grid_type
   use coulter_grid_box, only: average_over_edge, box_reach
   use coulter_grid_cells, only: cells_type
   use coulter_grid_shape, only: shape_gradients_2d, shape_values_2d
   use coulter_system_dofs, only: dofs_type
   use coulter_system_unknowns, only: coupling_type, couple_vertices, new_coupling
   implicit none(type, external)
   private
   public :: patches_type, patch_functions_type, most_patch_nodes
   public :: build_patches, couple_patches, functions_in_patch, scatter_patch, patches_memory

   !> Nodes of a cell and its eight neighbours.
   integer, parameter :: most_patch_nodes = 16

   !> All patches of a step.
   type :: patches_type
      !> Number of patches.
      integer :: n = 0
      !> Cell of every patch, shape (n).
      integer, allocatable :: cell(:)
      !> Number of its nodes, shape (n).
      integer, allocatable :: n_nodes(:)
      !> Its nodes, shape (most_patch_nodes, n).
      integer, allocatable :: node(:, :)
      !> Where the nodes of the cell and of its neighbours, row by row, stand among them, or 0; only
      !> for boxes, shape (-1:2, -1:2, n).
      integer, allocatable :: place(:, :, :)
      !> First entry of every patch in `point`, shape (n + 1).
      integer, allocatable :: point_start(:)
      !> Points ordered by patch, shape (n_points).
      integer, allocatable :: point(:)
      !> Edges of the boxes of all points at the start of the step, length units; only for boxes,
      !> shape (2, n_points).
      real(wp), allocatable :: box(:, :)
      !> Unknowns of all patches.
      type(coupling_type) :: coupling
      !> Does no node of the patch follow others, shape (n)?
      logical, allocatable :: is_plain(:)
   end type patches_type

   !> The nodes that one point hangs on, as places among the nodes of its patch.
   type :: patch_functions_type
      !> How many.
      integer :: n = 0
      integer :: place(most_patch_nodes) = 0
      !> Their shape functions.
      real(wp) :: value(most_patch_nodes) = 0.0_wp
      !> Gradients of these at the start of the step, per length.
      real(wp) :: gradient(2, most_patch_nodes) = 0.0_wp
   end type patch_functions_type

contains

   !> One patch for every cell that holds the centre of a point.
   pure subroutine build_patches(patches, grid, cells, position)
      !> Patches; `box` is allocated where points have boxes.
      type(patches_type), intent(inout) :: patches
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Active cells with numbered nodes.
      type(cells_type), intent(in) :: cells
      !> Positions of the points, length units, shape (2, n_points).
      real(wp), intent(in) :: position(:, :)
      integer :: c, k, p, n_points

      allocate (patches%cell(cells%n_with_points), patches%n_nodes(cells%n_with_points))
      allocate (patches%node(most_patch_nodes, cells%n_with_points))
      allocate (patches%point_start(cells%n_with_points + 1), patches%point(size(position, 2)))
      if (allocated(patches%box)) then
         allocate (patches%place(-1:2, -1:2, cells%n_with_points), source=0)
      end if
      n_points = 0
      do c = 1, cells%n_with_points
         patches%point_start(patches%n + 1) = n_points + 1
         do k = cells%point_start(c), cells%point_start(c + 1) - 1
            p = cells%point(k)
            if (any(grid%cell_of(position(:, p)) /= cells%cell_index(:, c))) cycle
            n_points = n_points + 1
            patches%point(n_points) = p
         end do
         if (n_points < patches%point_start(patches%n + 1)) cycle
         patches%n = patches%n + 1
         patches%cell(patches%n) = c
         call list_nodes(patches, grid, cells, position, &
                         patches%point(patches%point_start(patches%n):n_points))
      end do
      patches%point_start(patches%n + 1) = n_points + 1
   end subroutine build_patches

   !> Nodes of the last patch.
   pure subroutine list_nodes(patches, grid, cells, position, points)
      type(patches_type), intent(inout) :: patches
      type(grid_type), intent(in) :: grid
      type(cells_type), intent(in) :: cells
      real(wp), intent(in) :: position(:, :)
      integer, intent(in) :: points(:)
      integer :: node_at(-1:2, -1:2), first(2), last(2), i, j, k, c

      associate (e => patches%n, own => patches%cell(patches%n))
         if (.not. allocated(patches%box)) then
            patches%n_nodes(e) = 4
            patches%node(:4, e) = cells%node(:, own)
            return
         end if
         node_at = 0
         do k = 1, size(points)
            call reach_of_box(patches, grid, position(:, points(k)), points(k), first, last)
            do j = first(2), last(2)
               do i = first(1), last(1)
                  c = cells%number_at(cells%cell_index(:, own) + [i, j])
                  node_at(i:i + 1, j) = cells%node([1, 2], c)
                  node_at(i:i + 1, j + 1) = cells%node([4, 3], c)
               end do
            end do
         end do
         patches%n_nodes(e) = 0
         do j = -1, 2
            do i = -1, 2
               if (node_at(i, j) == 0) cycle
               patches%n_nodes(e) = patches%n_nodes(e) + 1
               patches%node(patches%n_nodes(e), e) = node_at(i, j)
               patches%place(i, j, e) = patches%n_nodes(e)
            end do
         end do
      end associate
   end subroutine list_nodes

   !> Cells that the box of a point covers, relative to its own.
   pure subroutine reach_of_box(patches, grid, position, p, first, last)
      type(patches_type), intent(in) :: patches
      type(grid_type), intent(in) :: grid
      real(wp), intent(in) :: position(2)
      integer, intent(in) :: p
      integer, intent(out) :: first(2), last(2)
      integer :: index(2)

      index = grid%cell_of(position)
      call box_reach((position - grid%origin)/grid%spacing - real(index - 1, wp), &
                     patches%box(:, p)/grid%spacing, index, grid%n_cells, first, last)
   end subroutine reach_of_box

   !> Shape functions of a point.
   pure subroutine functions_in_patch(patches, grid, e, position, p, functions)
      !> Patches.
      type(patches_type), intent(in) :: patches
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Number of the patch.
      integer, intent(in) :: e
      !> Position of the point, length units.
      real(wp), intent(in) :: position(2)
      !> Number of the point.
      integer, intent(in) :: p
      !> Its functions.
      type(patch_functions_type), intent(out) :: functions
      real(wp) :: local(2), edge(2), value(-1:2, 2), slope(-1:2, 2)
      integer :: index(2), first(2), last(2), i, j, n

      index = grid%cell_of(position)
      local = (position - grid%origin)/grid%spacing - real(index - 1, wp)
      if (.not. allocated(patches%box)) then
         functions%n = 4
         functions%place(:4) = [1, 2, 3, 4]
         functions%value(:4) = shape_values_2d(local)
         functions%gradient(:, :4) = shape_gradients_2d(local, grid%spacing)
         return
      end if
      edge = patches%box(:, p)/grid%spacing
      call box_reach(local, edge, index, grid%n_cells, first, last)
      do i = 1, 2
         call average_over_edge(local(i), edge(i), first(i), last(i), value(:, i), slope(:, i))
      end do
      n = 0
      do j = first(2), last(2) + 1
         do i = first(1), last(1) + 1
            n = n + 1
            functions%place(n) = patches%place(i, j, e)
            functions%value(n) = value(i, 1)*value(j, 2)
            functions%gradient(:, n) = [slope(i, 1)*value(j, 2), value(i, 1)*slope(j, 2)] &
               /grid%spacing
         end do
      end do
      functions%n = n
   end subroutine functions_in_patch

   !> Unknowns of all patches.
   pure subroutine couple_patches(patches, dofs)
      !> Patches; get `coupling` and `is_plain`.
      type(patches_type), intent(inout) :: patches
      !> Numbering.
      type(dofs_type), intent(in) :: dofs
      real(wp), parameter :: one(1, most_patch_nodes) = 1.0_wp
      integer :: e

      call new_coupling(patches%coupling, patches%n, most_patch_nodes)
      allocate (patches%is_plain(patches%n))
      do e = 1, patches%n
         associate (node => patches%node(:patches%n_nodes(e), e))
            call couple_vertices(patches%coupling, dofs, reshape(node, [1, size(node)]), &
                                 one(:, :size(node)))
            patches%is_plain(e) = all(dofs%dof(:, node) >= 0)
         end associate
      end do
   end subroutine couple_patches

   !> Add the matrix of a patch to the tangent.
   pure subroutine scatter_patch(patches, e, n, matrix, pattern, element, values)
      !> Coupled patches.
      type(patches_type), intent(in) :: patches
      !> Number of the patch and of its nodes.
      integer, intent(in) :: e, n
      !> Its matrix, shape (component, node, component, node).
      real(wp), intent(in) :: matrix(2, n, 2, n)
      !> Pattern of the tangent.
      type(pattern_type), intent(in) :: pattern
      !> Number of the patch among the elements of the pattern.
      integer, intent(in) :: element
      !> Values of the tangent, shape (n_entries).
      real(wp), intent(inout) :: values(:)
      integer :: first, last

      first = (patches%coupling%elements%start(e) + 1)/2
      last = (patches%coupling%elements%start(e + 1) - 1)/2
      associate (share => patches%coupling%share(:n, first:last))
         if (patches%is_plain(e)) then
            call add_element_matrix(pattern, element, picked(matrix, maxloc(share, dim=1)), values)
         else
            call add_element_matrix(pattern, element, condensed(matrix, share), values)
         end if
      end associate
   end subroutine scatter_patch

   !> Bytes that the patches occupy.
   pure function patches_memory(patches) result(bytes)
      !> Coupled patches.
      type(patches_type), intent(in) :: patches
      integer(long) :: bytes

      bytes = 4_long*int(size(patches%node) + size(patches%point) &
                         + size(patches%coupling%elements%dof), long) &
         + 8_long*int(size(patches%coupling%share), long)
      if (allocated(patches%box)) bytes = bytes + 8_long*int(size(patches%box), long)
   end function patches_memory

   !> Matrix of the pairs of unknowns of given nodes, columns first.
   pure function picked(matrix, node) result(entries)
      real(wp), intent(in) :: matrix(:, :, :, :)
      integer, intent(in) :: node(:)
      real(wp) :: entries(4*size(node)**2)

      entries = reshape(matrix(:, node, :, node), shape(entries))
   end function picked

   !> Matrix in terms of the pairs of unknowns that its nodes hang on, columns first.
   pure function condensed(matrix, share) result(entries)
      real(wp), intent(in) :: matrix(:, :, :, :), share(:, :)
      real(wp) :: entries(4*size(share, 2)**2)
      real(wp) :: half(2, size(share, 1), 2), square(2, size(share, 2), 2, size(share, 2))
      integer :: a, b, v

      do b = 1, size(share, 2)
         half = 0.0_wp
         do v = 1, size(share, 1)
            if (abs(share(v, b)) > 0.0_wp) half = half + share(v, b)*matrix(:, :, :, v)
         end do
         do a = 1, size(share, 2)
            square(:, a, :, b) = 0.0_wp
            do v = 1, size(share, 1)
               if (.not. abs(share(v, a)) > 0.0_wp) cycle
               square(:, a, :, b) = square(:, a, :, b) + share(v, a)*half(:, v, :)
            end do
         end do
      end do
      entries = reshape(square, shape(entries))
   end function condensed

end module coulter_system_patches
