! SPDX-License-Identifier: BSD-3-Clause
!> Asserts on reals and integers: one text for each, compiled here for two kinds of each.
module funit_real64
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use, intrinsic :: iso_fortran_env, only: rk => real64
   use funit_core, only: SourceLocation, conform, differ, require
   implicit none(type, external)
   private

   include "funit_real.inc"

end module funit_real64

!> The same in single precision
module funit_real32
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use, intrinsic :: iso_fortran_env, only: rk => real32
   use funit_core, only: SourceLocation, conform, differ, require
   implicit none(type, external)
   private

   include "funit_real.inc"

end module funit_real32

!> Default integers
module funit_int32
   use, intrinsic :: iso_fortran_env, only: ik => int32
   use funit_core, only: SourceLocation, conform, differ
   implicit none(type, external)
   private

   include "funit_integer.inc"

end module funit_int32

!> Long integers
module funit_int64
   use, intrinsic :: iso_fortran_env, only: ik => int64
   use funit_core, only: SourceLocation, conform, differ
   implicit none(type, external)
   private

   include "funit_integer.inc"

end module funit_int64
