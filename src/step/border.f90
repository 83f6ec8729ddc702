!> Free components of tools: a few unknowns that border the system of the bodies.
!>
!> A free tool moves so that its contacts carry the load on it. Moving the tool is moving its
!> stations the other way; turning it also turns the forces of its stations. So all derivatives are
!> sums over the forces and tangents of the stations (theory, section 4).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_border
   use coulter_algebra_solver, only: solver_type
   use coulter_algebra_sparse, only: pattern_type
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_motion, only: crosswise, motion_type, turn_matrix
   use coulter_step_dofs, only: dofs_type, reduce
   implicit none(type, external)
   private
   public :: border_type, tool_load_type, new_border, clear_border, add_station, set_motion, &
      solve_bordered, load_on, mode_at, direction_of_turning

   !> Pivots below this share of the tangents of the stations vanish.
   real(wp), parameter :: smallest_pivot = epsilon(1.0_wp)
   !> Loads below this share of the largest are round-off.
   real(wp), parameter :: negligible = 1.0e-9_wp

   !> Direction that stands for the rotation, after both translations.
   integer, parameter :: direction_of_turning = 3

   !> Load on a free tool at the end of the step.
   type :: tool_load_type
      !> Force per thickness, and moment beside it, counter-clockwise, force times length.
      real(wp) :: force(2) = 0.0_wp, moment = 0.0_wp
      !> Where the force acts, from the pivot, before the tool turns freely, length units.
      real(wp) :: lever(2) = 0.0_wp
   end type tool_load_type

   !> The free components of all tools, their balance and its derivatives.
   type :: border_type
      !> Number of free components.
      integer :: n = 0
      !> Boundary of each and its direction: 1, 2 or `direction_of_turning`, shape (n).
      integer, allocatable :: boundary(:), direction(:)
      !> Distance of the farthest vertex from the pivot, by which angles are multiplied and moments
      !> divided, so that all unknowns are lengths and all loads forces; 1 for translations; shape
      !> (n).
      real(wp), allocatable :: reach(:)
      !> What pulls at the tool of each, shape (n).
      type(tool_load_type), allocatable :: pull(:)
      !> Load on the tool, and load with the force of the contacts, force units, shape (n).
      real(wp), allocatable :: load(:), unbalanced(:)
      !> Derivatives of the nodal forces by the free motions, and of the balance by the nodes, shape
      !> (2, n_nodes, n).
      real(wp), allocatable :: column(:, :, :), row(:, :, :)
      !> The same on corners, shape (2, n_corners, n).
      real(wp), allocatable :: corner_column(:, :, :), corner_row(:, :, :)
      !> Derivatives of the balance by the free motions, shape (n, n).
      real(wp), allocatable :: block(:, :)
      !> Free motion of every boundary in the step, after the prescribed one and about the pivot as
      !> that leaves it, shape (n_boundaries).
      type(motion_type), allocatable :: motion(:)
      !> Boundary that nothing held in the last solution, 0 if there is none.
      integer :: unheld = 0
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
      allocate (border%motion(size(boundaries)))
      allocate (border%boundary(0), border%direction(0), border%reach(0))
      do b = 1, size(boundaries)
         do i = 1, direction_of_turning
            if (.not. (boundaries(b)%is_active .and. is_free(boundaries(b), i))) cycle
            border%boundary = [border%boundary, b]
            border%direction = [border%direction, i]
            border%reach = [border%reach, reach_of(boundaries(b), i)]
         end do
      end do
      border%n = size(border%boundary)
      allocate (border%load(border%n), border%unbalanced(border%n), source=0.0_wp)
      if (border%n == 0) return
      allocate (border%pull(border%n))
      allocate (border%column(2, n_nodes, border%n), border%row(2, n_nodes, border%n))
      allocate (border%corner_column(2, n_corners, border%n))
      allocate (border%corner_row(2, n_corners, border%n), border%block(border%n, border%n))
   end subroutine new_border

   !> Is a component free?
   pure function is_free(boundary, direction) result(answer)
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: direction
      logical :: answer

      answer = boundary%turns_freely
      if (direction /= direction_of_turning) answer = boundary%is_free(direction)
   end function is_free

   !> Length that goes with an angle.
   pure function reach_of(boundary, direction) result(reach)
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: direction
      real(wp) :: reach
      integer :: i

      reach = 1.0_wp
      if (direction /= direction_of_turning) return
      reach = maxval([(norm2(boundary%vertices(:, i) - boundary%centre), &
                       i=1, size(boundary%vertices, 2))])
   end function reach_of

   !> Begin a new sum over the stations: loads, and how they change as a tool turns.
   pure subroutine clear_border(border)
      !> Border with loads.
      type(border_type), intent(inout) :: border
      integer :: j

      if (border%n == 0) return
      border%column = 0.0_wp
      border%row = 0.0_wp
      border%corner_column = 0.0_wp
      border%corner_row = 0.0_wp
      border%block = 0.0_wp
      do j = 1, border%n
         border%load(j) = load_on(border, j)
         if (border%direction(j) == direction_of_turning) border%block(j, j) = &
            -dot_product(lever_of(border, j), border%pull(j)%force)/border%reach(j)**2
      end do
      border%unbalanced = border%load
   end subroutine clear_border

   !> Load on a free component, force units.
   pure function load_on(border, j) result(load)
      !> Border with motions.
      type(border_type), intent(in) :: border
      !> Number of the component.
      integer, intent(in) :: j
      real(wp) :: load

      associate (pull => border%pull(j), d => border%direction(j))
         if (d /= direction_of_turning) then
            load = pull%force(d)
         else
            load = (pull%moment + dot_product(crosswise(lever_of(border, j)), pull%force)) &
               /border%reach(j)
         end if
      end associate
   end function load_on

   !> Way from the pivot to where the load acts, as the tool stands.
   pure function lever_of(border, j) result(lever)
      type(border_type), intent(in) :: border
      integer, intent(in) :: j
      real(wp) :: lever(2)

      lever = matmul(turn_matrix(border%motion(border%boundary(j))%rotation), border%pull(j)%lever)
   end function lever_of

   !> Which way a place on a free tool goes, per length of the free component.
   pure function mode_at(border, j, position) result(mode)
      !> Border with motions.
      type(border_type), intent(in) :: border
      !> Number of the component.
      integer, intent(in) :: j
      !> The place, length units.
      real(wp), intent(in) :: position(2)
      real(wp) :: mode(2)

      mode = 0.0_wp
      if (border%direction(j) /= direction_of_turning) then
         mode(border%direction(j)) = 1.0_wp
      else
         associate (motion => border%motion(border%boundary(j)))
            mode = crosswise(position - motion%centre - motion%translation)/border%reach(j)
         end associate
      end if
   end function mode_at

   !> Add a station of a boundary. Forces and moments of a tool and its station do not change when
   !> both move together, which gives the derivatives by the motions of the tool.
   pure subroutine add_station(border, boundary, corner, position, force, stiffness)
      !> Border to sum up.
      type(border_type), intent(inout) :: border
      !> Number of the boundary.
      integer, intent(in) :: boundary
      !> Corners of the tile.
      integer, intent(in) :: corner(4)
      !> Where they are at the end of the step, length units.
      real(wp), intent(in) :: position(2, 4)
      !> Force of the station on the vertices as it stands in the residual, and its tangent, shape
      !> (component, vertex, component, vertex).
      real(wp), intent(in) :: force(2, 4), stiffness(2, 4, 2, 4)
      real(wp) :: mode(8, border%n), matrix(8, 8), by_motion(8), turned(8), row(8)
      integer :: i, j, v

      matrix = reshape(stiffness, [8, 8])
      turned = reshape([(crosswise(force(:, v)), v=1, 4)], [8])
      do j = 1, border%n
         mode(:, j) = reshape([(mode_at(border, j, position(:, v)), v=1, 4)], [8])
      end do
      do j = 1, border%n
         if (border%boundary(j) /= boundary) cycle
         border%unbalanced(j) = border%unbalanced(j) + dot_product(mode(:, j), reshape(force, [8]))
         by_motion = -matmul(matrix, mode(:, j))
         row = matmul(mode(:, j), matrix)
         if (border%direction(j) == direction_of_turning) then
            by_motion = by_motion + turned/border%reach(j)
            row = row - turned/border%reach(j)
         end if
         call add_at_corners(by_motion, border%corner_column(:, :, j))
         call add_at_corners(row, border%corner_row(:, :, j))
         do i = 1, border%n
            if (border%boundary(i) /= boundary) cycle
            associate (entry => border%block(i, j))
               entry = entry + dot_product(mode(:, i), by_motion)
               ! the pivot moves with the tool
               if (border%direction(i) == direction_of_turning &
                   .and. border%direction(j) /= direction_of_turning) &
                  entry = entry + dot_product(mode(:, j), turned)/border%reach(i)
            end associate
         end do
      end do

   contains

      !> Add what belongs to the vertices.
      pure subroutine add_at_corners(at_vertices, at_corners)
         real(wp), intent(in) :: at_vertices(8)
         real(wp), intent(inout) :: at_corners(:, :)
         integer :: k

         do k = 1, 4
            at_corners(:, corner(k)) = at_corners(:, corner(k)) + at_vertices(2*k - 1:2*k)
         end do
      end subroutine add_at_corners

   end subroutine add_station

   !> Free motions from the unknowns behind those of the nodes.
   pure subroutine set_motion(border, unknowns)
      !> Border; gets `motion`.
      type(border_type), intent(inout) :: border
      !> Free motions, length units, shape (n).
      real(wp), intent(in) :: unknowns(:)
      integer :: j

      do j = 1, border%n
         associate (motion => border%motion(border%boundary(j)), d => border%direction(j))
            if (d == direction_of_turning) then
               motion%rotation = unknowns(j)/border%reach(j)
            else
               motion%translation(d) = unknowns(j)
            end if
         end associate
      end do
   end subroutine set_motion

   !> Solve tangent times correction = - unbalanced, border included, by elimination of the nodes:
   !> the nodes move with every free motion, and the rest is a small dense system.
   subroutine solve_bordered(border, solver, pattern, values, dofs, unbalanced, correction, &
                             has_failed, error)
      !> Border, summed up; gets `unheld`.
      type(border_type), intent(inout) :: border
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
      integer :: j, n, unheld

      n = dofs%n_dofs
      border%unheld = 0
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
      call solve_small(schur, right, [maxval(abs(border%block)), maxval(abs(border%load))], unheld)
      has_failed = unheld > 0
      if (has_failed) border%unheld = border%boundary(unheld)
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

end module coulter_step_border
