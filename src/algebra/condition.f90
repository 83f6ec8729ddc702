!> Condition number of a sparse matrix after scaling, for those who want to judge a scheme: it costs
!> two factorisations and a few solutions.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_condition
   use coulter_algebra_lu, only: lu_type
   use coulter_algebra_sparse, only: find_mirror, multiply, pattern_type
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: scaled_condition

   !> Rounds of the estimator; it seldom needs more than two.
   integer, parameter :: most_rounds = 5

contains

   !> Lower bound, seldom below a third, of |B| |B^-1| in the 1-norm, where B = D A D with
   !> D_i = |A_ii|^(-1/2): what units and penalties add to the condition of A is left out. Infinite,
   !> as `huge`, where A is singular or has zeros on its diagonal. (Higham, N. J. (1988), ACM Trans.
   !> Math. Softw. 14, 381-396, algorithm 4.1.)
   function scaled_condition(pattern, values) result(condition)
      !> Pattern of the matrix, symmetric.
      type(pattern_type), intent(in) :: pattern
      !> Its values, shape (n_entries).
      real(wp), intent(in) :: values(:)
      real(wp) :: condition
      type(lu_type) :: factors(2)
      real(wp), allocatable :: scaled(:, :)
      real(wp) :: column_sums(pattern%n)
      integer, allocatable :: mirror(:)
      logical :: has_failed

      condition = huge(condition)
      call find_mirror(pattern, mirror)
      allocate (scaled(pattern%n_entries, 2))
      call scale_by_diagonal(pattern, values, scaled(:, 1), has_failed)
      if (has_failed) return
      scaled(:, 2) = scaled(mirror, 1)
      call factorise_both(factors, pattern, scaled, has_failed)
      if (.not. has_failed) then
         call multiply(pattern, abs(scaled(:, 2)), spread(1.0_wp, 1, pattern%n), column_sums)
         condition = norm_of_inverse(factors, pattern, scaled)
         if (condition < huge(condition)) condition = condition*maxval(column_sums)
      end if
      call factors(1)%release()
      call factors(2)%release()
   end function scaled_condition

   !> D A D with the inverse roots of the diagonal in D.
   pure subroutine scale_by_diagonal(pattern, values, scaled, has_failed)
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: values(:)
      real(wp), intent(out) :: scaled(:)
      logical, intent(out) :: has_failed
      real(wp) :: root(pattern%n)
      integer :: column, k

      root = 0.0_wp
      do column = 1, pattern%n
         do k = pattern%column_start(column) + 1, pattern%column_start(column + 1)
            if (pattern%row(k) + 1 == column) root(column) = sqrt(abs(values(k)))
         end do
      end do
      has_failed = .not. all(root > 0.0_wp)
      scaled = 0.0_wp
      if (has_failed) return
      do column = 1, pattern%n
         do k = pattern%column_start(column) + 1, pattern%column_start(column + 1)
            scaled(k) = values(k)/(root(column)*root(pattern%row(k) + 1))
         end do
      end do
   end subroutine scale_by_diagonal

   !> Factorise a matrix and its transpose, which have the same pattern.
   subroutine factorise_both(factors, pattern, scaled, has_failed)
      type(lu_type), intent(inout) :: factors(2)
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: scaled(:, :)
      logical, intent(out) :: has_failed
      integer :: i, any_order(0)

      do i = 1, 2
         call factors(i)%analyse(pattern, any_order, has_failed)
         if (.not. has_failed) call factors(i)%factorise(pattern, scaled(:, i), has_failed)
         if (has_failed) return
      end do
   end subroutine factorise_both

   !> Estimate of the 1-norm of the inverse; infinite where a solution cannot be trusted.
   function norm_of_inverse(factors, pattern, scaled) result(norm)
      type(lu_type), intent(inout) :: factors(2)
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: scaled(:, :)
      real(wp) :: norm
      real(wp) :: x(pattern%n), y(pattern%n), z(pattern%n)
      logical :: has_failed(2)
      integer :: round, i

      norm = 0.0_wp
      x = 1.0_wp/real(pattern%n, wp)
      do round = 1, most_rounds
         call factors(1)%solve(pattern, scaled(:, 1), x, y, has_failed(1))
         call factors(2)%solve(pattern, scaled(:, 2), sign(1.0_wp, y), z, has_failed(2))
         if (any(has_failed)) exit
         if (sum(abs(y)) <= norm) exit
         norm = sum(abs(y))
         i = maxloc(abs(z), dim=1)
         if (abs(z(i)) <= dot_product(z, x)) exit
         x = 0.0_wp
         x(i) = 1.0_wp
      end do
      if (.not. any(has_failed)) then
         ! a vector that guards against matrices made to deceive
         x = [((-1.0_wp)**i*(1.0_wp + real(i - 1, wp)/real(max(pattern%n - 1, 1), wp)), &
               i=1, pattern%n)]
         call factors(1)%solve(pattern, scaled(:, 1), x, y, has_failed(1))
         norm = max(norm, 2.0_wp*sum(abs(y))/real(3*pattern%n, wp))
      end if
      if (any(has_failed)) norm = huge(norm)
   end function norm_of_inverse

end module coulter_algebra_condition
