!> The C interface of UMFPACK (SuiteSparse), int32 indices and real values: declarations only.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_umfpack
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_ptr
   implicit none(type, external)
   private
   public :: umfpack_di_defaults, umfpack_di_symbolic, umfpack_di_qsymbolic, umfpack_di_numeric
   public :: umfpack_di_solve, umfpack_di_free_symbolic, umfpack_di_free_numeric

   !> Lengths of the control and information arrays.
   integer, parameter, public :: n_control = 20, n_info = 90
   !> Places in the control array (from 1).
   integer, parameter, public :: control_strategy = 6, control_refinement_steps = 8
   integer, parameter, public :: control_scale = 17
   !> Values of these.
   real(c_double), parameter, public :: strategy_auto = 0.0_c_double
   real(c_double), parameter, public :: strategy_symmetric = 3.0_c_double
   real(c_double), parameter, public :: scale_none = 0.0_c_double, scale_sum = 1.0_c_double
   !> Places in the information array (from 1): size of the factors in units of 8 bytes, operations,
   !> entries of both factors, smallest over largest pivot.
   integer, parameter, public :: info_numeric_size = 41, info_flops = 43
   integer, parameter, public :: info_lower_entries = 44, info_upper_entries = 45, info_rcond = 68
   !> Solve A x = b with A in compressed columns.
   integer(c_int), parameter, public :: system_a = 0

   interface
      subroutine umfpack_di_defaults(control) bind(C, name="umfpack_di_defaults")
         import :: c_double, n_control
         implicit none (type, external)
         real(c_double), intent(out) :: control(n_control)
      end subroutine umfpack_di_defaults

      function umfpack_di_symbolic(n_row, n_column, column_start, row, values, symbolic, &
                                   control, info) result(status) bind(C, name="umfpack_di_symbolic")
         import :: c_double, c_int, c_ptr, n_control, n_info
         implicit none (type, external)
         integer(c_int), value :: n_row, n_column
         integer(c_int), intent(in) :: column_start(*), row(*)
         real(c_double), intent(in) :: values(*)
         type(c_ptr), intent(out) :: symbolic
         real(c_double), intent(in) :: control(n_control)
         real(c_double), intent(out) :: info(n_info)
         integer(c_int) :: status
      end function umfpack_di_symbolic

      function umfpack_di_qsymbolic(n_row, n_column, column_start, row, values, order, symbolic, &
                                    control, info) result(status) &
         bind(C, name="umfpack_di_qsymbolic")
         import :: c_double, c_int, c_ptr, n_control, n_info
         implicit none (type, external)
         integer(c_int), value :: n_row, n_column
         integer(c_int), intent(in) :: column_start(*), row(*), order(*)
         real(c_double), intent(in) :: values(*)
         type(c_ptr), intent(out) :: symbolic
         real(c_double), intent(in) :: control(n_control)
         real(c_double), intent(out) :: info(n_info)
         integer(c_int) :: status
      end function umfpack_di_qsymbolic

      function umfpack_di_numeric(column_start, row, values, symbolic, numeric, control, info) &
         result(status) bind(C, name="umfpack_di_numeric")
         import :: c_double, c_int, c_ptr, n_control, n_info
         implicit none (type, external)
         integer(c_int), intent(in) :: column_start(*), row(*)
         real(c_double), intent(in) :: values(*)
         type(c_ptr), value :: symbolic
         type(c_ptr), intent(out) :: numeric
         real(c_double), intent(in) :: control(n_control)
         real(c_double), intent(out) :: info(n_info)
         integer(c_int) :: status
      end function umfpack_di_numeric

      function umfpack_di_solve(system, column_start, row, values, x, b, numeric, control, info) &
         result(status) bind(C, name="umfpack_di_solve")
         import :: c_double, c_int, c_ptr, n_control, n_info
         implicit none (type, external)
         integer(c_int), value :: system
         integer(c_int), intent(in) :: column_start(*), row(*)
         real(c_double), intent(in) :: values(*), b(*)
         real(c_double), intent(out) :: x(*)
         type(c_ptr), value :: numeric
         real(c_double), intent(in) :: control(n_control)
         real(c_double), intent(out) :: info(n_info)
         integer(c_int) :: status
      end function umfpack_di_solve

      subroutine umfpack_di_free_symbolic(symbolic) bind(C, name="umfpack_di_free_symbolic")
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), intent(inout) :: symbolic
      end subroutine umfpack_di_free_symbolic

      subroutine umfpack_di_free_numeric(numeric) bind(C, name="umfpack_di_free_numeric")
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), intent(inout) :: numeric
      end subroutine umfpack_di_free_numeric
   end interface

end module coulter_algebra_umfpack
