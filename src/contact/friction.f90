!> Traction of one station: what presses against a face, and how that rubs along it.
!>
!> Normal traction t_n = n . S + k g, tangential one by a stick-slip return mapping from the place
!> where the station sticks in the frame of the face; S is the traction of the material (Nitsche).
!> Tension positive: what presses has t_n < 0. Where a face holds tension, t_n is cut off. Theory,
!> section 4.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_friction
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: place_type
   use coulter_contact, only: broken
   implicit none(type, external)
   private
   public :: friction_type, rub_type, press, cut_off, rub, shear_capacity, friction_of, outer

   !> Shear and tension that a face can carry.
   type :: friction_type
      !> Coefficient of Coulomb friction.
      real(wp) :: coefficient = 0.0_wp
      !> Shear at no pressure and largest shear, stress units.
      real(wp) :: adhesion = 0.0_wp, limit = 0.0_wp
      !> Does the face stick at any pressure, up to the limit?
      logical :: is_rough = .false.
      !> Tension that it holds, stress units, and opening over which that fades, length units.
      real(wp) :: tension = 0.0_wp, opening = 0.0_wp
      !> Does it hold what is on it for good?
      logical :: is_bilateral = .false.
   end type friction_type

   !> What a station answers to its place and to the traction of the material.
   type :: rub_type
      !> Normal and tangential traction, stress units.
      real(wp) :: traction(2) = 0.0_wp
      !> The same as a vector, and its derivatives by the place of the station and by S, shape
      !> (component, component).
      real(wp) :: vector(2) = 0.0_wp, by_place(2, 2) = 0.0_wp, by_stress(2, 2) = 0.0_wp
      !> Derivatives of the normal traction by the place and by S.
      real(wp) :: normal_by_place(2) = 0.0_wp, normal_by_stress(2) = 0.0_wp
      !> Derivatives of vector and normal traction by the place of the other end of its edge, where
      !> that says what the station may press.
      real(wp) :: by_other(2, 2) = 0.0_wp, normal_by_other(2) = 0.0_wp
      !> Sign of the traction while it slips, 0 while it sticks or is smooth.
      integer :: slip = 0
      !> Does it stick?
      logical :: sticks = .false.
   end type rub_type

   !> Shear over pressure is at most this on a face that holds no tension, whatever adhesion and
   !> roughness: if shear sprang up where contact begins, there might be no equilibrium with it and
   !> none without.
   real(wp), parameter :: steepest = 3.0_wp

contains

   !> Friction of a boundary.
   pure function friction_of(boundary) result(friction)
      !> The boundary.
      type(boundary_type), intent(in) :: boundary
      type(friction_type) :: friction

      friction = friction_type(boundary%friction, boundary%adhesion, boundary%shear_limit, &
                               boundary%is_rough, boundary%tension_limit, &
                               boundary%tension_opening, boundary%is_bilateral)
   end function friction_of

   !> Normal part: traction, and its share of the derivatives.
   pure subroutine press(answer, place, material, penalty)
      !> Answer to begin.
      type(rub_type), intent(out) :: answer
      !> Place of the station relative to the face.
      type(place_type), intent(in) :: place
      !> Traction S of the material on the face, stress units.
      real(wp), intent(in) :: material(2)
      !> Penalty stiffness k, stress per length.
      real(wp), intent(in) :: penalty

      answer%traction(1) = dot_product(place%normal, material) + penalty*place%gap
      ! the normal turns on arcs
      answer%normal_by_place = penalty*place%normal &
         + place%curvature*dot_product(place%tangent, material)*place%tangent
      answer%normal_by_stress = place%normal
      call along_normal(answer, place)
   end subroutine press

   !> Normal traction as a vector.
   pure subroutine along_normal(answer, place)
      type(rub_type), intent(inout) :: answer
      type(place_type), intent(in) :: place

      associate (n => place%normal, t => place%tangent)
         answer%vector = answer%traction(1)*n
         answer%by_place = outer(n, answer%normal_by_place) &
            + answer%traction(1)*place%curvature*outer(t, t)
         answer%by_stress = outer(n, answer%normal_by_stress)
      end associate
   end subroutine along_normal

   !> Cut the tension off that a face holds, to be called after `press`: its limit, which falls in
   !> proportion to the largest opening, or all at once after a step that has reached it.
   pure subroutine cut_off(answer, place, friction, opening, new_opening, holds)
      !> Answer to limit.
      type(rub_type), intent(inout) :: answer
      !> Place of the station relative to the face.
      type(place_type), intent(in) :: place
      !> What the face can carry.
      type(friction_type), intent(in) :: friction
      !> Largest opening before the step and with this answer, length units.
      real(wp), intent(in) :: opening
      real(wp), intent(out) :: new_opening
      !> Does the face hold any tension?
      logical, intent(out) :: holds
      real(wp) :: limit, slope

      new_opening = opening
      limit = merge(friction%tension, 0.0_wp, opening < broken)
      slope = 0.0_wp
      if (friction%opening > 0.0_wp) then
         new_opening = max(opening, place%gap)
         limit = friction%tension*(1.0_wp - min(new_opening, friction%opening)/friction%opening)
         if (place%gap > opening .and. limit > 0.0_wp) slope = -friction%tension/friction%opening
      end if
      holds = limit > 0.0_wp
      if (answer%traction(1) <= limit) return
      if (.not. limit > 0.0_wp .or. .not. friction%opening > 0.0_wp) new_opening = broken
      if (.not. holds) return
      answer%traction(1) = limit
      answer%normal_by_place = slope*place%normal
      answer%normal_by_stress = 0.0_wp
      call along_normal(answer, place)
   end subroutine cut_off

   !> Tangential part, to be called after `press`: sticks up to the capacity, then slips.
   pure subroutine rub(answer, place, material, penalty, lag, friction, forced_slip)
      !> Answer to complete.
      type(rub_type), intent(inout) :: answer
      !> Place of the station relative to the face.
      type(place_type), intent(in) :: place
      !> Traction S of the material on the face, stress units.
      real(wp), intent(in) :: material(2)
      !> Penalty stiffnesses along normal and tangent, stress per length.
      real(wp), intent(in) :: penalty(2)
      !> Way from the place where the station sticks to its present one, length units.
      real(wp), intent(in) :: lag(2)
      !> What the face can carry.
      type(friction_type), intent(in) :: friction
      !> If given, sticks (0) or slips (sign of the traction) whatever the capacity: prediction.
      integer, intent(in), optional :: forced_slip
      real(wp) :: stuck, capacity, slope, by_place(2), by_stress(2)

      associate (n => place%normal, t => place%tangent, kappa => place%curvature)
         stuck = dot_product(t, material) + penalty(2)*dot_product(t, lag)
         call shear_capacity(friction, answer%traction(1), capacity, slope)
         if (present(forced_slip)) then
            answer%slip = forced_slip
         else if (abs(stuck) > capacity) then
            answer%slip = nint(sign(1.0_wp, stuck))
         end if
         answer%sticks = answer%slip == 0
         if (answer%sticks) then
            answer%traction(2) = stuck
            by_place = (penalty(2)*(1.0_wp - kappa*dot_product(n, lag)) &
                        - kappa*dot_product(n, material))*t
            by_stress = t
         else
            answer%traction(2) = real(answer%slip, wp)*capacity
            by_place = real(answer%slip, wp)*slope*answer%normal_by_place
            by_stress = real(answer%slip, wp)*slope*answer%normal_by_stress
         end if
         answer%vector = answer%vector + answer%traction(2)*t
         answer%by_place = answer%by_place + outer(t, by_place) &
            - answer%traction(2)*kappa*outer(n, t)
         answer%by_stress = answer%by_stress + outer(t, by_stress)
         if (.not. answer%sticks) answer%by_other = answer%by_other &
            + real(answer%slip, wp)*slope*outer(t, answer%normal_by_other)
      end associate
   end subroutine rub

   !> Largest shear at a normal traction, and its derivative by that.
   pure subroutine shear_capacity(friction, normal_traction, capacity, slope)
      !> The face.
      type(friction_type), intent(in) :: friction
      !> Normal traction, tension positive, stress units.
      real(wp), intent(in) :: normal_traction
      !> Largest shear, stress units.
      real(wp), intent(out) :: capacity
      !> Its derivative.
      real(wp), intent(out) :: slope

      capacity = friction%limit
      slope = 0.0_wp
      if (.not. friction%is_rough) then
         associate (coulomb => friction%adhesion - friction%coefficient*normal_traction)
            if (coulomb < friction%limit) then
               capacity = max(0.0_wp, coulomb)
               if (coulomb > 0.0_wp) slope = -friction%coefficient
            end if
         end associate
      end if
      if (friction%is_bilateral .or. friction%tension > 0.0_wp) return
      if (capacity <= -steepest*normal_traction) return
      capacity = max(0.0_wp, -steepest*normal_traction)
      slope = 0.0_wp
      if (normal_traction < 0.0_wp) slope = -steepest
   end subroutine shear_capacity

   !> Dyadic product.
   pure function outer(first, second) result(product)
      !> Its factors.
      real(wp), intent(in) :: first(2), second(2)
      real(wp) :: product(2, 2)

      product(:, 1) = first*second(1)
      product(:, 2) = first*second(2)
   end function outer

end module coulter_contact_friction
