!> Free components of tools: a few unknowns that border the system of the bodies.
!>
!> A free tool moves so that its contacts carry the load on it. Moving the tool is moving its
!> stations the other way, so that all derivatives are sums over the tangents of the stations.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_border
   use coulter_algebra_solver, only: solver_type
   use coulter_algebra_sparse, only: pattern_type
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_step_dofs, only: dofs_type, reduce
   implicit none(type, external)
   private
   public :: border_type, new_border, clear_border, add_station, set_motion, solve_bordered

   !> The free components of all tools, their balance and its derivatives.
   type :: border_type
      !> Number of free components.
      integer :: n = 0
      !> Boundary of each and its direction, 1 or 2, shape (n).
      integer, allocatable :: boundary(:), direction(:)
      !> Load on the tool, and load with the force of the contacts, force units, shape (n).
      real(wp), allocatable :: load(:), unbalanced(:)
      !> Derivatives of the nodal forces by the free motions, and of the balance by the nodes, shape
      !> (2, n_nodes, n).
      real(wp), allocatable :: column(:, :, :), row(:, :, :)
      !> The same on corners, shape (2, n_corners, n).
      real(wp), allocatable :: corner_column(:, :, :), corner_row(:, :, :)
      !> Derivatives of the balance by the free motions, shape (n, n).
      real(wp), allocatable :: block(:, :)
      !> Free motion of every boundary in the step, length units, shape (2, n_boundaries).
      real(wp), allocatable :: motion(:, :)
   end type border_type

contains

   !> List the free components; without any there is only the motion, which stays 0.
   pure subroutine new_border(border, boundaries, n_nodes, n_corners)
      !> Border to make.
      type(border_type), intent(inout) :: border
      !> Walls and tools.
      type(boundary_type), intent(in) :: boundaries(:)
      !> Nodes and corners of the step.
      integer, intent(in) :: n_nodes, n_corners
      integer :: b, i

      border = border_type()
      allocate (border%motion(2, size(boundaries)), source=0.0_wp)
      allocate (border%boundary(0), border%direction(0))
      do b = 1, size(boundaries)
         do i = 1, 2
            if (.not. (boundaries(b)%is_free(i) .and. boundaries(b)%is_active)) cycle
            border%boundary = [border%boundary, b]
            border%direction = [border%direction, i]
         end do
      end do
      border%n = size(border%boundary)
      allocate (border%load(border%n), border%unbalanced(border%n), source=0.0_wp)
      if (border%n == 0) return
      allocate (border%column(2, n_nodes, border%n), border%row(2, n_nodes, border%n))
      allocate (border%corner_column(2, n_corners, border%n))
      allocate (border%corner_row(2, n_corners, border%n), border%block(border%n, border%n))
   end subroutine new_border

   !> Begin a new sum over the stations.
   pure subroutine clear_border(border)
      !> Border with loads.
      type(border_type), intent(inout) :: border

      border%unbalanced = border%load
      if (border%n == 0) return
      border%column = 0.0_wp
      border%row = 0.0_wp
      border%corner_column = 0.0_wp
      border%corner_row = 0.0_wp
      border%block = 0.0_wp
   end subroutine clear_border

   !> Add a station of a boundary.
   pure subroutine add_station(border, boundary, corner, force, stiffness)
      !> Border to sum up.
      type(border_type), intent(inout) :: border
      !> Number of the boundary.
      integer, intent(in) :: boundary
      !> Corners of the tile.
      integer, intent(in) :: corner(4)
      !> Force of the station on the vertices as it stands in the residual, and its tangent, shape
      !> (component, vertex, component, vertex).
      real(wp), intent(in) :: force(2, 4), stiffness(2, 4, 2, 4)
      integer :: i, j, v

      do j = 1, border%n
         if (border%boundary(j) /= boundary) cycle
         associate (d => border%direction(j))
            border%unbalanced(j) = border%unbalanced(j) + sum(force(d, :))
            do v = 1, 4
               associate (column => border%corner_column(:, corner(v), j), &
                          row => border%corner_row(:, corner(v), j))
                  column = column - sum(stiffness(:, v, d, :), dim=2)
                  row = row + sum(stiffness(d, :, :, v), dim=1)
               end associate
            end do
            do i = 1, border%n
               if (border%boundary(i) /= boundary) cycle
               border%block(i, j) = border%block(i, j) &
                  - sum(stiffness(border%direction(i), :, d, :))
            end do
         end associate
      end do
   end subroutine add_station

   !> Free motions from the unknowns behind those of the nodes.
   pure subroutine set_motion(border, unknowns)
      !> Border; gets `motion`.
      type(border_type), intent(inout) :: border
      !> Free motions, length units, shape (n).
      real(wp), intent(in) :: unknowns(:)
      integer :: j

      do j = 1, border%n
         border%motion(border%direction(j), border%boundary(j)) = unknowns(j)
      end do
   end subroutine set_motion

   !> Solve tangent times correction = - unbalanced, border included, by elimination of the nodes:
   !> the nodes move with every free motion, and the rest is a small dense system.
   subroutine solve_bordered(border, solver, pattern, values, dofs, unbalanced, correction, &
                             has_failed, error)
      !> Border, summed up.
      type(border_type), intent(in) :: border
      !> Solver that has factorised the tangent of the nodes.
      type(solver_type), intent(inout) :: solver
      !> That tangent.
      type(pattern_type), intent(in) :: pattern
      real(wp), intent(in) :: values(:)
      !> Numbering of the unknowns.
      type(dofs_type), intent(in) :: dofs
      !> Unbalanced force, free components last, shape (n_dofs + n).
      real(wp), intent(in) :: unbalanced(:)
      !> Correction, shape as this.
      real(wp), intent(inout) :: correction(:)
      !> Has the solver failed, or is a free tool held by nothing?
      logical, intent(out) :: has_failed
      !> Relative error that the correction may have.
      real(wp), intent(in) :: error
      real(wp) :: follows(dofs%n_dofs, border%n), row(dofs%n_dofs, border%n)
      real(wp) :: schur(border%n, border%n), right(border%n), column(dofs%n_dofs)
      integer :: j, n

      n = dofs%n_dofs
      call solver%solve(pattern, values, -unbalanced(:n), correction(:n), has_failed, error)
      if (has_failed .or. border%n == 0) return
      do j = 1, border%n
         call reduce_copy(dofs, border%column(:, :, j), column)
         call reduce_copy(dofs, border%row(:, :, j), row(:, j))
         follows(:, j) = 0.0_wp
         call solver%solve(pattern, values, -column, follows(:, j), has_failed, error)
         if (has_failed) return
      end do
      schur = border%block + matmul(transpose(row), follows)
      right = -unbalanced(n + 1:) - matmul(transpose(row), correction(:n))
      call solve_small(schur, right, maxval(abs(border%block)), has_failed)
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

   !> Gaussian elimination with pivots; singular where one vanishes against the scale.
   pure subroutine solve_small(matrix, right, scale, is_singular)
      real(wp), intent(inout) :: matrix(:, :), right(:)
      real(wp), intent(in) :: scale
      logical, intent(out) :: is_singular
      real(wp) :: share
      integer :: i, k, n, pivot

      n = size(right)
      is_singular = .false.
      do k = 1, n
         pivot = k - 1 + maxloc(abs(matrix(k:, k)), dim=1)
         is_singular = .not. abs(matrix(pivot, k)) > epsilon(1.0_wp)*scale
         if (is_singular) return
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

end module coulter_step_border
