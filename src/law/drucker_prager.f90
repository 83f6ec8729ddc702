!> Drucker-Prager plasticity with tension cut-off: a cone fitted to Mohr-Coulomb.
!>
!> q + M p <= k and p <= tension cut-off, which is at most k/M, the apex; q is the equivalent, p the
!> mean stress, tension positive. The return keeps the direction of the deviator, so that only p and
!> q remain (law/planes). Drucker, D. C. and Prager, W. (1952), Quart. Appl. Math. 10, 157-165.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_drucker_prager
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_law_parameters, only: law_model_type, law_values_type
   use coulter_law_planes, only: n_stress, planes_type, return_to_planes, return_type
   use coulter_law_plastic, only: new_plastic_law, plastic_law_type, quotient
   use coulter_law_softening, only: check_softening
   use coulter_law_strength, only: factors_type, strength_parameters
   implicit none(type, external)
   private
   public :: drucker_prager_type, new_drucker_prager, drucker_prager_model

   !> Strength is the cohesion, or without friction the yield stress (von Mises).
   type, extends(plastic_law_type) :: drucker_prager_type
      !> Fit to Mohr-Coulomb: 1 compression, -1 extension, 0 plane strain, 2: the strength is k.
      integer :: cone = 2
   contains
      procedure :: project => project_drucker_prager
   end type drucker_prager_type

   !> How decks name it.
   type(law_model_type), parameter :: drucker_prager_model = law_model_type("drucker_prager", &
      "cohesion and friction on a smooth cone", &
      "youngs_modulus poisson_ratio cohesion friction_angle", &
      "dilation_angle cone tension_cutoff friction_factor "//strength_parameters)

   real(wp), parameter :: round_off = 1.0e-13_wp
   !> Planes are the cone and the cut-off; sets of them that can be active together. Both come
   !> first: at the apex without deviator the cut-off alone would do, but not beside it.
   integer, parameter :: cone_sets(3, 1) = reshape([1, 0, 0], [3, 1])
   integer, parameter :: all_sets(3, 3) = reshape([1, 0, 0, 1, 2, 0, 2, 0, 0], [3, 3])

contains

   !> Make the law.
   pure subroutine new_drucker_prager(law, name, values, error)
      !> Law to make.
      type(drucker_prager_type), intent(out) :: law
      !> Name by which bodies refer to it.
      character(len=*), intent(in) :: name
      !> Parameters.
      type(law_values_type), intent(in) :: values
      !> Set when they are missing, out of range or contradict each other.
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: cone

      cone = values%number("cone", 0.0_wp)
      if (.not. any(abs(cone - [-1.0_wp, 0.0_wp, 1.0_wp]) <= 0.0_wp)) then
         call fatal_error(error, "law "//name//": cone must be -1, 0 or 1")
         return
      end if
      law%cone = nint(cone)
      call new_plastic_law(law, drucker_prager_model, name, "cohesion", values, error)
      if (allocated(error)) return
      law%is_symmetric = law%is_associated()
      call check_softening(law, error)
   end subroutine new_drucker_prager

   !> See `project_interface`.
   pure subroutine project_drucker_prager(self, trial, strength, factors, found, is_elastic)
      class(drucker_prager_type), intent(in) :: self
      !> Principal elastic trial strains.
      real(wp), intent(in) :: trial(3)
      !> Strength before plastic strain.
      real(wp), intent(in) :: strength
      !> Factors on it and on the tangents of the angles.
      type(factors_type), intent(in) :: factors
      !> The answer.
      type(return_type), intent(out) :: found
      !> Is the trial state elastic?
      logical, intent(out) :: is_elastic
      type(planes_type) :: planes
      type(return_type) :: invariant
      real(wp) :: deviator(3), shear, stiffness(n_stress, n_stress), stress(n_stress)
      logical :: has_tension

      deviator = trial - sum(trial)/3.0_wp
      shear = sqrt(2.0_wp/3.0_wp*sum(deviator**2))
      ! a deviator of round-off has no direction, and at the apex there is none
      if (shear < round_off*maxval(abs(trial))) shear = 0.0_wp
      stiffness = 0.0_wp
      stiffness(1, 1) = self%elastic%lame_lambda + 2.0_wp/3.0_wp*self%elastic%shear_modulus
      stiffness(2, 2) = 3.0_wp*self%elastic%shear_modulus
      stress = [stiffness(1, 1)*sum(trial), stiffness(2, 2)*shear, 0.0_wp]
      call set_planes(self, strength, factors, planes, has_tension)
      is_elastic = dot_product(planes%normal(:2, 1), stress(:2)) <= planes%offset(1)
      if (has_tension) is_elastic = is_elastic .and. stress(1) <= planes%offset(2)
      if (is_elastic) return
      if (has_tension) then
         call return_to_planes(stiffness, stress, planes, all_sets, invariant)
         if (planes%normal(1, 1)*planes%offset(2) >= (1.0_wp - round_off)*planes%offset(1) &
             .and. invariant%stress(2) <= round_off*planes%offset(1)) call clear(invariant)
      else
         call return_to_planes(stiffness, stress, planes, cone_sets, invariant)
      end if
      call expand(invariant, deviator, shear, found)
   end subroutine project_drucker_prager

   !> Take the round-off out of what belongs to q at the apex.
   pure subroutine clear(invariant)
      type(return_type), intent(inout) :: invariant

      invariant%stress(2) = 0.0_wp
      invariant%slope(2) = 0.0_wp
      invariant%tangent(2, :2) = 0.0_wp
   end subroutine clear

   !> From p and q to principal stresses: s_i = p + 2/3 q n_i with n = dev(eps)/eps_q.
   pure subroutine expand(invariant, deviator, shear, found)
      type(return_type), intent(in) :: invariant
      real(wp), intent(in) :: deviator(3), shear
      type(return_type), intent(out) :: found
      real(wp) :: along(3), ratio
      integer :: i, j

      along = 0.0_wp
      ratio = invariant%tangent(2, 2)
      if (shear > 0.0_wp) then
         along = deviator/shear
         ratio = invariant%stress(2)/shear
      end if
      found%violation = invariant%violation
      found%stress = invariant%stress(1) + 2.0_wp/3.0_wp*invariant%stress(2)*along
      found%slope = invariant%slope(1) + 2.0_wp/3.0_wp*invariant%slope(2)*along
      found%plastic = invariant%plastic(1)/3.0_wp + invariant%plastic(2)*along
      associate (t => invariant%tangent, weight => 2.0_wp/3.0_wp)
         do j = 1, 3
            ! d eps_q / d eps_j = 2/3 n_j; dn = (d dev - n d eps_q)/eps_q
            found%tangent(:, j) = t(1, 1) + weight*t(1, 2)*along(j) + weight*along &
               *(t(2, 1) + weight*t(2, 2)*along(j)) - weight*ratio*(1.0_wp/3.0_wp &
               + weight*along*along(j))
         end do
         do i = 1, 3
            found%tangent(i, i) = found%tangent(i, i) + weight*ratio
         end do
      end associate
   end subroutine expand

   !> Cone and cut-off for given factors.
   pure subroutine set_planes(self, strength, factors, planes, has_tension)
      type(drucker_prager_type), intent(in) :: self
      real(wp), intent(in) :: strength
      type(factors_type), intent(in) :: factors
      type(planes_type), intent(out) :: planes
      logical, intent(out) :: has_tension
      real(wp) :: friction(4), dilation(4), cutoff(2)

      friction = fit(self%cone, self%friction*factors%friction)
      dilation = fit(self%cone, self%dilation*factors%friction)
      planes%normal(:2, 1) = [friction(1), 1.0_wp]
      planes%normal_slope(1, 1) = friction(2)*self%friction*factors%friction_slope
      planes%flow(:2, 1) = [dilation(1), 1.0_wp]
      planes%flow_slope(1, 1) = dilation(2)*self%dilation*factors%friction_slope
      planes%normal(1, 2) = 1.0_wp
      planes%flow(1, 2) = 1.0_wp
      planes%offset(1) = strength*factors%strength*friction(3)
      planes%offset_slope(1) = strength*(factors%strength_slope*friction(3) &
         + factors%strength*friction(4)*self%friction*factors%friction_slope)
      has_tension = friction(1) > 0.0_wp .or. self%tension_cutoff < huge(1.0_wp)
      planes%n = merge(2, 1, has_tension)
      if (.not. has_tension) return
      cutoff = huge(1.0_wp)
      if (friction(1) > 0.0_wp) cutoff = quotient([planes%offset(1), planes%offset_slope(1)], &
                                                  [friction(1), planes%normal_slope(1, 1)])
      cutoff = self%tension_limit(cutoff, factors)
      planes%offset(2) = cutoff(1)
      planes%offset_slope(2) = cutoff(2)
   end subroutine set_planes

   !> M, dM/dt, k/c and d(k/c)/dt of the cone for t = tan(angle). In triaxial compression
   !> (extension) it touches the edges of Mohr-Coulomb; in plane strain it gives the
   !> same collapse loads for associated flow.
   pure function fit(cone, t)
      integer, intent(in) :: cone
      real(wp), intent(in) :: t
      real(wp) :: fit(4)
      real(wp) :: sine, cosine, side

      select case (cone)
      case (2)
         fit = [0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp]
      case (0)
         side = sqrt(3.0_wp + 4.0_wp*t**2)
         fit = 3.0_wp*[t/side, 3.0_wp/side**3, 1.0_wp/side, -4.0_wp*t/side**3]
      case default
         cosine = 1.0_wp/sqrt(1.0_wp + t**2)
         sine = t*cosine
         side = 3.0_wp - real(cone, wp)*sine
         fit = [6.0_wp*sine/side, 18.0_wp*cosine**3/side**2, 6.0_wp*cosine/side, &
                (6.0_wp*real(cone, wp) - 18.0_wp*sine)*cosine**2/side**2]
      end select
   end function fit

end module coulter_law_drucker_prager
