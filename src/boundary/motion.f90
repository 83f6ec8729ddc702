!> Rigid motion of a boundary within a step.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_motion
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: motion_type, leg_type
   public :: moved_by, largest_shift, followed_by, seen_from, turn_matrix, crosswise

   !> Rotation about a centre, then translation.
   type :: motion_type
      !> Translation, length units.
      real(wp) :: translation(2) = 0.0_wp
      !> Angle of rotation, counter-clockwise, radians.
      real(wp) :: rotation = 0.0_wp
      !> Centre of rotation before the motion, length units.
      real(wp) :: centre(2) = 0.0_wp
   end type motion_type

   !> A part of the way of a boundary, beside others that may run at the same time.
   type :: leg_type
      !> Displacement and rotation at a factor of 1, length units and radians, counter-clockwise.
      real(wp) :: displacement(2) = 0.0_wp, rotation = 0.0_wp
      !> Table of the factor, or 0: it grows evenly from 0 to 1 over a phase, by its number.
      integer :: table = 0, phase = 1
   end type leg_type

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

   !> A motion followed by one about the centre as the first leaves it.
   pure function followed_by(motion, next) result(both)
      !> Both motions; the centre of the second is that of the first after it.
      type(motion_type), intent(in) :: motion, next
      type(motion_type) :: both

      both = motion
      both%translation = motion%translation + next%translation
      both%rotation = motion%rotation + next%rotation
   end function followed_by

   !> Way of a place for one who moves along with a motion.
   pure function seen_from(motion, position, way) result(seen)
      !> The motion.
      type(motion_type), intent(in) :: motion
      !> Position before it, and its way, length units.
      real(wp), intent(in) :: position(2), way(2)
      real(wp) :: seen(2)
      real(wp) :: arm(2)

      seen = way - motion%translation
      ! without rotation no digits may be lost
      if (.not. abs(motion%rotation) > 0.0_wp) return
      arm = position - motion%centre + seen
      seen = seen - 2.0_wp*sin(0.5_wp*motion%rotation)**2*arm - sin(motion%rotation)*crosswise(arm)
   end function seen_from

   !> Matrix that turns vectors counter-clockwise by an angle, radians.
   pure function turn_matrix(angle) result(turn)
      !> The angle.
      real(wp), intent(in) :: angle
      real(wp) :: turn(2, 2)

      turn = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
   end function turn_matrix

   !> A vector turned by a right angle, counter-clockwise.
   pure function crosswise(vector)
      !> The vector.
      real(wp), intent(in) :: vector(2)
      real(wp) :: crosswise(2)

      crosswise = [-vector(2), vector(1)]
   end function crosswise

end module coulter_boundary_motion
