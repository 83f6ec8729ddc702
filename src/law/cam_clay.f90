!> Modified Cam clay at finite strain: critical states, preconsolidation, elasticity from an energy.
!>
!> Logarithmic strains and Kirchhoff stresses; p and volume strains positive in compression. The
!> elasticity is that of law/houlsby with exponent 1, bulk number 1/kappa and G = g p, so that the
!> stress ratio q/p = 3 g eps_q follows the elastic shear strain alone. Yield surface
!> q^2/M^2 + p (p - p_c) = 0, associated flow, dp_c/p_c = d eps_v^p/(lambda - kappa).
!>
!> The return keeps the direction of the deviator. With eps_q = trial/(1 + y) all else follows from
!> y >= 0: the plastic volume strain y (M^2 - eta^2)/(6 g), eta = 3 g eps_q, hence p and p_c; and
!> ln p + ln(1 + eta^2/M^2) = ln p_c is one equation for y, positive at 0 and negative far out.
!> Roscoe, K. H. and Burland, J. B. (1968), in Engineering Plasticity, 535-609; finite strain:
!> Borja, R. I. and Tamagnini, C. (1998), Comput. Methods Appl. Mech. Engrg. 155, 73-95.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_cam_clay
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_law_abstract, only: law_variable_type, law_visit_type, n_plane
   use coulter_law_houlsby, only: houlsby_type
   use coulter_law_parameters, only: check_values, law_model_type, law_values_type
   use coulter_law_principal, only: principal_law_type, principal_response_type
   implicit none(type, external)
   private
   public :: cam_clay_type, new_cam_clay, cam_clay_model

   !> The law. State: preconsolidation pressure.
   type, extends(principal_law_type) :: cam_clay_type
      !> Elasticity, with a pressure of 1 at zero strain.
      type(houlsby_type) :: elastic
      !> lambda - kappa, and the ratio M at the critical state.
      real(wp) :: plastic_index = 1.0_wp, critical_ratio = 1.0_wp
      !> Overconsolidation ratio at the start.
      real(wp) :: overconsolidation = 1.0_wp
   contains
      procedure :: update_principal => update_cam_clay
      procedure :: elastic_moduli => cam_clay_moduli
      procedure :: elastic_strain => cam_clay_strain
      procedure :: initial_state => cam_clay_initial_state
   end type cam_clay_type

   !> What follows from a value of y.
   type :: yield_type
      !> Equation for y, and its derivatives by y, trial volume strain and trial shear strain.
      real(wp) :: value, by_y, by_volume, by_shear
      !> Plastic volume strain, and its derivatives by y and trial shear strain.
      real(wp) :: plastic, plastic_by_y, plastic_by_shear
   end type yield_type

   !> How decks name it.
   type(law_model_type), parameter :: cam_clay_model = law_model_type("cam_clay", &
      "modified Cam clay; needs an initial stress", &
      "compression_index swelling_index shear_ratio critical_ratio", "overconsolidation")

   !> Trials for y, and every how many of them bisect.
   integer, parameter :: most_trials = 200, bisection = 8
   !> Pressures are refused beyond exp of this; smaller ones at the start count as the second.
   real(wp), parameter :: largest_logarithm = 300.0_wp, least_pressure = 1.0e-100_wp

contains

   !> Make the law.
   pure subroutine new_cam_clay(law, name, values, error)
      !> Law to make.
      type(cam_clay_type), intent(out) :: law
      !> Name by which bodies refer to it.
      character(len=*), intent(in) :: name
      !> Parameters.
      type(law_values_type), intent(in) :: values
      !> Set when they are missing, out of range or contradict each other.
      type(error_type), allocatable, intent(out) :: error

      call check_values(cam_clay_model, name, values, error)
      if (allocated(error)) return
      law%name = name
      law%is_elastic = .false.
      ! p_c follows a part of the plastic strain only: symmetric in the limit of small steps
      law%is_symmetric = .false.
      law%n_state = 1
      law%variables = [law_variable_type("preconsolidation", "stress", &
                                         "isotropic preconsolidation pressure p_c")]
      law%elastic%bulk = 1.0_wp/values%number("swelling_index", 1.0_wp)
      law%elastic%shear = values%number("shear_ratio", 1.0_wp)
      law%plastic_index = values%number("compression_index", 1.0_wp) &
         - values%number("swelling_index", 1.0_wp)
      law%critical_ratio = values%number("critical_ratio", 1.0_wp)
      law%overconsolidation = values%number("overconsolidation", 1.0_wp)
      if (.not. law%plastic_index > 0.0_wp) then
         call fatal_error(error, "law "//name//": compression_index must exceed swelling_index")
      end if
   end subroutine new_cam_clay

   !> See `principal_interface`.
   pure subroutine update_cam_clay(self, visit, trial, state, response, new_state)
      class(cam_clay_type), intent(in) :: self
      !> Of no interest.
      type(law_visit_type), intent(in) :: visit
      !> Principal elastic trial strains.
      real(wp), intent(in) :: trial(3)
      !> Preconsolidation pressure.
      real(wp), intent(in) :: state(self%n_state)
      !> Stress, tangent and elastic strain.
      type(principal_response_type), intent(out) :: response
      !> State variables at the end of the step.
      real(wp), intent(out) :: new_state(self%n_state)
      type(yield_type) :: yield
      real(wp) :: deviator(3), volume, shear, logarithm, y

      new_state = state
      response%has_failed = .not. all(abs(trial) < largest_logarithm)
      if (response%has_failed) return
      volume = -sum(trial)
      deviator = trial + volume/3.0_wp
      shear = sqrt(2.0_wp/3.0_wp*sum(deviator**2))
      logarithm = log(max(state(1), tiny(1.0_wp)))
      call find_yield(self, volume, shear, logarithm, 0.0_wp, yield)
      if (yield%value <= 0.0_wp) then
         call self%elastic%update_principal(visit, trial, state(:0), response, new_state(:0))
         return
      end if
      call find_root(self, volume, shear, logarithm, y, yield, response%has_failed)
      if (response%has_failed) return
      logarithm = logarithm + yield%plastic/self%plastic_index
      response%has_failed = .not. abs(logarithm) < largest_logarithm
      if (response%has_failed) return
      new_state(1) = exp(logarithm)
      response%strain = deviator/(1.0_wp + y) - (volume - yield%plastic)/3.0_wp
      call respond_plastically(self, deviator, shear, y, yield, response)
   end subroutine update_cam_clay

   !> The yield condition in logarithms at eps_q = shear/(1 + y), and its derivatives.
   pure subroutine find_yield(self, volume, shear, log_preconsolidation, y, yield)
      type(cam_clay_type), intent(in) :: self
      real(wp), intent(in) :: volume, shear, log_preconsolidation, y
      type(yield_type), intent(out) :: yield
      real(wp) :: elastic, ratio, shrink

      associate (k => self%elastic%bulk, g => self%elastic%shear, m => self%critical_ratio)
         shrink = 1.0_wp/(1.0_wp + y)
         elastic = shear*shrink
         ratio = (3.0_wp*g*elastic/m)**2
         yield%plastic = y*m**2*(1.0_wp - ratio)/(6.0_wp*g)
         yield%plastic_by_y = m**2*(1.0_wp - ratio + 2.0_wp*y*shrink*ratio)/(6.0_wp*g)
         yield%plastic_by_shear = -3.0_wp*g*y*elastic*shrink
         yield%value = k*(volume - yield%plastic + 1.5_wp*g*elastic**2) + log(1.0_wp + ratio) &
            - log_preconsolidation - yield%plastic/self%plastic_index
         associate (by_elastic => 3.0_wp*g*elastic*(k + 6.0_wp*g/(m**2*(1.0_wp + ratio))), &
                    by_plastic => k + 1.0_wp/self%plastic_index)
            yield%by_y = -by_elastic*elastic*shrink - by_plastic*yield%plastic_by_y
            yield%by_shear = by_elastic*shrink - by_plastic*yield%plastic_by_shear
         end associate
         yield%by_volume = k
      end associate
   end subroutine find_yield

   !> Root of the yield condition: Newton's method between bounds.
   pure subroutine find_root(self, volume, shear, log_preconsolidation, y, yield, has_failed)
      type(cam_clay_type), intent(in) :: self
      real(wp), intent(in) :: volume, shear, log_preconsolidation
      real(wp), intent(out) :: y
      type(yield_type), intent(out) :: yield
      logical, intent(out) :: has_failed
      real(wp) :: low, high, next
      integer :: k

      low = 0.0_wp
      high = huge(high)
      y = 0.0_wp
      do k = 1, most_trials
         call find_yield(self, volume, shear, log_preconsolidation, y, yield)
         if (yield%value >= 0.0_wp) low = y
         if (yield%value <= 0.0_wp) high = y
         if (.not. abs(yield%value) > 0.0_wp) exit
         next = y - yield%value/yield%by_y
         if (.not. (yield%by_y < 0.0_wp .and. next > low .and. next < high) &
             .or. mod(k, bisection) == 0) then
            next = 0.5_wp*(low + high)
            if (high >= huge(high)) next = 2.0_wp*low + 1.0e-3_wp
         end if
         if (abs(next - y) <= 2.0_wp*epsilon(y)*(1.0_wp + y)) exit
         y = next
      end do
      has_failed = k > most_trials .or. .not. yield%by_y < 0.0_wp
   end subroutine find_root

   !> Stress and tangent at the root: tau = -p 1 + 2 g p dev(eps), p = exp(k (v + 3/2 g eps_q^2)).
   pure subroutine respond_plastically(self, deviator, shear, y, yield, response)
      type(cam_clay_type), intent(in) :: self
      real(wp), intent(in) :: deviator(3), shear, y
      type(yield_type), intent(in) :: yield
      type(principal_response_type), intent(inout) :: response
      real(wp) :: elastic(3), along(3), shrink, pressure, y_slope(3), p_slope(3)
      integer :: i

      shrink = 1.0_wp/(1.0_wp + y)
      elastic = deviator*shrink
      associate (k => self%elastic%bulk, g => self%elastic%shear)
         response%has_failed = .not. abs(k*sum(response%strain)) < largest_logarithm
         if (response%has_failed) return
         pressure = exp(k*(g*sum(elastic**2) - sum(response%strain)))
         response%stress = pressure*(2.0_wp*g*elastic - 1.0_wp)
         along = 0.0_wp
         if (shear > 0.0_wp) along = 2.0_wp/3.0_wp*deviator/shear
         y_slope = (yield%by_volume - yield%by_shear*along)/yield%by_y
         ! ln p = k (v - plastic + g e:e): by trial strain, y being a function of it
         p_slope = -k*(1.0_wp + yield%plastic_by_shear*along + yield%plastic_by_y*y_slope) &
            + 2.0_wp*k*g*shrink*elastic - 2.0_wp*k*g*sum(elastic**2)*shrink*y_slope
         response%tangent = spread(response%stress, 2, 3)*spread(p_slope, 1, 3) &
            - 2.0_wp*g*pressure*shrink*(1.0_wp/3.0_wp + spread(elastic, 2, 3)*spread(y_slope, 1, 3))
         do i = 1, 3
            response%tangent(i, i) = response%tangent(i, i) + 2.0_wp*g*pressure*shrink
         end do
      end associate
   end subroutine respond_plastically

   !> See `law_type`.
   pure subroutine cam_clay_moduli(self, stress, state, lame_lambda, shear_modulus)
      class(cam_clay_type), intent(in) :: self
      !> Kirchhoff stress.
      real(wp), intent(in) :: stress(n_plane)
      !> Of no influence.
      real(wp), intent(in) :: state(self%n_state)
      !> First Lame parameter.
      real(wp), intent(out) :: lame_lambda
      !> Shear modulus.
      real(wp), intent(out) :: shear_modulus

      call self%elastic%elastic_moduli(stress, state(:0), lame_lambda, shear_modulus)
   end subroutine cam_clay_moduli

   !> See `law_type`.
   pure function cam_clay_strain(self, stress, state) result(strain)
      class(cam_clay_type), intent(in) :: self
      !> Kirchhoff stress.
      real(wp), intent(in) :: stress(n_plane)
      !> Of no influence.
      real(wp), intent(in) :: state(self%n_state)
      !> Logarithmic elastic strain.
      real(wp) :: strain(n_plane)

      strain = self%elastic%elastic_strain(stress, state(:0))
   end function cam_clay_strain

   !> See `law_type`: p_c = R (p + q^2/(M^2 p)).
   subroutine cam_clay_initial_state(self, stress, position, state)
      class(cam_clay_type), intent(in) :: self
      !> Kirchhoff stress, in compression.
      real(wp), intent(in) :: stress(n_plane)
      !> Of no influence.
      real(wp), intent(in) :: position(2)
      !> State variables.
      real(wp), intent(out) :: state(self%n_state)
      real(wp) :: pressure, square

      pressure = max(-sum(stress(:3))/3.0_wp, least_pressure)
      square = 1.5_wp*(sum((stress(:3) + pressure)**2) + 2.0_wp*stress(4)**2)
      state(1) = self%overconsolidation*(pressure + square/(self%critical_ratio**2*pressure))
   end subroutine cam_clay_initial_state

end module coulter_law_cam_clay
