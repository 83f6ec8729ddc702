!> Reads fixities: boxes whose grid nodes are held.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_fixities
   use coulter_base_kinds, only: wp
   use coulter_deck_document, only: blame, deck_type, find_groups
   use coulter_deck_references, only: check_unique_names
   use coulter_deck_schedule, only: read_acting_phases
   use coulter_deck_values, only: get_choice, get_value, is_given
   use coulter_grid, only: grid_type
   use coulter_model, only: fixity_type
   implicit none(type, external)
   private
   public :: read_fixities

   !> Share of the spacing around a side that counts as on it, so that round-off loses no nodes.
   real(wp), parameter :: margin = 0.25_wp

contains

   !> All fixities.
   subroutine read_fixities(deck, grid, fixities)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Background grid, to whose sides fixities may refer.
      type(grid_type), intent(in) :: grid
      !> Fixities in the order of the deck.
      type(fixity_type), allocatable, intent(out) :: fixities(:)
      integer, allocatable :: groups(:)
      integer :: i, held

      call check_unique_names(deck, "fixity")
      call find_groups(deck, "fixity", groups)
      allocate (fixities(size(groups)))
      do i = 1, size(groups)
         associate (fixity => fixities(i))
            fixity%name = ""
            call get_value(deck, groups(i), "name", fixity%name)
            held = 3
            call get_choice(deck, groups(i), "held", held)
            fixity%is_held = [held /= 2, held /= 1]
            call read_box(deck, groups(i), grid, fixity)
            call read_acting_phases(deck, groups(i), fixity%first_phase, fixity%last_phase)
         end associate
      end do
   end subroutine read_fixities

   !> Box of a fixity: a side of the grid, or given by its corners.
   subroutine read_box(deck, group, grid, fixity)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(grid_type), intent(in) :: grid
      type(fixity_type), intent(inout) :: fixity
      integer :: side
      logical :: has_side, has_lower, has_upper

      has_side = is_given(deck, group, "side")
      has_lower = is_given(deck, group, "lower")
      has_upper = is_given(deck, group, "upper")
      if (has_side .and. (has_lower .or. has_upper)) then
         call blame(deck, group, "side", "stands beside a box; give `side`, or `lower` and `upper`")
      else if (.not. (has_side .or. (has_lower .and. has_upper) &
                      .or. deck%groups(group)%is_broken)) then
         call blame(deck, group, "", "needs `side`, or `lower` and `upper`")
      end if
      fixity%lower = grid%origin - margin*grid%spacing
      fixity%upper = grid%upper_corner() + margin*grid%spacing
      side = 0
      call get_choice(deck, group, "side", side)
      select case (side)
      case (1)
         fixity%upper(1) = fixity%lower(1) + 2.0_wp*margin*grid%spacing(1)
      case (2)
         fixity%lower(1) = fixity%upper(1) - 2.0_wp*margin*grid%spacing(1)
      case (3)
         fixity%upper(2) = fixity%lower(2) + 2.0_wp*margin*grid%spacing(2)
      case (4)
         fixity%lower(2) = fixity%upper(2) - 2.0_wp*margin*grid%spacing(2)
      case default
         call get_value(deck, group, "lower", fixity%lower)
         call get_value(deck, group, "upper", fixity%upper)
         if (has_lower .and. has_upper .and. any(fixity%upper < fixity%lower)) then
            call blame(deck, group, "upper", "must not be less than `lower`")
         end if
      end select
   end subroutine read_box

end module coulter_deck_fixities
