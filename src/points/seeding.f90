!> Filling regions with material points: one per sub-cell, truncated at the outline.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_seeding
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid, clip_box, polygon_type
   use coulter_grid, only: grid_type
   use coulter_points, only: allocate_points, points_type
   use coulter_points_body, only: body_type, region_type
   use coulter_points_domains, only: add_domain, cut_domains, domain_list_type, weld_domains
   use coulter_points_tiling, only: new_tiling, tiling_type
   implicit none(type, external)
   private
   public :: seed_points, seed_tiles

   !> Truncated sub-cells smaller than this share of a full one are left out: they weigh nothing
   !> and their position would be round-off.
   real(wp), parameter :: smallest_share = 1.0e-10_wp

   !> Corners of tiles nearer than this share of a sub-cell to a line between sub-cells are on it.
   real(wp), parameter :: snap_tolerance = 2.0e-7_wp
   !> Corners of tiles nearer than this share of a sub-cell are one.
   real(wp), parameter :: corner_tolerance = 1.0e-7_wp

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
      type(domain_list_type) :: domains

      call cut_bodies(domains, grid, bodies)
      call make_points(points, domains, n_state)
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
      type(domain_list_type) :: domains, tiles
      real(wp), allocatable :: vertices(:, :, :)
      integer, allocatable :: owner(:)
      real(wp) :: tolerance
      integer :: p

      tolerance = corner_tolerance*grid%smallest_spacing()/real(maxval(bodies%points_per_cell), wp)
      call cut_bodies(domains, grid, bodies)
      call settle_corners(domains, grid, bodies, tolerance)
      call cut_domains(domains, smallest_areas(grid, bodies), vertices, owner)
      do p = 1, size(owner)
         call add_domain(tiles, vertices(:, :, p), owner(p))
      end do
      call make_points(points, tiles, n_state)
      ! corners that differ are farther apart
      call new_tiling(tiling, vertices, 0.5_wp*tolerance, bodies(owner)%field)
   end subroutine seed_tiles

   !> Cut all regions of all bodies into sub-cells.
   pure subroutine cut_bodies(domains, grid, bodies)
      type(domain_list_type), intent(inout) :: domains
      type(grid_type), intent(in) :: grid
      type(body_type), intent(in) :: bodies(:)
      real(wp) :: smallest(size(bodies))
      integer :: b, r

      smallest = smallest_areas(grid, bodies)
      do b = 1, size(bodies)
         do r = 1, size(bodies(b)%regions)
            call cut_region(domains, grid, bodies(b)%regions(r), bodies(b)%points_per_cell, b, &
                            smallest(b))
         end do
      end do
   end subroutine cut_bodies

   !> Area below which a domain of every body is left out.
   pure function smallest_areas(grid, bodies) result(area)
      type(grid_type), intent(in) :: grid
      type(body_type), intent(in) :: bodies(:)
      real(wp) :: area(size(bodies))

      area = smallest_share*product(grid%spacing)/real(bodies%points_per_cell, wp)**2
   end function smallest_areas

   !> Move corners that nearly lie on a line between sub-cells onto it, so that outlines along grid
   !> lines leave no slivers, and let corners that nearly coincide be one, until neither changes
   !> anything. Every corner moves in all domains that have it alike.
   pure subroutine settle_corners(domains, grid, bodies, tolerance)
      type(domain_list_type), intent(inout) :: domains
      type(grid_type), intent(in) :: grid
      type(body_type), intent(in) :: bodies(:)
      real(wp), intent(in) :: tolerance
      integer :: d, i, n, last

      last = 0
      do
         call weld_domains(domains, tolerance, n)
         if (n == last) exit
         last = n
         do d = 1, domains%n
            do i = domains%start(d), domains%start(d + 1) - 1
               call snap(domains%corner(:, i), grid, bodies(domains%body(d))%points_per_cell)
            end do
         end do
      end do
   end subroutine settle_corners

   !> Move a position that nearly lies on a line between sub-cells onto it.
   pure subroutine snap(position, grid, points_per_cell)
      real(wp), intent(inout) :: position(2)
      type(grid_type), intent(in) :: grid
      integer, intent(in) :: points_per_cell
      real(wp) :: nearest, edge
      integer :: axis

      do axis = 1, 2
         edge = grid%spacing(axis)/real(points_per_cell, wp)
         nearest = line(grid, axis, nint((position(axis) - grid%origin(axis))/edge), &
                        points_per_cell)
         if (abs(position(axis) - nearest) <= snap_tolerance*edge) position(axis) = nearest
      end do
   end subroutine snap

   !> Points at the centroids of domains.
   pure subroutine make_points(points, domains, n_state)
      type(points_type), intent(out) :: points
      type(domain_list_type), intent(in) :: domains
      integer, intent(in) :: n_state
      integer :: p

      call allocate_points(points, domains%n, n_state)
      do p = 1, domains%n
         associate (corner => domains%corner(:, domains%start(p):domains%start(p + 1) - 1))
            call area_and_centroid(corner, points%reference_volume(p), points%position(:, p))
            points%domain_size(:, p) = maxval(corner, dim=2) - minval(corner, dim=2)
            points%body(p) = domains%body(p)
         end associate
      end do
   end subroutine make_points

   !> Cut the region into rows of sub-cells, each row into sub-cells; those that are all but empty
   !> are left out.
   pure subroutine cut_region(domains, grid, region, points_per_cell, body, smallest_area)
      type(domain_list_type), intent(inout) :: domains
      type(grid_type), intent(in) :: grid
      type(region_type), intent(in) :: region
      integer, intent(in) :: points_per_cell, body
      real(wp), intent(in) :: smallest_area
      type(polygon_type) :: whole, row, domain
      real(wp) :: edge(2), area, centroid(2)
      integer :: i, j, first(2), last(2)

      whole%n = size(region%vertices, 2)
      whole%corner = region%vertices
      edge = grid%spacing/real(points_per_cell, wp)
      first = floor((minval(whole%corner, dim=2) - grid%origin)/edge)
      last = ceiling((maxval(whole%corner, dim=2) - grid%origin)/edge) - 1
      do j = first(2), last(2)
         call clip_box(whole, 2, line(grid, 2, j, points_per_cell), &
                       line(grid, 2, j + 1, points_per_cell), row)
         do i = first(1), last(1)
            call clip_box(row, 1, line(grid, 1, i, points_per_cell), &
                          line(grid, 1, i + 1, points_per_cell), domain)
            if (domain%n < 3) cycle
            call area_and_centroid(domain%corner(:, :domain%n), area, centroid)
            if (area > smallest_area) call add_domain(domains, domain%corner(:, :domain%n), body)
         end do
      end do
   end subroutine cut_region

   !> Coordinate of a line between sub-cells, exactly on the grid line where there is one.
   pure function line(grid, axis, index, points_per_cell) result(coordinate)
      type(grid_type), intent(in) :: grid
      integer, intent(in) :: axis, index, points_per_cell
      real(wp) :: coordinate

      coordinate = grid%origin(axis) &
         + grid%spacing(axis)*real(index, wp)/real(points_per_cell, wp)
   end function line

end module coulter_points_seeding
