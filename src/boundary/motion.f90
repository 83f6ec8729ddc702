!> Rigid motion of a boundary within a step.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_motion
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: motion_type, moved_by, largest_shift

   !> Rotation about a centre, then translation.
   type :: motion_type
      !> Translation, length units.
      real(wp) :: translation(2) = 0.0_wp
      !> Angle of rotation, counter-clockwise, radians.
      real(wp) :: rotation = 0.0_wp
      !> Centre of rotation before the motion, length units.
      real(wp) :: centre(2) = 0.0_wp
   end type motion_type

contains

   !> Where the motion takes a position.
   pure function moved_by(motion, position) result(moved)
      !> The motion.
      type(motion_type), intent(in) :: motion
      !> Position before it, length units.
      real(wp), intent(in) :: position(2)
      real(wp) :: moved(2)
      real(wp) :: arm(2)

      moved = position
      ! without rotation no digits may be lost
      if (abs(motion%rotation) > 0.0_wp) then
         arm = position - motion%centre
         moved = motion%centre + cos(motion%rotation)*arm &
            + sin(motion%rotation)*[-arm(2), arm(1)]
      end if
      moved = moved + motion%translation
   end function moved_by

   !> How far the motion takes the farthest of some positions.
   pure function largest_shift(motion, positions) result(shift)
      !> The motion.
      type(motion_type), intent(in) :: motion
      !> Positions before it, length units, shape (2, n).
      real(wp), intent(in) :: positions(:, :)
      real(wp) :: shift
      integer :: i

      shift = norm2(motion%translation)
      if (.not. abs(motion%rotation) > 0.0_wp) return
      do i = 1, size(positions, 2)
         shift = max(shift, norm2(moved_by(motion, positions(:, i)) - positions(:, i)))
      end do
   end function largest_shift

end module coulter_boundary_motion
