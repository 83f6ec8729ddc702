!> Fill-reducing elimination orders that use the geometry of the grid.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_ordering
   implicit none(type, external)
   private
   public :: dissection_order

   !> Sets of nodes as small as this are not dissected further.
   integer, parameter :: smallest_set = 12

contains

   !> Nested dissection (George, 1973) of a regular grid: halve the longer side by a line of nodes,
   !> eliminate both halves first and the line last.
   function dissection_order(dof, node_index) result(order)
      !> Unknown of every nodal component, <= 0 if there is none, shape (n_components, n_nodes).
      integer, intent(in) :: dof(:, :)
      !> Grid index of every node, shape (2, n_nodes).
      integer, intent(in) :: node_index(:, :)
      !> Unknowns in the order of their elimination, zero-based, shape (n_dofs).
      integer, allocatable :: order(:)
      integer, allocatable :: nodes(:)
      integer :: node, i, n

      allocate (nodes(size(node_index, 2)))
      do node = 1, size(nodes)
         nodes(node) = node
      end do
      call dissect(nodes, node_index)
      allocate (order(count(dof > 0)))
      n = 0
      do node = 1, size(nodes)
         do i = 1, size(dof, 1)
            if (dof(i, nodes(node)) <= 0) cycle
            n = n + 1
            order(n) = dof(i, nodes(node)) - 1
         end do
      end do
   end function dissection_order

   !> Order a set of nodes in place.
   recursive subroutine dissect(nodes, node_index)
      integer, intent(inout) :: nodes(:)
      integer, intent(in) :: node_index(:, :)
      integer :: axis, middle, n_below, n_above, lower(2), upper(2)

      if (size(nodes) <= smallest_set) return
      lower = minval(node_index(:, nodes), dim=2)
      upper = maxval(node_index(:, nodes), dim=2)
      axis = maxloc(upper - lower, dim=1)
      if (upper(axis) - lower(axis) < 2) return
      middle = median(node_index(axis, nodes), lower(axis), upper(axis))
      associate (position => node_index(axis, nodes))
         n_below = count(position < middle)
         n_above = count(position > middle)
         nodes = [pack(nodes, position < middle), pack(nodes, position > middle), &
                  pack(nodes, position == middle)]
      end associate
      call dissect(nodes(:n_below), node_index)
      call dissect(nodes(n_below + 1:n_below + n_above), node_index)
   end subroutine dissect

   !> Value that halves a set of integers, away from the ends of their range.
   pure function median(numbers, lowest, highest) result(middle)
      integer, intent(in) :: numbers(:), lowest, highest
      integer :: middle
      integer :: histogram(lowest:highest), k, below

      histogram = 0
      do k = 1, size(numbers)
         histogram(numbers(k)) = histogram(numbers(k)) + 1
      end do
      below = 0
      do middle = lowest, highest - 1
         below = below + histogram(middle)
         if (2*below >= size(numbers)) exit
      end do
      middle = min(max(middle, lowest + 1), highest - 1)
   end function median

end module coulter_algebra_ordering
