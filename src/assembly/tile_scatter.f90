!> What single tiles answer, and how it enters the system: forces at corners, tangent entries.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly_tile_scatter
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_points_tiling, only: values_at
   use coulter_system, only: system_type
   use coulter_system_point_kernel, only: point_response_type, respond
   use coulter_system_tile_stars, only: add_matrix
   implicit none(type, external)
   private
   public :: respond_tile, add_at_corners, scatter_tile

contains

   !> Stress and moduli of a tile at the current increments; of one that shares its volume change,
   !> those that have been found for its patch.
   subroutine respond_tile(system, model, tile, response, has_failed)
      !> System of the step.
      type(system_type), intent(in) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Number of the tile.
      integer, intent(in) :: tile
      !> What it answers.
      type(point_response_type), intent(out) :: response
      !> Is it turned inside out, or did its law fail?
      logical, intent(out) :: has_failed

      if (allocated(system%tile_patches)) then
         if (model%tiling%patch(tile) > 0) then
            response = system%tile_patches%response(tile)
            has_failed = .false.
            return
         end if
      end if
      associate (item => model%laws(model%bodies(model%points%body(tile))%law))
         call respond(item%law, system%visit(tile), system%map%gradient(:, :, tile), &
                      values_at(model%tiling%corner(:, tile), system%map%increment), &
                      model%points%converged%elastic_finger(:, tile), &
                      model%points%converged%law_state(:, tile), response)
      end associate
      has_failed = response%has_failed
   end subroutine respond_tile

   !> Add the forces of a tile to those of its corners; a triangle has one corner twice.
   pure subroutine add_at_corners(corner, force, at_corners)
      !> Corners of the tile.
      integer, intent(in) :: corner(4)
      !> Forces on its vertices.
      real(wp), intent(in) :: force(2, 4)
      !> Forces on all corners, shape (2, n_corners).
      real(wp), intent(inout) :: at_corners(:, :)
      integer :: v

      do v = 1, 4
         at_corners(:, corner(v)) = at_corners(:, corner(v)) + force(:, v)
      end do
   end subroutine add_at_corners

   !> Add the matrix of a tile to the tangent of the corners, if that is needed.
   pure subroutine scatter_tile(system, tile, stiffness)
      !> System of the step; gets `stars`.
      type(system_type), intent(inout) :: system
      !> Number of the tile.
      integer, intent(in) :: tile
      !> Its matrix, shape (component, vertex, component, vertex).
      real(wp), intent(in) :: stiffness(2, 4, 2, 4)

      if (system%needs_tangent) call add_matrix(system%stars, tile, stiffness)
   end subroutine scatter_tile

end module coulter_assembly_tile_scatter
