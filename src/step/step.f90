!> One load step, or a part of one: locate, number, solve, accept.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_model, only: model_type
   use coulter_model_observer, only: phase_accept, phase_locate, phase_number, step_report_type
   use coulter_step_accept, only: accept_step
   use coulter_step_assembly, only: apply_dead_loads, assemble
   use coulter_step_meetings, only: find_meetings
   use coulter_step_guess, only: forget_motion, remember_motion
   use coulter_step_newton, only: newton_type, solve_newton
   use coulter_step_passage, only: check_passage
   use coulter_step_report, only: report_step
   use coulter_step_retile, only: retile_if_distorted
   use coulter_step_point_setup, only: find_participants, number_system
   use coulter_step_settle, only: is_settling
   use coulter_step_sites, only: place_sites
   use coulter_step_surface_forces, only: check_sliding
   use coulter_step_system, only: system_type
   use coulter_step_tile_setup, only: find_contacts, find_tile_participants, number_tile_system, &
      set_border
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
      if (system%is_set_up) then
         system%has_reused_pattern = .true.
      else
         call set_up(model, system, failure)
         if (allocated(failure)) return
      end if
      call meet_boundaries(model, system)
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
      if (allocated(model%tiling)) call find_meetings(system, model, failure)
      if (allocated(system%surfaces)) call check_sliding(system, model, failure)
      if (.not. allocated(failure)) call accept_step(model, system, failure)
      if (.not. allocated(failure)) then
         if (allocated(model%tiling) .and. .not. is_settling(system)) then
            call remember_motion(system, newton%residuals)
         end if
         call report_step(report, model, system, newton)
         if (allocated(model%tiling)) call retile_if_distorted(model, system, report)
      end if
      call system%watch%stop()
   end subroutine advance_step

   !> Who takes part, and which are the unknowns.
   subroutine prepare_system(model, system, failure)
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> System to set up.
      type(system_type), intent(inout) :: system
      !> Why it cannot be set up; unallocated when it is.
      character(len=:), allocatable, intent(out) :: failure

      call set_up(model, system, failure)
      if (.not. allocated(failure)) call meet_boundaries(model, system)
   end subroutine prepare_system

   !> What depends on the state of the scene alone: it serves until that changes.
   subroutine set_up(model, system, failure)
      type(model_type), intent(in) :: model
      type(system_type), intent(inout) :: system
      character(len=:), allocatable, intent(out) :: failure
      integer :: first_outside
      logical :: has_failed

      call system%watch%start(phase_locate)
      if (allocated(model%tiling)) then
         call find_tile_participants(system, model, first_outside)
      else
         call find_participants(system, model, first_outside)
      end if
      call system%watch%stop()
      if (first_outside > 0) then
         failure = trim(merge("corner", "point ", allocated(model%tiling)))//" " &
            //to_text(first_outside)//" is outside the grid"
         return
      end if
      call system%watch%start(phase_number)
      system%solver%is_lu_only = model%control%is_lu_only
      if (allocated(model%tiling)) then
         call number_tile_system(system, model, has_failed)
      else
         call number_system(system, model, has_failed)
      end if
      call system%watch%stop()
      if (has_failed) failure = "the sparsity pattern cannot be analysed (out of memory?)"
      system%is_set_up = .not. has_failed
   end subroutine set_up

   !> What depends on the step as well: phases of laws, the way that boundaries go. Stations of
   !> points do not.
   subroutine meet_boundaries(model, system)
      type(model_type), intent(in) :: model
      type(system_type), intent(inout) :: system

      call system%watch%start(phase_locate)
      call place_sites(system, model)
      if (allocated(model%tiling)) then
         call find_contacts(system, model)
         call set_border(system, model)
      end if
      call system%watch%stop()
   end subroutine meet_boundaries

end module coulter_step
