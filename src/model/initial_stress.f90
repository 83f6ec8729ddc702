!> Stress before the first step: uniform, by elevation, or from the weight of the ground above.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_initial_stress
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_points_body, only: body_type, stress_profile_type
   implicit none(type, external)
   private
   public :: initial_stress, is_geostatic, weight_above

contains

   !> Cauchy stress xx, yy, zz, xy at the start, tension positive, stress units.
   pure function initial_stress(model, body, position) result(stress)
      !> Scene; bodies and body force are read.
      type(model_type), intent(in) :: model
      !> Number of the body.
      integer, intent(in) :: body
      !> Where, length units.
      real(wp), intent(in) :: position(2)
      real(wp) :: stress(4)

      associate (item => model%bodies(body))
         if (is_geostatic(item)) then
            stress(2) = -item%overburden - weight_above(model, position)
            stress([1, 3]) = item%earth_pressure*stress(2)
            stress(4) = 0.0_wp
         else if (allocated(item%stress_profile)) then
            stress = profile_stress(item%stress_profile, position(2))
         else
            stress = item%initial_stress
         end if
      end associate
   end function initial_stress

   !> Does the stress of a body follow from the weight above?
   elemental function is_geostatic(body) result(answer)
      !> Body to ask.
      type(body_type), intent(in) :: body
      logical :: answer

      answer = body%earth_pressure >= 0.0_wp
   end function is_geostatic

   !> Weight per area of all bodies on the vertical line above a position, stress units, under the
   !> full body force, which points down.
   pure function weight_above(model, position) result(weight)
      !> Scene; bodies and body force are read.
      type(model_type), intent(in) :: model
      !> Lower end of the line, length units.
      real(wp), intent(in) :: position(2)
      real(wp) :: weight
      integer :: b, r

      weight = 0.0_wp
      do b = 1, size(model%bodies)
         associate (body => model%bodies(b))
            do r = 1, size(body%regions)
               weight = weight + body%density*length_above(body%regions(r)%vertices, position)
            end do
         end associate
      end do
      weight = -model%body_force%acceleration(2)*weight
   end function weight_above

   !> Length of the vertical line above a position that lies in a polygon: heights of the edges that
   !> close it minus heights of those that open it.
   pure function length_above(vertices, position) result(length)
      !> Corners, counter-clockwise.
      real(wp), intent(in) :: vertices(:, :), position(2)
      real(wp) :: length
      real(wp) :: height, share
      integer :: i, j

      length = 0.0_wp
      do i = 1, size(vertices, 2)
         j = merge(1, i + 1, i == size(vertices, 2))
         ! half-open, so that a corner on the line counts once
         if (vertices(1, i) <= position(1) .eqv. vertices(1, j) <= position(1)) cycle
         share = (position(1) - vertices(1, i))/(vertices(1, j) - vertices(1, i))
         height = vertices(2, i) + share*(vertices(2, j) - vertices(2, i)) - position(2)
         length = length + sign(max(height, 0.0_wp), vertices(1, i) - vertices(1, j))
      end do
   end function length_above

   !> Stress at an elevation.
   pure function profile_stress(profile, elevation) result(stress)
      type(stress_profile_type), intent(in) :: profile
      real(wp), intent(in) :: elevation
      real(wp) :: stress(4)
      real(wp) :: share
      integer :: i, n

      n = size(profile%elevation)
      i = count(profile%elevation <= elevation)
      if (i == 0 .or. i == n) then
         stress = profile%stress(:, max(i, 1))
         return
      end if
      share = (elevation - profile%elevation(i))/(profile%elevation(i + 1) - profile%elevation(i))
      stress = (1.0_wp - share)*profile%stress(:, i) + share*profile%stress(:, i + 1)
   end function profile_stress

end module coulter_model_initial_stress
