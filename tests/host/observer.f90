!> Prints what the first boundary of a scene feels. An observer is told after every step; it may look
!> at all of the model, and end the run by an error.
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
