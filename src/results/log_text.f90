!> Pieces of text for the run log: padded columns, grouped digits, durations, a progress bar.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_log_text
   use coulter_base_kinds, only: long, wp
   use coulter_base_text, only: to_text
   implicit none(type, external)
   private
   public :: line_width, write_paragraph, progress_bar
   public :: left, right, plural, grouped, scaled_real, bytes_text, duration_text

   !> Most characters of a line.
   integer, parameter :: line_width = 100

contains

   !> Write a text behind a label, on as many lines as it needs.
   subroutine write_paragraph(unit, label, text)
      !> Unit to write to.
      integer, intent(in) :: unit
      !> What stands before the first line; the others are indented by its length.
      character(len=*), intent(in) :: label
      !> Text to break at blanks.
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: before
      integer :: first, last

      before = label
      first = 1
      do while (first <= len(text))
         last = len(text)
         if (last - first + 1 > line_width - len(label)) then
            last = first + index(text(first:first + line_width - len(label)), " ", back=.true.) - 2
         end if
         if (last < first) last = len(text)
         write (unit, "(2a)") before, text(first:last)
         before = left("", len(label))
         first = last + 2
      end do
   end subroutine write_paragraph

   !> Text padded with blanks on its right; never cut.
   pure function left(text, width) result(padded)
      !> Text to pad.
      character(len=*), intent(in) :: text
      !> Least length of the result.
      integer, intent(in) :: width
      character(len=:), allocatable :: padded

      padded = text
      do while (len(padded) < width)
         padded = padded//" "
      end do
   end function left

   !> Text padded with blanks on its left; never cut.
   pure function right(text, width) result(padded)
      !> Text to pad.
      character(len=*), intent(in) :: text
      !> Least length of the result.
      integer, intent(in) :: width
      character(len=:), allocatable :: padded

      padded = text
      do while (len(padded) < width)
         padded = " "//padded
      end do
   end function right

   !> Number with the word that suits it: "1 body", "2 bodies".
   pure function plural(number, one, several) result(text)
      !> Number to write.
      integer, intent(in) :: number
      !> Word for one.
      character(len=*), intent(in) :: one
      !> Word for any other number.
      character(len=*), intent(in) :: several
      character(len=:), allocatable :: text

      text = to_text(number)//" "//several
      if (number == 1) text = to_text(number)//" "//one
   end function plural

   !> Integer with its digits in groups of three: 1 234 567.
   pure function grouped(number) result(text)
      !> Number to write, >= 0.
      integer(long), intent(in) :: number
      character(len=:), allocatable :: text
      character(len=20) :: digits
      integer :: i

      write (digits, "(i20)") number
      text = ""
      do i = 1, len(digits)
         if (modulo(len(digits) - i, 3) == 2 .and. text /= "") text = text//" "
         if (digits(i:i) /= " ") text = text//digits(i:i)
      end do
   end function grouped

   !> Real with as many decimals as give the largest of its neighbours five digits, so that
   !> columns line up; zero where it is noise beside them.
   pure function scaled_real(number, scale) result(text)
      !> Number to write.
      real(wp), intent(in) :: number
      !> Size of the largest number beside which it stands.
      real(wp), intent(in) :: scale
      character(len=:), allocatable :: text
      real(wp), parameter :: noise = 1.0e-9_wp
      character(len=32) :: buffer, layout
      integer :: decade

      text = "0"
      if (abs(number) <= noise*scale) return
      decade = floor(log10(max(scale, tiny(scale))))
      layout = "(es12.3)"
      if (abs(decade - 2) <= 4) write (layout, "(a, i0, a)") "(f20.", max(4 - decade, 1), ")"
      write (buffer, layout) number
      text = trim(adjustl(buffer))
   end function scaled_real

   !> Amount of memory: "12.3 MB".
   pure function bytes_text(n_bytes) result(text)
      !> Bytes, >= 0.
      integer(long), intent(in) :: n_bytes
      character(len=:), allocatable :: text
      character(len=2), parameter :: units(4) = ["kB", "MB", "GB", "TB"]
      integer :: i

      i = 1
      do while (i < size(units) .and. real(n_bytes, wp) >= 1000.0_wp**(i + 1))
         i = i + 1
      end do
      text = to_text(real(n_bytes, wp)/1000.0_wp**i, 3)//" "//units(i)
   end function bytes_text

   !> Duration as minutes and seconds, with hours where there are any: "0:07", "1:02:03".
   pure function duration_text(seconds) result(text)
      !> Seconds, >= 0.
      real(wp), intent(in) :: seconds
      character(len=:), allocatable :: text
      character(len=32) :: buffer
      integer :: total

      total = nint(min(seconds, 1.0e9_wp))
      if (total < 3600) then
         write (buffer, "(i0, a, i2.2)") total/60, ":", modulo(total, 60)
      else
         write (buffer, "(i0, 2(a, i2.2))") total/3600, ":", modulo(total/60, 60), ":", &
            modulo(total, 60)
      end if
      text = trim(buffer)
   end function duration_text

   !> One line that shows how far a run is.
   pure function progress_bar(share, elapsed) result(line)
      !> Share of the run that is done, 0 to 1.
      real(wp), intent(in) :: share
      !> Wall time so far, seconds.
      real(wp), intent(in) :: elapsed
      character(len=:), allocatable :: line
      integer, parameter :: width = 40
      character(len=width) :: bar
      integer :: i

      bar = ""
      do i = 1, min(int(share*real(width, wp)), width)
         bar(i:i) = "="
      end do
      line = "["//bar//"]" &
         //right(to_text(nint(100.0_wp*share)), 4)//" %   "//duration_text(elapsed)//" elapsed"
      if (share > 0.0_wp) line = line//", about " &
         //duration_text(elapsed*(1.0_wp - share)/share)//" to go"
   end function progress_bar

end module coulter_results_log_text
