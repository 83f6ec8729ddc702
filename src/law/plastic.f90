!> Elastoplastic laws with linear elasticity whose yield surface depends on one hardening variable.
!>
!> The surface is given for any accumulated plastic strain h = sqrt(2/3 e_p : e_p), summed over the
!> steps, and the return to it is exact; what remains is one equation for h at the end of the step,
!> h = h_n + growth(h), which is solved between bounds.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_plastic
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: wp
   use coulter_law_abstract, only: law_variable_type, law_visit_type, n_plane
   use coulter_law_hencky, only: hencky_type, new_hencky
   use coulter_law_parameters, only: law_values_type
   use coulter_law_planes, only: return_type
   use coulter_law_principal, only: principal_law_type, principal_response_type
   use coulter_law_strength, only: factors_type, new_strength, strength_type
   implicit none(type, external)
   private
   public :: plastic_law_type, new_plastic_law

   !> A law of this kind. State: accumulated plastic strain, and the strength at the datum of strain
   !> where that varies with depth.
   type, abstract, extends(principal_law_type) :: plastic_law_type
      !> Elasticity.
      type(hencky_type) :: elastic
      !> Strength by depth, plastic strain and rate.
      type(strength_type) :: strength
   contains
      procedure :: update_principal => update_plastic
      procedure :: elastic_moduli => plastic_moduli
      procedure :: elastic_strain => plastic_elastic_strain
      procedure :: initial_state => plastic_initial_state
      procedure(project_interface), deferred :: project
   end type plastic_law_type

   !> Trials for h, and the share of the trial strain to which it is found.
   integer, parameter :: most_trials = 200
   real(wp), parameter :: tightness = 4.0e-15_wp, round_off = 1.0e-13_wp

   abstract interface
      !> Return to the yield surface of a given strength.
      pure subroutine project_interface(self, trial, strength, factors, found, is_elastic)
         import :: factors_type, plastic_law_type, return_type, wp
         implicit none (type, external)
         class(plastic_law_type), intent(in) :: self
         !> Principal elastic trial strains.
         real(wp), intent(in) :: trial(3)
         !> Strength before plastic strain, stress units.
         real(wp), intent(in) :: strength
         !> Factors on it, with slopes by h.
         type(factors_type), intent(in) :: factors
         !> Principal stresses, plastic strains, tangent, and slope of the stresses by h.
         type(return_type), intent(out) :: found
         !> Is the trial state elastic? Then nothing has been found.
         logical, intent(out) :: is_elastic
      end subroutine project_interface
   end interface

contains

   !> What all these laws have in common.
   pure subroutine new_plastic_law(law, name, strength_name, values, error)
      !> Law to set up.
      class(plastic_law_type), intent(inout) :: law
      !> Its name.
      character(len=*), intent(in) :: name
      !> Parameter that is its strength.
      character(len=*), intent(in) :: strength_name
      !> Parameters, each in its range.
      type(law_values_type), intent(in) :: values
      !> Set when they contradict each other.
      type(error_type), allocatable, intent(out) :: error

      call new_hencky(law%elastic, name, values%number("youngs_modulus", 0.0_wp), &
                      values%number("poisson_ratio", 0.0_wp), error)
      if (allocated(error)) return
      call new_strength(law%strength, name, values%number(strength_name, 0.0_wp), values, error)
      if (allocated(error)) return
      law%name = name
      law%is_elastic = .false.
      law%variables = [law_variable_type("plastic_strain", "1", &
                                         "accumulated plastic strain, sqrt(2/3 e:e)")]
      if (law%strength%gradient > 0.0_wp) then
         law%variables = [law%variables, law_variable_type( &
                          "strength", "stress", strength_name//" before plastic strain")]
      end if
      law%n_state = size(law%variables)
   end subroutine new_plastic_law

   !> See `principal_interface`.
   pure subroutine update_plastic(self, visit, trial, state, response, new_state)
      class(plastic_law_type), intent(in) :: self
      !> Where and when.
      type(law_visit_type), intent(in) :: visit
      !> Principal elastic trial strains.
      real(wp), intent(in) :: trial(3)
      !> Accumulated plastic strain, and the strength where it varies with depth.
      real(wp), intent(in) :: state(self%n_state)
      !> Stress, tangent and elastic strain.
      type(principal_response_type), intent(out) :: response
      !> State variables at the end of the step.
      real(wp), intent(out) :: new_state(self%n_state)
      type(return_type) :: found
      real(wp) :: strength
      logical :: is_elastic

      new_state = state
      response%has_failed = .not. all(abs(trial) <= huge(trial))
      if (response%has_failed) return
      strength = self%strength%reference
      if (self%n_state > 1) strength = state(2)
      call self%project(trial, strength, self%strength%factors(state(1), 0.0_wp, 0.0_wp), found, &
                        is_elastic)
      if (is_elastic) then
         call respond_elastically(self, trial, response)
         return
      end if
      call harden(self, visit, trial, state(1), strength, found, new_state(1), is_elastic, &
                  response%has_failed)
      if (response%has_failed) return
      if (is_elastic) then
         ! by round-off: it hardens as fast as it would yield
         call respond_elastically(self, trial, response)
         return
      end if
      response%stress = found%stress
      response%tangent = found%tangent
      response%strain = trial - found%plastic
   end subroutine update_plastic

   !> Hencky's law in principal axes.
   pure subroutine respond_elastically(self, trial, response)
      class(plastic_law_type), intent(in) :: self
      real(wp), intent(in) :: trial(3)
      type(principal_response_type), intent(inout) :: response
      integer :: i

      response%tangent = self%elastic%lame_lambda
      do i = 1, 3
         response%tangent(i, i) = self%elastic%lame_lambda + 2.0_wp*self%elastic%shear_modulus
      end do
      response%stress = self%elastic%lame_lambda*sum(trial) &
         + 2.0_wp*self%elastic%shear_modulus*trial
      response%strain = trial
   end subroutine respond_elastically

   !> Find h = start + growth(h), where the return `found` belongs to h; and complete the tangent.
   pure subroutine harden(self, visit, trial, start, strength, found, h, is_elastic, has_failed)
      class(plastic_law_type), intent(in) :: self
      type(law_visit_type), intent(in) :: visit
      real(wp), intent(in) :: trial(3), start, strength
      type(return_type), intent(inout) :: found
      real(wp), intent(out) :: h
      logical, intent(out) :: is_elastic, has_failed
      real(wp) :: low, high, excess, growth, slope, by_trial(3), next
      integer :: k
      logical :: has_bound

      has_failed = .false.
      is_elastic = .false.
      h = start
      call measure(found, self%elastic%shear_modulus, growth, by_trial, slope)
      if (self%strength%is_constant) then
         h = start + growth
         return
      end if
      low = start
      high = start + 2.0_wp*growth
      has_bound = .false.
      h = start + growth/max(1.0_wp - slope, 0.5_wp)
      do k = 1, most_trials
         call self%project(trial, strength, self%strength%factors(h, h - start, visit%time_step), &
                           found, is_elastic)
         growth = 0.0_wp
         slope = 0.0_wp
         if (.not. is_elastic) then
            call measure(found, self%elastic%shear_modulus, growth, by_trial, slope)
         end if
         excess = start + growth - h
         if (abs(excess) <= tightness*max(maxval(abs(trial)), h)) exit
         if (excess > 0.0_wp) then
            low = h
            if (.not. has_bound .and. h >= high) high = start + 2.0_wp*(h - start)
         else
            high = h
            has_bound = .true.
         end if
         next = h + excess/(1.0_wp - slope)
         if (.not. (slope < 1.0_wp .and. next > low .and. next < high) .or. mod(k, 8) == 0) then
            next = merge(0.5_wp*(low + high), high, has_bound)
         end if
         if (.not. abs(next - h) > 0.0_wp) exit
         h = next
      end do
      has_failed = k > most_trials .or. .not. slope < 1.0_wp
      if (has_failed .or. is_elastic) return
      found%tangent = found%tangent &
         + spread(found%slope, 2, 3)*spread(by_trial, 1, 3)/(1.0_wp - slope)
   end subroutine harden

   !> Growth of the accumulated plastic strain, and its derivatives by trial strain and h. The
   !> deviator of the plastic strain is that of trial - stress/(2 G).
   pure subroutine measure(found, shear_modulus, growth, by_trial, slope)
      type(return_type), intent(in) :: found
      real(wp), intent(in) :: shear_modulus
      real(wp), intent(out) :: growth, by_trial(3), slope
      real(wp) :: direction(3)

      direction = found%plastic - sum(found%plastic)/3.0_wp
      growth = sqrt(2.0_wp/3.0_wp*sum(direction**2))
      by_trial = 0.0_wp
      slope = 0.0_wp
      ! a deviator of round-off has no direction
      if (growth <= round_off*maxval(abs(found%plastic) + abs(found%stress)/shear_modulus)) return
      direction = 2.0_wp/3.0_wp*direction/growth
      by_trial = direction - matmul(direction, found%tangent)/(2.0_wp*shear_modulus)
      slope = -dot_product(direction, found%slope)/(2.0_wp*shear_modulus)
   end subroutine measure

   !> See `law_type`.
   pure subroutine plastic_moduli(self, stress, state, lame_lambda, shear_modulus)
      class(plastic_law_type), intent(in) :: self
      !> Of no influence.
      real(wp), intent(in) :: stress(n_plane)
      !> Of no influence.
      real(wp), intent(in) :: state(self%n_state)
      !> First Lame parameter.
      real(wp), intent(out) :: lame_lambda
      !> Shear modulus.
      real(wp), intent(out) :: shear_modulus

      lame_lambda = self%elastic%lame_lambda
      shear_modulus = self%elastic%shear_modulus
   end subroutine plastic_moduli

   !> See `law_type`.
   pure function plastic_elastic_strain(self, stress, state) result(strain)
      class(plastic_law_type), intent(in) :: self
      !> Kirchhoff stress.
      real(wp), intent(in) :: stress(n_plane)
      !> Of no influence.
      real(wp), intent(in) :: state(self%n_state)
      !> Logarithmic elastic strain.
      real(wp) :: strain(n_plane)

      strain = self%elastic%elastic_strain(stress, [real(wp) ::])
   end function plastic_elastic_strain

   !> See `law_type`: no plastic strain, and the strength of the place.
   subroutine plastic_initial_state(self, stress, position, state)
      class(plastic_law_type), intent(in) :: self
      !> Of no influence.
      real(wp), intent(in) :: stress(n_plane)
      !> Position at the start.
      real(wp), intent(in) :: position(2)
      !> State variables.
      real(wp), intent(out) :: state(self%n_state)

      state = 0.0_wp
      if (self%n_state > 1) state(2) = self%strength%at_position(position(2))
   end subroutine plastic_initial_state

end module coulter_law_plastic
