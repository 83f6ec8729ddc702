!> How fields vary from tile to tile: slopes by least squares over the neighbours.
!>
!> A slope is shrunk to the share of the squared differences to the neighbours that it explains,
!> less the share that it does not: a linear field keeps it whole, also at the rim of a body, a
!> smooth one but for a share of the squared spacing, and noise loses it. No frame enters.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_slopes
   use coulter_base_kinds, only: wp
   use coulter_points_tiling, only: list_tiles, tiling_type
   implicit none(type, external)
   private
   public :: field_type, fit_slopes

   !> Fields of one kind: components that a rotation mixes, which are shrunk together.
   type :: field_type
      !> Value in every tile, shape (n_components, n_tiles), of the centroid.
      real(wp), allocatable :: value(:, :)
      !> Weight of every component in the squared norm, shape (n_components).
      real(wp), allocatable :: weight(:)
      !> Slope in every tile, per length, shape (2, n_components, n_tiles).
      real(wp), allocatable :: slope(:, :, :)
      !> Must values stay within those of the neighbours everywhere in a tile?
      logical :: is_bounded = .false.
   end type field_type

   !> Neighbours of a tile, and how to fit to them.
   type :: stencil_type
      !> Their number, their tiles. Do they tell a slope?
      integer :: n = 0
      integer, allocatable :: tile(:)
      logical :: is_enough = .false.
      !> Way to their centroids, length units, shape (2, >= n).
      real(wp), allocatable :: way(:, :)
      !> Shares of their differences in the slope, per length, shape (2, >= n).
      real(wp), allocatable :: share(:, :)
   end type stencil_type

   !> Fewer neighbours tell no slope.
   integer, parameter :: least_neighbours = 3
   !> Nor do neighbours in a row: least determinant of their directions over the squared trace.
   real(wp), parameter :: least_spread = 1.0e-3_wp

contains

   !> Fit slopes of fields in all tiles; bodies do not see each other.
   pure subroutine fit_slopes(fields, tiling, body, centroid)
      !> Fields with values and weights; get slopes.
      type(field_type), intent(inout) :: fields(:)
      !> Tiles.
      type(tiling_type), intent(in) :: tiling
      !> Body of every tile, shape (n_tiles).
      integer, intent(in) :: body(:)
      !> Centroid of every tile, length units, shape (2, n_tiles).
      real(wp), intent(in) :: centroid(:, :)
      type(stencil_type) :: stencil
      integer, allocatable :: start(:), around(:)
      integer :: f, k, p

      allocate (start(tiling%n_corners + 1), around(size(tiling%corner)))
      call list_tiles(tiling%corner, start, around)
      do f = 1, size(fields)
         allocate (fields(f)%slope(2, size(fields(f)%value, 1), size(body)), source=0.0_wp)
      end do
      do p = 1, size(body)
         stencil%n = 0
         call add_neighbours(stencil, p, p, tiling, start, around, body)
         call weigh(stencil, centroid, p)
         if (.not. stencil%is_enough) then
            do k = 1, stencil%n
               call add_neighbours(stencil, stencil%tile(k), p, tiling, start, around, body)
            end do
            call weigh(stencil, centroid, p)
         end if
         if (.not. stencil%is_enough) cycle
         do f = 1, size(fields)
            call fit(fields(f), stencil, p)
            if (fields(f)%is_bounded) call bound(fields(f), stencil, p, centroid(:, p), &
                                                 tiling%position(:, tiling%corner(:, p)))
         end do
      end do
   end subroutine fit_slopes

   !> Slope of one field in one tile.
   pure subroutine fit(field, stencil, tile)
      type(field_type), intent(inout) :: field
      type(stencil_type), intent(in) :: stencil
      integer, intent(in) :: tile
      real(wp) :: slope(2, size(field%weight)), difference(size(field%weight))
      real(wp) :: nearness, total, left
      integer :: k

      slope = 0.0_wp
      do k = 1, stencil%n
         difference = field%value(:, stencil%tile(k)) - field%value(:, tile)
         slope(1, :) = slope(1, :) + stencil%share(1, k)*difference
         slope(2, :) = slope(2, :) + stencil%share(2, k)*difference
      end do
      total = 0.0_wp
      left = 0.0_wp
      do k = 1, stencil%n
         difference = field%value(:, stencil%tile(k)) - field%value(:, tile)
         nearness = 1.0_wp/sum(stencil%way(:, k)**2)
         total = total + nearness*sum(field%weight*difference**2)
         difference = difference - matmul(stencil%way(:, k), slope)
         left = left + nearness*sum(field%weight*difference**2)
      end do
      if (total > 0.0_wp) field%slope(:, :, tile) = max(1.0_wp - 2.0_wp*left/total, 0.0_wp)*slope
   end subroutine fit

   !> Flatten slopes until no corner of the tile leaves the range of the neighbours (Barth and
   !> Jespersen, 1989).
   pure subroutine bound(field, stencil, tile, centroid, corner)
      type(field_type), intent(inout) :: field
      type(stencil_type), intent(in) :: stencil
      integer, intent(in) :: tile
      real(wp), intent(in) :: centroid(2), corner(2, 4)
      real(wp) :: change, room, share
      integer :: c, v

      do c = 1, size(field%weight)
         associate (here => field%value(c, tile), &
                    others => field%value(c, stencil%tile(:stencil%n)))
            share = 1.0_wp
            do v = 1, 4
               change = dot_product(field%slope(:, c, tile), corner(:, v) - centroid)
               room = max(maxval(others) - here, 0.0_wp)
               if (change < 0.0_wp) room = min(minval(others) - here, 0.0_wp)
               if (abs(change) > abs(room)) share = min(share, room/change)
            end do
         end associate
         field%slope(:, c, tile) = share*field%slope(:, c, tile)
      end do
   end subroutine bound

   !> Shares of the neighbours in slopes: least squares, weighted by the inverse squared distance.
   pure subroutine weigh(stencil, centroid, tile)
      type(stencil_type), intent(inout) :: stencil
      real(wp), intent(in) :: centroid(:, :)
      integer, intent(in) :: tile
      real(wp) :: nearness, moment(2, 2), determinant
      integer :: k

      moment = 0.0_wp
      do k = 1, stencil%n
         stencil%way(:, k) = centroid(:, stencil%tile(k)) - centroid(:, tile)
         nearness = 1.0_wp/sum(stencil%way(:, k)**2)
         moment(:, 1) = moment(:, 1) + nearness*stencil%way(1, k)*stencil%way(:, k)
         moment(:, 2) = moment(:, 2) + nearness*stencil%way(2, k)*stencil%way(:, k)
      end do
      determinant = moment(1, 1)*moment(2, 2) - moment(1, 2)*moment(2, 1)
      stencil%is_enough = stencil%n >= least_neighbours &
         .and. determinant > least_spread*(moment(1, 1) + moment(2, 2))**2
      if (.not. stencil%is_enough) return
      moment = reshape([moment(2, 2), -moment(2, 1), -moment(1, 2), moment(1, 1)], [2, 2]) &
         /determinant
      do k = 1, stencil%n
         stencil%share(:, k) = matmul(moment, stencil%way(:, k))/sum(stencil%way(:, k)**2)
      end do
   end subroutine weigh

   !> Add tiles of the same body that share a corner with a tile, but the one whose stencil it is.
   pure subroutine add_neighbours(stencil, tile, centre, tiling, start, around, body)
      type(stencil_type), intent(inout) :: stencil
      integer, intent(in) :: tile, centre, start(:), around(:), body(:)
      type(tiling_type), intent(in) :: tiling
      integer :: c, k, v

      do v = 1, 4
         c = tiling%corner(v, tile)
         call make_room(stencil, stencil%n + start(c + 1) - start(c))
         do k = start(c), start(c + 1) - 1
            if (around(k) == centre .or. body(around(k)) /= body(centre)) cycle
            if (any(stencil%tile(:stencil%n) == around(k))) cycle
            stencil%n = stencil%n + 1
            stencil%tile(stencil%n) = around(k)
         end do
      end do
   end subroutine add_neighbours

   !> Let a stencil hold at least `n` neighbours.
   pure subroutine make_room(stencil, n)
      type(stencil_type), intent(inout) :: stencil
      integer, intent(in) :: n
      integer, allocatable :: kept(:)

      if (allocated(stencil%tile)) then
         if (size(stencil%tile) >= n) return
         kept = stencil%tile(:stencil%n)
         deallocate (stencil%tile, stencil%way, stencil%share)
      end if
      allocate (stencil%tile(2*n), stencil%way(2, 2*n), stencil%share(2, 2*n))
      if (allocated(kept)) stencil%tile(:size(kept)) = kept
   end subroutine make_room

end module coulter_retile_slopes
