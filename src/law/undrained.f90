!> Undrained soil by effective stress: any law of the skeleton, and water that follows its volume.
!>
!> Water that cannot flow out is strained like the soil: its pressure grows by the bulk modulus K_w
!> of the water over the porosity, p_w = -K_w ln J, and the total stress is tau = tau' - p_w 1
!> (Naylor, D. J. (1974), Int. J. Numer. Methods Eng. 8, 443-460).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_undrained
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_law_abstract, only: law_item_type, law_response_type, law_type, law_variable_type, &
      law_visit_type, n_plane
   implicit none(type, external)
   private
   public :: make_undrained

   !> A law around another. State: ln J minus the trace of the elastic strain, and the excess pore
   !> pressure; then that of the skeleton.
   type, extends(law_type) :: undrained_type
      !> Law of the skeleton, in effective stress.
      class(law_type), allocatable :: skeleton
      !> Bulk modulus of the water over the porosity, stress units.
      real(wp) :: bulk_modulus = 0.0_wp
   contains
      procedure :: update => update_undrained
      procedure :: elastic_moduli => undrained_moduli
      procedure :: elastic_strain => undrained_strain
      procedure :: initial_state => undrained_initial_state
      procedure :: spatial_moduli => undrained_spatial_moduli
   end type undrained_type

   !> State variables of the water, before those of the skeleton.
   integer, parameter :: n_water = 2

contains

   !> Fill the pores of a law with water.
   subroutine make_undrained(item, bulk_modulus, error)
      !> Law of the skeleton; becomes the law of both.
      type(law_item_type), intent(inout) :: item
      !> Bulk modulus of the water over the porosity, stress units.
      real(wp), intent(in) :: bulk_modulus
      !> Set when this cannot be.
      type(error_type), allocatable, intent(out) :: error
      type(undrained_type), allocatable :: law

      if (.not. bulk_modulus > 0.0_wp) then
         call fatal_error(error, "law "//item%law%name//": the bulk modulus of the water must be" &
                          //" positive")
         return
      end if
      allocate (law)
      call move_alloc(item%law, law%skeleton)
      associate (skeleton => law%skeleton)
         law%name = skeleton%name
         law%n_state = skeleton%n_state + n_water
         law%is_symmetric = skeleton%is_symmetric
         law%is_elastic = skeleton%is_elastic
         law%is_incremental = skeleton%is_incremental
         law%needs_sites = skeleton%needs_sites
      end associate
      call name_variables(law)
      law%bulk_modulus = bulk_modulus
      call move_alloc(law, item%law)
   end subroutine make_undrained

   !> Say what the state variables are that results keep: they come first.
   pure subroutine name_variables(law)
      type(undrained_type), intent(inout) :: law
      integer :: n

      n = 0
      if (allocated(law%skeleton%variables)) n = size(law%skeleton%variables)
      allocate (law%variables(n_water + n))
      law%variables(1) = law_variable_type( &
         "inelastic_volume", "1", "ln J minus the trace of the elastic strain")
      law%variables(2) = law_variable_type( &
         "excess_pore_pressure", "stress", "excess pore pressure, positive in compression")
      if (n > 0) law%variables(n_water + 1:) = law%skeleton%variables
   end subroutine name_variables

   !> See `law_type`: the skeleton takes the strain, the water its trace.
   subroutine update_undrained(self, visit, trial_strain, state, response, new_state)
      class(undrained_type), intent(in) :: self
      !> Where and when.
      type(law_visit_type), intent(in) :: visit
      !> Logarithmic elastic trial strain.
      real(wp), intent(in) :: trial_strain(n_plane)
      !> State variables at the start of the step.
      real(wp), intent(in) :: state(self%n_state)
      !> Total Kirchhoff stress and its tangent; elastic strain of the skeleton.
      type(law_response_type), intent(out) :: response
      !> State variables at the end of the step.
      real(wp), intent(out) :: new_state(self%n_state)
      real(wp) :: volume

      call self%skeleton%update(visit, trial_strain, state(n_water + 1:), response, &
                                new_state(n_water + 1:))
      if (response%has_failed) return
      volume = sum(trial_strain(:3)) + state(1)
      new_state(1) = volume - sum(response%strain(:3))
      new_state(2) = -self%bulk_modulus*volume
      response%stress(:3) = response%stress(:3) + self%bulk_modulus*volume
      response%tangent(:3, :3) = response%tangent(:3, :3) + self%bulk_modulus
   end subroutine update_undrained

   !> See `law_type`: moduli of soil and water together.
   pure subroutine undrained_moduli(self, stress, state, lame_lambda, shear_modulus)
      class(undrained_type), intent(in) :: self
      !> Total Kirchhoff stress.
      real(wp), intent(in) :: stress(n_plane)
      !> State variables.
      real(wp), intent(in) :: state(self%n_state)
      !> First Lame parameter.
      real(wp), intent(out) :: lame_lambda
      !> Shear modulus.
      real(wp), intent(out) :: shear_modulus

      call self%skeleton%elastic_moduli(effective(stress, state(2)), state(n_water + 1:), &
                                        lame_lambda, shear_modulus)
      lame_lambda = lame_lambda + self%bulk_modulus
   end subroutine undrained_moduli

   !> See `law_type`: the skeleton alone has elastic strain.
   pure function undrained_strain(self, stress, state) result(strain)
      class(undrained_type), intent(in) :: self
      !> Total Kirchhoff stress.
      real(wp), intent(in) :: stress(n_plane)
      !> State variables.
      real(wp), intent(in) :: state(self%n_state)
      !> Logarithmic elastic strain.
      real(wp) :: strain(n_plane)

      strain = self%skeleton%elastic_strain(effective(stress, state(2)), state(n_water + 1:))
   end function undrained_strain

   !> See `law_type`: no excess pressure, so that the stress at the start is effective.
   subroutine undrained_initial_state(self, stress, position, state)
      class(undrained_type), intent(in) :: self
      !> Effective stress at the start.
      real(wp), intent(in) :: stress(n_plane)
      !> Position at the start.
      real(wp), intent(in) :: position(2)
      !> State variables.
      real(wp), intent(out) :: state(self%n_state)
      real(wp) :: strain(n_plane)

      call self%skeleton%initial_state(stress, position, state(n_water + 1:))
      strain = self%skeleton%elastic_strain(stress, state(n_water + 1:))
      state(1) = -sum(strain(:3))
      state(2) = 0.0_wp
   end subroutine undrained_initial_state

   !> See `law_type`: pressure does not turn, so that water changes nothing.
   pure subroutine undrained_spatial_moduli(self, finger, strain, response, moduli)
      class(undrained_type), intent(in) :: self
      !> Elastic trial left Cauchy-Green tensor.
      real(wp), intent(in) :: finger(4)
      !> Its logarithmic strain.
      real(wp), intent(in) :: strain(n_plane)
      !> Total stress and tangent.
      type(law_response_type), intent(in) :: response
      !> Moduli A_ijkl.
      real(wp), intent(out) :: moduli(2, 2, 2, 2)

      call self%skeleton%spatial_moduli(finger, strain, response, moduli)
   end subroutine undrained_spatial_moduli

   !> Effective stress.
   pure function effective(stress, pore_pressure)
      real(wp), intent(in) :: stress(n_plane), pore_pressure
      real(wp) :: effective(n_plane)

      effective(:3) = stress(:3) + pore_pressure
      effective(4) = stress(4)
   end function effective

end module coulter_law_undrained
