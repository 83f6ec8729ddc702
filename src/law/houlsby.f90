!> Hyperelasticity whose moduli grow with a power of the pressure; exponent 1 is the kappa law.
!>
!> There is an energy f, so that no cycle makes or loses work. With volume strain v and pressure p
!> positive in compression, deviator e, k and g the bulk and shear number, n the exponent and p_r
!> the reference pressure,
!>    n < 1: f = p_r/(k (2 - n)) (k (1 - n) r)^((2 - n)/(1 - n)),
!>           r^2 = (v + 1/(k (1 - n)))^2 + 2 g e:e/(k (1 - n)),
!>    n = 1: f = p_r/k exp(k (v + g e:e)),
!> so that K = k p_r (p/p_r)^n and G = g p_r (p/p_r)^n under isotropic stress. A shift is subtracted
!> from the pressure. Houlsby, G. T., Amorosi, A. and Rojas, E. (2005), Geotechnique 55, 383-392,
!> here for logarithmic strain and Kirchhoff stress.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_houlsby
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: wp
   use coulter_law_abstract, only: law_visit_type, n_plane
   use coulter_law_parameters, only: check_values, law_model_type, law_values_type
   use coulter_law_principal, only: join_axes, principal_law_type, principal_response_type, &
      split_axes
   implicit none(type, external)
   private
   public :: houlsby_type, new_houlsby, houlsby_model

   !> The law.
   type, extends(principal_law_type) :: houlsby_type
      !> Bulk and shear modulus over the reference pressure, at that pressure.
      real(wp) :: bulk = 1.0_wp, shear = 1.0_wp
      !> Exponent, 0 to 1.
      real(wp) :: exponent = 1.0_wp
      !> Pressure without strain, before the shift, stress units.
      real(wp) :: reference = 1.0_wp
      !> What is subtracted from the pressure, stress units.
      real(wp) :: shift = 0.0_wp
   contains
      procedure :: update_principal => update_houlsby
      procedure :: elastic_moduli => houlsby_moduli
      procedure :: elastic_strain => houlsby_strain
   end type houlsby_type

   !> How decks name it.
   type(law_model_type), parameter :: houlsby_model = law_model_type("houlsby", &
      "elastic, moduli grow with pressure", &
      "bulk_number shear_number reference_pressure pressure_shift", "stiffness_exponent")

   !> What follows from volume and deviator.
   type :: scale_type
      !> C = G/g, and the pressure before the shift, stress units.
      real(wp) :: value, pressure
      !> d value = by_volume d trace + by_deviator (deviator : d strain).
      real(wp) :: by_volume, by_deviator
   end type scale_type

   !> Exponents nearer to 1 than this are 1.
   real(wp), parameter :: nearly_one = 1.0e-6_wp
   !> Logarithm of the largest stress over the reference pressure.
   real(wp), parameter :: largest_logarithm = 300.0_wp

contains

   !> Make the law.
   pure subroutine new_houlsby(law, name, values, error)
      !> Law to make.
      type(houlsby_type), intent(out) :: law
      !> Name by which bodies refer to it.
      character(len=*), intent(in) :: name
      !> Parameters.
      type(law_values_type), intent(in) :: values
      !> Set when they are missing or out of range.
      type(error_type), allocatable, intent(out) :: error

      call check_values(houlsby_model, name, values, error)
      if (allocated(error)) return
      law%name = name
      law%bulk = values%number("bulk_number", 1.0_wp)
      law%shear = values%number("shear_number", 1.0_wp)
      law%exponent = values%number("stiffness_exponent", 0.5_wp)
      if (law%exponent > 1.0_wp - nearly_one) law%exponent = 1.0_wp
      law%reference = values%number("reference_pressure", 1.0_wp)
      law%shift = values%number("pressure_shift", 0.0_wp)
   end subroutine new_houlsby

   !> See `principal_interface`: with C = G/g, s = 2 g C e and p = k (1 - n) C w, where
   !> w = v + 1/(k (1 - n)); for n = 1: p = C.
   pure subroutine update_houlsby(self, visit, trial, state, response, new_state)
      class(houlsby_type), intent(in) :: self
      !> Of no interest.
      type(law_visit_type), intent(in) :: visit
      !> Principal elastic strains.
      real(wp), intent(in) :: trial(3)
      !> State variables: none.
      real(wp), intent(in) :: state(self%n_state)
      !> Stress and tangent.
      type(principal_response_type), intent(out) :: response
      !> State variables: none.
      real(wp), intent(out) :: new_state(self%n_state)
      type(scale_type) :: scale
      real(wp) :: deviator(3), gradient(3)
      integer :: i

      new_state = state
      deviator = trial - sum(trial)/3.0_wp
      call find_scale(self, -sum(trial), sum(deviator**2), scale, response%has_failed)
      if (response%has_failed) return
      response%stress = self%shift - scale%pressure + 2.0_wp*self%shear*scale%value*deviator
      response%strain = trial
      gradient = scale%by_volume + scale%by_deviator*deviator
      response%tangent = 2.0_wp*self%shear*(spread(deviator, 2, 3)*spread(gradient, 1, 3) &
                                            - scale%value/3.0_wp)
      do i = 1, 3
         response%tangent(i, i) = response%tangent(i, i) + 2.0_wp*self%shear*scale%value
      end do
      if (self%exponent < 1.0_wp) then
         associate (a => self%bulk*(1.0_wp - self%exponent))
            gradient = gradient*(1.0_wp - a*sum(trial)) - a*scale%value
         end associate
      end if
      response%tangent = response%tangent - spread(gradient, 1, 3)
   end subroutine update_houlsby

   !> C and what goes with it.
   pure subroutine find_scale(self, volume, square, scale, has_failed)
      class(houlsby_type), intent(in) :: self
      !> Volume strain, positive in compression, and square of the deviator.
      real(wp), intent(in) :: volume, square
      type(scale_type), intent(out) :: scale
      logical, intent(out) :: has_failed
      real(wp) :: logarithm, a, along, radius, power

      a = self%bulk*(1.0_wp - self%exponent)
      if (self%exponent < 1.0_wp) then
         ! radius and along are r and w times k (1 - n)
         along = 1.0_wp + a*volume
         radius = max(sqrt(along**2 + 2.0_wp*self%shear*a*square), tiny(1.0_wp))
         power = self%exponent/(1.0_wp - self%exponent)
         logarithm = power*log(radius)
      else
         logarithm = self%bulk*(volume + self%shear*square)
      end if
      has_failed = .not. logarithm < largest_logarithm
      if (has_failed) return
      associate (c => self%reference*exp(logarithm))
         scale%value = c
         if (self%exponent < 1.0_wp) then
            scale%pressure = c*along
            scale%by_volume = -power*a*c*along/radius**2
            scale%by_deviator = power*a*2.0_wp*self%shear*c/radius**2
         else
            scale%pressure = c
            scale%by_volume = -self%bulk*c
            scale%by_deviator = 2.0_wp*self%bulk*self%shear*c
         end if
      end associate
   end subroutine find_scale

   !> See `law_type`: K and G at p_0, where p_0^2 = p^2 + k (1 - n)/(2 g) s:s.
   pure subroutine houlsby_moduli(self, stress, state, lame_lambda, shear_modulus)
      class(houlsby_type), intent(in) :: self
      !> Kirchhoff stress.
      real(wp), intent(in) :: stress(n_plane)
      !> State variables: none.
      real(wp), intent(in) :: state(self%n_state)
      !> First Lame parameter.
      real(wp), intent(out) :: lame_lambda
      !> Shear modulus.
      real(wp), intent(out) :: shear_modulus
      real(wp) :: values(3), axis(2)

      call split_axes(stress, values, axis)
      shear_modulus = self%shear*self%reference &
         *(equivalent_pressure(self, values)/self%reference)**self%exponent
      lame_lambda = shear_modulus*(self%bulk/self%shear - 2.0_wp/3.0_wp)
   end subroutine houlsby_moduli

   !> See `law_type`. For n = 1 there is no strain that carries tension beyond the shift.
   pure function houlsby_strain(self, stress, state) result(strain)
      class(houlsby_type), intent(in) :: self
      !> Kirchhoff stress.
      real(wp), intent(in) :: stress(n_plane)
      !> State variables: none.
      real(wp), intent(in) :: state(self%n_state)
      !> Logarithmic elastic strain.
      real(wp) :: strain(n_plane)
      real(wp) :: values(3), axis(2), deviator(3), scale, volume, ratio

      call split_axes(stress, values, axis)
      deviator = values - sum(values)/3.0_wp
      ratio = equivalent_pressure(self, values)/self%reference
      scale = self%reference*ratio**self%exponent
      deviator = deviator/(2.0_wp*self%shear*scale)
      if (self%exponent < 1.0_wp) then
         volume = ((self%shift - sum(values)/3.0_wp)/scale - 1.0_wp) &
            /(self%bulk*(1.0_wp - self%exponent))
      else
         volume = log(ratio)/self%bulk - self%shear*sum(deviator**2)
      end if
      strain = join_axes(deviator - volume/3.0_wp, axis)
      strain(4) = 2.0_wp*strain(4)
   end function houlsby_strain

   !> Isotropic pressure under which the moduli are the same; never quite zero.
   pure function equivalent_pressure(self, values) result(pressure)
      class(houlsby_type), intent(in) :: self
      !> Principal stresses.
      real(wp), intent(in) :: values(3)
      real(wp) :: pressure
      real(wp), parameter :: smallest = 1.0e-12_wp

      pressure = self%shift - sum(values)/3.0_wp
      if (self%exponent < 1.0_wp) then
         pressure = norm2([pressure, sqrt(0.5_wp*self%bulk*(1.0_wp - self%exponent)/self%shear) &
                                    *norm2(values - sum(values)/3.0_wp)])
      end if
      pressure = max(pressure, smallest*self%reference)
   end function equivalent_pressure

end module coulter_law_houlsby
