!> History in a results file: one row for every accepted step or part of a step.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_history
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use coulter_base_kinds, only: long, wp
   use coulter_base_text, only: last_of_line
   use coulter_model, only: model_type
   use coulter_model_observer, only: n_phases, phase_names, step_report_type
   use coulter_results_hdf5_io, only: hdf5_file_type
   use coulter_results_hdf5_types, only: kind_integer, kind_real, kind_text
   use coulter_results_surface_history, only: add_surface_columns, put_surface_columns
   implicit none(type, external)
   private
   public :: history_type, add_history, put_history

   !> Where the next row goes.
   type :: history_type
      !> Rows written so far.
      integer :: n_rows = 0
      !> Warnings and resets written so far.
      integer, private :: n_warnings = 0, n_resets = 0
      !> Residuals that a row has room for.
      integer, private :: n_residuals = 1
   end type history_type

   !> Rows that are stored together.
   integer, parameter :: chunk = 64
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

      history%n_residuals = model%control%max_iterations + 1
      call file%add_group("history")
      call file%set_integers("history", "n_rows", [0])
      call add_step_columns(file)
      call add_size_columns(file)
      call add_boundary_columns(file, model)
      call add_surface_columns(file, model, chunk)
      call add_warnings(file)
      call add_resets(file, model)
      call add_real(file, "residuals", [history%n_residuals], &
                    "relative residual before every iteration and at the end, then NaN", "1")
      call add_real(file, "phase_seconds", [n_phases], "wall time by phase", "s")
      call file%put_texts("history/phase_names", phase_names)
   end subroutine add_history

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
      real(wp) :: residuals(history%n_residuals)
      integer(long) :: row

      row = int(history%n_rows, long)
      call put_step_columns(file, row, report)
      call put_size_columns(file, row, report)
      call put_boundary_columns(file, row, model, report)
      if (allocated(report%surfaces)) call put_surface_columns(file, row, report%surfaces)
      call padded_residuals(report, residuals)
      call file%put_reals("history/residuals", row, size(residuals), residuals)
      call file%put_reals("history/phase_seconds", row, n_phases, report%phase_seconds)
      if (allocated(report%warnings)) call put_warnings(history, file, report%warnings)
      if (allocated(report%reset_force_changes)) call put_changes(history, file, report)
      if (report%has_retiled) call put_reset(history, file, report)
      call file%flush()
      history%n_rows = history%n_rows + 1
      call file%set_integers("history", "n_rows", [history%n_rows])
   end subroutine put_history

   !> Columns on the step and how it was solved.
   subroutine add_step_columns(file)
      type(hdf5_file_type), intent(inout) :: file

      call add_integer(file, "step", "number of the load step, from 1")
      call add_integer(file, "phase", "number of the phase that holds the step, from 1")
      call add_integer(file, "is_complete", "1 at the end of a load step, 0 for a part of one")
      call add_real(file, "time", [integer ::], "time at the end of the step")
      call add_real(file, "time_increment", [integer ::], "size of the step in time")
      call add_real(file, "load_factor", [integer ::], "time over the time of the last step", "1")
      call add_integer(file, "n_iterations", "Newton iterations")
      call add_integer(file, "n_halvings", "failed attempts that led to this step size")
      call add_integer(file, "n_settling", &
                       "attempts to let bodies settle so far, 0 where none does")
      call add_real(file, "condition", [integer ::], &
                    "estimated condition of the scaled tangent, 0 where not asked for", "1")
   end subroutine add_step_columns

   !> Row of the columns on the step.
   subroutine put_step_columns(file, row, report)
      type(hdf5_file_type), intent(inout) :: file
      integer(long), intent(in) :: row
      type(step_report_type), intent(in) :: report

      call put_integer(file, "step", row, report%step)
      call put_integer(file, "phase", row, report%phase)
      call put_integer(file, "is_complete", row, merge(1, 0, report%is_complete))
      call file%put_reals("history/time", row, 1, [report%time])
      call file%put_reals("history/time_increment", row, 1, [report%time_increment])
      call file%put_reals("history/load_factor", row, 1, [report%load_factor])
      call put_integer(file, "n_iterations", row, report%n_iterations)
      call put_integer(file, "n_halvings", row, report%n_halvings)
      call put_integer(file, "n_settling", row, report%n_settling)
      call file%put_reals("history/condition", row, 1, [report%condition])
   end subroutine put_step_columns

   !> Columns on the size of the linear system.
   subroutine add_size_columns(file)
      type(hdf5_file_type), intent(inout) :: file

      call add_integer(file, "n_cells", "active cells")
      call add_integer(file, "n_nodes", "nodes of the active cells")
      call add_integer(file, "n_dofs", "unknowns")
      call add_integer(file, "has_reused_pattern", &
                       "1 where the sparsity pattern of the step before served again")
   end subroutine add_size_columns

   !> Row of the columns on the size of the linear system.
   subroutine put_size_columns(file, row, report)
      type(hdf5_file_type), intent(inout) :: file
      integer(long), intent(in) :: row
      type(step_report_type), intent(in) :: report

      call put_integer(file, "n_cells", row, report%n_cells)
      call put_integer(file, "n_nodes", row, report%n_nodes)
      call put_integer(file, "n_dofs", row, report%n_dofs)
      call put_integer(file, "has_reused_pattern", row, merge(1, 0, report%has_reused_pattern))
   end subroutine put_size_columns

   !> Columns on forces and boundaries.
   subroutine add_boundary_columns(file, model)
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      integer :: n

      n = size(model%boundaries)
      call add_real(file, "boundary_displacements", [2, n], &
                    "displacement of every boundary since the start", model%units%length)
      call add_real(file, "boundary_reactions", [2, n], &
                    "force of every boundary on the bodies, per unit thickness in plane strain", &
                    model%units%force)
      call add_real(file, "penetrations", [n], "deepest point behind every boundary", &
                    model%units%length)
      call add_real(file, "tip_penetrations", [n], "deepest sharp corner of every tool in a body", &
                    model%units%length)
      call add_real(file, "loaded_lengths", [n], "length of every boundary that acts", &
                    model%units%length)
      call add_real(file, "fixity_reactions", [2, size(model%fixities)], &
                    "force of every fixity on the bodies, per unit thickness in plane strain", &
                    model%units%force)
      call add_real(file, "worst_corner", [integer ::], &
                    "1 plus the least change of the scaled Jacobian of a tile's corner", "1")
      call add_real(file, "worst_aspect", [integer ::], &
                    "largest aspect of a tile over the first one", "1")
      call add_real(file, "met_length", [integer ::], &
                    "length of surfaces within a cell of other surfaces", model%units%length)
      call add_integer(file, "has_retiled", "1 where the bodies were tiled anew after the step")
      call add_real(file, "body_force", [2], "total body force", model%units%force)
      call put_fixity_names(file, model)
      call add_contact_columns(file, model)
   end subroutine add_boundary_columns

   !> Columns on what walls and tools feel.
   subroutine add_contact_columns(file, model)
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      integer :: n

      n = size(model%boundaries)
      call add_real(file, "pivots", [2, n], "pivot of every boundary", model%units%length)
      call add_real(file, "rotations", [n], "rotation of every boundary since the start", "rad")
      call add_real(file, "moments", [n], "moment of every boundary on the bodies about its pivot")
      call add_real(file, "works", [n], "work of every boundary on the bodies since the start")
      call add_real(file, "pressing_forces", [n], "sum of all forces along the normals", &
                    model%units%force)
      call add_real(file, "rubbing_forces", [n], "sum of all shear forces, without their signs", &
                    model%units%force)
      call add_integer(file, "n_acting", "stations of every boundary in contact", [n])
      call add_integer(file, "n_sticking", "stations of every boundary that stick", [n])
      call add_integer(file, "n_slipping", "stations of every boundary that slip", [n])
      call add_real(file, "imbalance", [2], "sum of all forces on the bodies", model%units%force)
   end subroutine add_contact_columns

   !> Row of the columns on what walls and tools feel.
   subroutine put_contact_columns(file, row, report)
      type(hdf5_file_type), intent(inout) :: file
      integer(long), intent(in) :: row
      type(step_report_type), intent(in) :: report
      real(wp) :: pivots(2, size(report%contacts))
      integer :: i, n

      n = size(report%contacts)
      do i = 1, n
         pivots(:, i) = report%contacts(i)%centre
      end do
      associate (c => report%contacts)
         call file%put_reals("history/pivots", row, 2*n, pivots)
         call file%put_reals("history/rotations", row, n, c%rotation)
         call file%put_reals("history/moments", row, n, c%moment)
         call file%put_reals("history/works", row, n, c%work)
         call file%put_reals("history/pressing_forces", row, n, c%pressing)
         call file%put_reals("history/rubbing_forces", row, n, c%rubbing)
         call file%put_integers("history/n_acting", row, n, int(c%n_acting, long))
         call file%put_integers("history/n_sticking", row, n, int(c%n_sticking, long))
         call file%put_integers("history/n_slipping", row, n, int(c%n_slipping, long))
      end associate
      call file%put_reals("history/imbalance", row, 2, report%imbalance)
   end subroutine put_contact_columns

   !> Row of the columns on forces and boundaries.
   subroutine put_boundary_columns(file, row, model, report)
      type(hdf5_file_type), intent(inout) :: file
      integer(long), intent(in) :: row
      type(model_type), intent(in) :: model
      type(step_report_type), intent(in) :: report
      real(wp) :: displacements(2, size(model%boundaries))
      integer :: i, n

      n = size(model%boundaries)
      do i = 1, n
         displacements(:, i) = report%contacts(i)%travel
      end do
      call file%put_reals("history/boundary_displacements", row, 2*n, displacements)
      call file%put_reals("history/boundary_reactions", row, 2*n, report%boundary_reactions)
      call file%put_reals("history/penetrations", row, n, report%penetrations)
      call file%put_reals("history/tip_penetrations", row, n, report%tip_penetrations)
      call file%put_reals("history/loaded_lengths", row, n, report%loaded_lengths)
      call file%put_reals("history/fixity_reactions", row, 2*size(model%fixities), &
                          report%fixity_reactions)
      call file%put_reals("history/worst_corner", row, 1, [report%worst_corner])
      call file%put_reals("history/worst_aspect", row, 1, [report%worst_aspect])
      call file%put_reals("history/met_length", row, 1, [report%met_length])
      call put_integer(file, "has_retiled", row, merge(1, 0, report%has_retiled))
      call file%put_reals("history/body_force", row, 2, report%body_force)
      call put_contact_columns(file, row, report)
   end subroutine put_boundary_columns

   !> Lists of warnings: most steps have none, some have many.
   subroutine add_warnings(file)
      type(hdf5_file_type), intent(inout) :: file

      call add_integer(file, "warning_rows", "row of the step that a warning belongs to, from 0")
      call file%add_rows("history/warning_texts", kind_text, [integer ::], chunk)
      call file%describe("history/warning_texts", "what the log said about that step")
   end subroutine add_warnings

   !> Write the warnings of the present row.
   subroutine put_warnings(history, file, warnings)
      type(history_type), intent(inout) :: history
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: warnings
      integer :: first, last

      first = 1
      do while (first <= len(warnings))
         last = last_of_line(warnings, first)
         associate (place => int(history%n_warnings, long))
            call put_integer(file, "warning_rows", place, history%n_rows)
            call file%put_text("history/warning_texts", place, warnings(first:last))
         end associate
         history%n_warnings = history%n_warnings + 1
         first = last + 2
      end do
   end subroutine put_warnings

   !> Lists of what new tiles change: most scenes have none.
   subroutine add_resets(file, model)
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model

      call add_integer(file, "reset_rows", &
                       "row of the step after which bodies were tiled anew, from 0")
      call add_real(file, "reset_residuals", [integer ::], &
                    "relative residual of the new tiles before they move", "1")
      call add_real(file, "reset_force_changes", [2, size(model%boundaries)], &
                    "change of the force of every boundary in the first step of new tiles", &
                    model%units%force)
   end subroutine add_resets

   !> Write what new tiles change after the present row.
   subroutine put_reset(history, file, report)
      type(history_type), intent(inout) :: history
      type(hdf5_file_type), intent(inout) :: file
      type(step_report_type), intent(in) :: report
      real(wp) :: unknown(2, size(report%boundary_reactions, 2))

      unknown = ieee_value(1.0_wp, ieee_quiet_nan)
      associate (place => int(history%n_resets, long))
         call put_integer(file, "reset_rows", place, history%n_rows)
         call file%put_reals("history/reset_residuals", place, 1, [report%reset_residual])
         call file%put_reals("history/reset_force_changes", place, size(unknown), unknown)
      end associate
      history%n_resets = history%n_resets + 1
   end subroutine put_reset

   !> Write how forces have changed in the first step of the last new tiles.
   subroutine put_changes(history, file, report)
      type(history_type), intent(in) :: history
      type(hdf5_file_type), intent(inout) :: file
      type(step_report_type), intent(in) :: report

      call file%put_reals("history/reset_force_changes", int(history%n_resets - 1, long), &
                          size(report%reset_force_changes), report%reset_force_changes)
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
   subroutine padded_residuals(report, residuals)
      type(step_report_type), intent(in) :: report
      real(wp), intent(out) :: residuals(:)
      integer :: n

      residuals = ieee_value(1.0_wp, ieee_quiet_nan)
      if (.not. allocated(report%residuals)) return
      n = min(size(report%residuals), size(residuals))
      residuals(:n) = report%residuals(:n)
   end subroutine padded_residuals

   !> Make a column of reals.
   subroutine add_real(file, name, row_shape, description, unit)
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: name, description
      integer, intent(in) :: row_shape(:)
      character(len=*), intent(in), optional :: unit

      call file%add_rows("history/"//name, kind_real, row_shape, chunk)
      call file%describe("history/"//name, description, unit)
   end subroutine add_real

   !> Make a column of integers.
   subroutine add_integer(file, name, description, row_shape)
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: name, description
      integer, intent(in), optional :: row_shape(:)

      if (present(row_shape)) then
         call file%add_rows("history/"//name, kind_integer, row_shape, chunk)
      else
         call file%add_rows("history/"//name, kind_integer, [integer ::], chunk)
      end if
      call file%describe("history/"//name, description)
   end subroutine add_integer

   !> Write an integer of a row.
   subroutine put_integer(file, name, row, value)
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: name
      integer(long), intent(in) :: row
      integer, intent(in) :: value

      call file%put_integers("history/"//name, row, 1, [int(value, long)])
   end subroutine put_integer

end module coulter_results_history
