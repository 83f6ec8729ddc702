!> A program of its own on the library of Coulter: runs a deck and prints what its first boundary
!> feels. An observer is told after every step; it may look at all of the model, and end the run by
!> an error.
! SPDX-License-Identifier: BSD-3-Clause
module host_observer
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_model_observer, only: n_phases, observer_type, scene_report_type, step_report_type
   implicit none(type, external)
   private
   public :: printer_type

   type, extends(observer_type) :: printer_type
   contains
      procedure :: start
      procedure :: step_done
      procedure :: finish
   end type printer_type

contains

   subroutine start(self, model, scene, error)
      class(printer_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(scene_report_type), intent(in) :: scene
      type(error_type), allocatable, intent(out) :: error

      print "(i0, a)", model%points%n_points, " points"
   end subroutine start

   subroutine step_done(self, model, report, error)
      class(printer_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(step_report_type), intent(in) :: report
      type(error_type), allocatable, intent(out) :: error

      print "(f8.4, 2es16.8)", model%time, report%boundary_reactions(:, 1)
   end subroutine step_done

   subroutine finish(self, model, failure, phase_seconds)
      class(printer_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(in) :: failure
      real(wp), intent(in) :: phase_seconds(n_phases)
   end subroutine finish

end module host_observer

program host
   use coulter_base_error, only: error_type
   use coulter_base_faults, only: fault_list_type
   use coulter_deck, only: deck_type, read_deck
   use coulter_model, only: model_type
   use coulter_model_output, only: output_type
   use coulter_model_prepare, only: prepare_model
   use coulter_step_run, only: run_model
   use host_observer, only: printer_type
   implicit none(type, external)
   type(deck_type) :: deck
   type(model_type) :: model
   type(output_type) :: output
   type(printer_type) :: printer
   type(fault_list_type) :: faults
   type(error_type), allocatable :: error
   character(len=1000) :: path

   call get_command_argument(1, path)
   call read_deck(trim(path), deck, model, output, error)
   if (allocated(error)) error stop error%message
   call prepare_model(model, faults)
   if (faults%n_faults > 0) error stop "the scene of the deck has faults"
   call run_model(model, printer, error)
   if (allocated(error)) error stop error%message
end program host
