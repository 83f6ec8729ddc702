!> History in a results file: one row for every accepted step or part of a step.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_history
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: last_of_line
   use coulter_model, only: model_type
   use coulter_model_observer, only: n_phases, phase_names, step_report_type
   use coulter_results_columns, only: heading, put_integer, put_integers, put_real, put_reals, &
      put_text
   use coulter_results_hdf5_io, only: hdf5_file_type
   use coulter_results_surface_history, only: put_surface_names, put_surfaces
   implicit none(type, external)
   private
   public :: history_type, add_history, put_history

   !> Where the next row goes.
   type :: history_type
      !> Rows written so far.
      integer :: n_rows = 0
      !> Warnings and resets written so far.
      integer, private :: n_warnings = 0, n_resets = 0
   end type history_type

   !> Most characters of a name that is kept.
   integer, parameter :: name_length = 64

contains

   !> Make the group and its datasets, without rows.
   subroutine add_history(history, file, model)
      !> History to start.
      type(history_type), intent(out) :: history
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> Model in its initial state.
      type(model_type), intent(in) :: model
      type(step_report_type) :: nothing

      call make_report(nothing, model)
      call file%add_group("history")
      call file%set_integers("history", "n_rows", [history%n_rows])
      call put_fixity_names(file, model)
      call put_surface_names(file, model)
      call file%put_texts("history/phase_names", phase_names)
      call put_row(file, heading, model, nothing)
      call put_warning(file, heading, 0, "")
      call put_reset(file, heading, 0, nothing%reset_residual)
      call put_changes(file, heading, nothing%reset_force_changes, model%units%force)
   end subroutine add_history

   !> A report of nothing, with room for what all boundaries, fixities and contacts feel.
   pure subroutine make_report(report, model)
      type(step_report_type), intent(out) :: report
      type(model_type), intent(in) :: model

      associate (n => size(model%boundaries))
         allocate (report%boundary_reactions(2, n), report%reset_force_changes(2, n), source=0.0_wp)
         allocate (report%penetrations(n), report%tip_penetrations(n), report%loaded_lengths(n), &
                   source=0.0_wp)
         allocate (report%contacts(n))
      end associate
      allocate (report%fixity_reactions(2, size(model%fixities)), source=0.0_wp)
      if (.not. allocated(model%body_contacts)) return
      if (size(model%body_contacts) > 0) allocate (report%surfaces(size(model%body_contacts)))
   end subroutine make_report

   !> Append a row.
   subroutine put_history(history, file, model, report)
      !> History to continue.
      type(history_type), intent(inout) :: history
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> Model at the end of the step.
      type(model_type), intent(in) :: model
      !> What happened in the step.
      type(step_report_type), intent(in) :: report
      real(wp) :: unknown(2, size(report%boundary_reactions, 2))

      call put_row(file, history%n_rows, model, report)
      if (allocated(report%warnings)) call put_warnings(history, file, report%warnings)
      if (allocated(report%reset_force_changes)) call put_changes( &
         file, history%n_resets - 1, report%reset_force_changes, model%units%force)
      if (report%has_retiled) then
         unknown = ieee_value(1.0_wp, ieee_quiet_nan)
         call put_reset(file, history%n_resets, history%n_rows, report%reset_residual)
         call put_changes(file, history%n_resets, unknown, model%units%force)
         history%n_resets = history%n_resets + 1
      end if
      call file%flush()
      history%n_rows = history%n_rows + 1
      call file%set_integers("history", "n_rows", [history%n_rows])
   end subroutine put_history

   !> All columns with a row for every step; what the row holds is of no interest to a heading.
   subroutine put_row(file, row, model, report)
      type(hdf5_file_type), intent(inout) :: file
      !> Number of the row, from 0, or `heading`.
      integer, intent(in) :: row
      type(model_type), intent(in) :: model
      type(step_report_type), intent(in) :: report
      real(wp) :: residuals(model%control%max_iterations + 1)

      call put_step(file, row, report)
      call put_integer(file, row, "n_cells", report%n_cells, "active cells")
      call put_integer(file, row, "n_nodes", report%n_nodes, "nodes of the active cells")
      call put_integer(file, row, "n_dofs", report%n_dofs, "unknowns")
      call put_integer(file, row, "has_reused_pattern", merge(1, 0, report%has_reused_pattern), &
                       "1 where the sparsity pattern of the step before served again")
      call put_boundaries(file, row, model, report)
      call put_contacts(file, row, model, report)
      if (allocated(report%surfaces)) call put_surfaces(file, row, report%surfaces, model%units)
      call padded_residuals(report, residuals)
      call put_reals(file, row, "residuals", [size(residuals)], residuals, &
                     "relative residual before every iteration and at the end, then NaN", "1")
      call put_reals(file, row, "phase_seconds", [n_phases], report%phase_seconds, &
                     "wall time by phase", "s")
   end subroutine put_row

   !> Columns on the step and how it was solved.
   subroutine put_step(file, row, report)
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: row
      type(step_report_type), intent(in) :: report

      call put_integer(file, row, "step", report%step, "number of the load step, from 1")
      call put_integer(file, row, "phase", report%phase, &
                       "number of the phase that holds the step, from 1")
      call put_integer(file, row, "is_complete", merge(1, 0, report%is_complete), &
                       "1 at the end of a load step, 0 for a part of one")
      call put_real(file, row, "time", report%time, "time at the end of the step")
      call put_real(file, row, "time_increment", report%time_increment, "size of the step in time")
      call put_real(file, row, "load_factor", report%load_factor, &
                    "time over the time of the last step", "1")
      call put_integer(file, row, "n_iterations", report%n_iterations, "Newton iterations")
      call put_integer(file, row, "n_halvings", report%n_halvings, &
                       "failed attempts that led to this step size")
      call put_integer(file, row, "n_settling", report%n_settling, &
                       "attempts to let bodies settle so far, 0 where none does")
      call put_real(file, row, "condition", report%condition, &
                    "estimated condition of the scaled tangent, 0 where not asked for", "1")
   end subroutine put_step

   !> Columns on forces, boundaries and tiles.
   subroutine put_boundaries(file, row, model, report)
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: row
      type(model_type), intent(in) :: model
      type(step_report_type), intent(in) :: report
      integer :: i, n

      n = size(model%boundaries)
      associate (units => model%units)
         call put_reals(file, row, "boundary_displacements", [2, n], &
                        [(report%contacts(i)%travel, i=1, n)], &
                        "displacement of every boundary since the start", units%length)
         call put_reals(file, row, "boundary_reactions", [2, n], report%boundary_reactions, &
                        "force of every boundary on the bodies, per unit thickness in plane" &
                        //" strain", units%force)
         call put_reals(file, row, "penetrations", [n], report%penetrations, &
                        "deepest point behind every boundary", units%length)
         call put_reals(file, row, "tip_penetrations", [n], report%tip_penetrations, &
                        "deepest sharp corner of every tool in a body", units%length)
         call put_reals(file, row, "loaded_lengths", [n], report%loaded_lengths, &
                        "length of every boundary that acts", units%length)
         call put_reals(file, row, "fixity_reactions", [2, size(model%fixities)], &
                        report%fixity_reactions, &
                        "force of every fixity on the bodies, per unit thickness in plane strain", &
                        units%force)
         call put_real(file, row, "worst_corner", report%worst_corner, &
                       "1 plus the least change of the scaled Jacobian of a tile's corner", "1")
         call put_real(file, row, "worst_aspect", report%worst_aspect, &
                       "largest aspect of a tile over the first one", "1")
         call put_real(file, row, "met_length", report%met_length, &
                       "length of surfaces within a cell of other surfaces", units%length)
         call put_integer(file, row, "has_retiled", merge(1, 0, report%has_retiled), &
                          "1 where the bodies were tiled anew after the step")
         call put_reals(file, row, "body_force", [2], report%body_force, "total body force", &
                        units%force)
      end associate
   end subroutine put_boundaries

   !> Columns on what walls and tools feel.
   subroutine put_contacts(file, row, model, report)
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: row
      type(model_type), intent(in) :: model
      type(step_report_type), intent(in) :: report
      integer :: i, n

      n = size(report%contacts)
      associate (c => report%contacts, units => model%units)
         call put_reals(file, row, "pivots", [2, n], [(c(i)%centre, i=1, n)], &
                        "pivot of every boundary", units%length)
         call put_reals(file, row, "rotations", [n], c%rotation, &
                        "rotation of every boundary since the start", "rad")
         call put_reals(file, row, "moments", [n], c%moment, &
                        "moment of every boundary on the bodies about its pivot")
         call put_reals(file, row, "works", [n], c%work, &
                        "work of every boundary on the bodies since the start")
         call put_reals(file, row, "pressing_forces", [n], c%pressing, &
                        "sum of all forces along the normals", units%force)
         call put_reals(file, row, "rubbing_forces", [n], c%rubbing, &
                        "sum of all shear forces, without their signs", units%force)
         call put_integers(file, row, "n_acting", c%n_acting, &
                           "stations of every boundary in contact")
         call put_integers(file, row, "n_sticking", c%n_sticking, &
                           "stations of every boundary that stick")
         call put_integers(file, row, "n_slipping", c%n_slipping, &
                           "stations of every boundary that slip")
         call put_reals(file, row, "imbalance", [2], report%imbalance, &
                        "sum of all forces on the bodies", units%force)
      end associate
   end subroutine put_contacts

   !> Write the warnings of the present row: most steps have none, some have many.
   subroutine put_warnings(history, file, warnings)
      type(history_type), intent(inout) :: history
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: warnings
      integer :: first, last

      first = 1
      do while (first <= len(warnings))
         last = last_of_line(warnings, first)
         call put_warning(file, history%n_warnings, history%n_rows, warnings(first:last))
         history%n_warnings = history%n_warnings + 1
         first = last + 2
      end do
   end subroutine put_warnings

   !> Columns of a list of warnings.
   subroutine put_warning(file, place, row, text)
      type(hdf5_file_type), intent(inout) :: file
      !> Place in the list, from 0, or `heading`; row that the warning belongs to.
      integer, intent(in) :: place, row
      character(len=*), intent(in) :: text

      call put_integer(file, place, "warning_rows", row, &
                       "row of the step that a warning belongs to, from 0")
      call put_text(file, place, "warning_texts", text, "what the log said about that step")
   end subroutine put_warning

   !> Columns of a list of resets: most scenes have none.
   subroutine put_reset(file, place, row, residual)
      type(hdf5_file_type), intent(inout) :: file
      !> Place in the list, from 0, or `heading`; row that the new tiles belong to.
      integer, intent(in) :: place, row
      real(wp), intent(in) :: residual

      call put_integer(file, place, "reset_rows", row, &
                       "row of the step after which bodies were tiled anew, from 0")
      call put_real(file, place, "reset_residuals", residual, &
                    "relative residual of the new tiles before they move", "1")
   end subroutine put_reset

   !> The same list: how forces change in the first step of new tiles, NaN before it.
   subroutine put_changes(file, place, changes, unit)
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: place
      real(wp), intent(in) :: changes(:, :)
      character(len=*), intent(in), optional :: unit

      call put_reals(file, place, "reset_force_changes", shape(changes), changes, &
                     "change of the force of every boundary in the first step of new tiles", unit)
   end subroutine put_changes

   !> Write the names of the fixities in the order of their reactions.
   subroutine put_fixity_names(file, model)
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      character(len=name_length), allocatable :: names(:)
      integer :: i

      allocate (names(size(model%fixities)))
      do i = 1, size(names)
         names(i) = model%fixities(i)%name
      end do
      call file%put_texts("history/fixity_names", names)
   end subroutine put_fixity_names

   !> Residuals of a step, filled up with NaN.
   pure subroutine padded_residuals(report, residuals)
      type(step_report_type), intent(in) :: report
      real(wp), intent(out) :: residuals(:)
      integer :: n

      residuals = ieee_value(1.0_wp, ieee_quiet_nan)
      if (.not. allocated(report%residuals)) return
      n = min(size(report%residuals), size(residuals))
      residuals(:n) = report%residuals(:n)
   end subroutine padded_residuals

end module coulter_results_history
