!> GMRES for matrices that are nearly symmetric: preconditioned by the factor of their symmetric
!> part (Saad, Y. and Schultz, M. H. (1986), SIAM J. Sci. Stat. Comput. 7, 856-869).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_gmres
   use, intrinsic :: iso_c_binding, only: c_ptr
   use coulter_algebra_cholesky, only: cholesky_solve
   use coulter_algebra_sparse, only: multiply, pattern_type
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: solve_gmres

   !> Most iterations; a preconditioner that needs more is not worth it.
   integer, parameter :: most_iterations = 30

contains

   !> Solve A x = b with left preconditioning: the residual that is measured is close to the error
   !> of x, whatever penalties weigh in A.
   subroutine solve_gmres(factor, pattern, values, b, tolerance, x, has_failed)
      !> Factor of the symmetric part of A.
      type(c_ptr), intent(in) :: factor
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
      !> Did the iteration not converge?
      logical, intent(out) :: has_failed
      real(wp) :: basis(size(b), most_iterations + 1), direction(size(b))
      real(wp) :: hessenberg(most_iterations + 1, most_iterations), rotation(2, most_iterations)
      real(wp) :: right(most_iterations + 1), share(most_iterations), start
      integer :: k

      x = 0.0_wp
      has_failed = cholesky_solve(factor, b, basis(:, 1)) /= 0
      if (has_failed) return
      right = 0.0_wp
      right(1) = norm2(basis(:, 1))
      start = right(1)
      if (.not. start > 0.0_wp) return
      basis(:, 1) = basis(:, 1)/start
      do k = 1, most_iterations
         call multiply(pattern, values, basis(:, k), direction)
         has_failed = cholesky_solve(factor, direction, basis(:, k + 1)) /= 0
         if (has_failed) return
         call orthogonalise(basis(:, :k + 1), hessenberg(:k + 1, k))
         call rotate(hessenberg(:k + 1, k), rotation(:, :k), right(k:k + 1))
         if (abs(right(k + 1)) <= tolerance*start) exit
      end do
      has_failed = k > most_iterations
      if (has_failed) return
      call solve_triangle(hessenberg(:k, :k), right(:k), share(:k))
      x = matmul(basis(:, :k), share(:k))
   end subroutine solve_gmres

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
