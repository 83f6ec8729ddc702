!> The cell that an outer node follows: the nearest one that may lead.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_leading_cell
   use coulter_base_kinds, only: wp
   use coulter_grid, only: cell_nodes_2d, grid_type
   use coulter_grid_cells, only: cells_type
   implicit none(type, external)
   private
   public :: nearest_leading_cell

   !> Cells farther away than this many others belong to something else and do not lead.
   integer, parameter :: farthest_ring = 4

   !> Ways to the cells beside a cell.
   integer, parameter :: beside(2, 4) = reshape([-1, 0, 1, 0, 0, -1, 0, 1], [2, 4])

contains

   !> Number of the leading cell whose centre is nearest to a node; the fuller one if several are;
   !> 0 if none is near.
   pure function nearest_leading_cell(grid, cells, may_lead, fill, node) result(nearest)
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Active cells with numbered nodes.
      type(cells_type), intent(in) :: cells
      !> May nodes follow a cell, shape (<= n_cells)?
      logical, intent(in) :: may_lead(:)
      !> Share of these cells that is filled.
      real(wp), intent(in) :: fill(:)
      !> Number of the node.
      integer, intent(in) :: node
      integer :: nearest

      if (allocated(cells%next_sheet)) then
         nearest = nearest_in_sheets(grid, cells, may_lead, fill, node)
      else
         nearest = nearest_in_rings(grid, cells, may_lead, fill, cells%node_index(:, node))
      end if
   end function nearest_leading_cell

   !> The same where no cell is there several times: ring by ring around the node.
   pure function nearest_in_rings(grid, cells, may_lead, fill, index) result(nearest)
      type(grid_type), intent(in) :: grid
      type(cells_type), intent(in) :: cells
      logical, intent(in) :: may_lead(:)
      real(wp), intent(in) :: fill(:)
      integer, intent(in) :: index(2)
      integer :: nearest
      integer :: ring, last_ring, i, j, c
      real(wp) :: distance, least

      nearest = 0
      least = huge(least)
      last_ring = farthest_ring
      ring = 0
      do while (ring <= last_ring)
         do j = index(2) - 1 - ring, index(2) + ring
            do i = index(1) - 1 - ring, index(1) + ring
               if (ring_of([i, j], index) /= ring) cycle
               c = cells%number_at([i, j])
               if (c == 0 .or. c > size(may_lead)) cycle
               if (.not. may_lead(c)) cycle
               distance = distance_to(grid, index, [i, j], fill(c))
               if (distance >= least) cycle
               least = distance
               nearest = c
               ! a corner of this ring may be farther than the sides of the next
               last_ring = min(last_ring, 2*ring + 1)
            end do
         end do
         ring = ring + 1
      end do
   end function nearest_in_rings

   !> The same among sheets: of the cells that are reached from those of the node by the fewest
   !> steps from one to the next that hangs together with it. What is near across a gap is not.
   pure function nearest_in_sheets(grid, cells, may_lead, fill, node) result(nearest)
      type(grid_type), intent(in) :: grid
      type(cells_type), intent(in) :: cells
      logical, intent(in) :: may_lead(:)
      real(wp), intent(in) :: fill(:)
      integer, intent(in) :: node
      integer :: nearest
      integer, allocatable :: found(:)
      real(wp) :: distance, least
      integer :: k, first, next, side, step

      found = cells_of(cells, node)
      first = 1
      do step = 0, 2*farthest_ring
         nearest = 0
         least = huge(least)
         do k = first, size(found)
            if (.not. may_lead(found(k))) cycle
            distance = distance_to(grid, cells%node_index(:, node), &
                                   cells%cell_index(:, found(k)), fill(found(k)))
            if (distance < least) nearest = found(k)
            least = min(least, distance)
         end do
         if (nearest > 0) return
         associate (last => size(found))
            do k = first, last
               do side = 1, 4
                  next = cells%next_beside(found(k), beside(:, side), 0)
                  do while (next > 0)
                     if (ring_of(cells%cell_index(:, next), cells%node_index(:, node)) &
                         <= farthest_ring .and. all(found /= next)) found = [found, next]
                     next = cells%next_beside(found(k), beside(:, side), next)
                  end do
               end do
            end do
            first = last + 1
         end associate
      end do
   end function nearest_in_sheets

   !> The cells that have a node.
   pure function cells_of(cells, node) result(found)
      type(cells_type), intent(in) :: cells
      integer, intent(in) :: node
      integer, allocatable :: found(:)
      integer :: c, k

      allocate (found(0))
      do k = 1, 4
         c = cells%number_at(cells%node_index(:, node) - cell_nodes_2d(:, k))
         do while (c > 0)
            if (cells%node(k, c) == node) found = [found, c]
            c = cells%next_sheet(c)
         end do
      end do
   end function cells_of

   !> Rings of cells between a node and a cell.
   pure function ring_of(cell, node) result(ring)
      !> Grid indices.
      integer, intent(in) :: cell(2), node(2)
      integer :: ring

      ring = maxval(abs(2*(cell - node) + 1))/2
   end function ring_of

   !> Square of the distance from a node to the centre of a cell, a little less if that is full.
   pure function distance_to(grid, node, cell, fill) result(distance)
      type(grid_type), intent(in) :: grid
      !> Grid indices.
      integer, intent(in) :: node(2), cell(2)
      real(wp), intent(in) :: fill
      real(wp) :: distance

      distance = sum(((real(cell - node, wp) + 0.5_wp)*grid%spacing)**2) &
         - 1.0e-6_wp*grid%smallest_spacing()**2*fill
   end function distance_to

end module coulter_system_leading_cell
