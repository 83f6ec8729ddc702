!> What every constitutive law offers to the method: strain in, stress and tangent out.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_abstract
   use coulter_base_kinds, only: wp
   use coulter_law_spatial, only: moduli_of_strain
   implicit none(type, external)
   private
   public :: law_type, law_item_type, law_response_type, law_variable_type, law_verdict_type
   public :: law_sites_type, law_visit_type, n_plane

   !> Components of a symmetric tensor in plane strain and axisymmetry: xx, yy, zz, xy.
   integer, parameter :: n_plane = 4

   !> Why a law failed, and what that means for the step.
   type :: law_verdict_type
      !> In words; unallocated when no law has spoken.
      character(len=:), allocatable :: message
      !> Must the step be given up, even if shorter corrections could be tried?
      logical :: ends_step = .false.
      !> Must the run end?
      logical :: ends_run = .false.
      !> Share of its size with which the step is repeated.
      real(wp) :: step_ratio = 0.5_wp
   end type law_verdict_type

   !> Where the points of a step are and how far the run is, for laws that look at it.
   type :: law_sites_type
      !> Number of the phase, and of the increment in it.
      integer :: phase = 1, increment = 1
      !> Time at the start of the phase.
      real(wp) :: phase_start = 0.0_wp
      !> Places of the points at the start of the step, length units, shape (2, n_points).
      real(wp), allocatable :: position(:, :)
      !> Edges of squares of their volume then, length units, shape (n_points).
      real(wp), allocatable :: length(:)
   end type law_sites_type

   !> Where and when a law is asked; most laws do not look at it.
   type :: law_visit_type
      !> Time at the end of the step.
      real(wp) :: time = 0.0_wp
      !> Length of the step; 0: no time passes.
      real(wp) :: time_step = 0.0_wp
      !> Number of the point, for messages.
      integer :: point = 0
      !> In-plane deformation gradient of the step.
      real(wp) :: deformation(2, 2) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
      !> Share of the elastic tangent that the method mixes into that of the law.
      real(wp) :: stiffening = 0.0_wp
      !> Are moduli wanted, or the stress alone?
      logical :: needs_moduli = .true.
      !> Where the points are; not associated when no law asks, or nobody knows.
      type(law_sites_type), pointer :: sites => null()
      !> Where a law that fails may say why; not associated when nobody asks.
      type(law_verdict_type), pointer :: verdict => null()
   end type law_visit_type

   !> What a law answers. No component has a default, which would be set at every visit.
   type :: law_response_type
      !> Kirchhoff stress xx, yy, zz, xy, tension positive.
      real(wp) :: stress(n_plane)
      !> Algorithmic tangent, d stress(i) / d trial_strain(j).
      real(wp) :: tangent(n_plane, n_plane)
      !> Logarithmic elastic strain after return mapping: xx, yy, zz and engineering shear 2 xy.
      real(wp) :: strain(n_plane)
      !> Did the update fail? The step is then repeated with half its size.
      logical :: has_failed
   end type law_response_type

   !> What a state variable is, for the results.
   type :: law_variable_type
      !> Name of the field.
      character(len=32) :: name = ""
      !> "1", "stress" or "1/time"; results put the label of the scene in the place of "stress".
      character(len=8) :: unit = "1"
      !> What it is.
      character(len=80) :: meaning = ""
   end type law_variable_type

   !> A law relates the logarithmic elastic strain to the Kirchhoff stress, so that small-strain
   !> return mapping carries over to finite strain unchanged (theory, section 1).
   type, abstract :: law_type
      !> Name by which bodies refer to the law.
      character(len=:), allocatable :: name
      !> Number of state variables per point.
      integer :: n_state = 0
      !> What the first of them are, those that results keep; unallocated when there are none.
      type(law_variable_type), allocatable :: variables(:)
      !> Is the algorithmic tangent symmetric (elastic and associated laws)?
      logical :: is_symmetric = .true.
      !> Is the law elastic, so that the elastic strain always equals the trial strain?
      logical :: is_elastic = .true.
      !> Does the law look at `visit%sites`?
      logical :: needs_sites = .false.
      !> Does the law work on stress increments? Its elastic strain then starts at zero in every
      !> step, so that the trial strain is that of the step, and its stress turns with the step.
      logical :: is_incremental = .false.
   contains
      procedure(update_interface), deferred :: update
      procedure(moduli_interface), deferred :: elastic_moduli
      procedure(strain_interface), deferred :: elastic_strain
      procedure :: initial_state
      procedure :: spatial_moduli
   end type law_type

   !> A law of any kind, to be kept in arrays.
   type :: law_item_type
      !> The law.
      class(law_type), allocatable :: law
   end type law_item_type

   abstract interface
      !> Stress at the end of a strain increment, and its consistent tangent. Laws that call nothing
      !> foreign are pure.
      subroutine update_interface(self, visit, trial_strain, state, response, new_state)
         import :: law_response_type, law_type, law_visit_type, n_plane, wp
         implicit none (type, external)
         class(law_type), intent(in) :: self
         !> Where and when.
         type(law_visit_type), intent(in) :: visit
         !> Logarithmic elastic trial strain: xx, yy, zz and engineering shear 2 xy.
         real(wp), intent(in) :: trial_strain(n_plane)
         !> State variables at the start of the step.
         real(wp), intent(in) :: state(self%n_state)
         !> Stress, tangent and elastic strain.
         type(law_response_type), intent(out) :: response
         !> State variables at the end of the step.
         real(wp), intent(out) :: new_state(self%n_state)
      end subroutine update_interface

      !> Elastic moduli that scale boundary penalties, from the state at the start of the step.
      pure subroutine moduli_interface(self, stress, state, lame_lambda, shear_modulus)
         import :: law_type, n_plane, wp
         implicit none (type, external)
         class(law_type), intent(in) :: self
         !> Kirchhoff stress xx, yy, zz, xy.
         real(wp), intent(in) :: stress(n_plane)
         !> State variables.
         real(wp), intent(in) :: state(self%n_state)
         !> First Lame parameter, stress units.
         real(wp), intent(out) :: lame_lambda
         !> Shear modulus, stress units.
         real(wp), intent(out) :: shear_modulus
      end subroutine moduli_interface

      !> Logarithmic elastic strain that carries a given stress, for bodies with initial stress.
      pure function strain_interface(self, stress, state) result(strain)
         import :: law_type, n_plane, wp
         implicit none (type, external)
         class(law_type), intent(in) :: self
         !> Kirchhoff stress xx, yy, zz, xy.
         real(wp), intent(in) :: stress(n_plane)
         !> State variables, from `initial_state`.
         real(wp), intent(in) :: state(self%n_state)
         !> Elastic strain xx, yy, zz, 2 xy.
         real(wp) :: strain(n_plane)
      end function strain_interface
   end interface

contains

   !> State of a point before the first step. Laws whose parameters vary with depth, or that
   !> remember the largest pressure, keep what holds at the point as state variables. Unless a law
   !> overrides it: zeros.
   subroutine initial_state(self, stress, position, state)
      class(law_type), intent(in) :: self
      !> Kirchhoff stress xx, yy, zz, xy at the start.
      real(wp), intent(in) :: stress(n_plane)
      !> Position at the start, length units.
      real(wp), intent(in) :: position(2)
      !> State variables.
      real(wp), intent(out) :: state(self%n_state)

      state = 0.0_wp
   end subroutine initial_state

   !> Moduli A_ijkl of the spatial tangent. Unless a law overrides it: the stress depends on the
   !> elastic strain alone.
   pure subroutine spatial_moduli(self, finger, strain, response, moduli)
      class(law_type), intent(in) :: self
      !> Elastic trial left Cauchy-Green tensor xx, yy, zz, xy.
      real(wp), intent(in) :: finger(4)
      !> Its logarithmic strain xx, yy, zz, 2 xy.
      real(wp), intent(in) :: strain(n_plane)
      !> Stress and tangent.
      type(law_response_type), intent(in) :: response
      !> Moduli, stress units.
      real(wp), intent(out) :: moduli(2, 2, 2, 2)

      ! what the default ignores, overriding procedures use
      associate (unused => strain)
      end associate
      call moduli_of_strain(finger, response%stress, response%tangent, moduli)
   end subroutine spatial_moduli

end module coulter_law_abstract
