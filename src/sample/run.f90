!> Runs the stages of a test on a sample, and records every increment.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_sample_run
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_law_abstract, only: law_sites_type, law_type, law_verdict_type
   use coulter_sample, only: sample_type, stage_type
   use coulter_sample_control, only: demand_type, reach
   use coulter_sample_record, only: add_row, new_record, record_type
   use coulter_sample_state, only: sample_state_type, start_state
   implicit none(type, external)
   private
   public :: run_sample

   !> How often a failed increment may be cut.
   integer, parameter :: max_cuts = 12

contains

   !> Test a sample in the stages that are its own.
   subroutine run_sample(sample, law, stages, record, error)
      !> The sample.
      type(sample_type), intent(in) :: sample
      !> Its law.
      class(law_type), intent(in) :: law
      !> Its stages in order.
      type(stage_type), intent(in) :: stages(:)
      !> Rows of what was reached, also when the test ends early.
      type(record_type), intent(out) :: record
      !> Set when an increment fails for good.
      type(error_type), allocatable, intent(out) :: error
      type(sample_state_type) :: state
      integer :: s

      call start_state(state, sample, law)
      call new_record(record, sample, law, sum(stages%n_increments) + 1)
      call add_row(record, 0, state, 0)
      do s = 1, size(stages)
         call run_stage(law, stages(s), s, state, record, error)
         if (.not. allocated(error)) cycle
         error%message = "sample "//sample%name//": "//error%message
         return
      end do
   end subroutine run_sample

   !> One stage: equal increments of strain or stress.
   subroutine run_stage(law, stage, number, state, record, error)
      class(law_type), intent(in) :: law
      type(stage_type), intent(in) :: stage
      integer, intent(in) :: number
      type(sample_state_type), intent(inout) :: state
      type(record_type), intent(inout) :: record
      type(error_type), allocatable, intent(out) :: error
      type(demand_type) :: demand
      character(len=:), allocatable :: failure
      real(wp) :: first(4), last(4)
      integer :: i, n_iterations

      first = state%stress
      last = merge(first, stage%target, stage%is_kept)
      state%sites = law_sites_type(phase=number, phase_start=state%time)
      demand%is_stress = stage%is_stress
      demand%is_round = stage%is_round
      demand%change = stage%target/real(stage%n_increments, wp)
      demand%time_step = stage%duration/real(stage%n_increments, wp)
      do i = 1, stage%n_increments
         demand%stress = first + (last - first)*real(i, wp)/real(stage%n_increments, wp)
         call run_increment(law, demand, (last - first)/real(stage%n_increments, wp), state, &
                            n_iterations, failure)
         if (allocated(failure)) then
            call fatal_error(error, "increment "//to_text(i)//" of "//to_text(stage%n_increments) &
                             //" of stage "//to_text(number)//" fails: "//failure)
            return
         end if
         call add_row(record, number, state, n_iterations)
      end do
   end subroutine run_stage

   !> One increment, in parts where it fails as a whole.
   subroutine run_increment(law, demand, rise, state, n_iterations, failure)
      class(law_type), intent(in) :: law
      type(demand_type), intent(in) :: demand
      !> By how much the stresses rise.
      real(wp), intent(in) :: rise(4)
      type(sample_state_type), intent(inout) :: state
      integer, intent(out) :: n_iterations
      character(len=:), allocatable, intent(out) :: failure
      type(sample_state_type) :: new
      type(law_verdict_type) :: verdict
      type(demand_type) :: part
      real(wp) :: done, share
      integer :: n_cuts, n
      logical :: is_last

      part = demand
      done = 0.0_wp
      share = 1.0_wp
      n_iterations = 0
      n_cuts = 0
      do while (done < 1.0_wp)
         ! the last part ends exactly with the increment
         is_last = done + share > 1.0_wp - 1.0e-6_wp*share
         if (is_last) share = 1.0_wp - done
         part%change = share*demand%change
         part%time_step = share*demand%time_step
         part%stress = demand%stress - (1.0_wp - done - share)*rise
         call reach(law, state, part, new, n, verdict, failure)
         n_iterations = n_iterations + n
         if (allocated(failure)) then
            n_cuts = n_cuts + 1
            if (n_cuts > max_cuts .or. verdict%ends_run) return
            deallocate (failure)
            share = verdict%step_ratio*share
         else
            done = merge(1.0_wp, done + share, is_last)
            state = new
         end if
      end do
   end subroutine run_increment

end module coulter_sample_run
