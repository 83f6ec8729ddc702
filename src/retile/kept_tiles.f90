!> Takes down tiles with all that hangs on them, and brings them back.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_kept_tiles
   use coulter_model, only: model_type
   use coulter_system, only: system_type
   use coulter_system_kept_tiles, only: kept_tiles_type
   implicit none(type, external)
   private
   public :: keep_tiles, bring_back

contains

   !> A copy of the tiles between two steps.
   pure subroutine keep_tiles(kept, model, system)
      !> The copy.
      type(kept_tiles_type), intent(out) :: kept
      !> Scene and system, which remember these tiles.
      type(model_type), intent(in) :: model
      type(system_type), intent(in) :: system

      kept%tiling = model%tiling
      kept%points = model%points
      kept%held_edges = system%held_edges
      kept%loaded_edges = system%loaded_edges
      if (allocated(system%bonds)) kept%bonds = system%bonds
      kept%last_contacts = system%last_contacts
      if (allocated(system%surfaces)) kept%pairs = system%surfaces%last
      kept%way_since_tiling = system%way_since_tiling
   end subroutine keep_tiles

   !> Let scene and system be as they were when tiles were kept, but for `cuts`.
   pure subroutine bring_back(kept, model, system)
      !> The copy.
      type(kept_tiles_type), intent(in) :: kept
      !> Scene at the same time, and its system; what is set up must be set up again.
      type(model_type), intent(inout) :: model
      type(system_type), intent(inout) :: system

      model%tiling = kept%tiling
      model%points = kept%points
      system%held_edges = kept%held_edges
      system%loaded_edges = kept%loaded_edges
      if (allocated(kept%bonds)) system%bonds = kept%bonds
      system%last_contacts = kept%last_contacts
      if (allocated(kept%pairs)) system%surfaces%last = kept%pairs
      system%way_since_tiling = kept%way_since_tiling
      system%is_set_up = .false.
   end subroutine bring_back

end module coulter_retile_kept_tiles
