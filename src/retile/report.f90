!> How far from equilibrium new tiles leave the bodies, and how forces on tools change with them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_report
   use coulter_assembly, only: apply_dead_loads
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_model_observer, only: step_report_type
   use coulter_newton_iterate, only: evaluate_again, measure, newton_type
   use coulter_setup_prepare, only: prepare_step
   use coulter_system, only: system_type
   use coulter_system_border, only: set_motion
   implicit none(type, external)
   private
   public :: report_new_tiles, report_changes

contains

   !> Balance before anything moves, with boundaries where they are: the price is one assembly
   !> without tangent, since the next step takes over what is set up for it. Forces are not worth
   !> much there: a corner that new tiles put onto a face has lost what it pressed with.
   subroutine report_new_tiles(report, model, system)
      !> Report of the step that has ended; gets `reset_residual`, unless new tiles cannot be set
      !> up: the next step then says so.
      type(step_report_type), intent(inout) :: report
      !> Scene with new tiles.
      type(model_type), intent(in) :: model
      !> Its system, of the step that has ended; keeps the forces.
      type(system_type), intent(inout) :: system
      type(newton_type) :: newton
      character(len=:), allocatable :: failure

      system%forces_before_reset = report%boundary_reactions
      system%start_time = system%end_time
      call prepare_step(model, system, failure)
      if (allocated(failure)) return
      call apply_dead_loads(system, model)
      allocate (newton%unbalanced(system%dofs%n_dofs + system%border%n), newton%norms(0))
      system%increment = 0.0_wp
      call set_motion(system%border, spread(0.0_wp, 1, system%border%n))
      system%needs_tangent = .false.
      call evaluate_again(newton, system, model)
      system%needs_tangent = .true.
      if (allocated(newton%failure)) return
      call measure(newton, system)
      report%reset_residual = newton%residuals(1)
   end subroutine report_new_tiles

   !> Changes of forces in the first step of new tiles. What the boundaries have done in it is part
   !> of them.
   pure subroutine report_changes(report, system)
      !> Report of a step; gets `reset_force_changes` if it was the first with its tiles.
      type(step_report_type), intent(inout) :: report
      !> Its system; forgets the forces before.
      type(system_type), intent(inout) :: system

      if (.not. allocated(system%forces_before_reset)) return
      report%reset_force_changes = report%boundary_reactions - system%forces_before_reset
      deallocate (system%forces_before_reset)
   end subroutine report_changes

end module coulter_retile_report
