!> Public face of the results room: an observer that keeps a run in an HDF5 file which is also a
!> VTKHDF file. docs/results.md describes the layout.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results
   use coulter_base_directory, only: check_directory, make_directory
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_model_contact_report, only: station_report_type
   use coulter_model_observer, only: n_phases, observer_type, scene_report_type, step_report_type
   use coulter_model_output, only: output_type
   use coulter_results_frames, only: add_frames, frames_type, put_frame
   use coulter_results_hdf5_io, only: hdf5_file_type
   use coulter_results_history, only: add_history, history_type, put_history
   use coulter_results_provenance, only: provenance_type, put_deck, put_provenance, put_status
   use coulter_results_scene, only: put_scene, put_shapes
   use coulter_results_stations, only: add_stations, put_stations, stations_file_type
   implicit none(type, external)
   private
   public :: results_type, new_results, provenance_type

   !> Version of the layout; it grows when a reader has to change.
   integer, parameter :: layout_version = 1

   !> Keeps frames and the history of a run. The file is open only while something is written, so
   !> that others can read it at any time.
   type, extends(observer_type) :: results_type
      private
      character(len=:), allocatable :: directory
      character(len=:), allocatable :: deck_path
      character(len=:), allocatable :: deck_text
      type(output_type) :: output
      type(provenance_type) :: provenance
      type(hdf5_file_type) :: file
      type(frames_type) :: frames
      type(history_type) :: history
      type(stations_file_type) :: stations
      !> Number of the last step that was accepted, whole or in part.
      integer :: last_step = 0
      !> Does the file exist? A file of that name may be there from an earlier run.
      logical :: is_made = .false.
   contains
      procedure :: start => start_results
      procedure :: step_done => put_step
      procedure :: finish => finish_results
      procedure :: path => results_path
   end type results_type

contains

   !> Prepare to write `directory`/`output%name`.vtkhdf. Nothing on the disk changes before the
   !> run starts; then a file of that name is replaced.
   subroutine new_results(results, directory, output, deck_path, deck_text, provenance, error)
      !> Observer to make.
      type(results_type), intent(out) :: results
      !> Directory of the file; it is made if need be.
      character(len=*), intent(in) :: directory
      !> What is kept.
      type(output_type), intent(in) :: output
      !> Path of the deck as the user gave it; empty if there is none.
      character(len=*), intent(in) :: deck_path
      !> Contents of the deck.
      character(len=*), intent(in) :: deck_text
      !> The program that runs.
      type(provenance_type), intent(in) :: provenance
      !> Set when the directory cannot be made or written.
      type(error_type), allocatable, intent(out) :: error

      results%directory = trim(directory)
      if (results%directory == "") results%directory = "."
      call check_directory(results%directory, error)
      if (allocated(error)) return
      results%output = output
      results%deck_path = deck_path
      results%deck_text = deck_text
      results%provenance = provenance
      if (.not. allocated(results%output%name)) results%output%name = "results"
      results%file%path = results%directory//"/"//results%output%name//".vtkhdf"
   end subroutine new_results

   !> Path of the file.
   pure function results_path(self) result(path)
      class(results_type), intent(in) :: self
      character(len=:), allocatable :: path

      path = self%file%path
   end function results_path

   !> See `observer_type`: make the file and keep the initial state.
   subroutine start_results(self, model, scene, error)
      class(results_type), intent(inout) :: self
      !> The model at time 0.
      type(model_type), intent(in) :: model
      !> Facts about the scene.
      type(scene_report_type), intent(in) :: scene
      !> Set when the file cannot be written.
      type(error_type), allocatable, intent(out) :: error
      type(station_report_type) :: no_stations(0)

      call make_directory(self%directory, error)
      if (allocated(error)) return
      call self%file%create()
      self%is_made = .true.
      self%stations = stations_file_type()
      self%last_step = 0
      call self%file%set_integers("/", "layout_version", [layout_version])
      call put_provenance(self%file, self%provenance)
      call self%file%set_integers("/", "n_points", [scene%n_points])
      call put_deck(self%file, self%deck_path, self%deck_text)
      call put_scene(self%file, model)
      call add_history(self%history, self%file, model)
      if (allocated(model%tiling)) call add_stations(self%file, model)
      call add_frames(self%frames, self%file, model, self%output)
      call keep_frame(self, model, 0.0_wp, no_stations)
      call self%file%close(error)
   end subroutine start_results

   !> See `observer_type`: append to the history, and keep a frame where one is due.
   subroutine put_step(self, model, report, error)
      class(results_type), intent(inout) :: self
      !> The model at the end of the step.
      type(model_type), intent(in) :: model
      !> What happened.
      type(step_report_type), intent(in) :: report
      !> Set when the file cannot be written.
      type(error_type), allocatable, intent(out) :: error

      self%last_step = report%step
      call self%file%open()
      call put_history(self%history, self%file, model, report)
      if (is_frame_due(self%output, report, model%schedule%n_steps())) then
         call keep_frame(self, model, report%load_factor, report%stations)
      end if
      call self%file%close(error)
   end subroutine put_step

   !> See `observer_type`: after a failure, keep the last accepted state too.
   subroutine finish_results(self, model, failure, phase_seconds)
      class(results_type), intent(inout) :: self
      !> The model as it was last accepted.
      type(model_type), intent(in) :: model
      !> Why the run ended early; unallocated when it reached its end.
      type(error_type), allocatable, intent(in) :: failure
      !> Wall time by phase since the last report, seconds: its output and failed attempts.
      real(wp), intent(in) :: phase_seconds(n_phases)
      type(error_type), allocatable :: error
      type(station_report_type) :: no_stations(0)

      if (.not. self%is_made) return
      call self%file%open()
      if (model%time > self%frames%last_time) then
         call keep_frame(self, model, model%time/maxval(model%schedule%end_time), no_stations)
      end if
      call put_status(self%file, failure, phase_seconds)
      call self%file%close(error)
   end subroutine finish_results

   !> Append a frame.
   subroutine keep_frame(self, model, load_factor, stations)
      type(results_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: load_factor
      type(station_report_type), intent(in) :: stations(:)

      call put_shapes(self%file, model%boundaries, self%frames%n_frames)
      if (allocated(model%tiling)) then
         call put_stations(self%stations, self%file, self%frames%n_frames, stations)
      end if
      call put_frame(self%frames, self%file, model, self%last_step, load_factor)
   end subroutine keep_frame

   !> Is a frame to be kept after this step?
   pure function is_frame_due(output, report, n_steps) result(is_due)
      type(output_type), intent(in) :: output
      type(step_report_type), intent(in) :: report
      integer, intent(in) :: n_steps
      logical :: is_due

      if (.not. report%is_complete) then
         is_due = .false.
      else if (report%step == n_steps) then
         is_due = .true.
      else if (allocated(output%at_steps)) then
         is_due = any(output%at_steps == report%step)
      else
         is_due = modulo(report%step, output%every) == 0
      end if
   end function is_frame_due

end module coulter_results
