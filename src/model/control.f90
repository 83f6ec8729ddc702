!> Settings of the time loop and of the equilibrium iteration.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_control
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: schedule_type, control_type, small_cells_keep, small_cells_drop, small_cells_aggregate
   public :: phase_type, no_last_phase, domains_points, domains_tiles, domains_boxes

   !> The point is a quadrature point: standard material point method.
   integer, parameter :: domains_points = 1
   !> Domains are polygons that share their corners and tile the body (CPDI2).
   integer, parameter :: domains_tiles = 2
   !> Domains are axis-aligned boxes that overlap or gape as they stretch (GIMP).
   integer, parameter :: domains_boxes = 3

   !> Cells with little material are treated like all others.
   integer, parameter :: small_cells_keep = 1
   !> Cells with little material are left out, together with their points and boundaries.
   integer, parameter :: small_cells_drop = 2
   !> The outer nodes of cells with little material follow those of the nearest well-filled cell.
   integer, parameter :: small_cells_aggregate = 3

   !> A part of a run with loads and boundaries of its own.
   type :: phase_type
      !> Name.
      character(len=:), allocatable :: name
      !> Number of its last step.
      integer :: last_step = 0
      !> Do displacements count from its end?
      logical :: resets_displacements = .false.
   end type phase_type

   !> The load steps: time is a parameter that orders them, 0 at the start.
   type :: schedule_type
      !> Time at the end of every step, increasing, > 0, shape (n_steps).
      real(wp), allocatable :: end_time(:)
      !> Phases in their order; unallocated: a single one that holds all steps.
      type(phase_type), allocatable :: phases(:)
      !> A run ends after so many steps if there are more: a look at how a scene begins.
      integer :: most_steps = huge(1)
   contains
      procedure :: n_steps
      procedure :: phase_of
      procedure :: share_of_phase
      procedure :: duration_of_phase
   end type schedule_type

   !> Last phase of what acts to the end.
   integer, parameter :: no_last_phase = huge(1)

   !> How a step is solved.
   type :: control_type
      !> What a point stands for: one of `domains_*`.
      integer :: domains = domains_tiles
      !> Do the points of a cell share their volume change, against volumetric locking (F-bar)?
      logical :: has_mean_volume = .false.
      !> Hourglass stiffness of tiles over the one that is exact for a square in bending.
      real(wp) :: hourglass_ratio = 0.5_wp
      !> Largest hourglass force in a tile that flows, over its equivalent stress times the edge of
      !> a square of its area.
      real(wp) :: hourglass_limit = 0.1_wp
      !> Are bodies tiled anew when their tiles are distorted?
      logical :: may_retile = .true.
      !> Ghost penalty over the shear modulus, on cell faces near the outline of tiled bodies.
      real(wp) :: ghost_ratio = 1.0e-3_wp
      !> Are all systems solved by LU, symmetric ones as well?
      logical :: is_lu_only = .false.
      !> Is the condition of every step's last tangent estimated? It costs two factorisations.
      logical :: has_condition = .false.
      !> Largest accepted residual norm over the norm of the internal or external force.
      real(wp) :: tolerance = 1.0e-8_wp
      !> Largest accepted Newton correction over the largest displacement increment of the step;
      !> passing this test alone is enough.
      real(wp) :: increment_tolerance = 1.0e-11_wp
      !> Augmented Lagrangian updates in a step, for boundaries that use them.
      integer :: n_augmentations = 1
      !> Newton iterations before a step counts as failed.
      integer :: max_iterations = 75
      !> How often a failed step may be halved.
      integer :: max_halvings = 6
      !> Do bodies that find no equilibrium slide against a drag until they rest? Tiles only.
      logical :: may_settle = .false.
      !> What happens to cells with little material: one of `small_cells_*`.
      integer :: small_cells = small_cells_aggregate
      !> Volume fraction below which a cell has little material; with tiles, share of a cell's area
      !> below which a node does.
      real(wp) :: fill_tolerance = 0.05_wp
   end type control_type

contains

   !> Number of steps that a run takes.
   pure function n_steps(self) result(n)
      class(schedule_type), intent(in) :: self
      integer :: n

      n = min(size(self%end_time), self%most_steps)
   end function n_steps

   !> Number of the phase that holds a step.
   pure function phase_of(self, step) result(phase)
      class(schedule_type), intent(in) :: self
      !> Number of the step, from 1.
      integer, intent(in) :: step
      integer :: phase

      phase = 1
      if (allocated(self%phases)) phase = 1 + count(self%phases%last_step < step)
   end function phase_of

   !> How much of a phase is over at a time, 0 to 1. Phase 0 is over before the run starts.
   pure function share_of_phase(self, phase, time) result(share)
      class(schedule_type), intent(in) :: self
      !> Number of the phase; one beyond the last has not begun.
      integer, intent(in) :: phase
      !> Time.
      real(wp), intent(in) :: time
      real(wp) :: share
      real(wp) :: limits(2)

      share = 1.0_wp
      if (phase < 1) return
      if (allocated(self%phases)) then
         share = 0.0_wp
         if (phase > size(self%phases)) return
      end if
      limits = limits_of_phase(self, phase)
      share = (time - limits(1))/(limits(2) - limits(1))
      if (allocated(self%phases)) share = max(0.0_wp, min(1.0_wp, share))
   end function share_of_phase

   !> How long a phase takes; the whole run where there are none.
   pure function duration_of_phase(self, phase) result(duration)
      class(schedule_type), intent(in) :: self
      !> Number of the phase.
      integer, intent(in) :: phase
      real(wp) :: duration
      real(wp) :: limits(2)

      limits = limits_of_phase(self, phase)
      duration = limits(2) - limits(1)
   end function duration_of_phase

   !> Times at which a phase begins and ends.
   pure function limits_of_phase(schedule, phase) result(limits)
      class(schedule_type), intent(in) :: schedule
      integer, intent(in) :: phase
      real(wp) :: limits(2)

      limits = [0.0_wp, schedule%end_time(size(schedule%end_time))]
      if (.not. allocated(schedule%phases)) return
      if (phase > 1) limits(1) = schedule%end_time(schedule%phases(phase - 1)%last_step)
      limits(2) = schedule%end_time(schedule%phases(phase)%last_step)
   end function limits_of_phase

end module coulter_model_control
