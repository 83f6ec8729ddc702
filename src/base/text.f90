!> Small text helpers: numbers to text, lower case, words.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: to_text, last_of_line, lower_case, split_words

   !> Shortest readable text of a number, without blanks around it.
   interface to_text
      module procedure :: integer_to_text, real_to_text, vector_to_text
   end interface to_text

contains

   !> Where the line ends that begins at a place, without its line break.
   pure function last_of_line(text, first) result(last)
      !> Lines.
      character(len=*), intent(in) :: text
      !> First character of the line.
      integer, intent(in) :: first
      integer :: last

      last = index(text(first:), new_line("a"))
      if (last == 0) last = len(text) - first + 2
      last = last + first - 2
   end function last_of_line

   !> Decimal text of an integer.
   pure function integer_to_text(number) result(text)
      !> Number to write.
      integer, intent(in) :: number
      character(len=:), allocatable :: text
      character(len=12) :: buffer

      write (buffer, "(i0)") number
      text = trim(buffer)
   end function integer_to_text

   !> Text of a real number with up to `digits` significant digits, fixed or exponential
   !> notation as suits its size.
   pure function real_to_text(number, digits) result(text)
      !> Number to write.
      real(wp), intent(in) :: number
      !> Significant digits, 7 by default.
      integer, intent(in), optional :: digits
      character(len=:), allocatable :: text
      character(len=32) :: buffer, layout
      integer :: n_digits, decade

      n_digits = 7
      if (present(digits)) n_digits = digits
      if (.not. ieee_is_finite(number)) then
         write (buffer, "(g0)") number
         text = trim(adjustl(buffer))
         return
      else if (abs(number) < tiny(number)) then
         text = "0"
         return
      end if
      decade = floor(log10(abs(number)))
      if (decade >= -4 .and. decade < n_digits) then
         write (layout, "(a, i0, a)") "(f0.", n_digits - 1 - decade, ")"
         write (buffer, layout) number
         text = without_trailing_zeros(trim(adjustl(buffer)))
      else
         write (layout, "(a, i0, a)") "(es32.", n_digits - 1, "e3)"
         write (buffer, layout) number
         buffer = adjustl(buffer)
         text = without_trailing_zeros(buffer(:index(buffer, "E") - 1)) &
            //"e"//exponent_text(trim(buffer(index(buffer, "E") + 1:)))
      end if
      if (text(1:1) == ".") text = "0"//text
      if (index(text, "-.") == 1) text = "-0"//text(2:)
   end function real_to_text

   !> Numbers separated by a comma and a blank.
   pure function vector_to_text(numbers) result(text)
      !> Numbers to write.
      real(wp), intent(in) :: numbers(:)
      character(len=:), allocatable :: text
      integer :: i

      text = ""
      do i = 1, size(numbers)
         if (i > 1) text = text//", "
         text = text//real_to_text(numbers(i))
      end do
   end function vector_to_text

   !> Copy of `text` with the letters A to Z in lower case.
   pure function lower_case(text) result(lowered)
      !> Any text.
      character(len=*), intent(in) :: text
      character(len=len(text)) :: lowered
      integer :: i, code

      do i = 1, len(text)
         code = iachar(text(i:i))
         if (code >= iachar("A") .and. code <= iachar("Z")) code = code + 32
         lowered(i:i) = achar(code)
      end do
   end function lower_case

   !> Words of a text that blanks separate.
   pure subroutine split_words(text, words)
      !> Text of short words.
      character(len=*), intent(in) :: text
      !> Its words.
      character(len=16), allocatable, intent(out) :: words(:)
      character(len=:), allocatable :: rest
      character(len=16) :: word
      integer :: last

      allocate (words(0))
      rest = trim(adjustl(text))//" "
      do while (rest /= "")
         last = index(rest, " ")
         word = rest(:last)
         words = [words, word]
         rest = trim(adjustl(rest(last:)))//" "
      end do
   end subroutine split_words

   !> "1.2500" -> "1.25", "3." -> "3".
   pure function without_trailing_zeros(text) result(short)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: short
      integer :: last

      last = len(text)
      if (index(text, ".") > 0) then
         last = verify(text, "0", back=.true.)
         if (text(last:last) == ".") last = last - 1
      end if
      short = text(:last)
      if (short == "" .or. short == "-") short = short//"0"
   end function without_trailing_zeros

   !> "-005" -> "-5", "+012" -> "12".
   pure function exponent_text(text) result(short)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: short
      integer :: exponent

      read (text, *) exponent
      short = integer_to_text(exponent)
   end function exponent_text

end module coulter_base_text
