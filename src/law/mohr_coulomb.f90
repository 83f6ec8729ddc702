!> Mohr-Coulomb plasticity with tension cut-off: cohesion, friction, dilation, hardening.
!>
!> Planes in sorted principal stresses s1 >= s2 >= s3, tension positive:
!> (s1 - s3) + (s1 + s3) sin(phi) <= 2 c cos(phi) and s1 <= tension cut-off, which is at most
!> c cot(phi), the apex. Edges and apex are points where several planes meet: law/planes.
!> Coulomb, C. A. (1776), Mem. Math. Phys. 7, 343-382; return: Clausen, J. et al. (2007), Comput.
!> Struct. 85, 1795-1807.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_mohr_coulomb
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: wp
   use coulter_law_parameters, only: law_model_type, law_values_type
   use coulter_law_planes, only: planes_type, return_to_planes, return_type
   use coulter_law_plastic, only: new_plastic_law, plastic_law_type, quotient
   use coulter_law_softening, only: check_softening
   use coulter_law_strength, only: factors_type, strength_parameters
   implicit none(type, external)
   private
   public :: mohr_coulomb_type, new_mohr_coulomb, mohr_coulomb_model

   !> Strength is the cohesion. Without friction: Tresca.
   type, extends(plastic_law_type) :: mohr_coulomb_type
   contains
      procedure :: project => project_mohr_coulomb
   end type mohr_coulomb_type

   !> How decks name it.
   type(law_model_type), parameter :: mohr_coulomb_model = law_model_type("mohr_coulomb", &
      "cohesion and friction, exact edges and apex", &
      "youngs_modulus poisson_ratio cohesion friction_angle", &
      "dilation_angle tension_cutoff friction_factor "//strength_parameters)

   !> Planes by the principal stresses that they bound: 1-3, 1-2, 2-3, then 1, 2, 3 alone.
   integer, parameter :: larger(3) = [1, 1, 2], smaller(3) = [3, 2, 3]
   !> Sets of planes that can be active together, without and with tension.
   integer, parameter :: shear_sets(3, 3) = reshape([1, 0, 0, 1, 2, 0, 1, 3, 0], [3, 3])
   integer, parameter :: all_sets(3, 13) = reshape([1, 0, 0, 1, 2, 0, 1, 3, 0, 4, 0, 0, 1, 4, 0, &
      4, 5, 0, 4, 5, 6, 1, 2, 4, 1, 4, 5, 1, 3, 4, 1, 3, 5, 1, 2, 3, 1, 5, 6], [3, 13])

contains

   !> Make the law.
   pure subroutine new_mohr_coulomb(law, name, values, error)
      !> Law to make.
      type(mohr_coulomb_type), intent(out) :: law
      !> Name by which bodies refer to it.
      character(len=*), intent(in) :: name
      !> Parameters.
      type(law_values_type), intent(in) :: values
      !> Set when they are missing, out of range or contradict each other.
      type(error_type), allocatable, intent(out) :: error

      call new_plastic_law(law, mohr_coulomb_model, name, "cohesion", values, error)
      if (allocated(error)) return
      law%is_symmetric = law%is_associated()
      call check_softening(law, error)
   end subroutine new_mohr_coulomb

   !> See `project_interface`.
   pure subroutine project_mohr_coulomb(self, trial, strength, factors, found, is_elastic)
      class(mohr_coulomb_type), intent(in) :: self
      !> Principal elastic trial strains.
      real(wp), intent(in) :: trial(3)
      !> Cohesion before plastic strain.
      real(wp), intent(in) :: strength
      !> Factors on cohesion and on the tangents of the angles.
      type(factors_type), intent(in) :: factors
      !> The answer.
      type(return_type), intent(out) :: found
      !> Is the trial state elastic?
      logical, intent(out) :: is_elastic
      type(planes_type) :: planes
      real(wp) :: stress(3), stiffness(3, 3)
      integer :: order(3), i
      logical :: has_tension

      order = descending(trial)
      stiffness = self%elastic%lame_lambda
      do i = 1, 3
         stiffness(i, i) = self%elastic%lame_lambda + 2.0_wp*self%elastic%shear_modulus
      end do
      stress = self%elastic%lame_lambda*sum(trial) &
         + 2.0_wp*self%elastic%shear_modulus*trial(order)
      call set_planes(self, strength, factors, planes, has_tension)
      is_elastic = dot_product(planes%normal(:, 1), stress) <= planes%offset(1)
      if (has_tension) is_elastic = is_elastic .and. stress(1) <= planes%offset(4)
      if (is_elastic) return
      if (has_tension) then
         call return_to_planes(stiffness, stress, planes, all_sets, found)
      else
         call return_to_planes(stiffness, stress, planes, shear_sets, found)
      end if
      found%stress(order) = found%stress
      found%plastic(order) = found%plastic
      found%slope(order) = found%slope
      found%tangent(order, order) = found%tangent
   end subroutine project_mohr_coulomb

   !> Planes for given factors.
   pure subroutine set_planes(self, strength, factors, planes, has_tension)
      type(mohr_coulomb_type), intent(in) :: self
      real(wp), intent(in) :: strength
      type(factors_type), intent(in) :: factors
      type(planes_type), intent(out) :: planes
      !> Are planes 4 to 6 needed?
      logical, intent(out) :: has_tension
      real(wp) :: friction(2), dilation(2), cohesion(2), limit(2), cosine
      integer :: i

      friction = sine(self%friction, factors)
      dilation = sine(self%dilation, factors)
      do i = 1, 3
         planes%normal(larger(i), i) = 1.0_wp + friction(1)
         planes%normal(smaller(i), i) = friction(1) - 1.0_wp
         planes%normal_slope([larger(i), smaller(i)], i) = friction(2)
         planes%flow(larger(i), i) = 1.0_wp + dilation(1)
         planes%flow(smaller(i), i) = dilation(1) - 1.0_wp
         planes%flow_slope([larger(i), smaller(i)], i) = dilation(2)
         planes%normal(i, i + 3) = 1.0_wp
         planes%flow(i, i + 3) = 1.0_wp
      end do
      ! c cos(phi) and its slope
      cosine = sqrt(1.0_wp - friction(1)**2)
      cohesion = strength*[factors%strength*cosine, factors%strength_slope*cosine &
                           - factors%strength*friction(1)/cosine*friction(2)]
      planes%offset(:3) = 2.0_wp*cohesion(1)
      planes%offset_slope(:3) = 2.0_wp*cohesion(2)
      has_tension = friction(1) > 0.0_wp .or. self%tension_cutoff < huge(1.0_wp)
      planes%n = merge(6, 3, has_tension)
      if (.not. has_tension) return
      limit = huge(1.0_wp)
      if (friction(1) > 0.0_wp) limit = quotient(cohesion, friction)
      limit = self%tension_limit(limit, factors)
      planes%offset(4:) = limit(1)
      planes%offset_slope(4:) = limit(2)
   end subroutine set_planes

   !> Sine of an angle whose tangent follows the factor, and its slope.
   pure function sine(tangent, factors)
      real(wp), intent(in) :: tangent
      type(factors_type), intent(in) :: factors
      real(wp) :: sine(2)
      real(wp) :: secant

      secant = sqrt(1.0_wp + (tangent*factors%friction)**2)
      sine = [tangent*factors%friction/secant, tangent*factors%friction_slope/secant**3]
   end function sine

   !> Order in which three numbers do not increase.
   pure function descending(values) result(order)
      real(wp), intent(in) :: values(3)
      integer :: order(3)

      order = [1, 2, 3]
      if (values(2) > values(1)) order(:2) = order([2, 1])
      if (values(3) > values(order(2))) order(2:) = order([3, 2])
      if (values(order(2)) > values(order(1))) order(:2) = order([2, 1])
   end function descending

end module coulter_law_mohr_coulomb
