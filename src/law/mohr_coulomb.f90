!> Mohr-Coulomb plasticity with tension cut-off: cohesion, friction, dilation, hardening.
!>
!> Planes in sorted principal stresses s1 >= s2 >= s3, tension positive:
!> (s1 - s3) + (s1 + s3) sin(phi) <= 2 c cos(phi) and s1 <= tension cut-off, which is at most
!> c cot(phi), the apex. Edges and apex are points where several planes meet: law/planes.
!> Coulomb, C. A. (1776), Mem. Math. Phys. 7, 343-382; return: Clausen, J. et al. (2007), Comput.
!> Struct. 85, 1795-1807.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_mohr_coulomb
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_law_parameters, only: check_values, law_model_type, law_values_type
   use coulter_law_planes, only: planes_type, return_to_planes, return_type
   use coulter_law_plastic, only: new_plastic_law, plastic_law_type
   use coulter_law_strength, only: factors_type, strength_parameters
   implicit none(type, external)
   private
   public :: mohr_coulomb_type, new_mohr_coulomb, mohr_coulomb_model, set_angles

   !> Strength is the cohesion. Without friction: Tresca.
   type, extends(plastic_law_type) :: mohr_coulomb_type
      !> Tangents of friction and dilation angle.
      real(wp) :: friction = 0.0_wp, dilation = 0.0_wp
      !> Largest tensile stress, stress units; it follows the factors on the strength.
      real(wp) :: tension_cutoff = huge(1.0_wp)
   contains
      procedure :: project => project_mohr_coulomb
   end type mohr_coulomb_type

   !> How decks name it.
   type(law_model_type), parameter :: mohr_coulomb_model = law_model_type("mohr_coulomb", &
      "cohesion and friction, exact edges and apex", &
      "youngs_modulus poisson_ratio cohesion friction_angle", &
      "dilation_angle tension_cutoff friction_factor "//strength_parameters)

   real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp
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

      call check_values(mohr_coulomb_model, name, values, error)
      if (allocated(error)) return
      call new_plastic_law(law, name, "cohesion", values, error)
      if (allocated(error)) return
      call set_angles(name, values, law%friction, law%dilation, error)
      if (allocated(error)) return
      law%tension_cutoff = values%number("tension_cutoff", huge(1.0_wp))
      law%is_symmetric = abs(law%friction - law%dilation) <= 0.0_wp .and. law%strength%is_constant
   end subroutine new_mohr_coulomb

   !> Tangents of friction and dilation angle.
   pure subroutine set_angles(name, values, friction, dilation, error)
      !> Name of the law, for messages.
      character(len=*), intent(in) :: name
      !> Parameters.
      type(law_values_type), intent(in) :: values
      !> Tangents.
      real(wp), intent(out) :: friction, dilation
      !> Set when there is more dilation than friction, which would make energy, or no strength.
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: angle

      angle = values%number("friction_angle", 0.0_wp)
      friction = tan(angle*degree)
      dilation = tan(values%number("dilation_angle", 0.0_wp)*degree)
      if (dilation > friction) then
         call fatal_error(error, "law "//name//": dilation_angle must not exceed friction_angle")
      else if (.not. (angle > 0.0_wp .or. values%number("cohesion", 1.0_wp) > 0.0_wp)) then
         call fatal_error(error, "law "//name//": cohesion and friction_angle must not both be 0")
      end if
   end subroutine set_angles

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
         call return_to_planes(3, 6, stiffness, stress, planes, all_sets, found)
      else
         call return_to_planes(3, 3, stiffness, stress, planes, shear_sets, found)
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
      logical, intent(out) :: has_tension
      real(wp) :: friction(2), dilation(2), cosine, cutoff(2)
      integer :: i

      friction = sine(self%friction)
      dilation = sine(self%dilation)
      cosine = sqrt(1.0_wp - friction(1)**2)
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
      planes%offset(:3) = 2.0_wp*strength*factors%strength*cosine
      planes%offset_slope(:3) = 2.0_wp*strength*(factors%strength_slope*cosine &
         - factors%strength*friction(1)/cosine*friction(2))
      has_tension = friction(1) > 0.0_wp .or. self%tension_cutoff < huge(1.0_wp)
      if (.not. has_tension) return
      cutoff = huge(1.0_wp)
      if (friction(1) > 0.0_wp) then
         cutoff(1) = strength*factors%strength*cosine/friction(1)
         cutoff(2) = strength*(factors%strength_slope*cosine/friction(1) &
            - factors%strength*friction(2)/(friction(1)**2*cosine))
      end if
      if (self%tension_cutoff < huge(1.0_wp)) then
         if (self%tension_cutoff*factors%strength < cutoff(1)) then
            cutoff = self%tension_cutoff*[factors%strength, factors%strength_slope]
         end if
      end if
      planes%offset(4:) = cutoff(1)
      planes%offset_slope(4:) = cutoff(2)

   contains

      !> Sine of an angle whose tangent follows the factor, and its slope.
      pure function sine(tangent)
         real(wp), intent(in) :: tangent
         real(wp) :: sine(2)
         real(wp) :: secant

         secant = sqrt(1.0_wp + (tangent*factors%friction)**2)
         sine = [tangent*factors%friction/secant, tangent*factors%friction_slope/secant**3]
      end function sine

   end subroutine set_planes

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
