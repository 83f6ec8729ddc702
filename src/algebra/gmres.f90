!> GMRES for matrices that are close to one that has been factorised: their symmetric part, or the
!> tangent of an earlier iteration (Saad, Y. and Schultz, M. H. (1986), SIAM J. Sci. Stat. Comput.
!> 7, 856-869).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_gmres
   use, intrinsic :: iso_c_binding, only: c_null_ptr, c_ptr
   use coulter_algebra_cholesky, only: cholesky_solve
   use coulter_algebra_lu, only: lu_type
   use coulter_algebra_skew, only: multiply_skew, skew_type
   use coulter_algebra_sparse, only: multiply, pattern_type
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: preconditioner_type, solve_gmres

   !> A matrix close to A.
   type :: preconditioner_type
      !> Its Cholesky factor.
      type(c_ptr) :: factor = c_null_ptr
      !> Its LU factors, and do they serve instead?
      type(lu_type) :: lu
      logical :: is_lu = .false.
      !> What A has beyond it; unallocated unless it is the symmetric part of A.
      type(skew_type), allocatable :: rest
   end type preconditioner_type

   !> Iterations after which the rate of convergence is judged.
   integer, parameter :: telling_iterations = 4

contains

   !> Solve A x = b with left preconditioning: the residual that is measured is close to the error
   !> of x, whatever penalties weigh in A.
   subroutine solve_gmres(preconditioner, pattern, values, b, tolerance, x, n_iterations)
      !> A matrix close to A.
      type(preconditioner_type), intent(in) :: preconditioner
      !> Pattern of A.
      type(pattern_type), intent(in) :: pattern
      !> Values of A, shape (n_entries).
      real(wp), intent(in) :: values(:)
      !> Right-hand side, shape (n).
      real(wp), intent(in) :: b(:)
      !> Largest accepted preconditioned residual over that of x = 0.
      real(wp), intent(in) :: tolerance
      !> Solution, shape (n).
      real(wp), intent(out) :: x(:)
      !> On entry the most iterations, on return those that it took; 0 if they are not enough.
      integer, intent(inout) :: n_iterations
      real(wp), allocatable :: basis(:, :)
      real(wp) :: hessenberg(n_iterations + 1, n_iterations), rotation(2, n_iterations)
      real(wp) :: right(n_iterations + 1), share(n_iterations), start
      integer :: k, most
      logical :: has_failed

      most = n_iterations
      n_iterations = 0
      x = 0.0_wp
      allocate (basis(size(b), most + 1))
      call precondition(preconditioner, pattern, values, b, basis(:, 1), has_failed)
      if (has_failed) return
      start = norm2(basis(:, 1))
      if (start <= 0.0_wp) n_iterations = 1
      if (.not. start > 0.0_wp) return
      right = 0.0_wp
      right(1) = start
      basis(:, 1) = basis(:, 1)/start
      do k = 1, most
         call apply(preconditioner, pattern, values, basis(:, k:k + 1), has_failed)
         if (has_failed) return
         call orthogonalise(basis(:, :k + 1), hessenberg(:k + 1, k))
         call rotate(hessenberg(:k + 1, k), rotation(:, :k), right(k:k + 1))
         if (abs(right(k + 1)) <= tolerance*start) exit
         if (is_hopeless(abs(right(k + 1))/start, k, most, tolerance)) return
      end do
      if (k > most) return
      n_iterations = k
      call solve_triangle(hessenberg(:k, :k), right(:k), share(:k))
      x = matmul(basis(:, :k), share(:k))
   end subroutine solve_gmres

   !> Preconditioned matrix times vector.
   subroutine apply(preconditioner, pattern, values, pair, has_failed)
      type(preconditioner_type), intent(in) :: preconditioner
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: values(:)
      !> The vector, and the product.
      real(wp), intent(inout) :: pair(:, :)
      logical, intent(out) :: has_failed
      real(wp) :: product(size(pair, 1))

      if (allocated(preconditioner%rest)) then
         call multiply_skew(preconditioner%rest, pair(:, 1), product)
      else
         call multiply(pattern, values, pair(:, 1), product)
      end if
      call precondition(preconditioner, pattern, values, product, pair(:, 2), has_failed)
      if (allocated(preconditioner%rest)) pair(:, 2) = pair(:, 2) + pair(:, 1)
   end subroutine apply

   !> Solve with the factor at hand.
   subroutine precondition(preconditioner, pattern, values, b, x, has_failed)
      type(preconditioner_type), intent(in) :: preconditioner
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: values(:), b(:)
      real(wp), intent(out) :: x(:)
      logical, intent(out) :: has_failed

      if (preconditioner%is_lu) then
         call preconditioner%lu%substitute(pattern, values, b, x)
         has_failed = .not. all(abs(x) < huge(x))
      else
         has_failed = cholesky_solve(preconditioner%factor, b, x) /= 0
      end if
   end subroutine precondition

   !> Would `most` iterations at the mean rate of the first `k` not be enough? A few iterations say
   !> nothing yet.
   pure function is_hopeless(residual, k, most, tolerance) result(answer)
      real(wp), intent(in) :: residual, tolerance
      integer, intent(in) :: k, most
      logical :: answer

      answer = k >= telling_iterations &
         .and. residual**(real(most, wp)/real(k, wp)) > tolerance
   end function is_hopeless

   !> Make the last vector orthogonal to the others and of unit length (modified Gram-Schmidt).
   pure subroutine orthogonalise(basis, column)
      real(wp), intent(inout) :: basis(:, :)
      real(wp), intent(out) :: column(:)
      integer :: j, last

      last = size(basis, 2)
      do j = 1, last - 1
         column(j) = dot_product(basis(:, j), basis(:, last))
         basis(:, last) = basis(:, last) - column(j)*basis(:, j)
      end do
      column(last) = norm2(basis(:, last))
      if (column(last) > 0.0_wp) basis(:, last) = basis(:, last)/column(last)
   end subroutine orthogonalise

   !> Bring a column of the Hessenberg matrix to triangular form by Givens rotations.
   pure subroutine rotate(column, rotation, right)
      real(wp), intent(inout) :: column(:), rotation(:, :), right(2)
      real(wp) :: length
      integer :: j, last

      last = size(rotation, 2)
      do j = 1, last - 1
         column(j:j + 1) = turned(rotation(:, j), column(j:j + 1))
      end do
      length = norm2(column(last:last + 1))
      rotation(:, last) = [1.0_wp, 0.0_wp]
      if (length > 0.0_wp) rotation(:, last) = column(last:last + 1)/length
      column(last:last + 1) = [length, 0.0_wp]
      right = turned(rotation(:, last), right)
   end subroutine rotate

   !> A pair turned by cosine and sine.
   pure function turned(rotation, pair)
      real(wp), intent(in) :: rotation(2), pair(2)
      real(wp) :: turned(2)

      turned(1) = rotation(1)*pair(1) + rotation(2)*pair(2)
      turned(2) = -rotation(2)*pair(1) + rotation(1)*pair(2)
   end function turned

   !> Back substitution.
   pure subroutine solve_triangle(matrix, right, x)
      real(wp), intent(in) :: matrix(:, :), right(:)
      real(wp), intent(out) :: x(:)
      integer :: i, n

      n = size(right)
      do i = n, 1, -1
         x(i) = (right(i) - dot_product(matrix(i, i + 1:), x(i + 1:)))/matrix(i, i)
      end do
   end subroutine solve_triangle

end module coulter_algebra_gmres
