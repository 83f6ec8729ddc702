!> Forces and tangent of bodies whose domains tile them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_tile_assembly
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_step_contact_forces, only: add_contacts
   use coulter_step_ghost, only: add_ghost_forces
   use coulter_step_hourglass, only: add_hourglass
   use coulter_step_point_kernel, only: add_force, add_stiffness, point_response_type
   use coulter_step_system, only: system_type
   use coulter_step_tile_map, only: interpolate, spread_to_nodes
   use coulter_step_tile_patches, only: scatter_tile_patches
   use coulter_step_tile_scatter, only: add_at_corners, respond_tile, scatter_tile
   use coulter_step_tile_sharing, only: share_volume_changes
   implicit none(type, external)
   private
   public :: add_tiles

contains

   !> Add tiles, ghost penalty and contacts to forces and tangent.
   subroutine add_tiles(system, model, failed_tile)
      !> System of the step.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Tile that is turned inside out or whose law failed, else 0.
      integer, intent(out) :: failed_tile
      real(wp) :: at_corners(2, model%tiling%n_corners)

      call interpolate(system%map, system%increment)
      if (allocated(system%tile_patches)) then
         call share_volume_changes(system, model, failed_tile)
         if (failed_tile > 0) return
      end if
      at_corners = 0.0_wp
      call add_interiors(system, model, at_corners, failed_tile)
      if (failed_tile > 0) return
      call spread_to_nodes(system%map, at_corners, system%internal)
      call add_ghost_forces(system%ghost, system%ghost_stiffness, system%increment, &
                            system%internal)
      at_corners = 0.0_wp
      system%loaded_length = 0.0_wp
      call add_contacts(system, model, at_corners)
      call spread_to_nodes(system%map, at_corners, system%boundary)
      if (.not. (allocated(system%tile_patches) .and. system%needs_tangent)) return
      call scatter_tile_patches(system%tile_patches, system%pattern, system%elements%n_elements, &
                                system%values)
   end subroutine add_tiles

   !> Internal force and tangent of all tiles.
   subroutine add_interiors(system, model, at_corners, failed_tile)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: at_corners(:, :)
      integer, intent(out) :: failed_tile
      type(point_response_type) :: response
      real(wp) :: force(2, 4), stiffness(2, 4, 2, 4)
      integer :: p
      logical :: has_failed

      do p = 1, model%points%n_points
         associate (volume => model%points%reference_volume(p))
            call respond_tile(system, model, p, response, has_failed)
            failed_tile = p
            if (has_failed) return
            force = 0.0_wp
            stiffness = 0.0_wp
            call add_force(response%gradient, response%stress, volume, force)
            call add_stiffness(response%gradient, response%moduli, volume, stiffness)
            call add_hourglass(model, system%map, p, force, stiffness)
            call add_at_corners(model%tiling%corner(:, p), force, at_corners)
         end associate
         call scatter_tile(system, p, stiffness)
      end do
      failed_tile = 0
   end subroutine add_interiors

end module coulter_step_tile_assembly
