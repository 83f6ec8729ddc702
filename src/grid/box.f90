!> Shape functions averaged over a box around a point: the convolution of GIMP.
!>
!> Generalised interpolation material point method of Bardenhagen & Kober (2004), in the implicit
!> form of Coombs & Augarde (AMPLE, 2020). The functions of a box are products of those of its
!> edges, so that everything here is about one axis.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_grid_box
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: box_reach, average_over_edge

   !> Longest edge of a box over that of a cell: longer ones count as this, so that no box leaves
   !> the neighbours of its cell.
   real(wp), parameter :: longest_edge = 2.0_wp
   !> Shortest edge of a box over that of a cell.
   real(wp), parameter :: shortest_edge = 1.0e-6_wp
   !> Overlap with a cell, over its edge, that is round-off.
   real(wp), parameter :: no_overlap = 1.0e-9_wp

contains

   !> First and last cell that an edge covers, relative to the cell of its middle: -1, 0 or 1.
   elemental subroutine box_reach(local, length, cell, n_cells, first, last)
      !> Middle of the edge in its cell, over the edge of the cell: 0 to 1.
      real(wp), intent(in) :: local
      !> Length of the edge, over that of the cell.
      real(wp), intent(in) :: length
      !> Index of the cell, from 1, and number of cells of the grid.
      integer, intent(in) :: cell, n_cells
      !> The cells, inside the grid.
      integer, intent(out) :: first, last
      real(wp) :: half

      half = 0.5_wp*min(length, longest_edge)
      first = merge(-1, 0, local - half < -no_overlap .and. cell > 1)
      last = merge(1, 0, local + half > 1.0_wp + no_overlap .and. cell < n_cells)
   end subroutine box_reach

   !> Mean of the linear shape functions over an edge, and of their slopes. The first and the last
   !> cell extend as far as the edge does: what sticks out of the grid is extrapolated.
   pure subroutine average_over_edge(local, length, first, last, value, slope)
      !> See `box_reach`.
      real(wp), intent(in) :: local, length
      !> The cells that it covers.
      integer, intent(in) :: first, last
      !> Mean of the functions of all nodes from the lower one of cell -1 to the upper of cell 1.
      real(wp), intent(out) :: value(-1:2)
      !> Mean slope, times the edge of the cell.
      real(wp), intent(out) :: slope(-1:2)
      real(wp) :: edge, end_of_edge, lower, upper, share, middle
      integer :: c

      edge = max(min(length, longest_edge), shortest_edge)
      upper = local - 0.5_wp*edge
      end_of_edge = local + 0.5_wp*edge
      ! as long as it is in round-off, so that the shares sum to one
      edge = end_of_edge - upper
      value = 0.0_wp
      slope = 0.0_wp
      do c = first, last
         lower = upper
         upper = real(c + 1, wp)
         if (c == last) upper = end_of_edge
         share = (upper - lower)/edge
         middle = 0.5_wp*(lower + upper) - real(c, wp)
         value(c) = value(c) + share*(1.0_wp - middle)
         value(c + 1) = value(c + 1) + share*middle
         slope(c) = slope(c) - share
         slope(c + 1) = slope(c + 1) + share
      end do
   end subroutine average_over_edge

end module coulter_grid_box
