!> One load step, or a part of one: locate, number, solve, accept.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step
   use coulter_assembly, only: apply_dead_loads, assemble
   use coulter_assembly_surface_forces, only: check_sliding
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_model_observer, only: phase_accept, step_report_type
   use coulter_newton, only: newton_type, solve_newton
   use coulter_newton_guess, only: forget_motion, remember_motion
   use coulter_retile, only: retile_if_distorted
   use coulter_retile_leads, only: note_motions
   use coulter_retile_meetings, only: find_meetings
   use coulter_retile_report, only: report_changes, report_new_tiles
   use coulter_setup_prepare, only: prepare_step, prepare_system
   use coulter_step_accept, only: accept_step
   use coulter_step_passage, only: check_passage
   use coulter_step_report, only: report_step
   use coulter_step_settle, only: is_settling
   use coulter_system, only: system_type
   implicit none(type, external)
   private
   public :: advance_step, prepare_system

contains

   !> Take the model from `model%time` to `end_time`. On failure the model is as it was.
   subroutine advance_step(model, system, end_time, report, failure)
      !> Scene; moves on if the step succeeds.
      type(model_type), intent(inout) :: model
      !> Workspace, kept from step to step.
      type(system_type), intent(inout) :: system
      !> Time to reach.
      real(wp), intent(in) :: end_time
      !> What happened in a step that succeeded.
      type(step_report_type), intent(out) :: report
      !> Why the step failed; unallocated when it succeeded.
      character(len=:), allocatable, intent(out) :: failure
      type(newton_type) :: newton
      integer :: failed_point

      call system%forget_verdict()
      system%start_time = model%time
      system%end_time = end_time
      call prepare_step(model, system, failure)
      if (allocated(failure)) return
      call apply_dead_loads(system, model)
      call solve_newton(newton, system, model)
      call forget_motion(system)
      if (allocated(newton%failure)) then
         call move_alloc(newton%failure, failure)
         return
      end if
      ! Newton's method leaves out the last tangent where it can
      if (model%control%has_condition) call assemble(system, model, failed_point)
      call system%watch%start(phase_accept)
      if (allocated(model%tiling)) call check_passage(model, system, failure)
      ! a step in which a tip has gone too far tells what soil did, others that are refused do not
      if (allocated(system%cuts) .and. (system%must_recut .or. .not. allocated(failure))) then
         call note_motions(system, model)
      end if
      if (allocated(model%tiling)) call find_meetings(system, model, failure)
      if (allocated(system%surfaces)) call check_sliding(system, model, failure)
      if (.not. allocated(failure)) call accept_step(model, system, failure)
      if (.not. allocated(failure)) then
         if (allocated(model%tiling) .and. .not. is_settling(system)) then
            call remember_motion(system, newton%residuals)
         end if
         call report_step(report, model, system, newton)
         call report_changes(report, system)
         if (allocated(model%tiling)) call retile_if_distorted(model, system, report)
         if (report%has_retiled) call report_new_tiles(report, model, system)
      end if
      call system%watch%stop()
   end subroutine advance_step

end module coulter_step
