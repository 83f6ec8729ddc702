!> Where a results file comes from: program, build, deck, time and how the run ended.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_provenance
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: long, wp
   use coulter_results_hdf5_io, only: hdf5_file_type
   use coulter_results_hdf5_types, only: kind_real
   implicit none(type, external)
   private
   public :: provenance_type, put_provenance, put_deck, put_status

   !> The program that runs, as its build system describes it.
   type :: provenance_type
      !> Version of the program.
      character(len=:), allocatable :: version
      !> Revision of the sources.
      character(len=:), allocatable :: revision
      !> Compiler and its version.
      character(len=:), allocatable :: compiler
      !> Compiler flags.
      character(len=:), allocatable :: flags
      !> Build type, such as "release".
      character(len=:), allocatable :: build_type
   end type provenance_type

   !> Bytes reserved for the status, which is set again when the run ends.
   integer, parameter :: status_width = 1024

contains

   !> Write the provenance at the start of a run.
   subroutine put_provenance(file, provenance)
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> The program.
      type(provenance_type), intent(in) :: provenance

      call file%add_group("provenance")
      call set_known("version", provenance%version)
      call set_known("revision", provenance%revision)
      call set_known("compiler", provenance%compiler)
      call set_known("flags", provenance%flags)
      call set_known("build_type", provenance%build_type)
      call file%set_text("provenance", "started", time_stamp())
      call file%set_text("provenance", "status", "running", status_width)

   contains

      !> Set what is known.
      subroutine set_known(name, text)
         character(len=*), intent(in) :: name
         character(len=*), intent(in), optional :: text

         if (present(text)) call file%set_text("provenance", name, text)
      end subroutine set_known

   end subroutine put_provenance

   !> Write the deck, so that the run can be repeated from its results.
   subroutine put_deck(file, path, text)
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> Path of the deck as the user gave it.
      character(len=*), intent(in) :: path
      !> Contents of the deck.
      character(len=*), intent(in) :: text

      call file%put_texts("deck", [text])
      call file%set_text("deck", "path", path)
   end subroutine put_deck

   !> Write how the run ended.
   subroutine put_status(file, failure, phase_seconds)
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> Why it ended early; unallocated when it reached its end.
      type(error_type), allocatable, intent(in) :: failure
      !> Wall time by phase after the last row of the history, seconds.
      real(wp), intent(in) :: phase_seconds(:)

      if (allocated(failure)) then
         call file%set_text("provenance", "status", "failed: "//failure%message, status_width)
      else
         call file%set_text("provenance", "status", "finished", status_width)
      end if
      call file%set_text("provenance", "ended", time_stamp())
      call file%add_rows("provenance/last_seconds", kind_real, [integer ::], size(phase_seconds))
      call file%put_reals("provenance/last_seconds", 0_long, size(phase_seconds), phase_seconds)
      call file%describe("provenance/last_seconds", &
                         "wall time by phase after the last row of the history", "s")
   end subroutine put_status

   !> Date and time with the offset from UTC, as in ISO 8601.
   function time_stamp() result(stamp)
      character(len=:), allocatable :: stamp
      character(len=10) :: date, time, zone

      call date_and_time(date, time, zone)
      stamp = date(:4)//"-"//date(5:6)//"-"//date(7:8)//"T" &
         //time(:2)//":"//time(3:4)//":"//time(5:6)//zone(:3)//":"//zone(4:5)
   end function time_stamp

end module coulter_results_provenance
