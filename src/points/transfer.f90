!> From distorted tiles to new ones: shape of the outline, and what the points carry.
!>
!> Averages over the shared areas keep a uniform state as it is, and elastic strains inside a
!> convex yield surface (theory, section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_transfer
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid, overlap_area
   use coulter_base_tensor, only: finger_of_log_strain_plane, log_strain_plane
   use coulter_points, only: allocate_points, points_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: restore_area, transfer_points

   !> Old tiles by the cells of a lattice that the boxes around them touch.
   type :: lookup_type
      real(wp) :: origin(2) = 0.0_wp, spacing = 1.0_wp
      !> First entry and number of entries of every cell, shape (nx, ny); the entries.
      integer, allocatable :: start(:, :), count(:, :), tile(:)
   end type lookup_type

   !> New tiles that share less than this part of their area with old ones take the state of the
   !> nearest.
   real(wp), parameter :: least_share = 1.0e-6_wp
   !> New tiles flow on where a larger share than this of what they are made of flowed.
   real(wp), parameter :: most_at_rest = 0.5_wp

contains

   !> Shift the free corners of the outline along their normals until the tiles have a given area.
   pure subroutine restore_area(tiling, is_free, area, limit)
      !> Tiles to change; only their positions do.
      type(tiling_type), intent(inout) :: tiling
      !> May a corner move? Shape (n_corners).
      logical, intent(in) :: is_free(:)
      !> Area that they shall have together.
      real(wp), intent(in) :: area
      !> Largest shift, length units.
      real(wp), intent(in) :: limit
      real(wp) :: normal(2, tiling%n_corners), edge(2), shift, step, slope, total
      integer :: e, k, pass

      shift = 0.0_wp
      do pass = 1, 8
         normal = 0.0_wp
         total = 0.0_wp
         do e = 1, size(tiling%outer_edge, 2)
            associate (a => tiling%outer_edge(1, e), b => tiling%outer_edge(2, e))
               edge = tiling%position(:, b) - tiling%position(:, a)
               normal(:, a) = normal(:, a) + 0.5_wp*[edge(2), -edge(1)]
               normal(:, b) = normal(:, b) + 0.5_wp*[edge(2), -edge(1)]
               ! relative to one corner, so that far from the origin no digits are lost
               total = total + 0.5_wp*wedge(tiling%position(:, a) - tiling%position(:, 1), edge)
            end associate
         end do
         slope = 0.0_wp
         do k = 1, tiling%n_corners
            if (is_free(k)) slope = slope + norm2(normal(:, k))
         end do
         if (.not. slope > 0.0_wp) return
         step = min(max(shift + (area - total)/slope, -limit), limit) - shift
         shift = shift + step
         do k = 1, tiling%n_corners
            if (.not. (is_free(k) .and. norm2(normal(:, k)) > 0.0_wp)) cycle
            tiling%position(:, k) = tiling%position(:, k) + step*normal(:, k)/norm2(normal(:, k))
         end do
      end do

   contains

      pure function wedge(first, second) result(value)
         real(wp), intent(in) :: first(2), second(2)
         real(wp) :: value

         value = first(1)*second(2) - first(2)*second(1)
      end function wedge

   end subroutine restore_area

   !> Points for new tiles with what the points of the old ones carry: logarithmic elastic strain,
   !> law state, displacement, shared ratio and 1/J averaged over the shared areas. Their reference
   !> volumes add up to what they were; the rotation in the deformation gradient is lost.
   pure subroutine transfer_points(points, tiling, owner, old_points, old_tiling, spacing)
      !> Points to make; their stress is left for the laws to find.
      type(points_type), intent(out) :: points
      !> Their tiles.
      type(tiling_type), intent(in) :: tiling
      !> Body of every new tile.
      integer, intent(in) :: owner(:)
      !> Points of the old tiles.
      type(points_type), intent(in) :: old_points
      !> Old tiles.
      type(tiling_type), intent(in) :: old_tiling
      !> Size of the cells that sort the tiles, length units.
      real(wp), intent(in) :: spacing
      type(lookup_type) :: lookup
      real(wp), allocatable :: strain(:, :), weight(:)
      integer, allocatable :: found(:)
      real(wp) :: centroid(2), area
      integer :: p, n

      call allocate_points(points, size(owner), old_points%n_state)
      points%body = owner
      if (allocated(old_points%shared_ratio)) allocate (points%shared_ratio(size(owner)))
      if (allocated(old_points%has_flowed)) allocate (points%has_flowed(size(owner)))
      allocate (strain(4, old_points%n_points))
      do p = 1, old_points%n_points
         call log_strain_plane(old_points%converged%elastic_finger(:, p), strain(:, p))
      end do
      call sort_tiles(lookup, old_tiling, spacing)
      allocate (found(old_points%n_points), weight(old_points%n_points))
      do p = 1, points%n_points
         associate (corner => tiling%position(:, tiling%corner(:, p)))
            call area_and_centroid(corner, area, centroid)
            points%position(:, p) = centroid
            points%domain_size(:, p) = maxval(corner, dim=2) - minval(corner, dim=2)
            call find_overlaps(lookup, old_tiling, old_points, corner, owner(p), found, weight, n)
            call average(points, p, old_points, strain, found(:n), weight(:n), area)
         end associate
      end do
      call keep_mass(points, old_points)
   end subroutine transfer_points

   !> State of one point from those of the old tiles that it shares area with.
   pure subroutine average(points, p, old, strain, found, weight, area)
      type(points_type), intent(inout) :: points
      integer, intent(in) :: p, found(:)
      type(points_type), intent(in) :: old
      real(wp), intent(in) :: strain(:, :), weight(:), area
      real(wp) :: share(size(found)), ratio

      share = weight/sum(weight)
      ratio = 1.0_wp/dot_product(share, 1.0_wp/old%volume_ratio(found))
      call finger_of_log_strain_plane(matmul(strain(:, found), share), &
                                      points%converged%elastic_finger(:, p))
      points%converged%law_state(:, p) = matmul(old%converged%law_state(:, found), share)
      points%displacement(:, p) = matmul(old%displacement(:, found), share)
      points%volume_ratio(p) = ratio
      if (allocated(old%shared_ratio)) then
         points%shared_ratio(p) = dot_product(share, old%shared_ratio(found))
      end if
      points%reference_volume(p) = area/ratio
      if (allocated(old%has_flowed)) then
         points%has_flowed(p) = sum(share, mask=old%has_flowed(found)) > most_at_rest
      end if
   end subroutine average

   !> Scale the volumes of every body so that it has its old mass; J follows.
   pure subroutine keep_mass(points, old)
      type(points_type), intent(inout) :: points
      type(points_type), intent(in) :: old
      real(wp) :: factor, volume
      integer :: body, p

      do body = 1, maxval(points%body)
         volume = sum(points%reference_volume, mask=points%body == body)
         if (.not. volume > 0.0_wp) cycle
         factor = sum(old%reference_volume, mask=old%body == body)/volume
         do p = 1, points%n_points
            if (points%body(p) /= body) cycle
            points%reference_volume(p) = factor*points%reference_volume(p)
            points%volume_ratio(p) = points%volume_ratio(p)/factor
            ! plane strain: the out-of-plane component stays 1
            points%converged%deformation_gradient([1, 4], p) = sqrt(points%volume_ratio(p))
         end do
      end do
   end subroutine keep_mass

   !> Old tiles of a body that share area with a polygon; the nearest if there is none.
   pure subroutine find_overlaps(lookup, tiling, points, corner, body, found, weight, n)
      type(lookup_type), intent(in) :: lookup
      type(tiling_type), intent(in) :: tiling
      type(points_type), intent(in) :: points
      real(wp), intent(in) :: corner(2, 4)
      integer, intent(in) :: body
      integer, intent(inout) :: found(:)
      real(wp), intent(inout) :: weight(:)
      integer, intent(out) :: n
      integer :: i, j, k, tile, low(2), high(2)
      real(wp) :: shared, area, centroid(2)

      n = 0
      call cells_around(lookup, corner, low, high)
      do j = low(2), high(2)
         do i = low(1), high(1)
            do k = lookup%start(i, j), lookup%start(i, j) + lookup%count(i, j) - 1
               tile = lookup%tile(k)
               if (points%body(tile) /= body) cycle
               if (any(found(:n) == tile)) cycle
               shared = overlap_area(corner, tiling%position(:, tiling%corner(:, tile)))
               if (.not. shared > 0.0_wp) cycle
               n = n + 1
               found(n) = tile
               weight(n) = shared
            end do
         end do
      end do
      call area_and_centroid(corner, area, centroid)
      if (n > 0) then
         if (sum(weight(:n)) > least_share*area) return
      end if
      n = 1
      weight(1) = 1.0_wp
      found(1) = minloc(norm2(points%position - spread(centroid, 2, points%n_points), dim=1), &
                        mask=points%body == body, dim=1)
   end subroutine find_overlaps

   !> Enter every tile in all cells that the box around it touches.
   pure subroutine sort_tiles(lookup, tiling, spacing)
      type(lookup_type), intent(out) :: lookup
      type(tiling_type), intent(in) :: tiling
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

end module coulter_points_transfer
