!> Solution of sparse linear systems: analyse a pattern, factorise values, solve, release.
!>
!> The tangents of Coulter are symmetric or nearly so, and positive definite in most scenes. Then a
!> Cholesky factorisation of the symmetric part is several times faster than LU: it solves
!> symmetric systems at once and makes a few iterations of GMRES do for the others. Whenever it is
!> not enough, LU takes over. Factors also serve for later matrices that hardly differ.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_solver
   use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_null_ptr
   use coulter_algebra_cholesky, only: cholesky_bytes, cholesky_factorise, cholesky_free, &
      cholesky_intensity, cholesky_new, cholesky_pivot_ratio, cholesky_solve
   use coulter_algebra_gmres, only: preconditioner_type, solve_gmres
   use coulter_algebra_lu, only: is_accurate, lu_type
   use coulter_algebra_skew, only: find_skew_part
   use coulter_algebra_sparse, only: find_mirror, pattern_type
   use coulter_base_kinds, only: long, wp
   implicit none(type, external)
   private
   public :: solver_type

   !> A factorised matrix. The owner calls `release` before it forgets the solver.
   type :: solver_type
      !> Is LU used for every system?
      logical :: is_lu_only = .false.
      !> Bytes that the factors occupy.
      integer(long) :: factor_memory = 0
      !> Systems that Cholesky could not solve after all, and that LU had to repair.
      integer :: n_repairs = 0
      !> Smallest over largest pivot of the last matrix: small when it is nearly singular.
      real(wp) :: pivot_ratio = 0.0_wp
      !> Numeric factorisations since the last analysis.
      integer :: n_factorisations = 0
      !> Factors of the matrix at hand, or of a former one.
      type(preconditioner_type), private :: near
      logical, private :: is_lu_analysed = .false., is_symmetric = .false.
      !> Factorisations since Cholesky has served.
      integer, private :: n_without = 0
      !> Does the factor belong to the matrix at hand, or must the next one be factorised anyway?
      logical, private :: is_current = .false., is_worn = .true.
      !> Iterations that cost as much as a factorisation.
      integer, private :: worth = 0
      integer, allocatable, private :: order(:)
      !> Mirrored place of every entry, see `find_mirror`.
      integer, allocatable, private :: mirror(:)
   contains
      procedure :: analyse
      procedure :: factorise
      procedure :: refresh
      procedure :: is_reusable
      procedure :: solve
      procedure :: release
   end type solver_type

   !> Entries that differ from their mirror images by less than this, over the largest entry, come
   !> from round-off.
   real(wp), parameter :: symmetry_tolerance = 1.0e-13_wp
   !> Preconditioned residual, about the relative error of the solution, that is accepted from
   !> GMRES unless the caller says otherwise.
   real(wp), parameter :: gmres_tolerance = 1.0e-6_wp
   !> Most iterations of GMRES; a preconditioner that needs more is not worth it.
   integer, parameter :: most_iterations = 30
   !> Operations per entry that a factorisation does in the time of one iteration: it stays in the
   !> cache, the iteration does not. So many iterations take no longer in any case, Cholesky and LU.
   real(wp), parameter :: operations_per_entry = 16.0_wp
   integer, parameter :: least_worth = 4, least_worth_of_lu = 8
   !> Cholesky that has failed so often in a row is tried only every so often.
   integer, parameter :: most_failures = 12, pause = 8
   !> Change of the matrix, relative to it, up to which LU factors serve on.
   real(wp), parameter :: small_change = 0.03_wp
   !> Factors with smaller ratios of pivots are used once: errors of iterations would hide behind
   !> the penalties of narrow bands, and free bodies behind old factors.
   real(wp), parameter :: healthy_ratio = 2.0e-6_wp

contains

   !> Symbolic factorisation, to be repeated only when the pattern changes.
   subroutine analyse(self, pattern, order, has_failed)
      class(solver_type), intent(inout) :: self
      !> Pattern of the matrix, structurally symmetric.
      type(pattern_type), intent(in) :: pattern
      !> Elimination order of the columns, zero-based, shape (n); empty: one is found.
      integer, intent(in) :: order(:)
      !> Did the analysis fail?
      logical, intent(out) :: has_failed

      call self%release()
      self%order = order
      self%n_factorisations = 0
      has_failed = .false.
      if (.not. self%is_lu_only) call analyse_cholesky(self, pattern)
      if (.not. c_associated(self%near%factor)) call analyse_lu(self, pattern, has_failed)
   end subroutine analyse

   !> Numeric factorisation of the analysed pattern.
   subroutine factorise(self, pattern, values, has_failed)
      class(solver_type), intent(inout) :: self
      !> The analysed pattern.
      type(pattern_type), intent(in) :: pattern
      !> Values of the matrix, shape (n_entries).
      real(wp), intent(in) :: values(:)
      !> Is the matrix singular or did memory run out? Then `solve` must not be called.
      logical, intent(out) :: has_failed

      has_failed = .true.
      if (c_associated(self%near%factor) .and. (self%n_without < most_failures &
                                                .or. modulo(self%n_without, pause) == 0)) then
         call factorise_cholesky(self, pattern, values, has_failed)
      end if
      self%n_without = merge(self%n_without + 1, 0, has_failed)
      if (has_failed) call factorise_lu(self, pattern, values, has_failed)
      self%n_factorisations = self%n_factorisations + 1
      self%is_current = .true.
   end subroutine factorise

   !> Be ready for new values: factorise them, unless the factor at hand serves as preconditioner.
   subroutine refresh(self, pattern, values, change, has_failed)
      class(solver_type), intent(inout) :: self
      !> The analysed pattern.
      type(pattern_type), intent(in) :: pattern
      !> Values of the matrix, shape (n_entries).
      real(wp), intent(in) :: values(:)
      !> How much they differ from those before, relative to these, as far as that is known.
      real(wp), intent(in) :: change
      !> Is the matrix singular or did memory run out? Then `solve` must not be called.
      logical, intent(out) :: has_failed

      self%is_current = .false.
      if (allocated(self%near%rest)) deallocate (self%near%rest)
      has_failed = .false.
      if (self%is_worn .or. (self%near%is_lu .and. change > small_change)) then
         call self%factorise(pattern, values, has_failed)
      end if
   end subroutine refresh

   !> May the last matrix be solved with once more?
   pure function is_reusable(self) result(answer)
      class(solver_type), intent(in) :: self
      logical :: answer

      answer = .not. self%is_worn
   end function is_reusable

   !> Solve A x = b and check the answer.
   subroutine solve(self, pattern, values, b, x, has_failed, tolerance)
      class(solver_type), intent(inout) :: self
      !> The analysed pattern.
      type(pattern_type), intent(in) :: pattern
      !> The values that were given to `factorise` or `refresh` last.
      real(wp), intent(in) :: values(:)
      !> Right-hand side, shape (n).
      real(wp), intent(in) :: b(:)
      !> Solution, shape (n).
      real(wp), intent(out) :: x(:)
      !> Is there no accurate solution?
      logical, intent(out) :: has_failed
      !> Accepted error of iterations, relative.
      real(wp), intent(in), optional :: tolerance
      real(wp) :: accepted

      accepted = gmres_tolerance
      if (present(tolerance)) accepted = tolerance
      if (.not. self%is_current) then
         call iterate(self, pattern, values, b, accepted, x, has_failed)
         if (.not. has_failed) return
         call self%factorise(pattern, values, has_failed)
         if (has_failed) return
      end if
      if (.not. self%near%is_lu) then
         if (self%is_symmetric) then
            has_failed = cholesky_solve(self%near%factor, b, x) /= 0
            if (.not. has_failed) has_failed = .not. is_accurate(pattern, values, b, x)
         else
            call iterate(self, pattern, values, b, accepted, x, has_failed)
         end if
         if (.not. has_failed) return
         self%n_repairs = self%n_repairs + 1
         call factorise_lu(self, pattern, values, has_failed)
         if (has_failed) return
      end if
      call self%near%lu%solve(pattern, values, b, x, has_failed)
   end subroutine solve

   !> Solve by GMRES with the factor at hand, and see whether that is worn.
   subroutine iterate(self, pattern, values, b, tolerance, x, has_failed)
      type(solver_type), intent(inout) :: self
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: values(:), b(:), tolerance
      real(wp), intent(out) :: x(:)
      logical, intent(out) :: has_failed
      integer :: n_iterations

      n_iterations = most_iterations
      if (.not. self%is_current) n_iterations = min(n_iterations, &
                                                    merge(1, 2, self%near%is_lu)*self%worth)
      call solve_gmres(self%near, pattern, values, b, tolerance, x, n_iterations)
      has_failed = n_iterations == 0
      if (.not. self%is_current) self%is_worn = has_failed .or. n_iterations > self%worth
   end subroutine iterate

   !> Free what the libraries hold.
   subroutine release(self)
      class(solver_type), intent(inout) :: self

      if (c_associated(self%near%factor)) call cholesky_free(self%near%factor)
      self%near%factor = c_null_ptr
      call self%near%lu%release()
      self%is_lu_analysed = .false.
      self%near%is_lu = .false.
      self%is_worn = .true.
   end subroutine release

   !> Analyse the pattern for Cholesky; without success there is no handle.
   subroutine analyse_cholesky(self, pattern)
      type(solver_type), intent(inout) :: self
      type(pattern_type), intent(in) :: pattern

      if (pattern%n == 0) return
      call find_mirror(pattern, self%mirror)
      if (size(self%mirror) == 0) return
      if (size(self%order) == pattern%n) then
         self%near%factor = cholesky_new(pattern%n, pattern%column_start, pattern%row, &
                                        self%mirror, self%order)
      else
         self%near%factor = cholesky_new(pattern%n, pattern%column_start, pattern%row, &
                                        self%mirror)
      end if
   end subroutine analyse_cholesky

   !> Factorise the symmetric part by Cholesky.
   subroutine factorise_cholesky(self, pattern, values, has_failed)
      type(solver_type), intent(inout) :: self
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: values(:)
      logical, intent(out) :: has_failed
      real(wp) :: skewness

      has_failed = cholesky_factorise(self%near%factor, values, skewness) /= 0
      if (has_failed) return
      self%near%is_lu = .false.
      self%is_symmetric = skewness <= symmetry_tolerance
      if (.not. allocated(self%near%rest)) allocate (self%near%rest)
      if (.not. self%is_symmetric) call find_skew_part(self%near%rest, pattern, self%mirror, values)
      self%factor_memory = cholesky_bytes(self%near%factor)
      self%pivot_ratio = cholesky_pivot_ratio(self%near%factor)
      self%is_worn = self%pivot_ratio < healthy_ratio
      self%worth = worth_of(cholesky_intensity(self%near%factor), least_worth)
   end subroutine factorise_cholesky

   !> Analyse the pattern for LU.
   subroutine analyse_lu(self, pattern, has_failed)
      type(solver_type), intent(inout) :: self
      type(pattern_type), intent(in) :: pattern
      logical, intent(out) :: has_failed

      call self%near%lu%analyse(pattern, self%order, has_failed)
      self%is_lu_analysed = .not. has_failed
   end subroutine analyse_lu

   !> Factorise by LU.
   subroutine factorise_lu(self, pattern, values, has_failed)
      type(solver_type), intent(inout) :: self
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: values(:)
      logical, intent(out) :: has_failed

      has_failed = .false.
      self%is_worn = .true.
      if (.not. self%is_lu_analysed) call analyse_lu(self, pattern, has_failed)
      if (has_failed) return
      if (allocated(self%near%rest)) deallocate (self%near%rest)
      self%near%is_lu = .true.
      associate (lu => self%near%lu)
         call lu%factorise(pattern, values, has_failed)
         self%factor_memory = lu%factor_memory
         self%pivot_ratio = lu%pivot_ratio
         self%is_worn = has_failed .or. lu%pivot_ratio < healthy_ratio
         self%worth = worth_of(lu%intensity, least_worth_of_lu)
      end associate
   end subroutine factorise_lu

   !> Iterations that cost as much as a factorisation.
   pure function worth_of(intensity, least) result(worth)
      !> Operations per entry of the factors.
      real(wp), intent(in) :: intensity
      integer, intent(in) :: least
      integer :: worth

      worth = max(least, nint(intensity/operations_per_entry))
   end function worth_of

end module coulter_algebra_solver
