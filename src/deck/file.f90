!> Reads a text file as one piece.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_file
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: long
   implicit none(type, external)
   private
   public :: read_text

   !> Bytes by which some editors mark a file as UTF-8.
   character(len=*), parameter :: byte_order_mark = char(239)//char(187)//char(191)

contains

   !> Text of a file, line ends included.
   subroutine read_text(path, text, error)
      !> Path of the file.
      character(len=*), intent(in) :: path
      !> What it holds.
      character(len=:), allocatable, intent(out) :: text
      !> Set when the file cannot be read or is no text.
      type(error_type), allocatable, intent(out) :: error
      character(len=256) :: message
      integer :: unit, status
      integer(long) :: n_bytes

      message = ""
      open (newunit=unit, file=path, access="stream", form="unformatted", status="old", &
            action="read", iostat=status, iomsg=message)
      if (status /= 0) then
         call fatal_error(error, path//": cannot be opened: "//reason(message))
         return
      end if
      inquire (unit=unit, size=n_bytes)
      allocate (character(len=max(n_bytes, 0_long)) :: text)
      read (unit, iostat=status, iomsg=message) text
      close (unit)
      if (status /= 0) then
         call fatal_error(error, path//": cannot be read: "//reason(message))
      else if (index(text, achar(0)) > 0) then
         call fatal_error(error, path//": is not a text file")
      else if (index(text, byte_order_mark) == 1) then
         text = text(len(byte_order_mark) + 1:)
      end if
   end subroutine read_text

   !> "Cannot open file 'x': Is a directory" -> "Is a directory".
   pure function reason(message) result(text)
      character(len=*), intent(in) :: message
      character(len=:), allocatable :: text

      text = trim(adjustl(message(index(message, ":", back=.true.) + 1:)))
   end function reason

end module coulter_deck_file
