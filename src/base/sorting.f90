!> Sorting by small numbers.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_sorting
   implicit none(type, external)
   private
   public :: sort_by_number

contains

   !> Counting sort: places of all numbers, in ragged rows; those of equal numbers stay in order.
   pure subroutine sort_by_number(number, start, place)
      !> Numbers from 1.
      integer, intent(in) :: number(:)
      !> First place of every number, shape (largest number + 1), and the places.
      integer, intent(out) :: start(:), place(:)
      integer :: k

      start = 0
      do k = 1, size(number)
         start(number(k)) = start(number(k)) + 1
      end do
      start(1) = start(1) + 1
      do k = 2, size(start)
         start(k) = start(k) + start(k - 1)
      end do
      do k = size(number), 1, -1
         start(number(k)) = start(number(k)) - 1
         place(start(number(k))) = k
      end do
   end subroutine sort_by_number

end module coulter_base_sorting
