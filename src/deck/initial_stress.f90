!> Reads the stress of bodies before the first step.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_initial_stress
   use coulter_base_kinds, only: wp
   use coulter_base_table, only: is_increasing
   use coulter_base_text, only: to_text
   use coulter_deck_document, only: blame, deck_type, find_groups
   use coulter_deck_references, only: get_reference
   use coulter_deck_values, only: get_list, get_value, is_given, refuse
   use coulter_points_body, only: body_type, stress_profile_type
   implicit none(type, external)
   private
   public :: read_body_stress, read_stress_profiles

contains

   !> Uniform stress, or that of the weight above.
   subroutine read_body_stress(deck, group, body)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the body's group in the deck.
      integer, intent(in) :: group
      !> Body to equip.
      type(body_type), intent(inout) :: body

      call get_value(deck, group, "initial_stress", body%initial_stress)
      call get_value(deck, group, "k0", body%earth_pressure)
      call get_value(deck, group, "overburden", body%overburden)
      if (is_given(deck, group, "k0")) then
         call refuse(deck, group, "initial_stress", "stands beside `k0`; give one of them")
      else
         call refuse(deck, group, "overburden", "belongs to `k0`")
      end if
   end subroutine read_body_stress

   !> All stresses by elevation, handed to their bodies.
   subroutine read_stress_profiles(deck, bodies)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Bodies of the deck.
      type(body_type), intent(inout) :: bodies(:)
      integer, allocatable :: groups(:), body_groups(:)
      integer :: i, body

      call find_groups(deck, "stress_profile", groups)
      call find_groups(deck, "body", body_groups)
      do i = 1, size(groups)
         body = 0
         call get_reference(deck, groups(i), "body", body)
         if (body == 0) cycle
         if (is_given(deck, body_groups(body), "k0") &
             .or. is_given(deck, body_groups(body), "initial_stress")) then
            call blame(deck, groups(i), "body", "has a `k0` or an `initial_stress` already")
         else if (allocated(bodies(body)%stress_profile)) then
            call blame(deck, groups(i), "body", "has a stress profile already")
            cycle
         end if
         allocate (bodies(body)%stress_profile)
         call read_profile(deck, groups(i), bodies(body)%stress_profile)
      end do
   end subroutine read_stress_profiles

   !> Elevations and the stresses there.
   subroutine read_profile(deck, group, profile)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(stress_profile_type), intent(inout) :: profile
      real(wp), allocatable :: stress(:)

      call get_list(deck, group, "elevation", profile%elevation)
      call get_list(deck, group, "stress", stress)
      if (.not. (allocated(profile%elevation) .and. allocated(stress))) return
      if (size(stress) /= 4*size(profile%elevation)) then
         call blame(deck, group, "stress", "must have four values for each elevation, of which" &
                    //" there are "//to_text(size(profile%elevation)))
      else if (.not. is_increasing(profile%elevation)) then
         call blame(deck, group, "elevation", "must increase")
      else
         profile%stress = reshape(stress, [4, size(profile%elevation)])
      end if
   end subroutine read_profile

end module coulter_deck_initial_stress
