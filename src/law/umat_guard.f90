!> Calls user materials so that they may give up (`XIT`) without ending the program.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_umat_guard
   use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_funptr, c_int, c_null_char, &
      c_ptr, c_size_t
   implicit none(type, external)
   private
   public :: call_guarded, leave_call, note, noted_text, text_at

   interface
      !> Call work(data); 1 when it was left by `leave_call`, else 0.
      function call_guarded(work, data) result(has_left) bind(C, name="coulter_guard_call")
         import :: c_funptr, c_int, c_ptr
         implicit none (type, external)
         type(c_funptr), value :: work
         type(c_ptr), value :: data
         integer(c_int) :: has_left
      end function call_guarded

      !> Go back to the innermost `call_guarded`; returns only when there is none.
      subroutine leave_call() bind(C, name="coulter_guard_leave")
         implicit none (type, external)
      end subroutine leave_call

      subroutine guard_note(text) bind(C, name="coulter_guard_note")
         import :: c_char
         implicit none (type, external)
         character(kind=c_char), intent(in) :: text(*)
      end subroutine guard_note

      function guard_text() result(text) bind(C, name="coulter_guard_text")
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr) :: text
      end function guard_text

      pure function strlen(text) result(length) bind(C, name="strlen")
         import :: c_ptr, c_size_t
         implicit none (type, external)
         type(c_ptr), value :: text
         integer(c_size_t) :: length
      end function strlen
   end interface

contains

   !> Remember what a user material says.
   subroutine note(text)
      !> Its words.
      character(len=*), intent(in) :: text
      character(kind=c_char) :: c_text(len(text) + 1)
      integer :: i

      do i = 1, len(text)
         c_text(i) = text(i:i)
      end do
      c_text(len(text) + 1) = c_null_char
      call guard_note(c_text)
   end subroutine note

   !> What the user material said last in this call or the last one; empty if nothing.
   function noted_text() result(text)
      character(len=:), allocatable :: text

      text = text_at(guard_text())
   end function noted_text

   !> Copy of a text of C.
   function text_at(address) result(text)
      !> Its first character; a null character ends it.
      type(c_ptr), intent(in) :: address
      character(len=:), allocatable :: text
      character(kind=c_char), pointer :: characters(:)
      integer :: i

      call c_f_pointer(address, characters, [strlen(address)])
      allocate (character(len=size(characters)) :: text)
      do i = 1, len(text)
         text(i:i) = characters(i)
      end do
   end function text_at

end module coulter_law_umat_guard
