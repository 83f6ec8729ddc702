!> Lets the compiler read the values of one variable, as it reads a namelist.
!>
!> Every reading has its own scratch file: after a failed one, gfortran may leave a shared unit, or
!> internal files altogether, in a state in which later readings do nothing.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_namelist
   use, intrinsic :: ieee_exceptions, only: ieee_overflow, ieee_set_flag, ieee_set_halting_mode, &
      ieee_get_halting_mode
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: value_type, read_value

   !> The values of a variable; only the component of its type is meaningful.
   type :: value_type
      !> Real numbers, shape (n).
      real(wp), allocatable :: reals(:)
      !> Integers, shape (n).
      integer, allocatable :: integers(:)
      !> A logical value.
      logical :: flag = .false.
      !> A text, without its quotes and without blanks at its end.
      character(len=:), allocatable :: text
   end type value_type

contains

   !> Read the values of a variable.
   subroutine read_value(type, n, written, value, is_valid, message)
      !> Type of the variable: "real", "integer", "logical" or "text".
      character(len=*), intent(in) :: type
      !> Number of values.
      integer, intent(in) :: n
      !> The values as they stand in the deck.
      character(len=*), intent(in) :: written
      !> What they mean.
      type(value_type), intent(out) :: value
      !> Does the compiler accept them?
      logical, intent(out) :: is_valid
      !> Why they cannot be read at all; empty if they can.
      character(len=:), allocatable, intent(out) :: message
      real(wp), allocatable :: real_value(:)
      integer, allocatable :: integer_value(:)
      logical :: logical_value
      character(len=len(written)) :: text_value
      integer :: unit, status
      logical :: is_halting
      namelist /one/ real_value, integer_value, logical_value, text_value

      allocate (real_value(n), source=0.0_wp)
      allocate (integer_value(n), source=0)
      logical_value = .false.
      text_value = ""
      call open_scratch(type//"_value = "//written, unit, message)
      is_valid = message == ""
      if (is_valid) then
         ! numbers such as 1e999 become infinite, also where overflow would end the program
         call ieee_get_halting_mode(ieee_overflow, is_halting)
         call ieee_set_halting_mode(ieee_overflow, .false.)
         read (unit, nml=one, iostat=status)
         close (unit)
         call ieee_set_flag(ieee_overflow, .false.)
         call ieee_set_halting_mode(ieee_overflow, is_halting)
         is_valid = status == 0
      end if
      ! one by one: gfortran 12 loses the length of a text in a structure constructor
      call move_alloc(real_value, value%reals)
      call move_alloc(integer_value, value%integers)
      value%flag = logical_value
      value%text = trim(text_value)
   end subroutine read_value

   !> Open a scratch file that holds a namelist.
   subroutine open_scratch(line, unit, message)
      !> What stands in the namelist.
      character(len=*), intent(in) :: line
      !> Unit at the start of the file, to be closed if there is no message.
      integer, intent(out) :: unit
      !> Why there is no such file; empty if there is.
      character(len=:), allocatable, intent(out) :: message
      character(len=256) :: remark
      integer :: status

      message = ""
      open (newunit=unit, status="scratch", iostat=status, iomsg=remark)
      if (status == 0) then
         write (unit, "(a)", iostat=status, iomsg=remark) "&one", line, "/"
         rewind (unit)
         if (status /= 0) close (unit)
      end if
      if (status /= 0) message = "cannot be read without a scratch file: "//trim(remark)
   end subroutine open_scratch

end module coulter_deck_namelist
