!> Isotropic Hencky elasticity: Kirchhoff stress linear in the logarithmic strain.
!>
!> Hencky, H. (1928), Z. techn. Phys. 9, 215-220; for soils with large strain: theory, section 1.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_hencky
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_law_abstract, only: law_response_type, law_type, law_visit_type, n_plane
   use coulter_law_parameters, only: check_values, law_model_type, law_values_type
   implicit none(type, external)
   private
   public :: hencky_type, new_hencky, new_hencky_law, hencky_model

   !> tau = lambda tr(eps) 1 + 2 G eps.
   type, extends(law_type) :: hencky_type
      !> First Lame parameter, stress units.
      real(wp) :: lame_lambda = 0.0_wp
      !> Shear modulus, stress units.
      real(wp) :: shear_modulus = 0.0_wp
   contains
      procedure :: update => update_hencky
      procedure :: elastic_moduli => hencky_moduli
      procedure :: elastic_strain => hencky_strain
   end type hencky_type

   !> How decks name it.
   type(law_model_type), parameter :: hencky_model = law_model_type("hencky", &
      "elastic, linear in the logarithmic strain", "youngs_modulus poisson_ratio", "")

contains

   !> Make the law from its parameters.
   pure subroutine new_hencky_law(law, name, values, error)
      !> Law to make.
      type(hencky_type), intent(out) :: law
      !> Name by which bodies refer to it.
      character(len=*), intent(in) :: name
      !> Parameters.
      type(law_values_type), intent(in) :: values
      !> Set when they are missing or out of range.
      type(error_type), allocatable, intent(out) :: error

      call check_values(hencky_model, name, values, error)
      if (allocated(error)) return
      call new_hencky(law, name, values%number("youngs_modulus", 0.0_wp), &
                      values%number("poisson_ratio", 0.0_wp), error)
   end subroutine new_hencky_law

   !> Make the law from engineering constants.
   pure subroutine new_hencky(law, name, youngs_modulus, poisson_ratio, error)
      !> Law to make.
      type(hencky_type), intent(out) :: law
      !> Name by which bodies refer to it.
      character(len=*), intent(in) :: name
      !> Young's modulus E > 0, stress units.
      real(wp), intent(in) :: youngs_modulus
      !> Poisson's ratio, -1 < nu < 0.5.
      real(wp), intent(in) :: poisson_ratio
      !> Set when a constant is out of range.
      type(error_type), allocatable, intent(out) :: error

      if (.not. youngs_modulus > 0.0_wp) then
         call fatal_error(error, "law "//name//": Young's modulus must be positive")
      else if (.not. (poisson_ratio > -1.0_wp .and. poisson_ratio < 0.5_wp)) then
         call fatal_error(error, "law "//name//": Poisson's ratio must lie between -1 and 0.5")
      end if
      if (allocated(error)) return
      law%name = name
      law%shear_modulus = youngs_modulus/(2.0_wp*(1.0_wp + poisson_ratio))
      law%lame_lambda = youngs_modulus*poisson_ratio &
         /((1.0_wp + poisson_ratio)*(1.0_wp - 2.0_wp*poisson_ratio))
   end subroutine new_hencky

   !> See `law_type`; the update of an elastic law is a matrix product.
   pure subroutine update_hencky(self, visit, trial_strain, state, response, new_state)
      class(hencky_type), intent(in) :: self
      !> Of no interest.
      type(law_visit_type), intent(in) :: visit
      !> Logarithmic elastic trial strain.
      real(wp), intent(in) :: trial_strain(n_plane)
      !> State variables: none.
      real(wp), intent(in) :: state(self%n_state)
      !> Kirchhoff stress and elastic stiffness; the strain is the trial strain.
      type(law_response_type), intent(out) :: response
      !> State variables: none.
      real(wp), intent(out) :: new_state(self%n_state)
      integer :: i

      response%has_failed = .false.
      response%tangent = 0.0_wp
      response%tangent(:3, :3) = self%lame_lambda
      do i = 1, 3
         response%tangent(i, i) = self%lame_lambda + 2.0_wp*self%shear_modulus
      end do
      response%tangent(4, 4) = self%shear_modulus
      response%stress(:3) = self%lame_lambda*sum(trial_strain(:3)) &
         + 2.0_wp*self%shear_modulus*trial_strain(:3)
      response%stress(4) = self%shear_modulus*trial_strain(4)
      response%strain = trial_strain
      new_state = state
   end subroutine update_hencky

   !> See `law_type`.
   pure subroutine hencky_moduli(self, stress, state, lame_lambda, shear_modulus)
      class(hencky_type), intent(in) :: self
      !> Of no influence.
      real(wp), intent(in) :: stress(n_plane)
      !> State variables: none.
      real(wp), intent(in) :: state(self%n_state)
      !> First Lame parameter.
      real(wp), intent(out) :: lame_lambda
      !> Shear modulus.
      real(wp), intent(out) :: shear_modulus

      lame_lambda = self%lame_lambda
      shear_modulus = self%shear_modulus
   end subroutine hencky_moduli

   !> See `law_type`: eps = (tau - lambda/(3 lambda + 2 G) tr(tau) 1)/(2 G).
   pure function hencky_strain(self, stress, state) result(strain)
      class(hencky_type), intent(in) :: self
      !> Kirchhoff stress.
      real(wp), intent(in) :: stress(n_plane)
      !> State variables: none.
      real(wp), intent(in) :: state(self%n_state)
      !> Logarithmic elastic strain.
      real(wp) :: strain(n_plane)
      real(wp) :: share

      share = self%lame_lambda/(3.0_wp*self%lame_lambda + 2.0_wp*self%shear_modulus)
      strain(:3) = (stress(:3) - share*sum(stress(:3)))/(2.0_wp*self%shear_modulus)
      strain(4) = stress(4)/self%shear_modulus
   end function hencky_strain

end module coulter_law_hencky
