!> Reads further parts of the way of tools and boundaries, so that it may bend from phase to phase.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_motions
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_motion, only: leg_type
   use coulter_deck_document, only: blame, deck_type, find_groups
   use coulter_deck_references, only: get_reference
   use coulter_deck_values, only: demand_one, get_choice, get_value, is_given, refuse
   use coulter_model_control, only: schedule_type
   implicit none(type, external)
   private
   public :: read_motions

   !> Radians of a degree.
   real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp

contains

   !> All motions, added to those of their tools and boundaries.
   subroutine read_motions(deck, schedule, boundaries)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Load steps and phases.
      type(schedule_type), intent(in) :: schedule
      !> Boundaries, then tools, in the order of the deck.
      type(boundary_type), intent(inout) :: boundaries(:)
      type(leg_type) :: leg
      integer, allocatable :: groups(:)
      integer :: i, b

      call find_groups(deck, "motion", groups)
      do i = 1, size(groups)
         call read_leg(deck, groups(i), schedule, leg)
         call find_boundary(deck, groups(i), boundaries, b)
         if (b == 0) cycle
         call check_freedom(deck, groups(i), boundaries(b), leg)
         if (allocated(boundaries(b)%legs)) then
            boundaries(b)%legs = [boundaries(b)%legs, leg]
         else
            boundaries(b)%legs = [leg]
         end if
      end do
   end subroutine read_motions

   !> Number of the tool or boundary that moves; 0 if at fault.
   subroutine find_boundary(deck, group, boundaries, b)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(boundary_type), intent(in) :: boundaries(:)
      integer, intent(out) :: b
      !> Number among the choices of `kind` of &boundary of those that stay in place.
      integer, parameter :: fixed = 2
      integer, allocatable :: groups(:)
      integer :: kind

      b = 0
      call demand_one(deck, group, "tool", "boundary")
      call get_reference(deck, group, "tool", b)
      if (b > 0) b = b + count(.not. boundaries%is_tool)
      if (b > 0) return
      call get_reference(deck, group, "boundary", b)
      if (b == 0) return
      kind = 0
      call find_groups(deck, "boundary", groups)
      call get_choice(deck, groups(b), "kind", kind)
      if (kind == fixed) call blame(deck, group, "boundary", "has kind = 'fixed' and stays in" &
                                    //" place; a moving one is 'prescribed'")
      call refuse(deck, group, "rotation", "belongs to tools")
      call refuse(deck, group, "rotation_rate", "belongs to tools")
   end subroutine find_boundary

   !> Way and time; velocities hold over the phase.
   subroutine read_leg(deck, group, schedule, leg)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(schedule_type), intent(in) :: schedule
      type(leg_type), intent(out) :: leg
      real(wp) :: velocity(2), rate, duration

      call get_reference(deck, group, "phase", leg%phase)
      call get_reference(deck, group, "table", leg%table)
      call get_value(deck, group, "displacement", leg%displacement)
      call get_value(deck, group, "rotation", leg%rotation)
      if (leg%table > 0) then
         call refuse(deck, group, "phase", "stands beside `table`, which says it")
         call refuse(deck, group, "velocity", "stands beside `table`; give `displacement`")
         call refuse(deck, group, "rotation_rate", "stands beside `table`; give `rotation`")
      end if
      if (is_given(deck, group, "displacement")) then
         call refuse(deck, group, "velocity", "stands beside `displacement`; give one of them")
      end if
      if (is_given(deck, group, "rotation")) then
         call refuse(deck, group, "rotation_rate", "stands beside `rotation`; give one of them")
      end if
      velocity = 0.0_wp
      rate = 0.0_wp
      call get_value(deck, group, "velocity", velocity)
      call get_value(deck, group, "rotation_rate", rate)
      duration = schedule%duration_of_phase(leg%phase)
      leg%displacement = leg%displacement + velocity*duration
      leg%rotation = degree*(leg%rotation + rate*duration)
      if (deck%groups(group)%is_broken) return
      if (.not. (any(abs(leg%displacement) > 0.0_wp) .or. abs(leg%rotation) > 0.0_wp)) then
         call blame(deck, group, "", "moves nothing: give `displacement`, `velocity`, `rotation`" &
                    //" or `rotation_rate`")
      end if
   end subroutine read_leg

   !> What a load decides cannot be prescribed.
   subroutine check_freedom(deck, group, boundary, leg)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(boundary_type), intent(in) :: boundary
      type(leg_type), intent(in) :: leg

      if (any(boundary%is_free .and. abs(leg%displacement) > 0.0_wp)) then
         call blame(deck, group, "", "moves the tool in a direction that is `free`")
      else if (boundary%turns_freely .and. abs(leg%rotation) > 0.0_wp) then
         call blame(deck, group, "", "turns a tool that has `free_rotation`")
      end if
   end subroutine check_freedom

end module coulter_deck_motions
