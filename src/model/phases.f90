!> Phases of a run: which boundaries and fixities act in them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_phases
   use coulter_model, only: model_type
   implicit none(type, external)
   private
   public :: activate

contains

   !> Switch boundaries and fixities on and off for a phase.
   pure subroutine activate(model, phase)
      !> Scene to change.
      type(model_type), intent(inout) :: model
      !> Number of the phase.
      integer, intent(in) :: phase

      model%boundaries%is_active = acts(model%boundaries%first_phase, &
                                        model%boundaries%last_phase, phase)
      model%fixities%is_active = acts(model%fixities%first_phase, model%fixities%last_phase, phase)
   end subroutine activate

   !> Is a phase one of those in which something acts?
   elemental function acts(first, last, phase) result(answer)
      integer, intent(in) :: first, last, phase
      logical :: answer

      answer = phase >= first .and. phase <= last
   end function acts

end module coulter_model_phases
