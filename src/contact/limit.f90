!> What a face of a tool can press near an open end: hardly more than the traction that the material
!> had at the start of the step, until it has given way, and hardly less where the face recedes.
!> Theory, section 4.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_limit
   use coulter_base_kinds, only: wp
   use coulter_boundary_face, only: place_type
   use coulter_contact_friction, only: friction_type, outer, rub_type, shear_capacity
   implicit none(type, external)
   private
   public :: limit_type, limit_press, limit_rub, lean_press

   !> Limits of the traction of a station. On straight faces they are constant in a step, and add
   !> nothing to the tangent.
   type :: limit_type
      !> Normal and tangential traction of the material at the start of the step, and how much more
      !> either may become, stress units.
      real(wp) :: traction(2) = 0.0_wp, margin = 0.0_wp
      !> The normal one holds up to this depth behind the face, or height before one that recedes,
      !> length units.
      real(wp) :: give = 0.0_wp
      !> Normal stress of the material along the face then, for arcs: its traction turns with them.
      real(wp) :: along = 0.0_wp
      !> Does the face recede, so that the margin says how much less it presses?
      logical :: recedes = .false.
   end type limit_type

contains

   !> Limit the normal traction, after `press`; deeper than `give` the face holds as ever. What a
   !> face recedes from is pressed until it is left behind by that.
   pure subroutine limit_press(answer, place, limit, penalty)
      !> Answer with normal part only.
      type(rub_type), intent(inout) :: answer
      !> Place of the station relative to the face.
      type(place_type), intent(in) :: place
      !> Its limits.
      type(limit_type), intent(in) :: limit
      !> Penalty stiffness, stress per length.
      real(wp), intent(in) :: penalty
      real(wp) :: bound, side, beyond, now

      side = merge(-1.0_wp, 1.0_wp, limit%recedes)
      bound = min(0.0_wp, limit%traction(1)) - side*limit%margin
      ! what does not follow a face that recedes presses no more
      now = min(0.0_wp, answer%traction(1) - penalty*place%gap)
      if (limit%recedes) bound = max(bound, now)
      if (side*(answer%traction(1) - bound) >= 0.0_wp) return
      beyond = side*min(0.0_wp, side*place%gap + limit%give)
      answer%traction(1) = bound + penalty*beyond
      answer%vector = answer%traction(1)*place%normal
      answer%normal_by_place = merge(penalty, 0.0_wp, abs(beyond) > 0.0_wp)*place%normal
      if (limit%traction(1) < 0.0_wp) answer%normal_by_place = answer%normal_by_place &
         + 2.0_wp*place%curvature*limit%traction(2)*place%tangent - side*margin_slope(limit, place)
      answer%normal_by_stress = 0.0_wp
      answer%by_place = outer(place%normal, answer%normal_by_place) &
         + answer%traction(1)*place%curvature*outer(place%tangent, place%tangent)
      if (limit%recedes .and. now < 0.0_wp .and. .not. now < bound) then
         answer%normal_by_stress = place%normal
      end if
      answer%by_stress = outer(place%normal, answer%normal_by_stress)
   end subroutine limit_press

   !> Limit the normal traction, after `press`, to that at the other end of the edge, S being the
   !> same in all of the tile: what is at the corner of a tool that cuts in parts, and is pressed as
   !> what is beside it.
   pure subroutine lean_press(answer, place, other_gap, material, penalty, hold)
      !> Answer with normal part only.
      type(rub_type), intent(inout) :: answer
      !> Place of the station relative to a straight face.
      type(place_type), intent(in) :: place
      !> Gap at the other end, length units.
      real(wp), intent(in) :: other_gap
      !> Traction S of the material on the face, stress units.
      real(wp), intent(in) :: material(2)
      !> Penalty stiffness, stress per length.
      real(wp), intent(in) :: penalty
      !> What the station may press more, over that.
      real(wp), intent(in) :: hold
      real(wp) :: most, factor

      most = dot_product(place%normal, material) + penalty*other_gap
      factor = merge(1.0_wp + hold, 0.0_wp, most < 0.0_wp)
      if (answer%traction(1) >= factor*most) return
      answer%traction(1) = factor*most
      answer%vector = answer%traction(1)*place%normal
      answer%normal_by_place = 0.0_wp
      answer%by_place = 0.0_wp
      answer%normal_by_stress = factor*place%normal
      answer%by_stress = outer(place%normal, answer%normal_by_stress)
      answer%normal_by_other = penalty*answer%normal_by_stress
      answer%by_other = outer(place%normal, answer%normal_by_other)
   end subroutine lean_press

   !> Limit the shear, after `rub`, to that of the material within what the face can carry; what
   !> slips with Coulomb's friction takes its direction only.
   pure subroutine limit_rub(answer, place, limit, friction)
      !> Complete answer.
      type(rub_type), intent(inout) :: answer
      !> Place of the station relative to the face.
      type(place_type), intent(in) :: place
      !> Its limits.
      type(limit_type), intent(in) :: limit
      !> Friction of the face.
      type(friction_type), intent(in) :: friction
      real(wp) :: change, capacity, slope, most, by_place(2)
      logical :: slips

      slips = answer%slip /= 0 .and. .not. friction%is_rough
      call shear_capacity(friction, answer%traction(1), capacity, slope)
      most = merge(capacity, min(capacity, abs(limit%traction(2))), slips)
      by_place = place%curvature*(limit%along - limit%traction(1))*place%tangent
      if (most >= capacity) by_place = 0.0_wp
      slope = merge(0.0_wp, slope*sign(1.0_wp, limit%traction(2)), most < capacity)
      change = sign(most, limit%traction(2)) - answer%traction(2)
      if (.not. slips) then
         by_place = by_place - sign(1.0_wp, change)*margin_slope(limit, place)
         change = sign(max(0.0_wp, abs(change) - limit%margin), change)
      end if
      if (.not. abs(change) > 0.0_wp) return
      answer%traction(2) = answer%traction(2) + change
      answer%vector = answer%vector + change*place%tangent
      associate (n => place%normal, t => place%tangent, kappa => place%curvature)
         answer%by_place = outer(n, matmul(n, answer%by_place) - change*kappa*t) &
            + outer(t, by_place + slope*answer%normal_by_place + answer%traction(1)*kappa*t)
         answer%by_stress = outer(n, matmul(n, answer%by_stress)) &
            + slope*outer(t, answer%normal_by_stress)
      end associate
   end subroutine limit_rub

   !> How the margin changes with the place on an arc, whose normal turns.
   pure function margin_slope(limit, place) result(slope)
      type(limit_type), intent(in) :: limit
      type(place_type), intent(in) :: place
      real(wp) :: slope(2)

      slope = 0.0_wp
      if (limit%traction(1) < 0.0_wp) slope = limit%margin/limit%traction(1) &
                                      *2.0_wp*place%curvature*limit%traction(2)*place%tangent
   end function margin_slope

end module coulter_contact_limit
