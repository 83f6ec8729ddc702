!> The time loop: load steps, halved where they fail.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_run
   use coulter_assembly_loose_parts, only: text_of_parts
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_base_timer, only: new_stopwatch
   use coulter_model, only: model_type
   use coulter_model_observer, only: n_phases, observer_type, phase_output, scene_report_type, &
      step_report_type
   use coulter_retile, only: cut_ahead
   use coulter_setup_sites, only: open_sites, release_sites
   use coulter_step, only: advance_step, prepare_system
   use coulter_step_phases, only: begin_phase
   use coulter_step_report, only: report_scene
   use coulter_step_settle, only: begin_settling, is_settling, settle_again, settle_on
   use coulter_system, only: system_type
   use coulter_system_border, only: border_type, direction_of_turning
   implicit none(type, external)
   private
   public :: run_model, describe_scene

   !> A step in which tips get into tiles is repeated so often with other cuts before it is halved.
   integer, parameter :: most_recuts = 2

contains

   !> Run all load steps of a prepared model and tell the observer.
   subroutine run_model(model, observer, error)
      !> Prepared model at its start; on return as it was last accepted.
      type(model_type), intent(inout) :: model
      !> Who is told.
      class(observer_type), intent(inout) :: observer
      !> Set when a step fails for good or the observer gives up.
      type(error_type), allocatable, intent(out) :: error
      type(system_type) :: system
      type(scene_report_type) :: scene
      real(wp) :: reported(n_phases)
      integer :: step, phase

      allocate (system%verdict)
      call new_stopwatch(system%watch, n_phases)
      reported = 0.0_wp
      call open_sites(system, model, 1)
      call describe_system(model, system, scene, error)
      if (.not. allocated(error)) then
         call observer%start(model, scene, error)
         call cut_ahead(model, system, model%schedule%end_time(1))
         do step = 1, model%schedule%n_steps()
            if (allocated(error)) exit
            phase = model%schedule%phase_of(step)
            if (phase > model%schedule%phase_of(step - 1)) then
               call begin_phase(model, system, phase)
               call open_sites(system, model, phase)
            end if
            call run_load_step(model, system, step, reported, observer, error)
         end do
         call observer%finish(model, error, system%watch%seconds - reported)
      end if
      call system%solver%release()
      call release_sites(system)
      deallocate (system%verdict)
   end subroutine run_model

   !> Facts about a prepared model without running it.
   subroutine describe_scene(model, scene, error)
      !> Prepared model.
      type(model_type), intent(in) :: model
      !> Facts about it.
      type(scene_report_type), intent(out) :: scene
      !> Set when it cannot be described.
      type(error_type), allocatable, intent(out) :: error
      type(system_type) :: system

      call new_stopwatch(system%watch, n_phases)
      call describe_system(model, system, scene, error)
      call system%solver%release()
   end subroutine describe_scene

   !> Set up the first system and report on it.
   subroutine describe_system(model, system, scene, error)
      type(model_type), intent(in) :: model
      type(system_type), intent(inout) :: system
      type(scene_report_type), intent(out) :: scene
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: failure

      call prepare_system(model, system, failure)
      if (allocated(failure)) then
         call fatal_error(error, "the scene cannot start: "//failure)
      else
         call report_scene(scene, model, system)
      end if
   end subroutine describe_system

   !> One load step, in one go or in parts: a part that fails is repeated with half its size, and
   !> where that does not help either, bodies settle.
   subroutine run_load_step(model, system, step, reported, observer, error)
      type(model_type), intent(inout) :: model
      type(system_type), intent(inout) :: system
      integer, intent(in) :: step
      real(wp), intent(inout) :: reported(n_phases)
      class(observer_type), intent(inout) :: observer
      type(error_type), allocatable, intent(out) :: error
      type(step_report_type) :: report
      character(len=:), allocatable :: failure
      real(wp) :: last_time, increment
      integer :: n_halvings
      logical :: is_lost

      last_time = model%schedule%end_time(step)
      increment = last_time - model%time
      n_halvings = 0
      do while (model%time < last_time .or. is_settling(system))
         call advance_step(model, system, end_of_part(model%time, increment, last_time), &
                           report, failure)
         if (allocated(failure)) then
            call try_again(model, system, increment, n_halvings, is_lost)
            if (.not. is_lost) then
               call cut_ahead(model, system, end_of_part(model%time, increment, last_time))
               system%must_recut = .false.
               cycle
            end if
            call fatal_error(error, failure_message(model, step, n_halvings, failure, &
                                                    is_settling(system)) &
                             //text_of_parts(model, system))
            return
         end if
         system%n_recuts = 0
         report%n_halvings = n_halvings
         report%n_settling = system%n_settling
         if (is_settling(system)) then
            call settle_on(system, model%grid%smallest_spacing())
            ! tools are held until bodies are at rest
            increment = merge(0.0_wp, last_time - model%time, is_settling(system))
            n_halvings = 0
         end if
         if (associated(system%sites)) system%sites%increment = system%sites%increment + 1
         report%step = step
         report%phase = model%schedule%phase_of(step)
         report%is_complete = model%time >= last_time .and. .not. is_settling(system)
         report%phase_seconds = system%watch%seconds - reported
         reported = system%watch%seconds
         call system%watch%start(phase_output)
         call observer%step_done(model, report, error)
         call system%watch%stop()
         if (allocated(error)) return
      end do
   end subroutine run_load_step

   !> After a part that failed: half of it, unless a law knows better; when that has not helped
   !> often enough, and the scene allows it, bodies settle, with more drag each time that they fail
   !> to.
   pure subroutine try_again(model, system, increment, n_halvings, is_lost)
      type(model_type), intent(in) :: model
      type(system_type), intent(inout) :: system
      !> Size of the part.
      real(wp), intent(inout) :: increment
      integer, intent(inout) :: n_halvings
      !> Does nothing help?
      logical, intent(out) :: is_lost

      is_lost = system%verdict%ends_run
      if (is_lost) return
      if (is_settling(system)) then
         call settle_again(system, is_lost)
      else if (system%must_recut .and. system%n_recuts < most_recuts) then
         system%n_recuts = system%n_recuts + 1
      else if (n_halvings < model%control%max_halvings) then
         n_halvings = n_halvings + 1
         increment = system%verdict%step_ratio*increment
      else if (model%control%may_settle .or. system%has_come_apart &
               .or. may_snap_through(system%border)) then
         ! parts that have come apart topple and slip
         call begin_settling(system)
      else
         is_lost = .true.
      end if
   end subroutine try_again

   !> Can a tool turn under its load, so far that no equilibrium is near? One that nothing holds
   !> would go on for ever.
   pure function may_snap_through(border) result(answer)
      type(border_type), intent(in) :: border
      logical :: answer

      answer = border%n > 0 .and. border%unheld == 0
      if (answer) answer = any(border%direction == direction_of_turning)
   end function may_snap_through

   !> End of the next part; the last one ends exactly with the load step.
   pure function end_of_part(time, increment, last_time) result(end_time)
      real(wp), intent(in) :: time, increment, last_time
      real(wp) :: end_time

      end_time = time + increment
      if (increment > 0.0_wp .and. end_time > last_time - 1.0e-6_wp*increment) end_time = last_time
   end function end_of_part

   !> Why and where the run ends.
   pure function failure_message(model, step, n_halvings, failure, is_settling) result(message)
      type(model_type), intent(in) :: model
      integer, intent(in) :: step, n_halvings
      character(len=*), intent(in) :: failure
      !> Did bodies settle, and not come to rest?
      logical, intent(in) :: is_settling
      character(len=:), allocatable :: message

      message = "step "//to_text(step)//" of "//to_text(size(model%schedule%end_time)) &
         //" failed at time "//to_text(model%time)
      if (n_halvings > 0) message = message//", even when halved "//to_text(n_halvings)//" times"
      if (is_settling) message = message//", and bodies do not come to rest"
      message = message//": "//failure
   end function failure_message

end module coulter_step_run
