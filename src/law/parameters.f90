!> Parameters of all laws: names, units, ranges and meaning, and the values that a law is given.
!>
!> A parameter means the same in every law that takes it. The schema of decks is made from this
!> table (deck/schema).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_parameters
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_base_range, only: is_in_range
   use coulter_base_text, only: to_text
   implicit none(type, external)
   private
   public :: law_parameter_type, law_model_type, law_values_type, law_parameters, check_values
   public :: has_word

   !> What a parameter is.
   type :: law_parameter_type
      !> Name, lower case.
      character(len=21) :: name
      !> Least and largest number of values.
      integer :: least, most
      !> Unit; empty for a pure number.
      character(len=13) :: unit
      !> Value when none is given, as written in a deck, or a remark in parentheses.
      character(len=20) :: default
      !> Conditions such as "> 0 <= 1"; empty if all is allowed.
      character(len=36) :: range
      !> What it means.
      character(len=110) :: meaning
   end type law_parameter_type

   !> A kind of law and its parameters.
   type :: law_model_type
      !> Word that names it in a deck.
      character(len=16) :: word
      !> What it is.
      character(len=110) :: meaning
      !> Names of the parameters that it needs, and of those that it takes, with blanks between.
      character(len=150) :: needs, takes
   end type law_model_type

   !> Values of parameters by name.
   type :: law_values_type
      private
      character(len=21), allocatable :: names(:)
      integer, allocatable :: owner(:)
      real(wp), allocatable :: values(:)
   contains
      procedure :: set
      procedure :: has
      procedure :: number
      procedure :: list
   end type law_values_type

   !> All parameters.
   type(law_parameter_type), parameter :: law_parameters(*) = [ &
      law_parameter_type("youngs_modulus", 1, 1, "stress", "(by model)", "> 0", &
         "Young's modulus; umat: of penalties and hourglass control, if not that of the library"), &
      law_parameter_type("poisson_ratio", 1, 1, "", "(by model)", "> -1 < 0.5", &
         "Poisson's ratio; umat: beside youngs_modulus"), &
      law_parameter_type("bulk_number", 1, 1, "", "(by model)", "> 0", &
         "bulk modulus over the reference pressure, at that pressure; 1/kappa for exponent 1"), &
      law_parameter_type("shear_number", 1, 1, "", "(by model)", "> 0", &
         "shear modulus over the reference pressure, at that pressure"), &
      law_parameter_type("stiffness_exponent", 1, 1, "", "0.5", ">= 0 <= 1", &
         "moduli grow with this power of the pressure"), &
      law_parameter_type("reference_pressure", 1, 1, "stress", "(by model)", "> 0", &
         "pressure at which the moduli are given"), &
      law_parameter_type("pressure_shift", 1, 1, "stress", "(by model)", "> 0", &
         "added to the pressure in the moduli, so that there is stiffness without stress"), &
      law_parameter_type("yield_stress", 1, 1, "stress", "(by model)", "> 0", &
         "strength in uniaxial tension"), &
      law_parameter_type("shear_strength", 1, 1, "stress", "(by model)", "> 0", &
         "undrained shear strength, half the largest difference of principal stresses"), &
      law_parameter_type("cohesion", 1, 1, "stress", "(by model)", ">= 0", &
         "shear strength without normal stress"), &
      law_parameter_type("friction_angle", 1, 1, "degrees", "(by model)", ">= 0 < 90", &
         "angle of internal friction"), &
      law_parameter_type("dilation_angle", 1, 1, "degrees", "0.0", ">= 0 < 90", &
         "angle of dilation, at most that of friction"), &
      law_parameter_type("cone", 1, 1, "", "0", ">= -1 <= 1", &
         "fit to Mohr-Coulomb: 1 in triaxial compression, -1 in extension, 0 in plane strain"), &
      law_parameter_type("tension_cutoff", 1, 1, "stress", "(none)", ">= 0", &
         "largest principal (drucker_prager: mean) stress in tension"), &
      law_parameter_type("strength_gradient", 1, 1, "stress/length", "0.0", ">= 0", &
         "increase of the strength (yield stress, shear strength, cohesion) with depth"), &
      law_parameter_type("strength_datum", 1, 1, "length", "0.0", "", &
         "level y from which on downwards the strength increases"), &
      law_parameter_type("plastic_strain", 1, 100, "", "(none)", ">= 0", &
         "accumulated plastic strains, increasing, at which the factors below hold"), &
      law_parameter_type("strength_factor", 1, 100, "", "1.0", ">= 0", &
         "factors on the strength at these strains: hardening; softening slower than unloading"), &
      law_parameter_type("friction_factor", 1, 100, "", "1.0", ">= 0", &
         "factors on the tangents of friction and dilation angle at these strains"), &
      law_parameter_type("rate_factor", 1, 1, "", "0.0", ">= 0", &
         "increase of the strength per decade of strain rate above the reference, as a share"), &
      law_parameter_type("reference_rate", 1, 1, "1/time", "1.0", "> 0", &
         "plastic strain rate above which the strength increases"), &
      law_parameter_type("compression_index", 1, 1, "", "(by model)", "> 0", &
         "lambda: slope of virgin compression, logarithmic volume strain over ln p"), &
      law_parameter_type("swelling_index", 1, 1, "", "(by model)", "> 0", &
         "kappa: slope of unloading, logarithmic volume strain over ln p"), &
      law_parameter_type("shear_ratio", 1, 1, "", "(by model)", "> 0", &
         "shear modulus over pressure"), &
      law_parameter_type("critical_ratio", 1, 1, "", "(by model)", "> 0", &
         "M: ratio q/p at the critical state"), &
      law_parameter_type("overconsolidation", 1, 1, "", "1.0", ">= 1", &
         "preconsolidation pressure over that of the yield surface through the initial stress")]

contains

   !> Is a word in a text of words with blanks between?
   elemental function has_word(text, word) result(answer)
      !> Text to search.
      character(len=*), intent(in) :: text
      !> Word to find.
      character(len=*), intent(in) :: word
      logical :: answer

      answer = index(" "//text//" ", " "//trim(word)//" ") > 0
   end function has_word

   !> Give a parameter its values.
   pure subroutine set(self, name, values)
      class(law_values_type), intent(inout) :: self
      !> Name of the parameter.
      character(len=*), intent(in) :: name
      !> Its values.
      real(wp), intent(in) :: values(:)
      character(len=21) :: padded

      if (.not. allocated(self%names)) allocate (self%names(0), self%owner(0), self%values(0))
      padded = name
      self%names = [self%names, padded]
      self%owner = [self%owner, spread(size(self%names), 1, size(values))]
      self%values = [self%values, values]
   end subroutine set

   !> Has a parameter been given?
   pure function has(self, name)
      class(law_values_type), intent(in) :: self
      !> Name of the parameter.
      character(len=*), intent(in) :: name
      logical :: has

      has = .false.
      if (allocated(self%names)) has = any(self%names == name)
   end function has

   !> Value of a parameter with one value.
   pure function number(self, name, default)
      class(law_values_type), intent(in) :: self
      !> Name of the parameter.
      character(len=*), intent(in) :: name
      !> Value when it is not given.
      real(wp), intent(in) :: default
      real(wp) :: number

      number = default
      if (.not. self%has(name)) return
      associate (given => self%list(name))
         if (size(given) > 0) number = given(1)
      end associate
   end function number

   !> Values of a parameter; none when it is not given.
   pure function list(self, name)
      class(law_values_type), intent(in) :: self
      !> Name of the parameter.
      character(len=*), intent(in) :: name
      real(wp), allocatable :: list(:)
      integer :: i

      allocate (list(0))
      if (.not. self%has(name)) return
      do i = 1, size(self%names)
         if (self%names(i) == name) list = pack(self%values, self%owner == i)
      end do
   end function list

   !> Are the values those of a model, all there and in their ranges?
   pure subroutine check_values(model, name, values, error)
      !> Kind of law.
      type(law_model_type), intent(in) :: model
      !> Name of the law.
      character(len=*), intent(in) :: name
      !> Values of its parameters.
      type(law_values_type), intent(in) :: values
      !> Set when they are not.
      type(error_type), allocatable, intent(out) :: error
      type(law_parameter_type) :: rule
      character(len=:), allocatable :: fault
      integer :: i

      do i = 1, size(law_parameters)
         rule = law_parameters(i)
         fault = ""
         if (values%has(rule%name)) then
            fault = fault_of(rule, model, values%list(rule%name))
         else if (has_word(model%needs, rule%name)) then
            fault = "is missing"
         end if
         if (fault == "") cycle
         call fatal_error(error, "law "//name//": "//trim(rule%name)//" "//fault)
         return
      end do
   end subroutine check_values

   !> What is wrong with the values of a parameter; empty if nothing.
   pure function fault_of(rule, model, given) result(fault)
      type(law_parameter_type), intent(in) :: rule
      type(law_model_type), intent(in) :: model
      real(wp), intent(in) :: given(:)
      character(len=:), allocatable :: fault
      integer :: k

      fault = ""
      if (.not. has_word(trim(model%needs)//" "//model%takes, rule%name)) then
         fault = "is no parameter of "//trim(model%word)
      else if (size(given) < rule%least .or. size(given) > rule%most) then
         fault = "has "//to_text(size(given))//" values, not "//to_text(rule%least)
         if (rule%most > rule%least) fault = fault//" to "//to_text(rule%most)
      else if (.not. all([(is_in_range(rule%range, given(k)), k=1, size(given))])) then
         fault = "must be "//trim(rule%range)
      end if
   end function fault_of

end module coulter_law_parameters
