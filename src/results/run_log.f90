!> Run log: what a person wants to see while a run goes on.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_run_log
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: last_of_line, to_text
   use coulter_base_timer, only: wall_seconds
   use coulter_model, only: model_type
   use coulter_model_observer, only: n_phases, observer_type, phase_names, scene_report_type, &
      step_report_type
   use coulter_results_log_scene, only: name_width, write_scene
   use coulter_results_log_text, only: left, line_width, plural, progress_bar, right, &
      scaled_real, write_paragraph
   use coulter_results_surface_history, only: surface_name
   implicit none(type, external)
   private
   public :: run_log_type, new_run_log

   !> Writes a line per step, with the reactions below it, and a summary at both ends.
   type, extends(observer_type) :: run_log_type
      private
      !> Unit to write to.
      integer :: unit = 0
      !> Is a progress bar kept below the last line?
      logical :: has_progress_bar = .false.
      !> Wall and processor time at the start, seconds.
      real(wp) :: wall_start = 0.0_wp, cpu_start = 0.0_wp
      !> Wall time by phase so far, seconds.
      real(wp) :: phase_seconds(n_phases) = 0.0_wp
      !> Whole steps, iterations and new tilings so far.
      integer :: n_steps = 0, n_iterations = 0, n_retilings = 0
      !> Phase whose heading was written last.
      integer :: phase = 0
      !> Has a boundary acted on material yet? Shape (n_boundaries).
      logical, allocatable :: has_acted(:)
   contains
      procedure :: start => start_log
      procedure :: step_done => log_step
      procedure :: finish => finish_log
   end type run_log_type

   !> Columns of the step table.
   character(len=*), parameter :: step_heading = &
      "  step        time    load  iterations    residual   seconds"
   !> Width of a number in the reactions.
   integer, parameter :: force_width = 10
   !> Return to the start of the line and clear it, on terminals that understand ANSI.
   character(len=*), parameter :: clear_line = achar(13)//achar(27)//"[2K"

contains

   !> Make a log.
   pure subroutine new_run_log(log, unit, has_progress_bar)
      !> Log to make.
      type(run_log_type), intent(out) :: log
      !> Unit to write to, open for formatted output.
      integer, intent(in) :: unit
      !> Is a progress bar wanted? Only for terminals.
      logical, intent(in) :: has_progress_bar

      log%unit = unit
      log%has_progress_bar = has_progress_bar
   end subroutine new_run_log

   !> See `observer_type`: write the summary of the scene and the heading of the step table.
   subroutine start_log(self, model, scene, error)
      class(run_log_type), intent(inout) :: self
      !> The model at time 0.
      type(model_type), intent(in) :: model
      !> Facts about the scene.
      type(scene_report_type), intent(in) :: scene
      !> Set when nothing can be written.
      type(error_type), allocatable, intent(out) :: error

      ! a log may watch one run after another
      self%has_acted = spread(.false., 1, size(model%boundaries))
      self%phase_seconds = 0.0_wp
      self%n_steps = 0
      self%n_iterations = 0
      self%n_retilings = 0
      self%phase = 0
      self%wall_start = wall_seconds()
      call cpu_time(self%cpu_start)
      call write_scene(self%unit, model, scene)
      write (self%unit, "(/, a)") step_heading
      if (size(model%boundaries) > 0) then
         write (self%unit, "(8x, a)") "force x, y of each boundary on the body"//in_unit()
      end if
      write (self%unit, "(a)") ""
      call show_progress(self, 0.0_wp, error)

   contains

      !> Unit of forces, where it is known.
      function in_unit() result(text)
         character(len=:), allocatable :: text

         text = ""
         if (.not. allocated(model%units%force)) return
         if (model%units%force /= "") text = ", "//model%units%force
      end function in_unit

   end subroutine start_log

   !> See `observer_type`: write the line of a step, its reactions and its warnings.
   subroutine log_step(self, model, report, error)
      class(run_log_type), intent(inout) :: self
      !> The model at the end of the step.
      type(model_type), intent(in) :: model
      !> What happened.
      type(step_report_type), intent(in) :: report
      !> Set when nothing can be written.
      type(error_type), allocatable, intent(out) :: error

      self%phase_seconds = self%phase_seconds + report%phase_seconds
      self%n_iterations = self%n_iterations + report%n_iterations
      if (report%is_complete) self%n_steps = self%n_steps + 1
      if (report%has_retiled) self%n_retilings = self%n_retilings + 1
      if (allocated(report%loaded_lengths)) then
         self%has_acted = self%has_acted .or. report%loaded_lengths > 0.0_wp
      end if
      call hide_progress(self)
      if (allocated(model%schedule%phases) .and. report%phase /= self%phase) then
         self%phase = report%phase
         write (self%unit, "(2x, a)") "phase "//to_text(report%phase)//": " &
            //model%schedule%phases(report%phase)%name
      end if
      write (self%unit, "(a)") step_line(report)
      call write_reactions(self%unit, model, report)
      call write_surfaces(self%unit, model, report)
      if (report%condition > 0.0_wp) then
         write (self%unit, "(8x, a)") "condition "//to_text(report%condition, 2)
      end if
      if (allocated(report%reset_force_changes)) call write_changes(self%unit, model, report)
      if (report%has_retiled) write (self%unit, "(8x, a)") "tiled anew: out of balance by " &
         //percent(report%reset_residual)//" until the next step"
      if (allocated(report%warnings)) call write_warnings(self%unit, report%warnings)
      call show_progress(self, report%load_factor, error)
   end subroutine log_step

   !> See `observer_type`: write how the run ended and where its time went.
   subroutine finish_log(self, model, failure, phase_seconds)
      class(run_log_type), intent(inout) :: self
      !> The model as it was last accepted.
      type(model_type), intent(in) :: model
      !> Why the run ended early; unallocated when it reached its end.
      type(error_type), allocatable, intent(in) :: failure
      !> Wall time by phase since the last report, seconds: its output and failed attempts.
      real(wp), intent(in) :: phase_seconds(n_phases)
      character(len=:), allocatable :: verdict

      self%phase_seconds = self%phase_seconds + phase_seconds
      call hide_progress(self)
      verdict = "finished"
      if (allocated(failure)) verdict = "stopped early, at time "//to_text(model%time)//","
      verdict = verdict//" after "//plural(self%n_steps, "step", "steps") &
         //" and "//plural(self%n_iterations, "iteration", "iterations")
      if (self%n_retilings > 0) then
         verdict = verdict//", bodies tiled anew "//plural(self%n_retilings, "time", "times")
      end if
      write (self%unit, "(/, 2x, a)") verdict
      if (self%n_steps > 0) call write_idle(self, model)
      call write_timing(self)
      flush (self%unit)
   end subroutine finish_log

   !> Name the boundaries that have met nothing: they may be misplaced.
   subroutine write_idle(self, model)
      class(run_log_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer :: b

      do b = 1, size(model%boundaries)
         if (self%has_acted(b)) cycle
         write (self%unit, "(2x, a)") "warning: "//trim(merge("tool    ", "boundary", &
                                                              model%boundaries(b)%is_tool)) &
            //" "//model%boundaries(b)%name//" has met no material"
      end do
   end subroutine write_idle

   !> Line of a step; a part of a step that was halved is marked by "+".
   function step_line(report) result(line)
      type(step_report_type), intent(in) :: report
      character(len=:), allocatable :: line
      character(len=12) :: residual, seconds

      residual = "-"
      if (allocated(report%residuals)) then
         write (residual, "(es12.1)") report%residuals(size(report%residuals))
      end if
      write (seconds, "(f10.2)") sum(report%phase_seconds)
      line = right(to_text(report%step), 6)//merge(" ", "+", report%is_complete) &
         //right(to_text(report%time, 5), 11) &
         //right(to_text(nint(100.0_wp*report%load_factor)), 6)//" %" &
         //right(to_text(report%n_iterations), 12)//residual//trim(seconds)
      if (report%n_settling > 0) line = line//"   settling"
      if (report%n_halvings > 0) line = line//"   halved "//to_text(report%n_halvings)//" x"
   end function step_line

   !> Write the forces of all boundaries, equally many on every line.
   subroutine write_reactions(unit, model, report)
      integer, intent(in) :: unit
      type(model_type), intent(in) :: model
      type(step_report_type), intent(in) :: report
      character(len=:), allocatable :: line
      real(wp) :: scale
      integer :: i, n, width, n_lines, n_per_line

      n = size(model%boundaries)
      if (n == 0 .or. .not. allocated(report%boundary_reactions)) return
      scale = maxval(abs(report%boundary_reactions))
      width = name_width(model%boundaries)
      n_per_line = max((line_width - 8)/(width + 2*force_width + 4), 1)
      n_lines = (n + n_per_line - 1)/n_per_line
      n_per_line = (n + n_lines - 1)/n_lines
      line = ""
      do i = 1, n
         line = line//left(model%boundaries(i)%name, width) &
            //right(scaled_real(report%boundary_reactions(1, i), scale), force_width) &
            //right(scaled_real(report%boundary_reactions(2, i), scale), force_width)//"    "
         if (modulo(i, n_per_line) == 0 .or. i == n) then
            write (unit, "(8x, a)") trim(line)
            line = ""
         end if
      end do
   end subroutine write_reactions

   !> Write the forces between bodies that have contacts, one on every line.
   subroutine write_surfaces(unit, model, report)
      integer, intent(in) :: unit
      type(model_type), intent(in) :: model
      type(step_report_type), intent(in) :: report
      real(wp) :: scale
      integer :: i

      if (.not. allocated(report%surfaces)) return
      scale = maxval([(abs(report%surfaces(i)%force), i=1, size(report%surfaces))])
      do i = 1, size(report%surfaces)
         associate (force => report%surfaces(i)%force)
            write (unit, "(8x, 3a)") surface_name(model, i), &
               right(scaled_real(force(1), scale), force_width), &
               right(scaled_real(force(2), scale), force_width)
         end associate
      end do
   end subroutine write_surfaces

   !> Say which force has changed most in the first step of new tiles.
   subroutine write_changes(unit, model, report)
      integer, intent(in) :: unit
      type(model_type), intent(in) :: model
      type(step_report_type), intent(in) :: report
      real(wp) :: whole
      integer :: b

      whole = maxval([0.0_wp, norm2(report%boundary_reactions, dim=1)])
      if (.not. whole > 0.0_wp) return
      b = maxloc(norm2(report%reset_force_changes, dim=1), dim=1)
      write (unit, "(8x, a)") "first step of new tiles: force of "//model%boundaries(b)%name &
         //" changed by "//percent(norm2(report%reset_force_changes(:, b))/whole)
   end subroutine write_changes

   !> A share in per cent.
   pure function percent(share) result(text)
      real(wp), intent(in) :: share
      character(len=:), allocatable :: text

      text = to_text(100.0_wp*share, 2)//" %"
   end function percent

   !> Write the warnings of a step, each on a line of its own.
   subroutine write_warnings(unit, warnings)
      integer, intent(in) :: unit
      character(len=*), intent(in) :: warnings
      integer :: first, last

      first = 1
      do while (first <= len(warnings))
         last = last_of_line(warnings, first)
         call write_paragraph(unit, "        warning: ", warnings(first:last))
         first = last + 2
      end do
   end subroutine write_warnings

   !> Write the time of every phase and its share of the whole.
   subroutine write_timing(self)
      class(run_log_type), intent(in) :: self
      real(wp) :: wall, cpu
      integer :: i

      call cpu_time(cpu)
      wall = max(wall_seconds() - self%wall_start, tiny(wall))
      write (self%unit, "(/, a)") "  phase        seconds     share"
      do i = 1, n_phases
         call write_row(phase_names(i), self%phase_seconds(i))
      end do
      call write_row("other", max(wall - sum(self%phase_seconds), 0.0_wp))
      write (self%unit, "(2x, a9, f11.2, 3a)") "total    ", wall, &
         "             processor time ", to_text(cpu - self%cpu_start, 3), " s"

   contains

      !> Write the row of a phase.
      subroutine write_row(name, seconds)
         character(len=*), intent(in) :: name
         real(wp), intent(in) :: seconds

         write (self%unit, "(2x, a9, f11.2, f8.1, a)") left(name, 9), seconds, &
            100.0_wp*seconds/wall, " %"
      end subroutine write_row

   end subroutine write_timing

   !> Draw the progress bar below the last line; without one, show what has been written.
   subroutine show_progress(self, share, error)
      class(run_log_type), intent(in) :: self
      real(wp), intent(in) :: share
      type(error_type), allocatable, intent(out) :: error
      integer :: status

      if (self%has_progress_bar) then
         write (self%unit, "(2x, a)", advance="no") &
            progress_bar(share, wall_seconds() - self%wall_start)
      end if
      flush (self%unit, iostat=status)
      if (status /= 0) call fatal_error(error, "the run log cannot be written")
   end subroutine show_progress

   !> Remove the progress bar.
   subroutine hide_progress(self)
      class(run_log_type), intent(in) :: self

      if (self%has_progress_bar) write (self%unit, "(a)", advance="no") clear_line
   end subroutine hide_progress

end module coulter_results_run_log
