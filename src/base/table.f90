!> Piecewise linear functions of time, by which loads and motions are scheduled.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_table
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: table_type, new_table, is_increasing

   !> A factor that varies with time: linear between the given times, constant beyond them; or a
   !> wave.
   type :: table_type
      !> Name by which loads refer to the table.
      character(len=:), allocatable :: name
      !> Times, strictly increasing, shape (n).
      real(wp), allocatable :: time(:)
      !> Factors at these times, shape (n).
      real(wp), allocatable :: value(:)
      !> Period of a sine wave that begins at the first time, with the values as amplitude; 0: no
      !> wave, the values themselves.
      real(wp) :: period = 0.0_wp
   contains
      procedure :: at => table_at
   end type table_type

   real(wp), parameter :: pi = acos(-1.0_wp)

contains

   !> Make a table from its columns.
   pure subroutine new_table(table, name, time, value)
      !> Table to make.
      type(table_type), intent(out) :: table
      !> Name of the table.
      character(len=*), intent(in) :: name
      !> Times, strictly increasing, at least one, shape (n).
      real(wp), intent(in) :: time(:)
      !> Factors, shape (n).
      real(wp), intent(in) :: value(:)

      table%name = name
      table%time = time
      table%value = value
   end subroutine new_table

   !> Factor at a time.
   pure function table_at(self, time) result(value)
      class(table_type), intent(in) :: self
      !> Time at which the factor is wanted.
      real(wp), intent(in) :: time
      real(wp) :: value

      value = interpolated(self, time)
      if (self%period > 0.0_wp) then
         value = value*sin(2.0_wp*pi*max(0.0_wp, time - self%time(1))/self%period)
      end if
   end function table_at

   !> What is linear between the times and constant beyond.
   pure function interpolated(self, time) result(value)
      class(table_type), intent(in) :: self
      real(wp), intent(in) :: time
      real(wp) :: value
      real(wp) :: share
      integer :: i, n

      n = size(self%time)
      if (time <= self%time(1)) then
         value = self%value(1)
         return
      end if
      do i = 2, n
         if (time <= self%time(i)) then
            share = (time - self%time(i - 1))/(self%time(i) - self%time(i - 1))
            value = (1.0_wp - share)*self%value(i - 1) + share*self%value(i)
            return
         end if
      end do
      value = self%value(n)
   end function interpolated

   !> Is every number larger than the one before it?
   pure function is_increasing(list)
      !> Numbers to compare.
      real(wp), intent(in) :: list(:)
      logical :: is_increasing

      is_increasing = all(list(2:) > list(:size(list) - 1))
   end function is_increasing

end module coulter_base_table
