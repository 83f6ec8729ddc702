!> Sparse LU factorisation by UMFPACK, for any matrix: analyse a pattern, factorise, solve, release.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_lu
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_null_ptr, c_ptr
   use coulter_algebra_sparse, only: multiply, pattern_type
   use coulter_algebra_umfpack, only: control_refinement_steps, control_scale, control_strategy, &
      info_flops, info_lower_entries, info_numeric_size, info_rcond, info_upper_entries, &
      n_control, n_info, scale_none, scale_sum, strategy_auto, strategy_symmetric, &
      system_a, umfpack_di_defaults, umfpack_di_free_numeric, &
      umfpack_di_free_symbolic, umfpack_di_numeric, umfpack_di_qsymbolic, umfpack_di_solve, &
      umfpack_di_symbolic
   use coulter_base_kinds, only: long, wp
   implicit none(type, external)
   private
   public :: lu_type, is_accurate

   !> A factorised matrix. The owner calls `release` before it forgets it.
   type :: lu_type
      private
      type(c_ptr) :: symbolic = c_null_ptr
      type(c_ptr) :: numeric = c_null_ptr
      real(c_double) :: control(n_control) = 0.0_c_double
      integer(c_int), allocatable :: order(:)
      !> Bytes that the factors occupy.
      integer(long), public :: factor_memory = 0
      !> Smallest over largest pivot of the last matrix.
      real(wp), public :: pivot_ratio = 0.0_wp
      !> Operations of the last factorisation over entries of the factors.
      real(wp), public :: intensity = 0.0_wp
      !> Solves that needed refinement or another factorisation to be accurate.
      integer, public :: n_repairs = 0
   contains
      procedure :: analyse
      procedure :: factorise
      procedure :: solve
      procedure :: substitute
      procedure :: release
   end type lu_type

   !> Largest accepted backward error |A x - b| / (|A| |x| + |b|), norms by maximum.
   real(wp), parameter :: accepted_error = 1.0e-13_wp

contains

   !> Symbolic factorisation, to be repeated only when the pattern changes.
   !> The matrix pattern is symmetric and penalties sit on the diagonal: without scaling UMFPACK
   !> keeps diagonal pivots, which halves the work at the same backward error.
   subroutine analyse(self, pattern, order, has_failed)
      class(lu_type), intent(inout) :: self
      !> Pattern of the matrix.
      type(pattern_type), intent(in) :: pattern
      !> Elimination order of the columns, zero-based, shape (n); empty: UMFPACK finds one.
      integer, intent(in) :: order(:)
      !> Did the analysis fail?
      logical, intent(out) :: has_failed
      real(c_double) :: info(n_info), no_values(1)
      integer(c_int) :: status

      call self%release()
      call umfpack_di_defaults(self%control)
      self%control(control_strategy) = strategy_symmetric
      self%control(control_scale) = scale_none
      self%control(control_refinement_steps) = 0.0_c_double
      self%order = int(order, c_int)
      no_values = 0.0_c_double
      if (size(order) == pattern%n .and. pattern%n > 0) then
         status = umfpack_di_qsymbolic(pattern%n, pattern%n, pattern%column_start, pattern%row, &
                                       pattern_values(), self%order, self%symbolic, &
                                       self%control, info)
      else
         status = umfpack_di_symbolic(pattern%n, pattern%n, pattern%column_start, pattern%row, &
                                      pattern_values(), self%symbolic, self%control, info)
      end if
      has_failed = status /= 0

   contains

      !> The symmetric strategy looks at the pattern alone, but wants an array.
      pure function pattern_values() result(values)
         real(c_double), allocatable :: values(:)

         allocate (values(pattern%n_entries), source=1.0_c_double)
      end function pattern_values

   end subroutine analyse

   !> Numeric factorisation of the analysed pattern.
   subroutine factorise(self, pattern, values, has_failed)
      class(lu_type), intent(inout) :: self
      !> The analysed pattern.
      type(pattern_type), intent(in) :: pattern
      !> Values of the matrix, shape (n_entries).
      real(wp), intent(in) :: values(:)
      !> Is the matrix singular or did memory run out? Then `solve` must not be called.
      logical, intent(out) :: has_failed
      real(c_double) :: info(n_info)
      integer(c_int) :: status

      if (c_associated(self%numeric)) call umfpack_di_free_numeric(self%numeric)
      status = umfpack_di_numeric(pattern%column_start, pattern%row, values, self%symbolic, &
                                  self%numeric, self%control, info)
      has_failed = status /= 0
      self%pivot_ratio = 0.0_wp
      if (has_failed) return
      self%factor_memory = 8*int(info(info_numeric_size), long)
      self%pivot_ratio = info(info_rcond)
      self%intensity = info(info_flops)/(info(info_lower_entries) + info(info_upper_entries))
   end subroutine factorise

   !> Solve A x = b and check the answer; when it is not accurate, repeat with iterative refinement,
   !> then with a scaled factorisation.
   subroutine solve(self, pattern, values, b, x, has_failed)
      class(lu_type), intent(inout) :: self
      !> The factorised pattern.
      type(pattern_type), intent(in) :: pattern
      !> The factorised values.
      real(wp), intent(in) :: values(:)
      !> Right-hand side, shape (n).
      real(wp), intent(in) :: b(:)
      !> Solution, shape (n).
      real(wp), intent(out) :: x(:)
      !> Is there no accurate solution?
      logical, intent(out) :: has_failed
      real(c_double) :: control(n_control)

      call self%substitute(pattern, values, b, x)
      has_failed = .not. is_accurate(pattern, values, b, x)
      if (.not. has_failed) return
      self%n_repairs = self%n_repairs + 1
      control = self%control
      control(control_refinement_steps) = 2.0_c_double
      call solve_once(self, pattern, values, b, control, x)
      has_failed = .not. is_accurate(pattern, values, b, x)
      if (.not. has_failed) return
      call solve_scaled(self, pattern, values, b, x, has_failed)
   end subroutine solve

   !> Forward and back substitution, whatever comes out: huge numbers if nothing does.
   subroutine substitute(self, pattern, values, b, x)
      class(lu_type), intent(in) :: self
      !> Pattern and values of a matrix: those of the factorised one, or of one close to it.
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: values(:)
      !> Right-hand side, shape (n).
      real(wp), intent(in) :: b(:)
      !> Solution, shape (n).
      real(wp), intent(out) :: x(:)

      call solve_once(self, pattern, values, b, self%control, x)
   end subroutine substitute

   !> Free what UMFPACK holds.
   subroutine release(self)
      class(lu_type), intent(inout) :: self

      if (c_associated(self%numeric)) call umfpack_di_free_numeric(self%numeric)
      if (c_associated(self%symbolic)) call umfpack_di_free_symbolic(self%symbolic)
      self%numeric = c_null_ptr
      self%symbolic = c_null_ptr
   end subroutine release

   !> Forward and back substitution, and refinement as `control` has it.
   subroutine solve_once(self, pattern, values, b, control, x)
      type(lu_type), intent(in) :: self
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: values(:), b(:)
      real(c_double), intent(in) :: control(n_control)
      real(wp), intent(out) :: x(:)
      real(c_double) :: info(n_info)
      integer(c_int) :: status

      status = umfpack_di_solve(system_a, pattern%column_start, pattern%row, values, x, b, &
                                self%numeric, control, info)
      if (status /= 0) x = huge(x)
   end subroutine solve_once

   !> The last resort: full pivoting freedom, row scaling and refinement, used once and thrown away.
   subroutine solve_scaled(self, pattern, values, b, x, has_failed)
      type(lu_type), intent(in) :: self
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: values(:), b(:)
      real(wp), intent(out) :: x(:)
      logical, intent(out) :: has_failed
      type(lu_type) :: scaled
      real(c_double) :: info(n_info)
      integer(c_int) :: status

      x = 0.0_wp
      scaled%control = self%control
      scaled%control(control_strategy) = strategy_auto
      scaled%control(control_scale) = scale_sum
      scaled%control(control_refinement_steps) = 2.0_c_double
      status = umfpack_di_symbolic(pattern%n, pattern%n, pattern%column_start, pattern%row, &
                                   values, scaled%symbolic, scaled%control, info)
      has_failed = status /= 0
      if (.not. has_failed) call scaled%factorise(pattern, values, has_failed)
      if (.not. has_failed) then
         call solve_once(scaled, pattern, values, b, scaled%control, x)
         has_failed = .not. is_accurate(pattern, values, b, x)
      end if
      call scaled%release()
   end subroutine solve_scaled

   !> Is the backward error small? False also for NaN, which `maxval` would pass over.
   pure function is_accurate(pattern, values, b, x) result(answer)
      !> Pattern of A.
      type(pattern_type), intent(in) :: pattern
      !> Values of A, right-hand side and solution.
      real(wp), intent(in) :: values(:), b(:), x(:)
      logical :: answer
      real(wp) :: product(size(b))

      answer = all(abs(x) < huge(x))
      if (.not. answer) return
      call multiply(pattern, values, x, product)
      answer = all(abs(product - b) &
                   <= accepted_error*(maxval(abs(values))*maxval(abs(x)) + maxval(abs(b))))
   end function is_accurate

end module coulter_algebra_lu
