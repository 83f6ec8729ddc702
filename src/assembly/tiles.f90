!> Forces and tangent of bodies whose domains tile them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly_tiles
   use coulter_assembly_contact_forces, only: add_contacts
   use coulter_assembly_hourglass, only: find_pull
   use coulter_assembly_loose_parts, only: add_drag
   use coulter_assembly_surface_forces, only: add_surfaces
   use coulter_assembly_tile_scatter, only: add_at_corners, respond_tile
   use coulter_assembly_tile_sharing, only: share_volume_changes
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_system, only: system_type
   use coulter_system_ghost, only: add_ghost_forces
   use coulter_system_point_kernel, only: add_force, point_response_type
   use coulter_system_star_groups, only: scatter_stars
   use coulter_system_surfaces, only: scatter_surfaces
   use coulter_system_tile_map, only: interpolate, spread_to_nodes
   use coulter_system_tile_patches, only: scatter_tile_patches
   use coulter_system_tile_stars, only: add_moduli, clear_stars
   implicit none(type, external)
   private
   public :: add_tiles, sum_tangent

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
      if (system%needs_tangent) call clear_stars(system%stars)
      call add_interiors(system, model, at_corners, failed_tile)
      if (failed_tile > 0) return
      if (allocated(system%drag) .or. system%settling_drag > 0.0_wp) then
         call add_drag(system, model, at_corners)
      end if
      call spread_to_nodes(system%map, at_corners, system%internal)
      call add_ghost_forces(system%ghost, system%ghost_stiffness, system%increment, &
                            system%internal)
      at_corners = 0.0_wp
      system%loaded_length = 0.0_wp
      call add_contacts(system, model, at_corners)
      if (allocated(system%surfaces)) call add_surfaces(system, model, at_corners)
      call spread_to_nodes(system%map, at_corners, system%boundary)
   end subroutine add_tiles

   !> Tangent from what tiles, their contacts and loads have added to that of the corners.
   subroutine sum_tangent(system)
      !> System of the step; gets `values`.
      type(system_type), intent(inout) :: system

      system%values = system%ghost_values
      call scatter_stars(system%groups, system%stars, system%pattern, system%values)
      if (allocated(system%surfaces)) then
         call scatter_surfaces(system%surfaces, system%pattern, &
                               system%groups%elements%n_elements + system%ghost%n_faces, &
                               system%values)
      end if
      if (.not. allocated(system%tile_patches)) return
      call scatter_tile_patches(system%tile_patches, system%pattern, system%elements%n_elements, &
                                system%values)
   end subroutine sum_tangent

   !> Internal force and tangent of all tiles.
   subroutine add_interiors(system, model, at_corners, failed_tile)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: at_corners(:, :)
      integer, intent(out) :: failed_tile
      type(point_response_type) :: response
      real(wp) :: force(2, 4), vector(4), pull(2), slope(2, 2)
      integer :: p, v
      logical :: has_failed

      do p = 1, model%points%n_points
         call respond_tile(system, model, p, response, has_failed)
         failed_tile = p
         if (has_failed) return
         call find_pull(model, system%map, p, system%hourglass_stiffness(p), vector, pull, slope)
         do v = 1, 4
            force(:, v) = vector(v)*pull
         end do
         associate (volume => model%points%reference_volume(p))
            call add_force(response%gradient, response%stress, volume, force)
            if (system%needs_tangent) call add_moduli(system%stars, p, response%gradient, &
                                                      volume*response%moduli, vector, slope)
         end associate
         call add_at_corners(model%tiling%corner(:, p), force, at_corners)
      end do
      failed_tile = 0
   end subroutine add_interiors

end module coulter_assembly_tiles
