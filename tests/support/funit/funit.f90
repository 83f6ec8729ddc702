! SPDX-License-Identifier: BSD-3-Clause
!> What a .pf file uses of pFUnit: `use funit` where pFUnit itself is not installed.
module funit
   use funit_core, only: SourceLocation, throw, anyExceptions, &
      start_test, end_test, skip_test, finish_run
   use funit_basic, only: assertTrue, assertFalse, assertFail, assertEqual, assertSameShape, &
      assertExceptionRaised
   use funit_int32, only: assertEqual, assertNotEqual, assertLessThan, assertLessThanOrEqual, &
      assertGreaterThan, assertGreaterThanOrEqual
   use funit_int64, only: assertEqual, assertNotEqual, assertLessThan, assertLessThanOrEqual, &
      assertGreaterThan, assertGreaterThanOrEqual
   use funit_real32, only: assertEqual, assertNotEqual, assertLessThan, assertLessThanOrEqual, &
      assertGreaterThan, assertGreaterThanOrEqual, assertRelativelyEqual, assertIsNaN, &
      assertIsFinite
   use funit_real64, only: assertEqual, assertNotEqual, assertLessThan, assertLessThanOrEqual, &
      assertGreaterThan, assertGreaterThanOrEqual, assertRelativelyEqual, assertIsNaN, &
      assertIsFinite
   implicit none(type, external)
   private

   public :: SourceLocation, throw, anyExceptions
   public :: assertTrue, assertFalse, assertFail, assertSameShape, assertExceptionRaised
   public :: assertEqual, assertNotEqual, assertRelativelyEqual, assertIsNaN, assertIsFinite
   public :: assertLessThan, assertLessThanOrEqual, assertGreaterThan, assertGreaterThanOrEqual
   public :: TestCase, ParameterizedTestCase, AbstractTestParameter
   public :: start_test, end_test, skip_test, finish_run

   !> A fixture: extend it, add components, override setUp and tearDown
   type, abstract :: TestCase
   contains
      procedure :: setUp => do_nothing
      procedure :: tearDown => do_nothing
   end type TestCase

   !> A fixture made anew for every parameter
   type, abstract, extends(TestCase) :: ParameterizedTestCase
   end type ParameterizedTestCase

   !> One parameter of a parametrised test; its text names the test
   type, abstract :: AbstractTestParameter
   contains
      procedure(to_string), deferred :: toString
   end type AbstractTestParameter

   abstract interface
      function to_string(this) result(string)
         import AbstractTestParameter
         implicit none(type, external)
         class(AbstractTestParameter), intent(in) :: this
         character(len=:), allocatable :: string
      end function to_string
   end interface

contains

   subroutine do_nothing(this)
      class(TestCase), intent(inout) :: this

      associate (unused => this)
      end associate
   end subroutine do_nothing

end module funit
