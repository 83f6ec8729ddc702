!> Tells laws that ask for it where the points are and how far the run is.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_setup_sites
   use coulter_law_abstract, only: law_sites_type
   use coulter_model, only: model_type
   use coulter_system, only: system_type
   implicit none(type, external)
   private
   public :: open_sites, place_sites, release_sites

contains

   !> Before a run or a phase: count its increments from here. Nothing where no law asks.
   subroutine open_sites(system, model, phase)
      !> Workspace of the run.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the phase.
      type(model_type), intent(in) :: model
      !> Number of the phase.
      integer, intent(in) :: phase
      integer :: i

      if (.not. associated(system%sites)) then
         do i = 1, size(model%laws)
            if (model%laws(i)%law%needs_sites) exit
         end do
         if (i > size(model%laws)) return
         allocate (system%sites)
      end if
      system%sites = law_sites_type(phase=phase, phase_start=model%time)
   end subroutine open_sites

   !> At the start of a step: places and sizes of the points.
   subroutine place_sites(system, model)
      !> Workspace of the run.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model

      if (.not. associated(system%sites)) return
      associate (points => model%points)
         system%sites%position = points%position
         system%sites%length = sqrt(points%reference_volume*points%volume_ratio)
      end associate
   end subroutine place_sites

   !> After a run.
   subroutine release_sites(system)
      !> Workspace of the run.
      type(system_type), intent(inout) :: system

      if (associated(system%sites)) deallocate (system%sites)
   end subroutine release_sites

end module coulter_setup_sites
