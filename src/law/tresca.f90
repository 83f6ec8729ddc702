!> Tresca plasticity for undrained clay: half the difference of the outer principal stresses is at
!> most the shear strength.
!>
!> It is Mohr-Coulomb without friction. Tresca, H. (1864), C. R. Acad. Sci. Paris 59, 754-758.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_tresca
   use coulter_base_error, only: error_type
   use coulter_law_mohr_coulomb, only: mohr_coulomb_type
   use coulter_law_parameters, only: law_model_type, law_values_type
   use coulter_law_plastic, only: new_plastic_law
   use coulter_law_softening, only: check_softening
   use coulter_law_strength, only: strength_parameters
   implicit none(type, external)
   private
   public :: new_tresca, tresca_model

   !> How decks name it.
   type(law_model_type), parameter :: tresca_model = law_model_type("tresca", &
      "undrained clay: largest shear stress", "youngs_modulus poisson_ratio shear_strength", &
      "tension_cutoff "//strength_parameters)

contains

   !> Make the law.
   pure subroutine new_tresca(law, name, values, error)
      !> Law to make.
      type(mohr_coulomb_type), intent(out) :: law
      !> Name by which bodies refer to it.
      character(len=*), intent(in) :: name
      !> Parameters.
      type(law_values_type), intent(in) :: values
      !> Set when they are missing, out of range or contradict each other.
      type(error_type), allocatable, intent(out) :: error

      call new_plastic_law(law, tresca_model, name, "shear_strength", values, error)
      if (allocated(error)) return
      ! at edges the plastic strain does not grow like the multipliers
      law%is_symmetric = law%is_associated()
      call check_softening(law, error)
   end subroutine new_tresca

end module coulter_law_tresca
