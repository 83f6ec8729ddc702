! SPDX-License-Identifier: BSD-3-Clause
!> Asserts on logicals, texts, shapes and raised failures.
module funit_basic
   use funit_core, only: SourceLocation, catch, conform, require, throw
   implicit none(type, external)
   private

   public :: assertTrue, assertFalse, assertFail, assertEqual, assertSameShape
   public :: assertExceptionRaised

   interface assertTrue
      module procedure assert_true
      module procedure assert_all_true
   end interface assertTrue

   interface assertFalse
      module procedure assert_false
      module procedure assert_all_false
   end interface assertFalse

   interface assertEqual
      module procedure assert_equal_logical
      module procedure assert_equal_text
      module procedure assert_equal_texts
      module procedure assert_equal_text_each
   end interface assertEqual

contains

   subroutine assert_true(condition, message, location)
      logical, intent(in) :: condition
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      call require(condition, "expected true, found false", message, location)
   end subroutine assert_true

   subroutine assert_all_true(condition, message, location)
      logical, intent(in) :: condition(:)
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      call require(all(condition), "expected all true, found a false", message, location)
   end subroutine assert_all_true

   subroutine assert_false(condition, message, location)
      logical, intent(in) :: condition
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      call require(.not. condition, "expected false, found true", message, location)
   end subroutine assert_false

   subroutine assert_all_false(condition, message, location)
      logical, intent(in) :: condition(:)
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      call require(.not. any(condition), "expected all false, found a true", message, location)
   end subroutine assert_all_false

   subroutine assertFail(message, location)
      character(len=*), intent(in) :: message
      type(SourceLocation), intent(in), optional :: location

      call throw(message, location)
   end subroutine assertFail

   subroutine assert_equal_logical(expected, found, message, location)
      logical, intent(in) :: expected, found
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      call require(expected .eqv. found, "expected "//trim(merge("true ", "false", expected)) &
         //", found "//trim(merge("true ", "false", found)), message, location)
   end subroutine assert_equal_logical

   !> Trailing blanks do not count, leading ones do (pFUnit ignores both)
   subroutine assert_equal_text(expected, found, message, location)
      character(len=*), intent(in) :: expected, found
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      call require(expected == found, "expected """//trim(expected)//"""" &
         //new_line("a")//"      found """//trim(found)//"""", message, location)
   end subroutine assert_equal_text

   subroutine assert_equal_texts(expected, found, message, location)
      character(len=*), intent(in) :: expected(:), found(:)
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      logical :: holds
      integer :: i

      call conform(shape(expected), shape(found), holds, message, location)
      if (.not. holds) return
      do i = 1, size(found)
         call assert_equal_text(expected(i), found(i), message, location)
      end do
   end subroutine assert_equal_texts

   subroutine assert_equal_text_each(expected, found, message, location)
      character(len=*), intent(in) :: expected, found(:)
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      integer :: i

      do i = 1, size(found)
         call assert_equal_text(expected, found(i), message, location)
      end do
   end subroutine assert_equal_text_each

   subroutine assertSameShape(expected, found, message, location)
      integer, intent(in) :: expected(:), found(:)
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      logical :: holds

      call conform(expected, found, holds, message, location)
   end subroutine assertSameShape

   !> Something has failed (with this text): take it back; else fail
   subroutine assertExceptionRaised(message, location)
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (catch(message)) return
      call require(.false., "expected a raised failure, found none", message, location)
   end subroutine assertExceptionRaised

end module funit_basic
