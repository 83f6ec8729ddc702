!> Reads when things happen: load steps, phases, and the phases in which loads and boundaries act.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_schedule
   use coulter_base_kinds, only: wp
   use coulter_base_table, only: is_increasing
   use coulter_deck_document, only: blame, deck_type, find_groups, first_group
   use coulter_deck_references, only: check_unique_names, get_reference
   use coulter_deck_values, only: demand_one, get_list, get_value, is_given, refuse
   use coulter_model_control, only: phase_type, schedule_type
   implicit none(type, external)
   private
   public :: read_schedule, read_load_phases, read_acting_phases, n_equal_steps

contains

   !> Load steps and phases; a single step where they are missing or at fault.
   subroutine read_schedule(deck, schedule)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Times at which steps end, and the phases that hold them.
      type(schedule_type), intent(out) :: schedule
      integer, allocatable :: groups(:)
      real(wp), allocatable :: end_time(:)
      integer :: steps, i

      steps = first_group(deck, "steps")
      call check_unique_names(deck, "phase")
      call find_groups(deck, "phase", groups)
      if (size(groups) == 0) then
         call read_steps(deck, steps, 1.0_wp, schedule%end_time)
         return
      end if
      if (steps > 0) call blame(deck, steps, "", "stands beside &phase; phases have steps of" &
                                //" their own")
      allocate (schedule%phases(size(groups)), schedule%end_time(0))
      do i = 1, size(groups)
         call read_phase(deck, groups(i), schedule%phases(i), end_time)
         if (i > 1) end_time = end_time + schedule%end_time(size(schedule%end_time))
         schedule%end_time = [schedule%end_time, end_time]
         schedule%phases(i)%last_step = size(schedule%end_time)
      end do
   end subroutine read_schedule

   !> One phase and the times of its steps, which count from its start.
   subroutine read_phase(deck, group, phase, end_time)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(phase_type), intent(out) :: phase
      real(wp), allocatable, intent(out) :: end_time(:)
      real(wp) :: duration

      phase%name = ""
      duration = 1.0_wp
      call get_value(deck, group, "name", phase%name)
      call get_value(deck, group, "duration", duration)
      call get_value(deck, group, "reset_displacements", phase%resets_displacements)
      if (is_given(deck, group, "end_times")) then
         call refuse(deck, group, "duration", "belongs to `count`; `end_times` says it")
      end if
      call read_steps(deck, group, duration, end_time)
   end subroutine read_phase

   !> Ends of the load steps that a group describes; group 0 is none.
   subroutine read_steps(deck, group, duration, end_time)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      !> End of the last of equal steps.
      real(wp), intent(in) :: duration
      real(wp), allocatable, intent(out) :: end_time(:)
      integer :: n, i

      n = 1
      if (group > 0) then
         call demand_one(deck, group, "count", "end_times")
         call get_value(deck, group, "count", n)
         call get_list(deck, group, "end_times", end_time)
      end if
      if (.not. allocated(end_time)) then
         end_time = [(duration*(real(i, wp)/real(n, wp)), i=1, n)]
      else if (.not. is_increasing(end_time)) then
         call blame(deck, group, "end_times", "must increase")
      end if
   end subroutine read_steps

   !> When a load grows and when it is taken off.
   subroutine read_load_phases(deck, group, table, ramp_phase, last_phase)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck, and of its table.
      integer, intent(in) :: group, table
      !> Phase over which the load grows; 0: it acts from the start.
      integer, intent(inout) :: ramp_phase
      !> Last phase in which it acts in full.
      integer, intent(inout) :: last_phase
      logical :: is_from_start

      is_from_start = .false.
      call get_value(deck, group, "from_start", is_from_start)
      call get_reference(deck, group, "ramp_phase", ramp_phase, "phase")
      call get_reference(deck, group, "last_phase", last_phase, "phase")
      if (table > 0) then
         call refuse(deck, group, "from_start", "stands beside `table`, which says it")
         call refuse(deck, group, "ramp_phase", "stands beside `table`, which says it")
      else if (is_from_start) then
         call refuse(deck, group, "ramp_phase", "stands beside `from_start`; give one of them")
         ramp_phase = 0
      end if
      if (last_phase < ramp_phase) call blame(deck, group, "last_phase", &
                                              "must not come before the phase in which it grows")
   end subroutine read_load_phases

   !> In which phases a boundary or a fixity acts.
   subroutine read_acting_phases(deck, group, first_phase, last_phase)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Numbers of the first and the last phase.
      integer, intent(inout) :: first_phase, last_phase

      call get_reference(deck, group, "first_phase", first_phase, "phase")
      call get_reference(deck, group, "last_phase", last_phase, "phase")
      if (last_phase < first_phase) call blame(deck, group, "last_phase", &
                                               "must not come before `first_phase`")
   end subroutine read_acting_phases

   !> Number of steps of a phase if they are equal, as far as one can tell, else 0.
   pure function n_equal_steps(deck, schedule, phase) result(n)
      !> Scanned deck.
      type(deck_type), intent(in) :: deck
      !> Its steps.
      type(schedule_type), intent(in) :: schedule
      !> Number of the phase.
      integer, intent(in) :: phase
      integer :: n
      integer, allocatable :: groups(:)

      if (.not. allocated(schedule%phases)) then
         call find_groups(deck, "steps", groups)
         n = size(schedule%end_time)
      else
         call find_groups(deck, "phase", groups)
         groups = groups(phase:)
         n = schedule%phases(phase)%last_step
         if (phase > 1) n = n - schedule%phases(phase - 1)%last_step
      end if
      if (size(groups) == 0) return
      if (is_given(deck, groups(1), "end_times")) n = 0
   end function n_equal_steps

end module coulter_deck_schedule
