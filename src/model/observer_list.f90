!> Several observers that watch a run as one.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_observer_list
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_model_observer, only: n_phases, observer_item_type, observer_type, &
      scene_report_type, step_report_type
   implicit none(type, external)
   private
   public :: observer_list_type

   !> Forwards every call to its members, in the order in which they were added.
   type, extends(observer_type) :: observer_list_type
      private
      !> The members.
      type(observer_item_type), allocatable :: members(:)
      !> Members that were told of the start, also if they failed in it.
      integer :: n_started = 0
   contains
      procedure :: add => add_observer
      procedure :: start => start_all
      procedure :: step_done => step_done_all
      procedure :: finish => finish_all
   end type observer_list_type

contains

   !> Add a member at the end of the list.
   subroutine add_observer(self, observer)
      class(observer_list_type), intent(inout) :: self
      !> Member to add; the list keeps its own copy.
      class(observer_type), intent(in) :: observer
      type(observer_item_type), allocatable :: grown(:)
      integer :: i, n_members

      n_members = 0
      if (allocated(self%members)) n_members = size(self%members)
      allocate (grown(n_members + 1))
      do i = 1, n_members
         call move_alloc(self%members(i)%observer, grown(i)%observer)
      end do
      allocate (grown(n_members + 1)%observer, source=observer)
      call move_alloc(grown, self%members)
   end subroutine add_observer

   !> See `observer_type`; the first member that fails ends the run.
   subroutine start_all(self, model, scene, error)
      class(observer_list_type), intent(inout) :: self
      !> The model at time 0.
      type(model_type), intent(in) :: model
      !> Facts about the scene.
      type(scene_report_type), intent(in) :: scene
      !> Set to end the run.
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      if (.not. allocated(self%members)) return
      do i = 1, size(self%members)
         self%n_started = i
         call self%members(i)%observer%start(model, scene, error)
         if (allocated(error)) return
      end do
   end subroutine start_all

   !> See `observer_type`; the first member that fails ends the run.
   subroutine step_done_all(self, model, report, error)
      class(observer_list_type), intent(inout) :: self
      !> The model at the end of the step.
      type(model_type), intent(in) :: model
      !> What happened.
      type(step_report_type), intent(in) :: report
      !> Set to end the run.
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      if (.not. allocated(self%members)) return
      do i = 1, size(self%members)
         call self%members(i)%observer%step_done(model, report, error)
         if (allocated(error)) return
      end do
   end subroutine step_done_all

   !> See `observer_type`; members that were never started hear nothing.
   subroutine finish_all(self, model, failure, phase_seconds)
      class(observer_list_type), intent(inout) :: self
      !> The model as it was last accepted.
      type(model_type), intent(in) :: model
      !> Why the run ended early; unallocated when it reached its end.
      type(error_type), allocatable, intent(in) :: failure
      !> Wall time by phase since the last report, seconds: its output and failed attempts.
      real(wp), intent(in) :: phase_seconds(n_phases)
      integer :: i

      do i = 1, self%n_started
         call self%members(i)%observer%finish(model, failure, phase_seconds)
      end do
   end subroutine finish_all

end module coulter_model_observer_list
