!> Which tiles share their volume change: those of one body that are made in one cell.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_tile_groups
   use coulter_grid, only: grid_type
   use coulter_points, only: points_type
   use coulter_points_body, only: body_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: group_tiles

contains

   !> Number the patches of tiles that share their volume change from now on. Bodies with one point
   !> per cell have none.
   pure subroutine group_tiles(tiling, points, grid, bodies)
      !> New tiles; get `patch`.
      type(tiling_type), intent(inout) :: tiling
      !> Their points.
      type(points_type), intent(in) :: points
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Bodies.
      type(body_type), intent(in) :: bodies(:)
      integer :: cell(2, points%n_points), b, p, n_patches

      do p = 1, points%n_points
         cell(:, p) = grid%cell_of(points%position(:, p))
      end do
      tiling%patch = spread(0, 1, points%n_points)
      n_patches = 0
      do b = 1, size(bodies)
         if (bodies(b)%points_per_cell > 1) call group_body(tiling%patch, cell, points%body == b, &
                                                            n_patches)
      end do
   end subroutine group_tiles

   !> Patches of one body.
   pure subroutine group_body(patch, cell, is_own, n_patches)
      integer, intent(inout) :: patch(:)
      !> Cell of every point, and whether it belongs to the body.
      integer, intent(in) :: cell(:, :)
      logical, intent(in) :: is_own(:)
      !> Patches so far.
      integer, intent(inout) :: n_patches
      integer, allocatable :: number(:, :)
      integer :: p

      if (.not. any(is_own)) return
      allocate (number(minval(cell(1, :), mask=is_own):maxval(cell(1, :), mask=is_own), &
                       minval(cell(2, :), mask=is_own):maxval(cell(2, :), mask=is_own)), source=0)
      do p = 1, size(patch)
         if (.not. is_own(p)) cycle
         associate (here => number(cell(1, p), cell(2, p)))
            if (here == 0) then
               n_patches = n_patches + 1
               here = n_patches
            end if
            patch(p) = here
         end associate
      end do
   end subroutine group_body

end module coulter_points_tile_groups
