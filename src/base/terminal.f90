!> What Fortran cannot ask the system about its streams.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_terminal
   use, intrinsic :: iso_c_binding, only: c_int
   implicit none(type, external)
   private
   public :: is_terminal, stdout_descriptor

   !> Descriptor of the standard output.
   integer, parameter :: stdout_descriptor = 1

   interface
      !> isatty of POSIX: 1 for a terminal.
      function c_isatty(descriptor) bind(c, name="isatty") result(answer)
         import :: c_int
         implicit none(type, external)
         integer(c_int), value :: descriptor
         integer(c_int) :: answer
      end function c_isatty
   end interface

contains

   !> Is a stream of this process shown on a terminal?
   function is_terminal(descriptor) result(answer)
      !> POSIX descriptor: 1 is the standard output.
      integer, intent(in) :: descriptor
      logical :: answer

      answer = c_isatty(int(descriptor, c_int)) == 1
   end function is_terminal

end module coulter_base_terminal
