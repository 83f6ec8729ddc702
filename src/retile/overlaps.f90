!> Tiles that polygons share area with.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_overlaps
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid, find_overlap
   use coulter_points_tiling, only: tiling_type, values_at
   implicit none(type, external)
   private
   public :: lookup_type, overlaps_type, sort_tiles, find_overlaps

   !> Tiles by the cells of a lattice that the boxes around them touch.
   type :: lookup_type
      private
      real(wp) :: origin(2) = 0.0_wp, spacing = 1.0_wp
      !> First entry and number of entries of every cell, shape (nx, ny); the entries.
      integer, allocatable :: start(:, :), count(:, :), tile(:)
   end type lookup_type

   !> Tiles that share area with a polygon.
   type :: overlaps_type
      !> Their number, their tiles.
      integer :: n = 0
      integer, allocatable :: tile(:)
      !> Shared areas, shape (>= n), and the way to their centroids from those of the tiles, length
      !> units, shape (2, >= n).
      real(wp), allocatable :: area(:), way(:, :)
   end type overlaps_type

   !> Polygons that share less than this part of their area with tiles share none.
   real(wp), parameter :: least_share = 1.0e-6_wp

contains

   !> Tiles of a body that share area with a polygon; if there is none, the one with the nearest
   !> centroid as if it were all.
   pure subroutine find_overlaps(overlaps, lookup, tiling, body, centroid, corner, wanted)
      !> What is found; keeps its room from call to call.
      type(overlaps_type), intent(inout) :: overlaps
      !> Lookup of the tiles.
      type(lookup_type), intent(in) :: lookup
      !> Tiles.
      type(tiling_type), intent(in) :: tiling
      !> Body of every tile, shape (n_tiles).
      integer, intent(in) :: body(:)
      !> Centroid of every tile, length units, shape (2, n_tiles).
      real(wp), intent(in) :: centroid(:, :)
      !> Corners of the polygon, counter-clockwise, length units.
      real(wp), intent(in) :: corner(2, 4)
      !> Body that tiles must belong to.
      integer, intent(in) :: wanted
      integer :: i, j, k, low(2), high(2)
      real(wp) :: area, place(2)

      if (.not. allocated(overlaps%tile)) then
         allocate (overlaps%tile(size(body)), overlaps%area(size(body)))
         allocate (overlaps%way(2, size(body)))
      end if
      overlaps%n = 0
      call cells_around(lookup, corner, low, high)
      do j = low(2), high(2)
         do i = low(1), high(1)
            do k = lookup%start(i, j), lookup%start(i, j) + lookup%count(i, j) - 1
               if (body(lookup%tile(k)) /= wanted) cycle
               call add(overlaps, tiling, lookup%tile(k), centroid, corner)
            end do
         end do
      end do
      call area_and_centroid(corner, area, place)
      if (sum(overlaps%area(:overlaps%n)) > least_share*area) return
      overlaps%n = 1
      overlaps%tile(1) = minloc(norm2(centroid - spread(place, 2, size(body)), dim=1), &
                                mask=body == wanted, dim=1)
      overlaps%area(1) = area
      overlaps%way(:, 1) = 0.0_wp
   end subroutine find_overlaps

   !> Add a tile, if it shares area with the polygon and has not been added yet.
   pure subroutine add(overlaps, tiling, tile, centroid, corner)
      type(overlaps_type), intent(inout) :: overlaps
      type(tiling_type), intent(in) :: tiling
      integer, intent(in) :: tile
      real(wp), intent(in) :: centroid(:, :), corner(2, 4)
      real(wp) :: area, place(2)

      if (any(overlaps%tile(:overlaps%n) == tile)) return
      call find_overlap(corner, values_at(tiling%corner(:, tile), tiling%position), area, place)
      if (.not. area > 0.0_wp) return
      overlaps%n = overlaps%n + 1
      overlaps%tile(overlaps%n) = tile
      overlaps%area(overlaps%n) = area
      overlaps%way(:, overlaps%n) = place - centroid(:, tile)
   end subroutine add

   !> Enter every tile in all cells that the box around it touches.
   pure subroutine sort_tiles(lookup, tiling, spacing)
      !> Lookup to make.
      type(lookup_type), intent(out) :: lookup
      !> Tiles.
      type(tiling_type), intent(in) :: tiling
      !> Size of the cells, length units.
      real(wp), intent(in) :: spacing
      integer :: p, i, j, n, pass, low(2), high(2)

      lookup%origin = minval(tiling%position, dim=2)
      lookup%spacing = spacing
      associate (n_cells => int((maxval(tiling%position, dim=2) - lookup%origin)/spacing) + 1)
         allocate (lookup%count(n_cells(1), n_cells(2)), source=0)
      end associate
      lookup%start = lookup%count
      do pass = 1, 2
         lookup%count = 0
         do p = 1, size(tiling%corner, 2)
            call cells_around(lookup, tiling%position(:, tiling%corner(:, p)), low, high)
            do j = low(2), high(2)
               do i = low(1), high(1)
                  if (pass == 2) lookup%tile(lookup%start(i, j) + lookup%count(i, j)) = p
                  lookup%count(i, j) = lookup%count(i, j) + 1
               end do
            end do
         end do
         if (pass == 2) return
         allocate (lookup%tile(sum(lookup%count)))
         n = 1
         do j = 1, size(lookup%count, 2)
            do i = 1, size(lookup%count, 1)
               lookup%start(i, j) = n
               n = n + lookup%count(i, j)
            end do
         end do
      end do
   end subroutine sort_tiles

   !> Range of cells that the box around a polygon touches.
   pure subroutine cells_around(lookup, corner, low, high)
      type(lookup_type), intent(in) :: lookup
      real(wp), intent(in) :: corner(2, 4)
      integer, intent(out) :: low(2), high(2)

      low = floor((minval(corner, dim=2) - lookup%origin)/lookup%spacing) + 1
      high = floor((maxval(corner, dim=2) - lookup%origin)/lookup%spacing) + 1
      low = min(max(low, 1), shape(lookup%count))
      high = min(max(high, 1), shape(lookup%count))
   end subroutine cells_around

end module coulter_retile_overlaps
