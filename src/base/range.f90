!> Conditions on numbers as text, such as "> 0 <= 1".
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_range
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: split_words
   implicit none(type, external)
   private
   public :: is_in_range

contains

   !> Does a number meet all conditions?
   pure function is_in_range(conditions, number) result(is_inside)
      !> Comparisons and bounds, with blanks between; empty if all is allowed.
      character(len=*), intent(in) :: conditions
      !> Number to judge.
      real(wp), intent(in) :: number
      logical :: is_inside
      character(len=16), allocatable :: words(:)
      real(wp) :: bound
      integer :: i

      call split_words(conditions, words)
      is_inside = .true.
      do i = 1, size(words), 2
         read (words(i + 1), *) bound
         select case (words(i))
         case (">")
            is_inside = is_inside .and. number > bound
         case (">=")
            is_inside = is_inside .and. number >= bound
         case ("<")
            is_inside = is_inside .and. number < bound
         case default
            is_inside = is_inside .and. number <= bound
         end select
      end do
   end function is_in_range

end module coulter_base_range
