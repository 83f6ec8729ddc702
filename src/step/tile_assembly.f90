!> Forces and tangent of bodies whose domains tile them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_tile_assembly
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type, point_moduli
   use coulter_step_contact_forces, only: add_contacts
   use coulter_step_ghost, only: add_ghost_forces
   use coulter_step_point_kernel, only: add_force, add_stiffness, point_response_type
   use coulter_step_system, only: system_type
   use coulter_step_tile_map, only: interpolate, spread_to_nodes
   use coulter_step_tile_scatter, only: add_at_corners, respond_tile, scatter_tile
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
         associate (corner => model%tiling%corner(:, p), &
                    volume => model%points%reference_volume(p))
            call respond_tile(system, model, p, response, has_failed)
            failed_tile = p
            if (has_failed) return
            force = 0.0_wp
            stiffness = 0.0_wp
            call add_force(response%gradient, response%stress, volume, force)
            call add_stiffness(response%gradient, response%moduli, volume, stiffness)
            call add_hourglass(hourglass_stiffness(model, p), &
                               model%tiling%hourglass(:, p), model%tiling%position(:, corner) &
                               + system%map%increment(:, corner), force, stiffness)
            call add_at_corners(corner, force, at_corners)
         end associate
         call scatter_tile(system, p, stiffness)
      end do
      failed_tile = 0
   end subroutine add_interiors

   !> k_hg = e (8/3) G/(1 - nu) with nu = lambda/(2 (lambda + G)).
   pure function hourglass_stiffness(model, tile) result(stiffness)
      type(model_type), intent(in) :: model
      integer, intent(in) :: tile
      real(wp) :: stiffness
      real(wp) :: lame_lambda, shear_modulus

      call point_moduli(model, tile, lame_lambda, shear_modulus)
      stiffness = model%control%hourglass_ratio*16.0_wp/3.0_wp*shear_modulus &
         *(lame_lambda + shear_modulus)/(lame_lambda + 2.0_wp*shear_modulus)
   end function hourglass_stiffness

   !> Hourglass control in total form: force k Gamma_a (sum_b Gamma_b x_b), zero for affine maps.
   pure subroutine add_hourglass(hourglass, vector, position, force, stiffness)
      real(wp), intent(in) :: hourglass, vector(4), position(2, 4)
      real(wp), intent(inout) :: force(2, 4), stiffness(2, 4, 2, 4)
      real(wp) :: amplitude(2)
      integer :: b

      ! relative to the first corner, so that far from the origin no digits are lost
      amplitude = matmul(position - spread(position(:, 1), 2, 4), vector)
      do b = 1, 4
         force(:, b) = force(:, b) + hourglass*vector(b)*amplitude
         stiffness(1, :, 1, b) = stiffness(1, :, 1, b) + hourglass*vector(b)*vector
         stiffness(2, :, 2, b) = stiffness(2, :, 2, b) + hourglass*vector(b)*vector
      end do
   end subroutine add_hourglass

end module coulter_step_tile_assembly
