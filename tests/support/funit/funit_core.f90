! SPDX-License-Identifier: BSD-3-Clause
!> Where a test run keeps its books: the failures of the running test and the count of all tests.
module funit_core
   use, intrinsic :: iso_fortran_env, only: output_unit
   implicit none(type, external)
   private

   public :: SourceLocation, throw, catch, anyExceptions, require, differ, conform
   public :: start_test, end_test, skip_test, finish_run

   !> Place of an annotation in a .pf file
   type :: SourceLocation
      character(len=128) :: file_name = "unknown file"
      integer :: line_number = 0
   end type SourceLocation

   type :: failure_type
      character(len=:), allocatable :: text
      type(SourceLocation) :: location
   end type failure_type

   ! One run per program: module state is right here, as it is nowhere in the library.
   integer, parameter :: max_failures = 20
   type(failure_type) :: failures(max_failures)
   character(len=:), allocatable :: test_name
   integer :: n_failures = 0
   integer :: n_tests = 0
   integer :: n_failed = 0
   integer :: n_disabled = 0

contains

   !> Record a failure of the running test
   subroutine throw(text, location)
      character(len=*), intent(in) :: text
      type(SourceLocation), intent(in), optional :: location

      if (n_failures == max_failures) return
      n_failures = n_failures + 1
      failures(n_failures)%text = text
      failures(n_failures)%location = SourceLocation()
      if (present(location)) failures(n_failures)%location = location
   end subroutine throw

   !> Take the newest failure (or the newest with exactly this text) back; false if there is none
   logical function catch(text)
      character(len=*), intent(in), optional :: text
      integer :: i

      catch = .false.
      do i = n_failures, 1, -1
         if (present(text)) then
            if (failures(i)%text /= text) cycle
         end if
         failures(i:n_failures - 1) = failures(i + 1:n_failures)
         n_failures = n_failures - 1
         catch = .true.
         return
      end do
   end function catch

   !> Has the running test failed?
   logical function anyExceptions()
      anyExceptions = n_failures > 0
   end function anyExceptions

   !> Fail with `text` (and the author's message) unless `holds`
   subroutine require(holds, text, message, location)
      logical, intent(in) :: holds
      character(len=*), intent(in) :: text
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (holds) return
      if (present(message)) then
         call throw(message//new_line("a")//"   "//text, location)
      else
         call throw(text, location)
      end if
   end subroutine require

   !> Fail because element `i` of an array of this shape differs (a scalar has an empty shape)
   subroutine differ(relation, expected, found, i, found_shape, message, location)
      character(len=*), intent(in) :: relation          !! put before the expected value
      character(len=*), intent(in) :: expected, found   !! the two values as texts
      integer, intent(in) :: i, found_shape(:)
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      call require(.false., "expected "//relation//expected//", found "//found &
         //element_text(i, found_shape), message, location)
   end subroutine differ

   !> Fail unless the shapes agree or the expected value is a scalar
   subroutine conform(expected_shape, found_shape, holds, message, location)
      integer, intent(in) :: expected_shape(:), found_shape(:)
      logical, intent(out) :: holds
      character(len=*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      holds = size(expected_shape) == 0
      if (size(expected_shape) == size(found_shape)) holds = all(expected_shape == found_shape)
      call require(holds, "expected shape "//list_text(expected_shape)//", found shape " &
         //list_text(found_shape), message, location)
   end subroutine conform

   !> Begin a test
   subroutine start_test(name)
      character(len=*), intent(in) :: name

      test_name = name
      n_failures = 0
      n_tests = n_tests + 1
   end subroutine start_test

   !> End a test: print its failures; however many there are, one test has failed
   subroutine end_test()
      integer :: i

      if (n_failures > 0) n_failed = n_failed + 1
      do i = 1, n_failures
         associate (failure => failures(i))
            write (output_unit, "(a, ':', i0, ': failure in ', a, /, '   ', a)") &
               trim(failure%location%file_name), failure%location%line_number, test_name, &
               failure%text
         end associate
      end do
      flush (output_unit)   ! a later test may crash
   end subroutine end_test

   !> Note a disabled test
   subroutine skip_test(name)
      character(len=*), intent(in) :: name

      n_disabled = n_disabled + 1
      write (output_unit, "(2a)") "disabled: ", name
   end subroutine skip_test

   !> Print the count and stop with status 2 if a test failed, or if none ran
   subroutine finish_run()
      if (n_failed > 0) then
         write (output_unit, "(*(g0))") "FAILED (", n_tests, " tests, ", n_failed, " failures)"
         stop 2, quiet=.true.
      end if
      write (output_unit, "(*(g0))", advance="no") " OK (", n_tests, " tests"
      if (n_disabled > 0) write (output_unit, "(*(g0))", advance="no") ", ", n_disabled, " disabled"
      write (output_unit, "(a)") ")"
      if (n_tests == 0 .and. n_disabled == 0) stop 2, quiet=.true.
   end subroutine finish_run

   !> " at element (1, 2)" for position i in array order; empty for a scalar
   pure function element_text(i, array_shape) result(text)
      integer, intent(in) :: i, array_shape(:)
      character(len=:), allocatable :: text
      integer :: place(size(array_shape)), left, k

      text = ""
      if (size(array_shape) == 0) return
      left = i - 1
      do k = 1, size(array_shape)
         place(k) = mod(left, array_shape(k)) + 1
         left = left/array_shape(k)
      end do
      text = " at element "//list_text(place)
   end function element_text

   !> "(2, 3)"
   pure function list_text(list) result(text)
      integer, intent(in) :: list(:)
      character(len=:), allocatable :: text
      character(len=80) :: buffer

      write (buffer, "('(', *(i0, :, ', '))") list
      text = trim(buffer)//")"
   end function list_text

end module funit_core
