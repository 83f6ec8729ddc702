!> How the strength of a point grows and shrinks: with depth, plastic strain and strain rate.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_strength
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_base_table, only: is_increasing
   use coulter_law_parameters, only: law_values_type
   implicit none(type, external)
   private
   public :: strength_type, factors_type, strength_parameters, new_strength

   !> Strength of a law; every table holds at least one value.
   type :: strength_type
      !> Strength at the datum and above, stress units.
      real(wp) :: reference = 0.0_wp
      !> Its increase with depth, stress per length, and the level where that begins.
      real(wp) :: gradient = 0.0_wp, datum = 0.0_wp
      !> Accumulated plastic strains, increasing, and the factors there: linear between, constant
      !> beyond; shape (n).
      real(wp), allocatable :: strain(:), strength_factor(:), friction_factor(:)
      !> Increase per decade of strain rate, and the rate above which it acts, per time.
      real(wp) :: rate_factor = 0.0_wp, reference_rate = 1.0_wp
      !> Does the strength change within a step?
      logical :: is_constant = .true.
   contains
      procedure :: at_position
      procedure :: factors
   end type strength_type

   !> Factors at an accumulated plastic strain, and their slopes.
   type :: factors_type
      !> Factor on the strength.
      real(wp) :: strength = 1.0_wp, strength_slope = 0.0_wp
      !> Factor on the tangents of friction and dilation angle.
      real(wp) :: friction = 1.0_wp, friction_slope = 0.0_wp
   end type factors_type

   !> Parameters that describe these, but for the strength itself and `friction_factor`.
   character(len=*), parameter :: strength_parameters = "strength_gradient strength_datum" &
      //" plastic_strain strength_factor rate_factor reference_rate"

contains

   !> Make it from the parameters of a law.
   pure subroutine new_strength(strength, name, reference, values, error)
      !> Strength to make.
      type(strength_type), intent(out) :: strength
      !> Name of the law, for messages.
      character(len=*), intent(in) :: name
      !> Strength at the datum, stress units.
      real(wp), intent(in) :: reference
      !> Parameters, each in its range.
      type(law_values_type), intent(in) :: values
      !> Set when they contradict each other.
      type(error_type), allocatable, intent(out) :: error
      integer :: n

      strength%reference = reference
      strength%gradient = values%number("strength_gradient", 0.0_wp)
      strength%datum = values%number("strength_datum", 0.0_wp)
      strength%rate_factor = values%number("rate_factor", 0.0_wp)
      strength%reference_rate = values%number("reference_rate", 1.0_wp)
      strength%strain = values%list("plastic_strain")
      strength%strength_factor = values%list("strength_factor")
      strength%friction_factor = values%list("friction_factor")
      n = size(strength%strain)
      if (n == 0) strength%strain = [0.0_wp]
      if (.not. (any(size(strength%strength_factor) == [0, n]) &
                 .and. any(size(strength%friction_factor) == [0, n]))) then
         call fatal_error(error, "law "//name//": strength_factor and friction_factor need as" &
                          //" many values as plastic_strain")
      else if (.not. is_increasing(strength%strain)) then
         call fatal_error(error, "law "//name//": plastic_strain must increase")
      end if
      call complete(strength%strength_factor, size(strength%strain))
      call complete(strength%friction_factor, size(strength%strain))
      strength%is_constant = n == 0 .and. .not. strength%rate_factor > 0.0_wp
   end subroutine new_strength

   !> Factors that are not given are 1.
   pure subroutine complete(factor, n)
      real(wp), allocatable, intent(inout) :: factor(:)
      integer, intent(in) :: n

      if (size(factor) == 0) factor = spread(1.0_wp, 1, n)
   end subroutine complete

   !> Strength at a place, before any plastic strain.
   elemental function at_position(self, level) result(value)
      class(strength_type), intent(in) :: self
      !> Coordinate y, length units.
      real(wp), intent(in) :: level
      real(wp) :: value

      value = self%reference + self%gradient*max(self%datum - level, 0.0_wp)
   end function at_position

   !> Factors at the end of a step. Rate: 1 + mu log10(rate/reference) above the reference (Einav,
   !> I. and Randolph, M. F. (2005), Int. J. Numer. Methods Eng. 63, 1991-2016).
   pure function factors(self, plastic_strain, growth, time_step)
      class(strength_type), intent(in) :: self
      !> Accumulated plastic strain at the end of the step.
      real(wp), intent(in) :: plastic_strain
      !> How much of it the step brings.
      real(wp), intent(in) :: growth
      !> Length of the step; 0: no influence of the rate.
      real(wp), intent(in) :: time_step
      type(factors_type) :: factors
      real(wp) :: rate, share
      integer :: i, n

      n = size(self%strain)
      i = max(min(count(self%strain <= plastic_strain), n - 1), 1)
      if (n > 1) then
         share = (plastic_strain - self%strain(i))/(self%strain(i + 1) - self%strain(i))
         call interpolate(self%strength_factor, factors%strength, factors%strength_slope)
         call interpolate(self%friction_factor, factors%friction, factors%friction_slope)
      else
         factors%strength = self%strength_factor(1)
         factors%friction = self%friction_factor(1)
      end if
      if (.not. (self%rate_factor > 0.0_wp .and. time_step > 0.0_wp)) return
      if (growth <= self%reference_rate*time_step) return
      rate = 1.0_wp + self%rate_factor*log10(growth/(self%reference_rate*time_step))
      factors%strength_slope = rate*factors%strength_slope &
         + factors%strength*self%rate_factor/(growth*log(10.0_wp))
      factors%strength = rate*factors%strength

   contains

      pure subroutine interpolate(table, value, slope)
         real(wp), intent(in) :: table(:)
         real(wp), intent(out) :: value, slope

         value = table(i) + min(max(share, 0.0_wp), 1.0_wp)*(table(i + 1) - table(i))
         slope = 0.0_wp
         if (share < 0.0_wp .or. share >= 1.0_wp) return
         slope = (table(i + 1) - table(i))/(self%strain(i + 1) - self%strain(i))
      end subroutine interpolate

   end function factors

end module coulter_law_strength
