!> From tiles to the system: forces to corners, matrices to the tangent.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_tile_scatter
   use coulter_algebra_sparse, only: add_element_matrix
   use coulter_base_kinds, only: wp
   use coulter_step_system, only: system_type
   use coulter_step_unknowns, only: condense, max_unknowns
   implicit none(type, external)
   private
   public :: add_at_corners, scatter_tile

contains

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

   !> Add the matrix of a tile to the tangent.
   subroutine scatter_tile(system, tile, stiffness)
      !> System of the step; gets `values`.
      type(system_type), intent(inout) :: system
      !> Number of the tile.
      integer, intent(in) :: tile
      !> Its matrix, shape (component, vertex, component, vertex).
      real(wp), intent(in) :: stiffness(2, 4, 2, 4)
      real(wp) :: condensed(4*max_unknowns**2)
      integer :: m

      m = system%coupling%elements%start(tile + 1) - system%coupling%elements%start(tile)
      call condense(system%coupling, tile, stiffness, m, condensed)
      call add_element_matrix(system%pattern, tile, condensed(:m*m), system%values)
   end subroutine scatter_tile

end module coulter_step_tile_scatter
