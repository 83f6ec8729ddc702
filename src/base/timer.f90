!> Wall time by phase.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_timer
   use coulter_base_kinds, only: long, wp
   implicit none(type, external)
   private
   public :: stopwatch_type, new_stopwatch, wall_seconds

   !> Adds up the wall time spent in numbered phases, one running at a time.
   type :: stopwatch_type
      !> Wall time by phase, seconds, shape (n_phases); the running phase counts when it stops.
      real(wp), allocatable :: seconds(:)
      !> Phase that is running, 0 if none.
      integer, private :: phase = 0
      !> Clock count at which it started.
      integer(long), private :: started = 0
   contains
      procedure :: start => start_phase
      procedure :: stop => stop_phase
   end type stopwatch_type

contains

   !> Make a watch at rest with all phases at zero.
   pure subroutine new_stopwatch(watch, n_phases)
      !> Watch to make.
      type(stopwatch_type), intent(out) :: watch
      !> Number of phases, >= 1.
      integer, intent(in) :: n_phases

      allocate (watch%seconds(n_phases), source=0.0_wp)
   end subroutine new_stopwatch

   !> Start a phase; the one that is running stops.
   subroutine start_phase(self, phase)
      class(stopwatch_type), intent(inout) :: self
      !> Number of the phase, from 1.
      integer, intent(in) :: phase

      call self%stop()
      self%phase = phase
      call system_clock(count=self%started)
   end subroutine start_phase

   !> Stop the running phase, if any, and add its time.
   subroutine stop_phase(self)
      class(stopwatch_type), intent(inout) :: self
      integer(long) :: count, rate

      if (self%phase == 0) return
      call system_clock(count=count, count_rate=rate)
      self%seconds(self%phase) = self%seconds(self%phase) &
         + real(count - self%started, wp)/real(rate, wp)
      self%phase = 0
   end subroutine stop_phase

   !> Wall time since some fixed moment, seconds; only differences mean something.
   function wall_seconds() result(seconds)
      real(wp) :: seconds
      integer(long) :: count, rate

      call system_clock(count=count, count_rate=rate)
      seconds = real(count, wp)/real(rate, wp)
   end function wall_seconds

end module coulter_base_timer
