!> Number kinds used throughout Coulter.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_kinds
   use, intrinsic :: iso_fortran_env, only: int64, real64
   implicit none(type, external)
   private
   public :: wp, long

   !> Working precision of all physical quantities.
   integer, parameter :: wp = real64
   !> Integers that may exceed the default range (bytes, clock counts).
   integer, parameter :: long = int64

end module coulter_base_kinds
