!> Bodies that find no equilibrium near by slide to one that is farther away: against a drag that
!> fades, with tools held.
!>
!> Where a limit load is passed, small motions do not lead to equilibrium: slopes slip until they
!> are flat enough. Inertia is left out as everywhere; the drag stands in for it, and is gone when
!> the bodies have come to rest (theory, section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_settle
   use coulter_base_kinds, only: wp
   use coulter_system, only: system_type
   use coulter_system_border, only: free_motions
   implicit none(type, external)
   private
   public :: begin_settling, settle_on, settle_again, is_settling

   !> Drag at first, at most, and below which it is left out: per area and motion, over shear
   !> modulus and squared spacing.
   real(wp), parameter :: first_drag = 1.0e-2_wp, largest_drag = 10.0_wp, least_drag = 1.0e-7_wp
   !> Motion of a part that is aimed at, over the spacing; factors by which the drag may change
   !> after a part, and after one that failed.
   real(wp), parameter :: good_motion = 0.1_wp, factors(2) = [0.1_wp, 2.0_wp], firmer = 3.0_wp
   !> Parts after which bodies are not expected to come to rest.
   integer, parameter :: most_parts = 200

contains

   !> Are bodies on their way to an equilibrium?
   pure function is_settling(system) result(answer)
      !> The system.
      type(system_type), intent(in) :: system
      logical :: answer

      answer = system%n_settling > 0
   end function is_settling

   !> Begin: nothing else has led to equilibrium.
   pure subroutine begin_settling(system)
      !> The system; gets a drag.
      type(system_type), intent(inout) :: system

      system%n_settling = 1
      system%settling_drag = first_drag
   end subroutine begin_settling

   !> After a part that succeeded: less drag the less has moved; without drag, bodies are at rest.
   pure subroutine settle_on(system, spacing)
      !> The system, in equilibrium with its drag; gets another one.
      type(system_type), intent(inout) :: system
      !> Spacing of the grid, length units.
      real(wp), intent(in) :: spacing
      real(wp) :: motion

      if (.not. system%settling_drag > 0.0_wp) then
         system%n_settling = 0
         return
      end if
      motion = maxval([maxval(abs(system%increment)), abs(free_motions(system%border))]) &
         /(good_motion*spacing)
      system%n_settling = system%n_settling + 1
      system%settling_drag = system%settling_drag*min(max(motion, factors(1)), factors(2))
      if (system%settling_drag < least_drag) system%settling_drag = 0.0_wp
   end subroutine settle_on

   !> After a part that failed: more drag.
   pure subroutine settle_again(system, is_lost)
      !> The system; gets a drag.
      type(system_type), intent(inout) :: system
      !> Is there no use in more drag, or no end?
      logical, intent(out) :: is_lost

      system%n_settling = system%n_settling + 1
      system%settling_drag = firmer*max(system%settling_drag, least_drag)
      is_lost = system%settling_drag > largest_drag .or. system%n_settling > most_parts
   end subroutine settle_again

end module coulter_step_settle
