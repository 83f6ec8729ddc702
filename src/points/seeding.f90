!> Filling regions with material points: one per sub-cell, truncated at the outline.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_seeding
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid, clip_box, polygon_type
   use coulter_base_tensor, only: finger_of_log_strain_plane
   use coulter_grid, only: grid_type
   use coulter_points, only: allocate_points, points_type
   use coulter_points_body, only: body_type, region_type
   use coulter_points_splitting, only: split_polygon
   use coulter_points_tiling, only: new_tiling, tiling_type
   implicit none(type, external)
   private
   public :: seed_points, seed_tiles, seed_initial_stress

   !> Truncated sub-cells smaller than this share of a full one are left out: they weigh nothing
   !> and their position would be round-off.
   real(wp), parameter :: smallest_share = 1.0e-10_wp

   !> Corners of tiles nearer than this share of a sub-cell to a line between sub-cells are on it.
   real(wp), parameter :: snap_tolerance = 2.0e-7_wp
   !> Corners of a domain nearer than this share of a sub-cell are one.
   real(wp), parameter :: corner_tolerance = 1.0e-7_wp
   !> Corners of different tiles nearer than this share of that are one: so much less that no tile
   !> loses a corner by it.
   real(wp), parameter :: merge_share = 0.25_wp

   !> Points found so far, in arrays that grow. Corners are kept only when domains shall tile.
   type :: seed_list_type
      integer :: n = 0
      logical :: has_tiles = .false.
      real(wp), allocatable :: position(:, :), domain_size(:, :), volume(:), vertices(:, :, :)
      integer, allocatable :: body(:)
   end type seed_list_type

contains

   !> Seed all bodies. A domain that the outline cuts is truncated to the part inside; the point
   !> sits at the centroid of that part and owns its volume (paper, section 2).
   pure subroutine seed_points(points, grid, bodies, n_state)
      !> Points to make, undeformed and free of stress.
      type(points_type), intent(out) :: points
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Bodies, inside the grid.
      type(body_type), intent(in) :: bodies(:)
      !> State variables per point.
      integer, intent(in) :: n_state
      type(seed_list_type) :: seeds

      call seed_bodies(seeds, grid, bodies)
      call collect_points(points, seeds, n_state)
   end subroutine seed_points

   !> Seed all bodies with points whose domains tile them: a domain that the outline cuts is split
   !> into quadrilaterals and triangles, each with a point of its own (theory, section 4).
   pure subroutine seed_tiles(points, tiling, grid, bodies, n_state)
      !> Points to make, undeformed and free of stress.
      type(points_type), intent(out) :: points
      !> Their domains.
      type(tiling_type), intent(out) :: tiling
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Bodies, inside the grid.
      type(body_type), intent(in) :: bodies(:)
      !> State variables per point.
      integer, intent(in) :: n_state
      type(seed_list_type) :: seeds

      seeds%has_tiles = .true.
      call seed_bodies(seeds, grid, bodies)
      call collect_points(points, seeds, n_state)
      call new_tiling(tiling, seeds%vertices(:, :, :seeds%n), &
                      merge_share*corner_tolerance*grid%smallest_spacing() &
                      /real(maxval(bodies%points_per_cell), wp))
   end subroutine seed_tiles

   !> Seed all regions of all bodies.
   pure subroutine seed_bodies(seeds, grid, bodies)
      type(seed_list_type), intent(inout) :: seeds
      type(grid_type), intent(in) :: grid
      type(body_type), intent(in) :: bodies(:)
      integer :: b, r

      call make_room(seeds, 64)
      do b = 1, size(bodies)
         do r = 1, size(bodies(b)%regions)
            call seed_region(seeds, grid, bodies(b)%regions(r), bodies(b)%points_per_cell, b)
         end do
      end do
   end subroutine seed_bodies

   !> Make points of the seeds.
   pure subroutine collect_points(points, seeds, n_state)
      type(points_type), intent(out) :: points
      type(seed_list_type), intent(in) :: seeds
      integer, intent(in) :: n_state

      call allocate_points(points, seeds%n, n_state)
      points%position = seeds%position(:, :seeds%n)
      points%domain_size = seeds%domain_size(:, :seeds%n)
      points%reference_volume = seeds%volume(:seeds%n)
      points%body = seeds%body(:seeds%n)
   end subroutine collect_points

   !> Give the points of a body a uniform stress, balanced or not.
   pure subroutine seed_initial_stress(points, body, strain, stress)
      !> Points to change.
      type(points_type), intent(inout) :: points
      !> Number of the body.
      integer, intent(in) :: body
      !> Logarithmic elastic strain that carries the stress: xx, yy, zz, 2 xy.
      real(wp), intent(in) :: strain(4)
      !> Kirchhoff stress xx, yy, zz, xy; Cauchy stress as well, since J = 1.
      real(wp), intent(in) :: stress(4)
      real(wp) :: finger(4)
      integer :: p

      call finger_of_log_strain_plane(strain, finger)
      do p = 1, points%n_points
         if (points%body(p) /= body) cycle
         points%converged%elastic_finger(:, p) = finger
         points%converged%kirchhoff_stress(:, p) = stress
      end do
   end subroutine seed_initial_stress

   !> Cut the region into rows of sub-cells, each row into sub-cells.
   pure subroutine seed_region(seeds, grid, region, points_per_cell, body)
      type(seed_list_type), intent(inout) :: seeds
      type(grid_type), intent(in) :: grid
      type(region_type), intent(in) :: region
      integer, intent(in) :: points_per_cell, body
      type(polygon_type) :: whole, row, domain
      real(wp) :: edge(2)
      integer :: i, j, first(2), last(2)

      whole%n = size(region%vertices, 2)
      whole%corner = region%vertices
      edge = grid%spacing/real(points_per_cell, wp)
      first = floor((minval(whole%corner, dim=2) - grid%origin)/edge)
      last = ceiling((maxval(whole%corner, dim=2) - grid%origin)/edge) - 1
      do j = first(2), last(2)
         call clip_box(whole, 2, line(2, j), line(2, j + 1), row)
         do i = first(1), last(1)
            call clip_box(row, 1, line(1, i), line(1, i + 1), domain)
            if (seeds%has_tiles) then
               call snap(domain, [line(1, i), line(2, j)], edge)
               call snap(domain, [line(1, i + 1), line(2, j + 1)], edge)
            end if
            call add_domain(seeds, domain, edge, body)
         end do
      end do

   contains

      !> Coordinate of a line between sub-cells, exactly on the grid line where there is one.
      pure function line(axis, index) result(coordinate)
         integer, intent(in) :: axis, index
         real(wp) :: coordinate

         coordinate = grid%origin(axis) &
            + grid%spacing(axis)*real(index, wp)/real(points_per_cell, wp)
      end function line

   end subroutine seed_region

   !> Move corners that nearly lie on a line between sub-cells onto it, in the sub-cells on both
   !> sides of it alike: outlines along grid lines leave no slivers.
   pure subroutine snap(domain, line, edge)
      type(polygon_type), intent(inout) :: domain
      real(wp), intent(in) :: line(2), edge(2)
      integer :: k

      do k = 1, domain%n
         where (abs(domain%corner(:, k) - line) <= snap_tolerance*edge) domain%corner(:, k) = line
      end do
   end subroutine snap

   !> Append the point that owns a domain, or those that own its tiles.
   pure subroutine add_domain(seeds, domain, edge, body)
      type(seed_list_type), intent(inout) :: seeds
      type(polygon_type), intent(in) :: domain
      real(wp), intent(in) :: edge(2)
      integer, intent(in) :: body
      real(wp), allocatable :: tile(:, :, :)
      integer :: n_tiles, k

      if (domain%n < 3) return
      if (.not. seeds%has_tiles) then
         call add_seed(seeds, domain%corner(:, :domain%n), smallest_share*product(edge), body)
         return
      end if
      call split_polygon(domain%corner(:, :domain%n), corner_tolerance*minval(edge), tile, n_tiles)
      do k = 1, n_tiles
         call add_seed(seeds, tile(:, :, k), smallest_share*product(edge), body)
      end do
   end subroutine add_domain

   !> Append the point that owns a polygon, unless that is empty.
   pure subroutine add_seed(seeds, corner, smallest_area, body)
      type(seed_list_type), intent(inout) :: seeds
      real(wp), intent(in) :: corner(:, :), smallest_area
      integer, intent(in) :: body
      real(wp) :: area, centroid(2)

      call area_and_centroid(corner, area, centroid)
      if (area <= smallest_area) return
      if (seeds%n == size(seeds%volume)) call make_room(seeds, 2*seeds%n)
      seeds%n = seeds%n + 1
      seeds%position(:, seeds%n) = centroid
      seeds%domain_size(:, seeds%n) = maxval(corner, dim=2) - minval(corner, dim=2)
      seeds%volume(seeds%n) = area
      seeds%body(seeds%n) = body
      if (seeds%has_tiles) seeds%vertices(:, :, seeds%n) = corner
   end subroutine add_seed

   !> Let the list hold `n` points, keeping those it has.
   pure subroutine make_room(seeds, n)
      type(seed_list_type), intent(inout) :: seeds
      integer, intent(in) :: n
      type(seed_list_type) :: grown

      allocate (grown%position(2, n), grown%domain_size(2, n), grown%volume(n), grown%body(n))
      allocate (grown%vertices(2, 4, merge(n, 0, seeds%has_tiles)))
      grown%n = seeds%n
      grown%has_tiles = seeds%has_tiles
      if (seeds%n > 0) then
         grown%position(:, :seeds%n) = seeds%position(:, :seeds%n)
         grown%domain_size(:, :seeds%n) = seeds%domain_size(:, :seeds%n)
         grown%volume(:seeds%n) = seeds%volume(:seeds%n)
         grown%body(:seeds%n) = seeds%body(:seeds%n)
         if (seeds%has_tiles) grown%vertices(:, :, :seeds%n) = seeds%vertices(:, :, :seeds%n)
      end if
      seeds = grown
   end subroutine make_room

end module coulter_points_seeding
