!> Asserts on reals and integers: one text for each, compiled for two kinds of each.
module funit_real64
   use, intrinsic :: iso_fortran_env, only: rk => real64
   include "funit_real.inc"
end module funit_real64

!> The same in single precision
module funit_real32
   use, intrinsic :: iso_fortran_env, only: rk => real32
   include "funit_real.inc"
end module funit_real32

!> Default integers
module funit_int32
   use, intrinsic :: iso_fortran_env, only: ik => int32
   include "funit_integer.inc"
end module funit_int32

!> Long integers
module funit_int64
   use, intrinsic :: iso_fortran_env, only: ik => int64
   include "funit_integer.inc"
end module funit_int64
