!> A first guess for steps in which material flows: it goes on flowing as in the last step.
!>
!> From rest, Newton's first tangent is elastic and far from the mechanism of a body at its limit
!> load; the field of the grid hardly changes from step to step, even when tiles are made anew.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_extrapolation
   use coulter_base_kinds, only: wp
   use coulter_boundary_motion, only: motion_type
   use coulter_model, only: boundary_motion, model_type
   use coulter_step_system, only: flow_type, system_type
   implicit none(type, external)
   private
   public :: remember_flow, extrapolate_flow

   !> Relative change of the rates of boundaries from which on they count as moving otherwise.
   real(wp), parameter :: steady = 1.0e-6_wp

contains

   !> Keep the increments of a step in which any point flowed.
   pure subroutine remember_flow(system, model)
      !> System in equilibrium.
      type(system_type), intent(inout) :: system
      !> Scene at the end of the step.
      type(model_type), intent(in) :: model
      logical :: is_flowing

      is_flowing = allocated(model%points%has_flowed) .and. system%border%n == 0
      if (is_flowing) is_flowing = any(model%points%has_flowed)
      if (allocated(system%flow)) deallocate (system%flow)
      if (.not. is_flowing) return
      allocate (system%flow)
      system%flow%node_index = system%cells%node_index
      system%flow%velocity = system%increment/(system%end_time - system%start_time)
      system%flow%boundary_rate = boundary_rates(system, model)
   end subroutine remember_flow

   !> Increments that follow from the flow of the last step, 0 at new nodes; none if there was no
   !> flow or boundaries move otherwise now.
   pure subroutine extrapolate_flow(system, model, unknowns, has_extrapolated)
      !> System of the step, numbered.
      type(system_type), intent(in) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Displacement increments, shape (n_dofs).
      real(wp), intent(inout) :: unknowns(:)
      !> Have they been set?
      logical, intent(out) :: has_extrapolated
      integer, allocatable :: node_at(:, :)
      integer :: lower(2), n(2), node, i

      has_extrapolated = allocated(system%flow)
      if (.not. has_extrapolated) return
      associate (flow => system%flow, index => system%cells%node_index)
         has_extrapolated = maxval(abs(boundary_rates(system, model) - flow%boundary_rate)) &
            <= steady*maxval(abs(flow%boundary_rate))
         if (.not. has_extrapolated) return
         lower = minval(flow%node_index, dim=2)
         n = maxval(flow%node_index, dim=2) - lower + 1
         allocate (node_at(n(1), n(2)), source=0)
         do node = 1, size(flow%node_index, 2)
            associate (at => flow%node_index(:, node) - lower + 1)
               node_at(at(1), at(2)) = node
            end associate
         end do
         do node = 1, system%cells%n_nodes
            associate (at => index(:, node) - lower + 1)
               if (any(at < 1) .or. any(at > n)) cycle
               if (node_at(at(1), at(2)) == 0) cycle
               do i = 1, 2
                  if (system%dofs%dof(i, node) > 0) unknowns(system%dofs%dof(i, node)) = &
                     (system%end_time - system%start_time)*flow%velocity(i, node_at(at(1), at(2)))
               end do
            end associate
         end do
      end associate
   end subroutine extrapolate_flow

   !> Translation and rotation of all boundaries over the time of the step, shape (3, n_boundaries).
   pure function boundary_rates(system, model) result(rate)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      real(wp) :: rate(3, size(model%boundaries))
      type(motion_type) :: motion
      integer :: b

      do b = 1, size(model%boundaries)
         motion = boundary_motion(model, b, system%start_time, system%end_time)
         rate(:, b) = [motion%translation, motion%rotation]/(system%end_time - system%start_time)
      end do
   end function boundary_rates

end module coulter_step_extrapolation
