!> Linear systems with a border: the unknowns of the nodes and the free components of tools.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_newton_border_solve
   use coulter_base_kinds, only: wp
   use coulter_system, only: system_type
   use coulter_system_dofs, only: dofs_type, reduce
   implicit none(type, external)
   private
   public :: solve_bordered

   !> Pivots below this share of the tangents of the stations vanish.
   real(wp), parameter :: smallest_pivot = epsilon(1.0_wp)
   !> Loads below this share of the largest are round-off.
   real(wp), parameter :: negligible = 1.0e-9_wp

contains

   !> Solve tangent times correction = - unbalanced, border included, by elimination of the nodes:
   !> the nodes move with every free motion, and the rest is a small dense system.
   subroutine solve_bordered(system, unbalanced, error, correction, has_failed)
      !> System whose solver has factorised the tangent of the nodes, with its border summed up,
      !> which gets `unheld`.
      type(system_type), intent(inout) :: system
      !> Unbalanced force, free components last, shape (n_dofs + n).
      real(wp), intent(in) :: unbalanced(:)
      !> Relative error that the correction may have.
      real(wp), intent(in) :: error
      !> Correction, shape as the force.
      real(wp), intent(inout) :: correction(:)
      !> Has the solver failed, or is a free tool held by nothing?
      logical, intent(out) :: has_failed
      real(wp), dimension(system%dofs%n_dofs, system%border%n) :: follows, row
      real(wp) :: schur(system%border%n, system%border%n), right(system%border%n)
      real(wp) :: column(system%dofs%n_dofs)
      integer :: j, n, unheld

      n = system%dofs%n_dofs
      associate (border => system%border, solver => system%solver)
         border%unheld = 0
         call solver%solve(system%pattern, system%values, -unbalanced(:n), correction(:n), &
                           has_failed, error)
         if (has_failed .or. border%n == 0) return
         do j = 1, border%n
            call reduce_copy(system%dofs, border%column(:, :, j), column)
            call reduce_copy(system%dofs, border%row(:, :, j), row(:, j))
            follows(:, j) = 0.0_wp
            call solver%solve(system%pattern, system%values, -column, follows(:, j), has_failed, &
                              error)
            if (has_failed) return
         end do
         schur = border%block + matmul(transpose(row), follows)
         right = -unbalanced(n + 1:) - matmul(transpose(row), correction(:n))
         call solve_small(schur, right, [maxval(abs(border%block)), maxval(abs(border%load))], &
                          unheld)
         has_failed = unheld > 0
         if (has_failed) border%unheld = border%boundary(unheld)
      end associate
      if (has_failed) return
      correction(:n) = correction(:n) + matmul(follows, right)
      correction(n + 1:) = right
   end subroutine solve_bordered

   !> `reduce` on a copy.
   pure subroutine reduce_copy(dofs, nodal, reduced)
      type(dofs_type), intent(in) :: dofs
      real(wp), intent(in) :: nodal(:, :)
      real(wp), intent(out) :: reduced(:)
      real(wp) :: copy(size(nodal, 1), size(nodal, 2))

      copy = nodal
      call reduce(dofs, copy, reduced)
   end subroutine reduce_copy

   !> Gaussian elimination with pivots. Where one vanishes, the component stays as it is if nothing
   !> pulls at it; else `singular` says which it is.
   pure subroutine solve_small(matrix, right, scale, singular)
      real(wp), intent(inout) :: matrix(:, :), right(:)
      !> Sizes of entries of the matrix and of loads.
      real(wp), intent(in) :: scale(2)
      !> First component that nothing holds, or 0.
      integer, intent(out) :: singular
      real(wp) :: share
      integer :: i, k, n, pivot

      n = size(right)
      singular = 0
      do k = 1, n
         pivot = k - 1 + maxloc(abs(matrix(k:, k)), dim=1)
         if (.not. abs(matrix(pivot, k)) > smallest_pivot*scale(1)) then
            singular = merge(0, k, abs(right(k)) <= negligible*scale(2))
            if (singular > 0) return
            pivot = k
            matrix(k, :) = 0.0_wp
            matrix(k, k) = 1.0_wp
            right(k) = 0.0_wp
         end if
         matrix([k, pivot], :) = matrix([pivot, k], :)
         right([k, pivot]) = right([pivot, k])
         do i = k + 1, n
            share = matrix(i, k)/matrix(k, k)
            matrix(i, :) = matrix(i, :) - share*matrix(k, :)
            right(i) = right(i) - share*right(k)
         end do
      end do
      do k = n, 1, -1
         right(k) = (right(k) - dot_product(matrix(k, k + 1:), right(k + 1:)))/matrix(k, k)
      end do
   end subroutine solve_small

end module coulter_newton_border_solve
