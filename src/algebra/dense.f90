!> Small dense systems, through LAPACK.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_dense
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: solve_dense

   interface
      !> LAPACK: solve by LU factors with row exchanges; both matrices are overwritten.
      pure subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         implicit none (type, external)
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, n), b(ldb, nrhs)
         integer, intent(out) :: ipiv(n), info
      end subroutine dgesv
   end interface

contains

   !> Solve A x = b.
   pure subroutine solve_dense(matrix, right, solution, is_singular)
      !> Matrix A, shape (n, n).
      real(wp), intent(in) :: matrix(:, :)
      !> Right-hand side b, shape (n).
      real(wp), intent(in) :: right(:)
      !> Solution x, shape (n).
      real(wp), intent(out) :: solution(:)
      !> Is there none?
      logical, intent(out) :: is_singular
      real(wp) :: factors(size(right), size(right)), column(size(right), 1)
      integer :: exchanges(size(right)), status

      factors = matrix
      column(:, 1) = right
      call dgesv(size(right), 1, factors, size(right), exchanges, column, size(right), status)
      is_singular = status /= 0
      solution = column(:, 1)
   end subroutine solve_dense

end module coulter_algebra_dense
