!> An observer that writes what tools feel to a table of comma-separated values, a row per accepted
!> step or part of a step.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_tool_table
   use coulter_base_directory, only: make_directory
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_model, only: model_type
   use coulter_model_observer, only: n_phases, observer_type, scene_report_type, step_report_type
   implicit none(type, external)
   private
   public :: tool_table_type, new_tool_table

   !> Writes the table; nothing for scenes without tools.
   type, extends(observer_type) :: tool_table_type
      private
      !> Directory and path of the file.
      character(len=:), allocatable :: directory, path
   contains
      procedure :: start => start_table
      procedure :: step_done => put_row
      procedure :: finish => finish_table
   end type tool_table_type

   !> Columns of every tool; its name and a colon stand before each.
   character(len=*), parameter :: columns(*) = [character(len=15) :: "force_x", "force_y", &
      "moment", "pivot_x", "pivot_y", "rotation", "contact_length", "penetration", &
      "tip_penetration", "work", "pressing_force", "rubbing_force", "n_acting", "n_sticking", &
      "n_slipping"]

contains

   !> Prepare to write `directory`/`name`_tools.csv.
   pure subroutine new_tool_table(table, directory, name)
      !> Observer to make.
      type(tool_table_type), intent(out) :: table
      !> Directory of the file; it is made if need be.
      character(len=*), intent(in) :: directory
      !> Base name of the results.
      character(len=*), intent(in) :: name

      table%directory = trim(directory)
      if (table%directory == "") table%directory = "."
      table%path = table%directory//"/"//name//"_tools.csv"
   end subroutine new_tool_table

   !> See `observer_type`: write the heads of the columns.
   subroutine start_table(self, model, scene, error)
      class(tool_table_type), intent(inout) :: self
      !> The model at time 0.
      type(model_type), intent(in) :: model
      !> Facts about the scene.
      type(scene_report_type), intent(in) :: scene
      !> Set when the file cannot be written.
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: line
      integer :: b, c

      if (scene%n_points == 0 .or. .not. any(model%boundaries%is_tool)) return
      call make_directory(self%directory, error)
      if (allocated(error)) return
      line = "step,is_complete,time,n_iterations"
      do b = 1, size(model%boundaries)
         if (.not. model%boundaries(b)%is_tool) cycle
         do c = 1, size(columns)
            line = line//","//model%boundaries(b)%name//":"//trim(columns(c))
         end do
      end do
      call write_line(self%path, line, "replace", error)
   end subroutine start_table

   !> See `observer_type`: append a row.
   subroutine put_row(self, model, report, error)
      class(tool_table_type), intent(inout) :: self
      !> The model at the end of the step.
      type(model_type), intent(in) :: model
      !> What happened.
      type(step_report_type), intent(in) :: report
      !> Set when the file cannot be written.
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: line
      integer :: b

      if (.not. any(model%boundaries%is_tool)) return
      line = to_text(report%step)//","//to_text(merge(1, 0, report%is_complete))//"," &
         //number(report%time)//","//to_text(report%n_iterations)
      do b = 1, size(model%boundaries)
         if (model%boundaries(b)%is_tool) line = line//cells_of(report, b)
      end do
      call write_line(self%path, line, "old", error)
   end subroutine put_row

   !> See `observer_type`.
   subroutine finish_table(self, model, failure, phase_seconds)
      class(tool_table_type), intent(inout) :: self
      !> The model as it was last accepted.
      type(model_type), intent(in) :: model
      !> Why the run ended early; unallocated when it reached its end.
      type(error_type), allocatable, intent(in) :: failure
      !> Wall time by phase since the last report, seconds.
      real(wp), intent(in) :: phase_seconds(n_phases)

      ! every row is complete already
   end subroutine finish_table

   !> Cells of one tool, each with a comma before it.
   pure function cells_of(report, b) result(text)
      type(step_report_type), intent(in) :: report
      integer, intent(in) :: b
      character(len=:), allocatable :: text
      real(wp) :: values(12)
      integer :: i

      associate (c => report%contacts(b))
         values = [report%boundary_reactions(:, b), c%moment, c%centre, c%rotation, &
                   report%loaded_lengths(b), report%penetrations(b), report%tip_penetrations(b), &
                   c%work, c%pressing, c%rubbing]
         text = ""
         do i = 1, size(values)
            text = text//","//number(values(i))
         end do
         text = text//","//to_text(c%n_acting)//","//to_text(c%n_sticking)//"," &
            //to_text(c%n_slipping)
      end associate
   end function cells_of

   !> A number with all its digits.
   pure function number(value) result(text)
      real(wp), intent(in) :: value
      character(len=:), allocatable :: text
      character(len=26) :: buffer

      write (buffer, "(es25.16e3)") value
      text = trim(adjustl(buffer))
   end function number

   !> Write a line to a new file, or append it to one that is there. Fortran's run-time library says
   !> nothing when a disk is full: hence the look at the size.
   subroutine write_line(path, line, status, error)
      character(len=*), intent(in) :: path, line, status
      type(error_type), allocatable, intent(out) :: error
      integer :: unit, code, old_size, new_size

      old_size = 0
      open (newunit=unit, file=path, status=status, position="append", action="write", iostat=code)
      if (code == 0) inquire (unit, size=old_size)
      if (code == 0) write (unit, "(a)", iostat=code) line
      if (code == 0) close (unit, iostat=code)
      inquire (file=path, size=new_size)
      if (code /= 0 .or. new_size <= old_size + len(line)) then
         call fatal_error(error, path//": cannot be written (is the disk full?)")
      end if
   end subroutine write_line

end module coulter_results_tool_table
