!> Errors as values: library code hands them back, only the main program stops.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_error
   implicit none(type, external)
   private
   public :: error_type, fatal_error

   !> What went wrong, in words that help the person who can mend it.
   type :: error_type
      !> One or more complete sentences, without a trailing newline.
      character(len=:), allocatable :: message
   end type error_type

contains

   !> Set `error`, so that the caller's `if (allocated(error)) return` takes effect.
   pure subroutine fatal_error(error, message)
      !> Error to allocate.
      type(error_type), allocatable, intent(out) :: error
      !> What went wrong.
      character(len=*), intent(in) :: message

      allocate (error)
      error%message = message
   end subroutine fatal_error

end module coulter_base_error
