!> Places that nearly coincide become one.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_welding
   use coulter_base_kinds, only: wp
   use coulter_base_sets, only: join_sets, root_of
   use coulter_base_sorting, only: sort_ascending
   implicit none(type, external)
   private
   public :: weld

contains

   !> Number the distinct places among many, ordered by x. Two are one when a chain of places runs
   !> from one to the other with no gap above a tolerance (single linkage): twins that differ by
   !> round-off always get the same number, whatever lies near.
   pure subroutine weld(position, tolerance, number, n)
      !> Places, length units, shape (2, n_places).
      real(wp), intent(in) :: position(:, :)
      !> Gap per component that is closed.
      real(wp), intent(in) :: tolerance
      !> Number of every place, from 1, shape (n_places).
      integer, intent(out) :: number(:)
      !> How many are distinct.
      integer, intent(out) :: n
      integer :: order(size(number)), parent(size(number)), first, last, i, j, k

      call sort_ascending(position(1, :), order)
      parent = [(i, i=1, size(number))]
      last = 0
      do while (last < size(order))
         ! places in a column that no other is near, from the lowest to the highest
         first = last + 1
         last = end_of_column(position(1, :), order, first, tolerance)
         order(first:last) = sorted_by(position(2, :), order(first:last))
         do i = first, last
            do j = i + 1, last
               if (position(2, order(j)) - position(2, order(i)) > tolerance) exit
               if (abs(position(1, order(j)) - position(1, order(i))) > tolerance) cycle
               call join_sets(parent, order(i), order(j))
            end do
         end do
      end do
      n = 0
      number = 0
      do i = 1, size(order)
         k = root_of(parent, order(i))
         if (number(k) == 0) then
            n = n + 1
            number(k) = n
         end if
         number(order(i)) = number(k)
      end do
   end subroutine weld

   !> Last place, in order of x, before the next gap.
   pure function end_of_column(x, order, first, tolerance) result(last)
      real(wp), intent(in) :: x(:), tolerance
      integer, intent(in) :: order(:), first
      integer :: last

      last = first
      do while (last < size(order))
         if (x(order(last + 1)) - x(order(last)) > tolerance) exit
         last = last + 1
      end do
   end function end_of_column

   !> Some places in the order of a coordinate.
   pure function sorted_by(coordinate, some) result(sorted)
      real(wp), intent(in) :: coordinate(:)
      integer, intent(in) :: some(:)
      integer :: sorted(size(some))

      call sort_ascending(coordinate(some), sorted)
      sorted = some(sorted)
   end function sorted_by

end module coulter_points_welding
