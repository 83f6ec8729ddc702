!> Sorting: by small numbers in one go, by reals in ascending order.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_sorting
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: sort_ascending, sort_by_number

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

   !> Order that sorts reals ascending; equal ones stay in order. Bottom-up merge sort.
   pure subroutine sort_ascending(key, order)
      !> What to sort by, shape (n).
      real(wp), intent(in) :: key(:)
      !> Places of the keys in the order of these, shape (n).
      integer, intent(out) :: order(:)
      integer :: left(size(order)), width, low, i

      do i = 1, size(order)
         order(i) = i
      end do
      width = 1
      do while (width < size(order))
         do low = 1, size(order) - width, 2*width
            call merge_runs(key, width, order(low:min(low + 2*width - 1, size(order))), left)
         end do
         width = 2*width
      end do
   end subroutine sort_ascending

   !> Merge two runs, each in order, of which the first has `n` members.
   pure subroutine merge_runs(key, n, run, left)
      real(wp), intent(in) :: key(:)
      integer, intent(in) :: n
      !> One run behind the other.
      integer, intent(inout) :: run(:)
      !> Room for the first.
      integer, intent(inout) :: left(:)
      integer :: i, j
      logical :: takes_left

      ! often they are in order as they stand: places come row by row
      if (key(run(n)) <= key(run(n + 1))) return
      left(:n) = run(:n)
      i = 1
      j = n + 1
      do while (i <= n)
         takes_left = j > size(run)
         if (.not. takes_left) takes_left = key(left(i)) <= key(run(j))
         if (takes_left) then
            run(i + j - n - 1) = left(i)
            i = i + 1
         else
            run(i + j - n - 1) = run(j)
            j = j + 1
         end if
      end do
   end subroutine merge_runs

end module coulter_base_sorting
