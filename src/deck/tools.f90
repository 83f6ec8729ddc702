!> Reads rigid tools: what they are and how they move.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_tools
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_deck_boundaries, only: read_friction, read_motion
   use coulter_deck_document, only: blame, deck_type, find_groups
   use coulter_deck_references, only: check_unique_names, get_reference
   use coulter_deck_tool_shapes, only: read_shape
   use coulter_deck_values, only: get_choice, get_value, is_given, refuse
   use coulter_model_control, only: domains_tiles, schedule_type
   implicit none(type, external)
   private
   public :: read_tools

   !> Radians of a degree.
   real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp

contains

   !> All tools, appended to the boundaries.
   subroutine read_tools(deck, schedule, domains, boundaries)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Load steps and phases.
      type(schedule_type), intent(in) :: schedule
      !> What a point stands for: one of `domains_*`.
      integer, intent(in) :: domains
      !> Boundaries read so far; gets the tools in the order of the deck.
      type(boundary_type), allocatable, intent(inout) :: boundaries(:)
      type(boundary_type), allocatable :: all_of_them(:)
      integer, allocatable :: groups(:)
      integer :: i, n

      call check_unique_names(deck, "tool")
      call find_groups(deck, "tool", groups)
      n = size(boundaries)
      allocate (all_of_them(n + size(groups)))
      all_of_them(:n) = boundaries
      do i = 1, size(groups)
         call read_tool(deck, groups(i), schedule, all_of_them(n + i))
         if (domains == domains_tiles) cycle
         call blame(deck, groups(i), "", "needs domains = 'cpdi2', whose tiles have edges")
      end do
      call move_alloc(all_of_them, boundaries)
   end subroutine read_tools

   !> One tool.
   subroutine read_tool(deck, group, schedule, tool)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(schedule_type), intent(in) :: schedule
      type(boundary_type), intent(out) :: tool

      tool%name = ""
      call get_value(deck, group, "name", tool%name)
      tool%is_tool = .true.
      tool%may_start_apart = .true.
      call get_value(deck, group, "band_ratio", tool%band_ratio)
      call read_friction(deck, group, tool)
      call read_shape(deck, group, tool)
      call read_motion(deck, group, 0, schedule, tool)
      call read_rotation(deck, group, tool)
      call read_freedom(deck, group, tool)
      call get_value(deck, group, "embedded", tool%is_embedded)
      if (tool%is_embedded .and. .not. tool%is_solid) then
         call blame(deck, group, "embedded", "needs a closed shape with the material outside")
      else if (tool%is_embedded .and. tool%first_phase > 1) then
         call blame(deck, group, "embedded", "needs a tool that acts from the first phase on")
      end if
   end subroutine read_tool

   !> Components that a load decides; the pivot is known.
   subroutine read_freedom(deck, group, tool)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(boundary_type), intent(inout) :: tool
      real(wp) :: load_point(2)
      integer :: choice

      choice = 0
      call get_choice(deck, group, "free", choice)
      tool%is_free = [choice == 1 .or. choice == 3, choice >= 2]
      call get_value(deck, group, "free_rotation", tool%turns_freely)
      call get_value(deck, group, "load", tool%load)
      load_point = tool%centre
      call get_value(deck, group, "load_point", load_point)
      tool%lever = load_point - tool%centre
      call get_value(deck, group, "moment", tool%moment)
      call get_reference(deck, group, "load_table", tool%load_table, "table")
      if (any(tool%is_free .and. abs(tool%displacement) > 0.0_wp)) then
         call blame(deck, group, "free", "cannot go with a displacement in the same direction")
      end if
      if (tool%turns_freely) then
         if (abs(tool%rotation) > 0.0_wp) call blame(deck, group, "free_rotation", &
                                                     "cannot go with a rotation")
         return
      end if
      call refuse(deck, group, "moment", "needs `free_rotation`")
      call refuse(deck, group, "load_point", "needs `free_rotation`")
      if (any(.not. tool%is_free .and. abs(tool%load) > 0.0_wp)) then
         call blame(deck, group, "load", "needs `free` in its direction, or `free_rotation`")
      end if
   end subroutine read_freedom

   !> Rotation about a point that moves with the tool.
   subroutine read_rotation(deck, group, tool)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(boundary_type), intent(inout) :: tool

      call get_value(deck, group, "rotation", tool%rotation)
      tool%rotation = degree*tool%rotation
      call get_reference(deck, group, "rotation_table", tool%rotation_table, "table")
      call get_value(deck, group, "pivot", tool%centre)
      if (is_given(deck, group, "rotation_table") .and. .not. is_given(deck, group, "rotation")) &
         then
         call blame(deck, group, "rotation_table", "has no rotation to schedule")
      end if
   end subroutine read_rotation

end module coulter_deck_tools
