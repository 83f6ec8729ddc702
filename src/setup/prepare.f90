!> What a step needs before it is solved: who takes part, which are the unknowns, what boundaries
!> meet.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_setup_prepare
   use coulter_base_text, only: to_text
   use coulter_model, only: model_type
   use coulter_model_observer, only: phase_locate, phase_number
   use coulter_setup_points, only: find_participants, number_system
   use coulter_setup_sites, only: place_sites
   use coulter_setup_tiles, only: find_contacts, find_tile_participants, number_tile_system, &
      set_border
   use coulter_system, only: system_type
   implicit none(type, external)
   private
   public :: prepare_step, prepare_system

contains

   !> Who takes part, and which are the unknowns.
   subroutine prepare_system(model, system, failure)
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> System to set up.
      type(system_type), intent(inout) :: system
      !> Why it cannot be set up; unallocated when it is.
      character(len=:), allocatable, intent(out) :: failure

      system%is_set_up = .false.
      call prepare_step(model, system, failure)
   end subroutine prepare_system

   !> The same, but what depends on the state of the scene alone is kept while that has not changed.
   subroutine prepare_step(model, system, failure)
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> System to set up.
      type(system_type), intent(inout) :: system
      !> Why it cannot be set up; unallocated when it is.
      character(len=:), allocatable, intent(out) :: failure

      if (.not. system%is_set_up) call set_up(model, system, failure)
      if (.not. allocated(failure)) call meet_boundaries(model, system)
   end subroutine prepare_step

   !> What depends on the state of the scene alone: it serves until that changes.
   subroutine set_up(model, system, failure)
      type(model_type), intent(in) :: model
      type(system_type), intent(inout) :: system
      character(len=:), allocatable, intent(out) :: failure
      integer :: first_outside
      logical :: has_failed

      call system%watch%start(phase_locate)
      if (allocated(model%tiling)) then
         call find_tile_participants(system, model, first_outside)
      else
         call find_participants(system, model, first_outside)
      end if
      call system%watch%stop()
      if (first_outside > 0) then
         failure = trim(merge("corner", "point ", allocated(model%tiling)))//" " &
            //to_text(first_outside)//" is outside the grid"
         return
      end if
      call system%watch%start(phase_number)
      system%solver%is_lu_only = model%control%is_lu_only
      if (allocated(model%tiling)) then
         call number_tile_system(system, model, has_failed)
      else
         call number_system(system, model, has_failed)
      end if
      call system%watch%stop()
      if (has_failed) failure = "the sparsity pattern cannot be analysed (out of memory?)"
      system%is_set_up = .not. has_failed
   end subroutine set_up

   !> What depends on the step as well: phases of laws, the way that boundaries go. Stations of
   !> points do not.
   subroutine meet_boundaries(model, system)
      type(model_type), intent(in) :: model
      type(system_type), intent(inout) :: system

      call system%watch%start(phase_locate)
      call place_sites(system, model)
      if (allocated(model%tiling)) then
         call find_contacts(system, model)
         call set_border(system, model)
      end if
      call system%watch%stop()
   end subroutine meet_boundaries

end module coulter_setup_prepare
