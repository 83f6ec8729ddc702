!> Von Mises plasticity for undrained clay: the equivalent stress is at most the yield stress.
!>
!> It is Drucker-Prager without friction. In plane strain a yield stress of sqrt(3) times the shear
!> strength gives the collapse loads of Tresca. Mises, R. von (1913), Nachr. Ges. Wiss. Goettingen,
!> 582-592; return: Simo, J. C. and Hughes, T. J. R. (1998), Computational Inelasticity, chapter 3.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_von_mises
   use coulter_base_error, only: error_type
   use coulter_law_drucker_prager, only: drucker_prager_type
   use coulter_law_parameters, only: law_model_type, law_values_type
   use coulter_law_plastic, only: new_plastic_law
   use coulter_law_softening, only: check_softening
   use coulter_law_strength, only: strength_parameters
   implicit none(type, external)
   private
   public :: new_von_mises, von_mises_model

   !> How decks name it.
   type(law_model_type), parameter :: von_mises_model = law_model_type("von_mises", &
      "undrained clay or metal: largest equivalent stress", &
      "youngs_modulus poisson_ratio yield_stress", strength_parameters)

contains

   !> Make the law.
   pure subroutine new_von_mises(law, name, values, error)
      !> Law to make.
      type(drucker_prager_type), intent(out) :: law
      !> Name by which bodies refer to it.
      character(len=*), intent(in) :: name
      !> Parameters.
      type(law_values_type), intent(in) :: values
      !> Set when they are missing, out of range or contradict each other.
      type(error_type), allocatable, intent(out) :: error

      call new_plastic_law(law, von_mises_model, name, "yield_stress", values, error)
      if (.not. allocated(error)) call check_softening(law, error)
   end subroutine new_von_mises

end module coulter_law_von_mises
