!> Sparse Cholesky factorisation of the symmetric part of a matrix: declarations of cholesky.c.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_cholesky
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_long_long, c_ptr
   implicit none(type, external)
   private
   public :: cholesky_new, cholesky_factorise, cholesky_solve, cholesky_pivot_ratio
   public :: cholesky_bytes, cholesky_free, cholesky_intensity

   interface
      !> Analyse a symmetric pattern; a null pointer on failure.
      function cholesky_new(n, column_start, row, mirror, order) result(handle) &
         bind(C, name="coulter_cholesky_new")
         import :: c_int, c_ptr
         implicit none(type, external)
         integer(c_int), value :: n
         integer(c_int), intent(in) :: column_start(*), row(*), mirror(*)
         integer(c_int), intent(in), optional :: order(*)
         type(c_ptr) :: handle
      end function cholesky_new

      !> Factorise the symmetric part of values: 0 done, 1 not positive definite, 2 out of memory.
      !> The largest entry of their skew part over their largest is told.
      function cholesky_factorise(handle, values, skewness) result(status) &
         bind(C, name="coulter_cholesky_factorise")
         import :: c_double, c_int, c_ptr
         implicit none(type, external)
         type(c_ptr), value :: handle
         real(c_double), intent(in) :: values(*)
         real(c_double), intent(out) :: skewness
         integer(c_int) :: status
      end function cholesky_factorise

      !> Solve with the factor: 0 done, 2 out of memory.
      function cholesky_solve(handle, b, x) result(status) bind(C, name="coulter_cholesky_solve")
         import :: c_double, c_int, c_ptr
         implicit none(type, external)
         type(c_ptr), value :: handle
         real(c_double), intent(in) :: b(*)
         real(c_double), intent(out) :: x(*)
         integer(c_int) :: status
      end function cholesky_solve

      !> Smallest over largest pivot of the factor.
      function cholesky_pivot_ratio(handle) result(ratio) &
         bind(C, name="coulter_cholesky_pivot_ratio")
         import :: c_double, c_ptr
         implicit none(type, external)
         type(c_ptr), value :: handle
         real(c_double) :: ratio
      end function cholesky_pivot_ratio

      !> Operations of a factorisation over entries of the factor.
      function cholesky_intensity(handle) result(ratio) bind(C, name="coulter_cholesky_intensity")
         import :: c_double, c_ptr
         implicit none(type, external)
         type(c_ptr), value :: handle
         real(c_double) :: ratio
      end function cholesky_intensity

      !> Bytes that the factor occupies.
      function cholesky_bytes(handle) result(bytes) bind(C, name="coulter_cholesky_bytes")
         import :: c_long_long, c_ptr
         implicit none(type, external)
         type(c_ptr), value :: handle
         integer(c_long_long) :: bytes
      end function cholesky_bytes

      !> Free everything.
      subroutine cholesky_free(handle) bind(C, name="coulter_cholesky_free")
         import :: c_ptr
         implicit none(type, external)
         type(c_ptr), value :: handle
      end subroutine cholesky_free
   end interface

end module coulter_algebra_cholesky
