!> Places sorted into the cells of a lattice, so that those nearby are found at once.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_bins
   use coulter_base_kinds, only: wp
   use coulter_base_sorting, only: sort_by_number
   implicit none(type, external)
   private
   public :: bins_type, new_bins

   !> Places by cell, row by row.
   type :: bins_type
      private
      !> Lower left corner and width of the cells; number of cells per direction.
      real(wp) :: lower(2) = 0.0_wp, width = 0.0_wp
      integer :: n(2) = 0
      !> First place of every cell, and the places.
      integer, allocatable :: start(:), item(:)
   contains
      procedure :: near
   end type bins_type

contains

   !> Sort places.
   pure subroutine new_bins(bins, place, width)
      !> Bins to make.
      type(bins_type), intent(out) :: bins
      !> Places, shape (2, n).
      real(wp), intent(in) :: place(:, :)
      !> Largest distance in either direction that is asked for, > 0.
      real(wp), intent(in) :: width
      integer :: cell(size(place, 2)), k

      allocate (bins%item(size(cell)))
      if (size(cell) == 0) return
      bins%lower = minval(place, dim=2)
      bins%width = width
      bins%n = int((maxval(place, dim=2) - bins%lower)/width) + 1
      do k = 1, size(cell)
         associate (at => int((place(:, k) - bins%lower)/width))
            cell(k) = at(1) + bins%n(1)*at(2) + 1
         end associate
      end do
      allocate (bins%start(product(bins%n) + 1))
      call sort_by_number(cell, bins%start, bins%item)
   end subroutine new_bins

   !> Places that may lie within the width of a place, in ascending order in every row of cells.
   pure function near(self, place) result(found)
      class(bins_type), intent(in) :: self
      !> The place.
      real(wp), intent(in) :: place(2)
      integer, allocatable :: found(:)
      integer :: at(2), low, high, j

      allocate (found(0))
      if (size(self%item) == 0) return
      at = floor((place - self%lower)/self%width)
      low = max(at(1) - 1, 0)
      high = min(at(1) + 1, self%n(1) - 1)
      if (low > high) return
      do j = max(at(2) - 1, 0), min(at(2) + 1, self%n(2) - 1)
         found = [found, self%item(self%start(low + 1 + self%n(1)*j): &
                                   self%start(high + 2 + self%n(1)*j) - 1)]
      end do
   end function near

end module coulter_base_bins
