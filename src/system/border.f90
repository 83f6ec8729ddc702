!> Free components of tools: a few unknowns that border the system of the bodies.
!>
!> A free tool moves so that its contacts carry the load on it. Moving the tool is moving its
!> stations the other way; turning it also turns the forces of its stations. So all derivatives are
!> sums over the forces and tangents of the stations (theory, section 4).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_border
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_motion, only: crosswise, motion_type, turn_matrix
   implicit none(type, external)
   private
   public :: border_type, tool_load_type, new_border, clear_border, add_station, set_motion, &
      free_motions, load_on, mode_at, direction_of_turning

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
      !> Drag on each while bodies settle, force per motion, shape (n).
      real(wp), allocatable :: drag(:)
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
      allocate (border%load(border%n), border%unbalanced(border%n), border%drag(border%n), &
                source=0.0_wp)
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

   !> Free motions as unknowns: the inverse of `set_motion`.
   pure function free_motions(border) result(unknowns)
      !> Border of a step.
      type(border_type), intent(in) :: border
      !> Motions, length units.
      real(wp) :: unknowns(border%n)
      integer :: j

      do j = 1, border%n
         associate (motion => border%motion(border%boundary(j)))
            if (border%direction(j) == direction_of_turning) then
               unknowns(j) = motion%rotation*border%reach(j)
            else
               unknowns(j) = motion%translation(border%direction(j))
            end if
         end associate
      end do
   end function free_motions

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
         border%block(j, j) = border%block(j, j) - border%drag(j)
      end do
      border%unbalanced = border%load - border%drag*free_motions(border)
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
      real(wp) :: mode(8), matrix(8, 8), by_motion(8), row(8), turned(8)
      integer :: j, v

      matrix = reshape(stiffness, [8, 8])
      do j = 1, border%n
         if (border%boundary(j) /= boundary) cycle
         mode = reshape([(mode_at(border, j, position(:, v)), v=1, 4)], [8])
         turned = 0.0_wp
         if (border%direction(j) == direction_of_turning) turned = &
            reshape([(crosswise(force(:, v)), v=1, 4)], [8])/border%reach(j)
         border%unbalanced(j) = border%unbalanced(j) + dot_product(mode, reshape(force, [8]))
         by_motion = turned - matmul(matrix, mode)
         row = matmul(mode, matrix) - turned
         do v = 1, 4
            associate (at => corner(v), i => [2*v - 1, 2*v])
               border%corner_column(:, at, j) = border%corner_column(:, at, j) + by_motion(i)
               border%corner_row(:, at, j) = border%corner_row(:, at, j) + row(i)
            end associate
         end do
         call add_to_block(border, j, position, force, reshape(by_motion, [2, 4]))
      end do
   end subroutine add_station

   !> How the balance of a tool changes with one of its own components.
   pure subroutine add_to_block(border, j, position, force, by_motion)
      type(border_type), intent(inout) :: border
      !> The component.
      integer, intent(in) :: j
      real(wp), intent(in) :: position(2, 4), force(2, 4)
      !> Derivative of the force by the component.
      real(wp), intent(in) :: by_motion(2, 4)
      real(wp) :: slope
      integer :: i, v

      do i = 1, border%n
         if (border%boundary(i) /= border%boundary(j)) cycle
         slope = sum([(dot_product(mode_at(border, i, position(:, v)), by_motion(:, v)), v=1, 4)])
         if (border%direction(i) == direction_of_turning &
             .and. border%direction(j) /= direction_of_turning) then
            ! the pivot moves with the tool
            slope = slope + sum([(dot_product(mode_at(border, j, position(:, v)), &
                                              crosswise(force(:, v))), v=1, 4)])/border%reach(i)
         end if
         border%block(i, j) = border%block(i, j) + slope
      end do
   end subroutine add_to_block

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

end module coulter_system_border
