!> What every constitutive law offers to the method: strain in, stress and tangent out.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_abstract
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: law_type, law_item_type, n_plane

   !> Components of a symmetric tensor in plane strain and axisymmetry: xx, yy, zz, xy.
   integer, parameter :: n_plane = 4

   !> A law relates the logarithmic elastic strain to the Kirchhoff stress, so that small-strain
   !> return mapping carries over to finite strain unchanged (theory, section 1).
   type, abstract :: law_type
      !> Name by which bodies refer to the law.
      character(len=:), allocatable :: name
      !> Number of state variables per point.
      integer :: n_state = 0
      !> Is the algorithmic tangent symmetric (elastic and associated laws)?
      logical :: is_symmetric = .true.
      !> Is the law elastic, so that the elastic strain always equals the trial strain?
      logical :: is_elastic = .true.
   contains
      procedure(update_interface), deferred :: update
      procedure(moduli_interface), deferred :: elastic_moduli
      procedure(strain_interface), deferred :: elastic_strain
   end type law_type

   !> A law of any kind, to be kept in arrays.
   type :: law_item_type
      !> The law.
      class(law_type), allocatable :: law
   end type law_item_type

   abstract interface
      !> Stress at the end of a strain increment, and its consistent tangent.
      pure subroutine update_interface(self, trial_strain, state, stress, tangent, strain, &
                                       new_state, has_failed)
         import :: law_type, n_plane, wp
         implicit none (type, external)
         class(law_type), intent(in) :: self
         !> Logarithmic elastic trial strain: xx, yy, zz and engineering shear 2 xy.
         real(wp), intent(in) :: trial_strain(n_plane)
         !> State variables at the start of the step.
         real(wp), intent(in) :: state(self%n_state)
         !> Kirchhoff stress xx, yy, zz, xy, tension positive.
         real(wp), intent(out) :: stress(n_plane)
         !> Algorithmic tangent, d stress(i) / d trial_strain(j).
         real(wp), intent(out) :: tangent(n_plane, n_plane)
         !> Logarithmic elastic strain after return mapping, components as `trial_strain`.
         real(wp), intent(out) :: strain(n_plane)
         !> State variables at the end of the step.
         real(wp), intent(out) :: new_state(self%n_state)
         !> Did the update fail? The step is then repeated with half its size.
         logical, intent(out) :: has_failed
      end subroutine update_interface

      !> Elastic moduli that scale boundary penalties; constant during a step.
      pure subroutine moduli_interface(self, lame_lambda, shear_modulus)
         import :: law_type, wp
         implicit none (type, external)
         class(law_type), intent(in) :: self
         !> First Lame parameter, stress units.
         real(wp), intent(out) :: lame_lambda
         !> Shear modulus, stress units.
         real(wp), intent(out) :: shear_modulus
      end subroutine moduli_interface

      !> Logarithmic elastic strain that carries a given stress, for bodies with initial stress.
      pure function strain_interface(self, stress) result(strain)
         import :: law_type, n_plane, wp
         implicit none (type, external)
         class(law_type), intent(in) :: self
         !> Kirchhoff stress xx, yy, zz, xy.
         real(wp), intent(in) :: stress(n_plane)
         !> Elastic strain xx, yy, zz, 2 xy.
         real(wp) :: strain(n_plane)
      end function strain_interface
   end interface

end module coulter_law_abstract
