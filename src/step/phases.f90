!> From one phase to the next: what acts, what is held, and where displacements start to count.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_phases
   use coulter_base_kinds, only: wp
   use coulter_boundary_held_edge, only: find_held_edges, held_edge_type
   use coulter_model, only: model_type
   use coulter_model_phases, only: activate
   use coulter_newton_guess, only: forget_motion
   use coulter_system, only: system_type
   implicit none(type, external)
   private
   public :: begin_phase

contains

   !> Begin a phase after another one. Boundaries that begin to act hold the edges that touch them
   !> now, those that end let go.
   subroutine begin_phase(model, system, phase)
      !> Scene at the end of the phase before.
      type(model_type), intent(inout) :: model
      !> Workspace of the run.
      type(system_type), intent(inout) :: system
      !> Number of the phase, from 2.
      integer, intent(in) :: phase

      if (model%schedule%phases(phase - 1)%resets_displacements) then
         model%points%displacement = 0.0_wp
      end if
      call activate(model, phase)
      if (allocated(system%kept_tiles)) deallocate (system%kept_tiles)
      call forget_motion(system)
      system%is_set_up = .false.
      if (allocated(system%held_edges)) call renew_held_edges(model, system%held_edges)
   end subroutine begin_phase

   !> Find anew which edges are held; those that stay in the same hands keep their place there.
   subroutine renew_held_edges(model, held)
      type(model_type), intent(in) :: model
      type(held_edge_type), allocatable, intent(inout) :: held(:)
      type(held_edge_type), allocatable :: fresh(:)
      integer :: e

      call find_held_edges(fresh, model%boundaries, model%tiling, model%grid%smallest_spacing())
      do e = 1, size(held)
         if (held(e)%boundary == 0) cycle
         if (model%boundaries(held(e)%boundary)%is_active) fresh(e) = held(e)
      end do
      call move_alloc(fresh, held)
   end subroutine renew_held_edges

end module coulter_step_phases
