!> Elastoplastic laws with linear elasticity whose yield surface depends on one hardening variable.
!>
!> The surface is given for any accumulated plastic strain h = sqrt(2/3 e_p : e_p), summed over the
!> steps, and the return to it is exact; what remains is one equation for h at the end of the step,
!> h = h_n + growth(h), which is solved between bounds.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_plastic
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_law_abstract, only: law_variable_type, law_visit_type, n_plane
   use coulter_law_hencky, only: hencky_type, new_hencky
   use coulter_law_parameters, only: check_values, law_model_type, law_values_type
   use coulter_law_planes, only: return_type
   use coulter_law_principal, only: principal_law_type, principal_response_type
   use coulter_law_strength, only: factors_type, new_strength, strength_type
   implicit none(type, external)
   private
   public :: plastic_law_type, new_plastic_law, quotient

   !> A law of this kind. State: accumulated plastic strain, and the strength at the datum of strain
   !> where that varies with depth.
   type, abstract, extends(principal_law_type) :: plastic_law_type
      !> Elasticity.
      type(hencky_type) :: elastic
      !> Strength by depth, plastic strain and rate.
      type(strength_type) :: strength
      !> Tangents of friction and dilation angle; 0 for laws without.
      real(wp) :: friction = 0.0_wp, dilation = 0.0_wp
      !> Largest principal or mean stress in tension, stress units; it follows the factors on the
      !> strength.
      real(wp) :: tension_cutoff = huge(1.0_wp)
   contains
      procedure :: update_principal => update_plastic
      procedure :: elastic_moduli => plastic_moduli
      procedure :: elastic_strain => plastic_elastic_strain
      procedure :: initial_state => plastic_initial_state
      procedure :: is_associated
      procedure :: tension_limit
      procedure :: growth_slope
      procedure(project_interface), deferred :: project
   end type plastic_law_type

   !> What is given at a point: trial strains, h at the start of the step, strength before plastic
   !> strain, stress units, and length of the step.
   type :: given_type
      real(wp) :: trial(3), start, strength, time_step
   end type given_type

   !> A value of h and what belongs to it.
   type :: guess_type
      !> Accumulated plastic strain.
      real(wp) :: h = 0.0_wp
      !> The return to the yield surface; nothing where the trial state is elastic.
      type(return_type) :: found
      logical :: is_elastic = .true.
      !> Growth of h in the step by this return, and its derivatives by h and by trial strain.
      real(wp) :: growth = 0.0_wp, slope = 0.0_wp, by_trial(3) = 0.0_wp
   end type guess_type

   !> Bounds of h; the upper one is only a guess until something lies beyond it.
   type :: bounds_type
      real(wp) :: low, high
      logical :: has_high
   end type bounds_type

   real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp
   !> Trials for h, every how many of them bisect, since Newton's method may crawl at kinks of the
   !> tables, and the share of the trial strain to which h is found.
   integer, parameter :: most_trials = 200, bisection = 8
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

   !> Set up what all these laws have in common; what remains is whether the tangent is symmetric.
   pure subroutine new_plastic_law(law, model, name, strength_name, values, error)
      !> Law to set up.
      class(plastic_law_type), intent(inout) :: law
      !> How decks name it, and what parameters it takes.
      type(law_model_type), intent(in) :: model
      !> Its name.
      character(len=*), intent(in) :: name
      !> Parameter that is its strength.
      character(len=*), intent(in) :: strength_name
      !> Parameters.
      type(law_values_type), intent(in) :: values
      !> Set when they are missing, out of range or contradict each other.
      type(error_type), allocatable, intent(out) :: error

      call check_values(model, name, values, error)
      if (allocated(error)) return
      call new_hencky(law%elastic, name, values%number("youngs_modulus", 0.0_wp), &
                      values%number("poisson_ratio", 0.0_wp), error)
      if (allocated(error)) return
      call new_strength(law%strength, name, values%number(strength_name, 0.0_wp), values, error)
      if (allocated(error)) return
      call set_angles(law, name, values, error)
      law%tension_cutoff = values%number("tension_cutoff", huge(1.0_wp))
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

   !> Tangents of friction and dilation angle. More dilation than friction would make energy.
   pure subroutine set_angles(law, name, values, error)
      class(plastic_law_type), intent(inout) :: law
      character(len=*), intent(in) :: name
      type(law_values_type), intent(in) :: values
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: angle

      angle = values%number("friction_angle", 0.0_wp)
      law%friction = tan(angle*degree)
      law%dilation = tan(values%number("dilation_angle", 0.0_wp)*degree)
      if (law%dilation > law%friction) then
         call fatal_error(error, "law "//name//": dilation_angle must not exceed friction_angle")
      else if (.not. (angle > 0.0_wp .or. values%number("cohesion", 1.0_wp) > 0.0_wp)) then
         call fatal_error(error, "law "//name//": cohesion and friction_angle must not both be 0")
      end if
   end subroutine set_angles

   !> Is plastic flow normal to a yield surface that does not move within a step?
   pure function is_associated(self) result(answer)
      class(plastic_law_type), intent(in) :: self
      logical :: answer

      answer = abs(self%friction - self%dilation) <= 0.0_wp .and. self%strength%is_constant
   end function is_associated

   !> Largest tension by the apex of the surface or the cut-off, whichever is less, and its slope by
   !> h.
   pure function tension_limit(self, apex, factors) result(limit)
      class(plastic_law_type), intent(in) :: self
      !> Tension at the apex and its slope, stress units.
      real(wp), intent(in) :: apex(2)
      !> Factors on the strength.
      type(factors_type), intent(in) :: factors
      real(wp) :: limit(2)

      limit = apex
      if (.not. self%tension_cutoff < huge(1.0_wp)) return
      if (self%tension_cutoff*factors%strength < apex(1)) then
         limit = self%tension_cutoff*[factors%strength, factors%strength_slope]
      end if
   end function tension_limit

   !> Quotient of two numbers and its slope.
   pure function quotient(above, below)
      !> The numbers and their slopes.
      real(wp), intent(in) :: above(2), below(2)
      real(wp) :: quotient(2)

      quotient(1) = above(1)/below(1)
      quotient(2) = (above(2) - quotient(1)*below(2))/below(1)
   end function quotient

   !> How the plastic strain of a step grows with the hardening variable when the trial strain is
   !> given: 1 and more if the strength falls faster than the stress does by unloading. Counted is
   !> the strength alone, not the angles, whose part grows with pressure.
   pure function growth_slope(self, trial, h) result(slope)
      class(plastic_law_type), intent(in) :: self
      !> Principal elastic trial strains.
      real(wp), intent(in) :: trial(3)
      !> Accumulated plastic strain.
      real(wp), intent(in) :: h
      real(wp) :: slope
      type(guess_type) :: guess
      type(factors_type) :: factors

      factors = self%strength%factors(h, 0.0_wp, 0.0_wp)
      factors%friction_slope = 0.0_wp
      call self%project(trial, self%strength%reference, factors, guess%found, guess%is_elastic)
      if (.not. guess%is_elastic) call measure(guess, self%elastic%shear_modulus)
      slope = guess%slope
   end function growth_slope

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
      type(given_type) :: given
      type(guess_type) :: guess
      integer :: j

      new_state = state
      response%has_failed = .not. all(abs(trial) <= huge(trial))
      if (response%has_failed) return
      given = given_type(trial, state(1), self%strength%reference, visit%time_step)
      if (self%n_state > 1) given%strength = state(2)
      call return_at(self, given, given%start, guess)
      if (.not. guess%is_elastic) call harden(self, given, guess, response%has_failed)
      if (response%has_failed) return
      ! after hardening by round-off: it hardens as fast as it would yield
      if (guess%is_elastic) then
         call respond_elastically(self, trial, response)
         return
      end if
      new_state(1) = guess%h
      response%stress = guess%found%stress
      response%strain = trial - guess%found%plastic
      do j = 1, 3
         response%tangent(:, j) = guess%found%tangent(:, j) &
            + guess%found%slope*guess%by_trial(j)/(1.0_wp - guess%slope)
      end do
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

   !> Find h = start + growth(h), to which the return of the guess belongs: Newton's method between
   !> bounds.
   pure subroutine harden(self, given, guess, has_failed)
      class(plastic_law_type), intent(in) :: self
      type(given_type), intent(in) :: given
      !> The return at the start; becomes that at the end.
      type(guess_type), intent(inout) :: guess
      logical, intent(out) :: has_failed
      type(bounds_type) :: bounds
      real(wp) :: excess, h, next
      integer :: k

      has_failed = .false.
      if (self%strength%is_constant) then
         guess%h = given%start + guess%growth
         guess%slope = 0.0_wp
         return
      end if
      bounds = bounds_type(given%start, given%start + 2.0_wp*guess%growth, .false.)
      h = given%start + guess%growth/max(1.0_wp - guess%slope, 0.5_wp)
      do k = 1, most_trials
         call return_at(self, given, h, guess)
         excess = given%start + guess%growth - h
         if (abs(excess) <= tightness*max(maxval(abs(given%trial)), h)) exit
         call narrow(bounds, given%start, h, excess)
         next = h + excess/(1.0_wp - guess%slope)
         if (.not. (guess%slope < 1.0_wp .and. next > bounds%low .and. next < bounds%high) &
             .or. mod(k, bisection) == 0) then
            next = merge(0.5_wp*(bounds%low + bounds%high), bounds%high, bounds%has_high)
         end if
         if (.not. abs(next - h) > 0.0_wp) exit
         h = next
      end do
      has_failed = k > most_trials .or. .not. guess%slope < 1.0_wp
   end subroutine harden

   !> The return to the yield surface that belongs to a value of h.
   pure subroutine return_at(self, given, h, guess)
      class(plastic_law_type), intent(in) :: self
      type(given_type), intent(in) :: given
      real(wp), intent(in) :: h
      type(guess_type), intent(out) :: guess

      guess%h = h
      call self%project(given%trial, given%strength, &
                        self%strength%factors(h, h - given%start, given%time_step), guess%found, &
                        guess%is_elastic)
      if (.not. guess%is_elastic) call measure(guess, self%elastic%shear_modulus)
   end subroutine return_at

   !> Take in a value of h and by how much more it would grow; as long as nothing bounds h from
   !> above, look farther away.
   pure subroutine narrow(bounds, start, h, excess)
      type(bounds_type), intent(inout) :: bounds
      real(wp), intent(in) :: start, h, excess

      if (excess > 0.0_wp) then
         bounds%low = h
         if (bounds%has_high .or. h < bounds%high) return
         bounds%high = start + 2.0_wp*(h - start)
      else
         bounds%high = h
         bounds%has_high = .true.
      end if
   end subroutine narrow

   !> Growth of the accumulated plastic strain, and its derivatives by trial strain and h. The
   !> deviator of the plastic strain is that of trial - stress/(2 G).
   pure subroutine measure(guess, shear_modulus)
      type(guess_type), intent(inout) :: guess
      real(wp), intent(in) :: shear_modulus
      real(wp) :: direction(3)

      associate (found => guess%found)
         direction = found%plastic - sum(found%plastic)/3.0_wp
         guess%growth = sqrt(2.0_wp/3.0_wp*sum(direction**2))
         ! a deviator of round-off has no direction
         if (guess%growth <= round_off*maxval(abs(found%plastic) &
                                              + abs(found%stress)/shear_modulus)) return
         direction = 2.0_wp/3.0_wp*direction/guess%growth
         guess%by_trial = direction - matmul(direction, found%tangent)/(2.0_wp*shear_modulus)
         guess%slope = -dot_product(direction, found%slope)/(2.0_wp*shear_modulus)
      end associate
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
