!> Patches of tiles that share their volume change: their corners, and how these hang together.
!>
!> Beyond the matrices of its tiles, a patch adds one of rank two to the tangent: the forces that go
!> with the mean volume change of the patch, and those that go with its pressure. Contacts on edges
!> of a tile depend on both as well, and add to these forces (theory, section 4).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_tile_patches
   use coulter_algebra_sparse, only: add_element_matrix, pattern_type
   use coulter_base_kinds, only: long, wp
   use coulter_points_tiling, only: tiling_type
   use coulter_system_dofs, only: dofs_type
   use coulter_system_point_kernel, only: point_response_type
   use coulter_system_tile_map, only: tile_map_type
   use coulter_system_unknowns, only: coupling_type, couple_vertices, new_coupling
   implicit none(type, external)
   private
   public :: tile_patches_type, build_tile_patches, couple_tile_patches, stress_by_mean, &
      add_by_mean, add_mean_slopes, scatter_tile_patches, tile_patches_memory

   !> All patches of a step.
   type :: tile_patches_type
      !> Number of patches.
      integer :: n = 0
      !> First entry of every patch in `tile`, shape (n + 1), and its tiles.
      integer, allocatable :: tile_start(:), tile(:)
      !> First entry of every patch in `corner`, shape (n + 1), and its corners.
      integer, allocatable :: corner_start(:), corner(:)
      !> Where the vertices of every tile stand in `corner`; 0 outside of patches, shape
      !> (4, n_tiles).
      integer, allocatable :: place(:, :)
      !> Derivatives of the mean volume change and of the pressure by the corners, per length, force
      !> per length, and the forces on the corners that go with them, shape (2, 2, size(corner)).
      real(wp), allocatable :: slope(:, :, :), force(:, :, :)
      !> What the tiles of patches answer to the shared volume change, shape (n_tiles).
      type(point_response_type), allocatable :: response(:)
      !> How the stress of every tile changes with the mean volume change, components 11, 21, 12,
      !> 22, stress units, and with the pressure, per volume, shapes (4, n_tiles), (n_tiles).
      real(wp), allocatable :: by_volume(:, :), by_pressure(:)
      !> Unknowns of all patches.
      type(coupling_type) :: coupling
   end type tile_patches_type

contains

   !> Lists of tiles and corners.
   pure subroutine build_tile_patches(patches, tiling)
      !> Patches to make.
      type(tile_patches_type), intent(out) :: patches
      !> Tiles with their patches.
      type(tiling_type), intent(in) :: tiling
      integer :: e, p, n_tiles

      n_tiles = size(tiling%patch)
      patches%n = maxval(tiling%patch)
      allocate (patches%tile_start(patches%n + 2), source=0)
      do p = 1, n_tiles
         associate (count => patches%tile_start(tiling%patch(p) + 2))
            count = count + 1
         end associate
      end do
      patches%tile_start(1:2) = 1
      do e = 2, patches%n + 1
         patches%tile_start(e + 1) = patches%tile_start(e + 1) + patches%tile_start(e)
      end do
      allocate (patches%tile(patches%tile_start(patches%n + 2) - 1))
      do p = 1, n_tiles
         e = tiling%patch(p)
         if (e == 0) cycle
         patches%tile(patches%tile_start(e + 1)) = p
         patches%tile_start(e + 1) = patches%tile_start(e + 1) + 1
      end do
      patches%tile_start = patches%tile_start(:patches%n + 1)
      call list_corners(patches, tiling)
      allocate (patches%slope(2, 2, size(patches%corner)))
      allocate (patches%force, mold=patches%slope)
      allocate (patches%response(n_tiles))
      allocate (patches%by_volume(4, n_tiles), patches%by_pressure(n_tiles))
   end subroutine build_tile_patches

   !> Distinct corners of every patch.
   pure subroutine list_corners(patches, tiling)
      type(tile_patches_type), intent(inout) :: patches
      type(tiling_type), intent(in) :: tiling
      integer :: last_place(tiling%n_corners), list(4*size(patches%tile)), corner, e, k, v, n

      allocate (patches%corner_start(patches%n + 1), source=1)
      allocate (patches%place(4, size(tiling%patch)), source=0)
      last_place = 0
      n = 0
      do e = 1, patches%n
         do k = patches%tile_start(e), patches%tile_start(e + 1) - 1
            do v = 1, 4
               corner = tiling%corner(v, patches%tile(k))
               if (last_place(corner) < patches%corner_start(e)) then
                  n = n + 1
                  list(n) = corner
                  last_place(corner) = n
               end if
               patches%place(v, patches%tile(k)) = last_place(corner)
            end do
         end do
         patches%corner_start(e + 1) = n + 1
      end do
      patches%corner = list(:n)
   end subroutine list_corners

   !> Unknowns of all patches.
   pure subroutine couple_tile_patches(patches, map, dofs)
      !> Patches; get `coupling`.
      type(tile_patches_type), intent(inout) :: patches
      !> Where their corners sit in the grid.
      type(tile_map_type), intent(in) :: map
      !> Numbering.
      type(dofs_type), intent(in) :: dofs
      integer :: e

      associate (start => patches%corner_start)
         call new_coupling(patches%coupling, patches%n, maxval(start(2:) - start(:patches%n)))
         do e = 1, patches%n
            associate (corner => patches%corner(start(e):start(e + 1) - 1))
               call couple_vertices(patches%coupling, dofs, map%node(:, corner), &
                                    map%shape(:, corner))
            end associate
         end do
      end associate
   end subroutine couple_tile_patches

   !> How a stress vector of a tile changes with mean volume change and pressure of its patch, shape
   !> (component, which).
   pure function stress_by_mean(patches, tile, normal) result(derivative)
      !> Patches with the answers of their tiles.
      type(tile_patches_type), intent(in) :: patches
      !> Number of the tile.
      integer, intent(in) :: tile
      !> What the Kirchhoff stress acts on.
      real(wp), intent(in) :: normal(2)
      real(wp) :: derivative(2, 2)

      derivative = 0.0_wp
      if (patches%place(1, tile) == 0) return
      derivative(:, 1) = matmul(reshape(patches%by_volume(:, tile), [2, 2]), normal)
      derivative(:, 2) = patches%by_pressure(tile)*normal
   end function stress_by_mean

   !> Add derivatives of the forces on the vertices of a tile by mean volume change and pressure.
   pure subroutine add_by_mean(patches, tile, derivative)
      !> Patches; get `force`.
      type(tile_patches_type), intent(inout) :: patches
      !> Number of the tile.
      integer, intent(in) :: tile
      !> Derivatives, shape (component, vertex, mean volume change or pressure).
      real(wp), intent(in) :: derivative(2, 4, 2)
      integer :: v

      do v = 1, 4
         associate (c => patches%place(v, tile))
            if (c > 0) patches%force(:, :, c) = patches%force(:, :, c) + derivative(:, v, :)
         end associate
      end do
   end subroutine add_by_mean

   !> Add the derivative by the corners of a patch of what depends on its mean volume change and
   !> pressure.
   pure subroutine add_mean_slopes(patches, patch, by_mean, at_corners)
      !> Patches.
      type(tile_patches_type), intent(in) :: patches
      !> Number of the patch; nothing is added for 0.
      integer, intent(in) :: patch
      !> Derivatives by mean volume change and pressure.
      real(wp), intent(in) :: by_mean(2)
      !> Derivative by all corners, shape (2, n_corners).
      real(wp), intent(inout) :: at_corners(:, :)
      integer :: c

      if (patch == 0) return
      do c = patches%corner_start(patch), patches%corner_start(patch + 1) - 1
         associate (here => at_corners(:, patches%corner(c)))
            here = here + matmul(patches%slope(:, :, c), by_mean)
         end associate
      end do
   end subroutine add_mean_slopes

   !> Add the matrices of all patches to the tangent.
   pure subroutine scatter_tile_patches(patches, pattern, n_elements, values)
      !> Coupled patches.
      type(tile_patches_type), intent(in) :: patches
      !> Pattern of the tangent; patches are its last elements.
      type(pattern_type), intent(in) :: pattern
      !> Number of its elements.
      integer, intent(in) :: n_elements
      !> Values of the tangent, shape (n_entries).
      real(wp), intent(inout) :: values(:)
      integer :: e, first, n_pairs, n_corners

      do e = 1, patches%n
         first = (patches%coupling%elements%start(e) + 1)/2
         n_pairs = (patches%coupling%elements%start(e + 1) + 1)/2 - first
         n_corners = patches%corner_start(e + 1) - patches%corner_start(e)
         associate (share => patches%coupling%share(:n_corners, first:first + n_pairs - 1), &
                    c => patches%corner_start(e))
            call add_element_matrix(pattern, n_elements - patches%n + e, &
                                    product_of(gathered(patches%force(:, :, c:c + n_corners - 1), &
                                                        share), &
                                               gathered(patches%slope(:, :, c:c + n_corners - 1), &
                                                        share)), values)
         end associate
      end do
   end subroutine scatter_tile_patches

   !> What stands at corners in terms of pairs of unknowns, shape (component, pair, which).
   pure function gathered(at_corners, share) result(at_pairs)
      real(wp), intent(in) :: at_corners(:, :, :), share(:, :)
      real(wp) :: at_pairs(2, size(share, 2), 2)
      integer :: k

      do k = 1, 2
         at_pairs(:, :, k) = matmul(at_corners(:, k, :), share)
      end do
   end function gathered

   !> Matrix of rank two, columns first.
   pure function product_of(left, right) result(matrix)
      real(wp), intent(in) :: left(:, :, :), right(:, :, :)
      real(wp) :: matrix(size(left, 1)**2*size(left, 2)**2)
      integer :: n

      n = size(left)/2
      matrix = reshape(matmul(reshape(left, [n, 2]), transpose(reshape(right, [n, 2]))), &
                       shape(matrix))
   end function product_of

   !> Bytes that the patches occupy.
   pure function tile_patches_memory(patches) result(bytes)
      !> Coupled patches.
      type(tile_patches_type), intent(in) :: patches
      integer(long) :: bytes
      integer, parameter :: reals_per_response = 32

      bytes = 4_long*int(size(patches%tile) + size(patches%corner) + size(patches%place) &
                         + size(patches%coupling%elements%dof), long) &
         + 8_long*int(size(patches%coupling%share) + 2*size(patches%slope) &
                      + (reals_per_response + 5)*size(patches%response), long)
   end function tile_patches_memory

end module coulter_system_tile_patches
