!> How a run tells the outside world what happens, without knowing of files or terminals.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_observer
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: long, wp
   use coulter_model, only: model_type
   use coulter_model_contact_report, only: contact_report_type, station_report_type, &
      surface_report_type
   implicit none(type, external)
   private
   public :: observer_type, observer_item_type, step_report_type, scene_report_type
   public :: n_phases, phase_names, add_warning
   public :: phase_locate, phase_number, phase_assemble, phase_factorise, phase_solve, phase_accept
   public :: phase_output

   !> Number of timed phases of a run.
   integer, parameter :: n_phases = 7
   !> Names of the timed phases, in the order of their index.
   character(len=*), parameter :: phase_names(n_phases) = [character(len=9) :: &
      "locate", "number", "assemble", "factorise", "solve", "accept", "output"]
   !> Indices of the timed phases.
   integer, parameter :: phase_locate = 1, phase_number = 2, phase_assemble = 3, &
      phase_factorise = 4, phase_solve = 5, phase_accept = 6, phase_output = 7

   !> Facts about the scene before the first step.
   type :: scene_report_type
      !> Material points.
      integer :: n_points = 0
      !> Cells of the whole grid.
      integer(long) :: n_grid_cells = 0
      !> Cells that hold material or carry a boundary.
      integer :: n_cells = 0
      !> Nodes of these cells.
      integer :: n_nodes = 0
      !> Unknowns of the linear system.
      integer :: n_dofs = 0
      !> Entries of the sparse matrix.
      integer :: n_entries = 0
      !> Bytes that points, cells, pattern and matrix occupy.
      integer(long) :: memory = 0
   end type scene_report_type

   !> What happened in an accepted step, or in the part of one that halving made of it.
   type :: step_report_type
      !> Number of the load step and of its phase, from 1.
      integer :: step = 0, phase = 1
      !> Is this the end of the load step (false for a part that is followed by others)?
      logical :: is_complete = .true.
      !> Time at the end of the step.
      real(wp) :: time = 0.0_wp
      !> Time over the time of the last step: 1 at the end of the run.
      real(wp) :: load_factor = 0.0_wp
      !> Size of the step in time.
      real(wp) :: time_increment = 0.0_wp
      !> Newton iterations: linear solves.
      integer :: n_iterations = 0
      !> Failed attempts that led to this step size.
      integer :: n_halvings = 0
      !> Attempts to let bodies settle so far, this one included; 0 where none does.
      integer :: n_settling = 0
      !> Relative residual before every iteration and at the end, shape (n_iterations + 1).
      real(wp), allocatable :: residuals(:)
      !> Estimated condition of the last tangent, scaled by its diagonal; 0 where nobody asked.
      real(wp) :: condition = 0.0_wp
      !> Force of every boundary on the body, force per thickness, shape (2, n_boundaries).
      real(wp), allocatable :: boundary_reactions(:, :)
      !> What every boundary feels beside that, shape (n_boundaries), and all stations in contact.
      type(contact_report_type), allocatable :: contacts(:)
      type(station_report_type), allocatable :: stations(:)
      !> Contacts between bodies, shape (n_body_contacts); unallocated if there are none.
      type(surface_report_type), allocatable :: surfaces(:)
      !> Sum of all forces on the bodies: what equilibrium lacks, force per thickness.
      real(wp) :: imbalance(2) = 0.0_wp
      !> Force of every fixity on the body, force per thickness, shape (2, n_fixities).
      real(wp), allocatable :: fixity_reactions(:, :)
      !> Deepest point behind every boundary, length units, 0 if none, shape (n_boundaries).
      real(wp), allocatable :: penetrations(:)
      !> Depth of the deepest corner of every tool in a tiled body, length units, 0 if none, shape
      !> (n_boundaries).
      real(wp), allocatable :: tip_penetrations(:)
      !> Length of every boundary that acts on material, length units, shape (n_boundaries).
      real(wp), allocatable :: loaded_lengths(:)
      !> Least scaled Jacobian of a tile's corner, and largest aspect of a tile, relative to the
      !> undeformed tile; 1 without tiles.
      real(wp) :: worst_corner = 1.0_wp, worst_aspect = 1.0_wp
      !> Length of surfaces of tiled bodies within a cell of other surfaces, length units.
      real(wp) :: met_length = 0.0_wp
      !> Have the bodies been tiled anew after the step?
      logical :: has_retiled = .false.
      !> Relative residual of new tiles before they move.
      real(wp) :: reset_residual = 0.0_wp
      !> Change of the force of every boundary on the body in the first step of new tiles, force per
      !> thickness, shape (2, n_boundaries); unallocated in all other steps.
      real(wp), allocatable :: reset_force_changes(:, :)
      !> Total external force on the material: body force and edge loads, force per thickness.
      real(wp) :: body_force(2) = 0.0_wp
      !> Cells, nodes and unknowns in this step.
      integer :: n_cells = 0, n_nodes = 0, n_dofs = 0
      !> Was the sparsity pattern of the previous step used again?
      logical :: has_reused_pattern = .false.
      !> Wall time by phase since the last report, seconds: failed attempts and the output of the
      !> last step are included.
      real(wp) :: phase_seconds(n_phases) = 0.0_wp
      !> Remarks that the user should see, one per line; empty if none.
      character(len=:), allocatable :: warnings
   end type step_report_type

   !> Somebody who watches a run: a results file, a log, a coupled program.
   type, abstract :: observer_type
   contains
      procedure(start_interface), deferred :: start
      procedure(step_interface), deferred :: step_done
      procedure(finish_interface), deferred :: finish
   end type observer_type

   !> An observer of any kind, to be kept in arrays.
   type :: observer_item_type
      !> The observer.
      class(observer_type), allocatable :: observer
   end type observer_item_type

   abstract interface
      !> Called once with the model in its initial state.
      subroutine start_interface(self, model, scene, error)
         import :: error_type, model_type, observer_type, scene_report_type
         implicit none (type, external)
         class(observer_type), intent(inout) :: self
         !> The model at time 0.
         type(model_type), intent(in) :: model
         !> Facts about the scene.
         type(scene_report_type), intent(in) :: scene
         !> Set to end the run.
         type(error_type), allocatable, intent(out) :: error
      end subroutine start_interface

      !> Called after every accepted step or part of a step.
      subroutine step_interface(self, model, report, error)
         import :: error_type, model_type, observer_type, step_report_type
         implicit none (type, external)
         class(observer_type), intent(inout) :: self
         !> The model at the end of the step.
         type(model_type), intent(in) :: model
         !> What happened.
         type(step_report_type), intent(in) :: report
         !> Set to end the run.
         type(error_type), allocatable, intent(out) :: error
      end subroutine step_interface

      !> Called once at the end, also after a failure, be it one of `start`.
      subroutine finish_interface(self, model, failure, phase_seconds)
         import :: error_type, model_type, n_phases, observer_type, wp
         implicit none (type, external)
         class(observer_type), intent(inout) :: self
         !> The model as it was last accepted.
         type(model_type), intent(in) :: model
         !> Why the run ended early; unallocated when it reached its end.
         type(error_type), allocatable, intent(in) :: failure
         !> Wall time by phase since the last report, seconds: its output and failed attempts.
         real(wp), intent(in) :: phase_seconds(n_phases)
      end subroutine finish_interface
   end interface

contains

   !> Append a line.
   pure subroutine add_warning(warnings, line)
      !> Lines so far.
      character(len=:), allocatable, intent(inout) :: warnings
      !> Line to append.
      character(len=*), intent(in) :: line

      if (len(warnings) > 0) warnings = warnings//new_line("a")
      warnings = warnings//line
   end subroutine add_warning

end module coulter_model_observer
