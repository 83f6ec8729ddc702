!> A law that a user material (UMAT) computes: stress increments instead of elastic strain.
!>
!> The step's deformation is F = V R. The user material gets what it knew at the start of the step,
!> stress and strain rotated by R, and the increment ln V; so the update is exactly objective for
!> steps of any size (docs/umat.md). Its elastic strain is taken as zero after every step: the left
!> Cauchy-Green tensor that the method offers is that of the step alone.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_umat
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_law_abstract, only: law_response_type, law_type, law_variable_type, &
      law_verdict_type, law_visit_type, n_plane
   use coulter_law_spatial, only: add_spin_moduli, moduli_of_strain
   use coulter_law_umat_library, only: call_umat, load_umat, n_plane_umat, n_solid_umat, &
      start_umat, umat_call_type
   implicit none(type, external)
   private
   public :: umat_type, umat_settings_type, new_umat, n_plane_umat, n_solid_umat

   !> What a deck says of a user material.
   type :: umat_settings_type
      !> Path of the shared library.
      character(len=:), allocatable :: library
      !> Name of the material, for libraries that hold several.
      character(len=:), allocatable :: material
      !> Constants of the material, shape (n_constants).
      real(wp), allocatable :: constants(:)
      !> Number of its stress components: 4, or 6 for one that knows three dimensions only.
      integer :: n_components = n_plane_umat
      !> Its state variables at the start, shape (n_state); SDVINI of the library may change them.
      real(wp), allocatable :: initial_state(:)
      !> Elastic constants that scale penalties and hourglass control; without Young's modulus they
      !> come from the material's tangent at zero strain and stress.
      real(wp) :: youngs_modulus = 0.0_wp, poisson_ratio = 0.0_wp
   end type umat_settings_type

   !> A user material. State variables: its own, then what is kept beside them.
   type, extends(law_type) :: umat_type
      private
      !> Number of its own state variables.
      integer :: n_own = 0
      !> Procedure and name of the material, and its constants.
      type(umat_call_type) :: call
      real(wp), allocatable :: constants(:)
      !> Own state at the start.
      real(wp), allocatable :: first_own(:)
      !> Moduli of penalties, stress units.
      real(wp) :: lame_lambda = 0.0_wp, shear_modulus = 0.0_wp
   contains
      procedure :: update => update_umat
      procedure :: elastic_moduli => umat_moduli
      procedure :: elastic_strain => umat_strain
      procedure :: initial_state => umat_initial_state
      procedure :: spatial_moduli => umat_spatial_moduli
   end type umat_type

   !> Behind the material's own state variables: logarithmic strain since the start, turned with the
   !> material; Cauchy stress; deformation gradient 11, 21, 12, 22, 33; volume ratio J, which
   !> averages of the gradient would spoil; shear stresses 13 and 23, if it has any. Results hold
   !> stress, gradient and ratio in fields of their own.
   integer, parameter :: at_strain = 0, at_stress = 4, at_gradient = 8, at_ratio = 13, &
      at_across = 14, n_kept = 14
   !> The gradient at the start.
   real(wp), parameter :: identity(5) = [1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp]
   !> A step is not cut to less than this share at once, whatever the material asks for.
   real(wp), parameter :: least_ratio = 0.01_wp

contains

   !> Load a user material and ask it once, at zero strain and stress.
   subroutine new_umat(law, name, settings, error)
      !> Law to make.
      type(umat_type), intent(out) :: law
      !> Name by which bodies refer to it.
      character(len=*), intent(in) :: name
      !> Library and constants.
      type(umat_settings_type), intent(in) :: settings
      !> Set when there is no such library, or it gives up, or its stiffness is of no use.
      type(error_type), allocatable, intent(out) :: error

      law%name = name
      law%is_elastic = .false.
      law%is_symmetric = .false.
      law%is_incremental = .true.
      law%first_own = settings%initial_state
      law%n_own = size(law%first_own)
      law%call%n_components = settings%n_components
      law%n_state = law%n_own + n_kept + settings%n_components - n_plane_umat
      law%needs_sites = .true.
      call name_variables(law)
      call load_umat(settings%library, law%call, error)
      if (allocated(error)) return
      law%constants = settings%constants
      law%call%material = settings%material
      call find_moduli(law, settings, error)
   end subroutine new_umat

   !> Say what the state variables are that results keep.
   pure subroutine name_variables(law)
      type(umat_type), intent(inout) :: law
      character(len=*), parameter :: components(4) = ["xx", "yy", "zz", "xy"]
      integer :: i

      allocate (law%variables(law%n_own + size(components)))
      do i = 1, law%n_own
         law%variables(i) = law_variable_type("sdv_"//to_text(i), "1", &
                                              "state variable of the user material")
      end do
      do i = 1, size(components)
         law%variables(law%n_own + at_strain + i) = law_variable_type( &
            "umat_strain_"//components(i), "1", "logarithmic strain of the user material")
      end do
   end subroutine name_variables

   !> Elastic moduli for penalties: from the deck, or from the material's first tangent.
   subroutine find_moduli(law, settings, error)
      type(umat_type), intent(inout) :: law
      type(umat_settings_type), intent(in) :: settings
      type(error_type), allocatable, intent(out) :: error
      type(law_response_type) :: response
      type(law_verdict_type), target :: verdict
      type(law_visit_type) :: visit
      real(wp) :: state(law%n_state), new_state(law%n_state), no_stress(n_plane)

      no_stress = 0.0_wp
      call law%initial_state(no_stress, no_stress(:2), state)
      visit%time_step = 1.0_wp
      visit%verdict => verdict
      call law%update(visit, no_stress, state, response, new_state)
      if (verdict%ends_run) then
         call fatal_error(error, verdict%message)
      else if (settings%youngs_modulus > 0.0_wp) then
         associate (e => settings%youngs_modulus, nu => settings%poisson_ratio)
            law%shear_modulus = 0.5_wp*e/(1.0_wp + nu)
            law%lame_lambda = e*nu/((1.0_wp + nu)*(1.0_wp - 2.0_wp*nu))
         end associate
      else if (response%has_failed) then
         call fatal_error(error, "without strain and stress it fails: "//verdict%message &
                          //"; give youngs_modulus and poisson_ratio if it needs stress")
      else
         associate (d => response%tangent)
            law%shear_modulus = d(4, 4)
            law%lame_lambda = (sum(d(:3, :3)) - d(1, 1) - d(2, 2) - d(3, 3))/6.0_wp
            if (d(4, 4) > 0.0_wp .and. law%lame_lambda + d(4, 4) > 0.0_wp) return
         end associate
         call fatal_error(error, "without strain and stress its tangent has no shear or bulk" &
                          //" stiffness; give youngs_modulus and poisson_ratio")
      end if
   end subroutine find_moduli

   !> See `law_type`.
   subroutine update_umat(self, visit, trial_strain, state, response, new_state)
      class(umat_type), intent(in) :: self
      !> Where, when, and the deformation of the step.
      type(law_visit_type), intent(in) :: visit
      !> Logarithmic strain of the step, ln V.
      real(wp), intent(in) :: trial_strain(n_plane)
      !> State variables at the start of the step.
      real(wp), intent(in) :: state(self%n_state)
      !> Stress and tangent; the elastic strain starts anew with the next step.
      type(law_response_type), intent(out) :: response
      !> State variables at the end of the step.
      real(wp), intent(out) :: new_state(self%n_state)
      type(umat_call_type) :: arguments
      real(wp), target :: own(self%n_own), constants(size(self%constants))
      character(len=:), allocatable :: message
      real(wp) :: ratio
      integer :: j

      own = state(:self%n_own)
      arguments = self%call
      arguments%state => own
      constants = self%constants
      arguments%constants => constants
      call prepare_call(arguments, trial_strain, visit%deformation, state(self%n_own + 1:))
      call place_call(arguments, visit)
      ! in no time and without strain nothing happens
      if (visit%time_step > 0.0_wp .or. any(abs(trial_strain) > 0.0_wp)) then
         call call_umat(arguments, message)
      end if
      call judge(visit, arguments, message, response%has_failed)
      if (response%has_failed) return
      ratio = exp(sum(trial_strain(:3)))*state(self%n_own + at_ratio + 1)
      associate (n => arguments%n_components)
         do j = 1, n_plane
            response%tangent(:, j) = ratio*arguments%jacobian(n*(j - 1) + 1:n*(j - 1) + n_plane)
         end do
         new_state = [own, arguments%strain(:n_plane) + trial_strain, arguments%stress(:n_plane), &
                      [arguments%new_gradient(:2, :2)], arguments%new_gradient(3, 3), ratio, &
                      arguments%stress(n_plane + 1:n)]
      end associate
      response%stress = ratio*arguments%stress(:n_plane)
      response%tangent(:, :3) = response%tangent(:, :3) + spread(response%stress, 2, 3)
      response%strain = 0.0_wp
   end subroutine update_umat

   !> What the material is told: tensors at the end of the step's rotation, F = V R.
   pure subroutine prepare_call(arguments, trial_strain, deformation, kept)
      type(umat_call_type), intent(inout) :: arguments
      real(wp), intent(in) :: trial_strain(n_plane)
      !> In-plane deformation gradient of the step.
      real(wp), intent(in) :: deformation(2, 2)
      !> State variables behind the material's own.
      real(wp), intent(in) :: kept(:)
      real(wp) :: r(3, 3), step(3, 3)

      step = 0.0_wp
      step(:2, :2) = deformation
      step(3, 3) = exp(trial_strain(3))
      r = 0.0_wp
      associate (f => deformation)
         r(1, 1) = (f(1, 1) + f(2, 2))/hypot(f(1, 1) + f(2, 2), f(2, 1) - f(1, 2))
         r(2, 1) = (f(2, 1) - f(1, 2))/hypot(f(1, 1) + f(2, 2), f(2, 1) - f(1, 2))
      end associate
      r(:, 2) = [-r(2, 1), r(1, 1), 0.0_wp]
      r(3, 3) = 1.0_wp
      arguments%rotation = r
      arguments%stress(:4) = turned(kept(at_stress + 1:at_stress + 4), r, 1.0_wp)
      if (arguments%n_components == n_solid_umat) then
         arguments%stress(5:) = matmul(r(:2, :2), kept(at_across + 1:))
      end if
      arguments%strain(:4) = turned(kept(at_strain + 1:at_strain + 4), r, 2.0_wp)
      arguments%strain_increment(:4) = trial_strain
      arguments%old_gradient(:2, :2) = reshape(kept(at_gradient + 1:at_gradient + 4), [2, 2])
      arguments%old_gradient(3, 3) = kept(at_gradient + 5)
      arguments%new_gradient = matmul(step, arguments%old_gradient)
   end subroutine prepare_call

   !> Where and when the material is asked.
   pure subroutine place_call(arguments, visit)
      type(umat_call_type), intent(inout) :: arguments
      type(law_visit_type), intent(in) :: visit

      arguments%time = visit%time - visit%time_step
      arguments%time_increment = visit%time_step
      arguments%point = visit%point
      if (.not. associated(visit%sites)) return
      associate (sites => visit%sites)
         arguments%time(1) = arguments%time(1) - sites%phase_start
         arguments%step = sites%phase
         arguments%increment = sites%increment
         if (.not. allocated(sites%position)) return
         arguments%position(:2) = sites%position(:, visit%point)
         arguments%length = sites%length(visit%point)
      end associate
   end subroutine place_call

   !> Symmetric tensor xx, yy, zz, xy turned about the z axis; shear is `factor` times component xy.
   pure function turned(tensor, r, factor) result(image)
      real(wp), intent(in) :: tensor(4), r(3, 3), factor
      real(wp) :: image(4)
      real(wp) :: matrix(2, 2)

      matrix = reshape([tensor(1), tensor(4)/factor, tensor(4)/factor, tensor(2)], [2, 2])
      matrix = matmul(r(:2, :2), matmul(matrix, transpose(r(:2, :2))))
      image = [matrix(1, 1), matrix(2, 2), tensor(3), factor*matrix(2, 1)]
   end function turned

   !> Can the answer be used? If not, say why to whom it concerns.
   subroutine judge(visit, arguments, message, has_failed)
      type(law_visit_type), intent(in) :: visit
      type(umat_call_type), intent(in) :: arguments
      !> Why there is no answer, if there is none.
      character(len=:), allocatable, intent(in) :: message
      logical, intent(out) :: has_failed
      type(law_verdict_type) :: verdict

      if (allocated(message)) then
         verdict%message = "the user material gives up: "//message
         verdict%ends_step = .true.
         verdict%ends_run = .true.
      else if (.not. (all(ieee_is_finite(arguments%stress)) &
                      .and. all(ieee_is_finite(arguments%state)))) then
         verdict%message = "the user material returns a stress or state that is no number"
      else if (.not. all(ieee_is_finite(arguments%jacobian))) then
         verdict%message = "the user material returns a tangent (DDSDDE) that is no number"
      else if (arguments%time_ratio < 1.0_wp) then
         verdict%message = "the user material asks for " &
            //to_text(arguments%time_ratio)//" of the step (PNEWDT)"
         verdict%ends_step = .true.
         verdict%step_ratio = max(arguments%time_ratio, least_ratio)
      end if
      has_failed = allocated(verdict%message)
      if (has_failed .and. associated(visit%verdict)) visit%verdict = verdict
   end subroutine judge

   !> See `law_type`.
   pure subroutine umat_moduli(self, stress, state, lame_lambda, shear_modulus)
      class(umat_type), intent(in) :: self
      !> Kirchhoff stress: makes no difference.
      real(wp), intent(in) :: stress(n_plane)
      !> State: makes no difference.
      real(wp), intent(in) :: state(self%n_state)
      !> First Lame parameter.
      real(wp), intent(out) :: lame_lambda
      !> Shear modulus.
      real(wp), intent(out) :: shear_modulus

      lame_lambda = self%lame_lambda
      shear_modulus = self%shear_modulus
   end subroutine umat_moduli

   !> See `law_type`: none, since the stress is a state variable.
   pure function umat_strain(self, stress, state) result(strain)
      class(umat_type), intent(in) :: self
      !> Kirchhoff stress.
      real(wp), intent(in) :: stress(n_plane)
      !> State variables.
      real(wp), intent(in) :: state(self%n_state)
      !> Zero.
      real(wp) :: strain(n_plane)

      strain = 0.0_wp
   end function umat_strain

   !> See `law_type`.
   subroutine umat_initial_state(self, stress, position, state)
      class(umat_type), intent(in) :: self
      !> Stress at the start.
      real(wp), intent(in) :: stress(n_plane)
      !> Position, which SDVINI is told.
      real(wp), intent(in) :: position(2)
      !> Own state, the stress, and no deformation.
      real(wp), intent(out) :: state(self%n_state)
      type(umat_call_type) :: arguments
      real(wp), target :: own(self%n_own)
      character(len=:), allocatable :: message

      own = self%first_own
      arguments = self%call
      arguments%state => own
      arguments%position(:2) = position
      call start_umat(arguments, message)
      ! the first update then says that this state is no number
      if (allocated(message)) own = ieee_value(own, ieee_quiet_nan)
      state = 0.0_wp
      state(:self%n_own) = own
      associate (kept => state(self%n_own + 1:))
         kept(at_stress + 1:at_stress + 4) = stress
         kept(at_gradient + 1:at_gradient + 5) = identity
         kept(at_ratio + 1) = 1.0_wp
      end associate
   end subroutine umat_initial_state

   !> See `law_type`: the stress of the start turns with the step.
   pure subroutine umat_spatial_moduli(self, finger, strain, response, moduli)
      class(umat_type), intent(in) :: self
      !> Left Cauchy-Green tensor of the step.
      real(wp), intent(in) :: finger(4)
      !> Its logarithmic strain.
      real(wp), intent(in) :: strain(n_plane)
      !> Stress and tangent.
      type(law_response_type), intent(in) :: response
      !> Moduli A_ijkl.
      real(wp), intent(out) :: moduli(2, 2, 2, 2)

      call moduli_of_strain(finger, response%stress, response%tangent, moduli)
      call add_spin_moduli(finger, strain, response%stress, response%tangent, moduli)
   end subroutine umat_spatial_moduli

end module coulter_law_umat
