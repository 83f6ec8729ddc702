!> Point domains that tile the body: polygons with shared corners (CPDI2).
!>
!> Sadeghirad, A., Brannon, R. M. and Guilkey, J. E. (2013), Int. J. Numer. Meth. Engng 95, 928-952.
!> Corners are shared between neighbours, so that a uniform stress cancels exactly inside the body;
!> cut domains are split into quadrilaterals and triangles (theory, section 4).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_tiling
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid, winding_number
   use coulter_base_sorting, only: sort_by_number
   use coulter_points_tile_quality, only: aspect_ratio, corner_jacobians, relative_jacobian
   use coulter_points_welding, only: weld
   implicit none(type, external)
   private
   public :: tiling_type, new_tiling, corner_gradients, corner_weights, tile_centroid, &
      current_hourglass, remember_pulls, tile_outlines, measure_quality, nearest_outer_edge, &
      depth_in_tiles, distance_to_outline, values_at, list_tiles

   !> Tiles and their corners; tile p is the domain of point p.
   type :: tiling_type
      !> Number of corners.
      integer :: n_corners = 0
      !> Current positions of the corners, length units, shape (2, n_corners).
      real(wp), allocatable :: position(:, :)
      !> Corners of every tile, counter-clockwise; a triangle repeats its third corner, shape
      !> (4, n_points).
      integer, allocatable :: corner(:, :)
      !> Hourglass vector of every undeformed tile: orthogonal to all linear fields, shape
      !> (4, n_points).
      real(wp), allocatable :: hourglass(:, :)
      !> For tiles of laws that flow: hourglass force that is remembered, force per thickness, shape
      !> (2, n_points), and its largest size, shape (n_points); unallocated where all are elastic.
      real(wp), allocatable :: pull(:, :), largest_pull(:)
      !> Patch of every tile, whose tiles share their volume change, or 0 for none, shape
      !> (n_points); unallocated where none does.
      integer, allocatable :: patch(:)
      !> Displacement field of every tile, shape (n_points); unallocated where there is only one.
      integer, allocatable :: field(:)
      !> Scaled Jacobians of the corners of every undeformed tile, shape (4, n_points).
      real(wp), allocatable :: first_jacobian(:, :)
      !> Aspect of every undeformed tile, shape (n_points).
      real(wp), allocatable :: first_aspect(:)
      !> Edges that only one tile owns: first corner, last corner, tile (on the left), shape
      !> (3, n_edges).
      integer, allocatable :: outer_edge(:, :)
   end type tiling_type

   !> What is this near to an outer edge is on it, over the length of that.
   real(wp), parameter :: on_edge = 0.02_wp

   !> Corners that some tile or edge list hangs on, in ragged rows.
   type :: bucket_type
      integer, allocatable :: start(:), item(:)
   end type bucket_type

contains

   !> Join polygons at their common corners.
   pure subroutine new_tiling(tiling, vertices, tolerance, field)
      !> Tiling to make.
      type(tiling_type), intent(out) :: tiling
      !> Corners of every polygon on its own, counter-clockwise, length units, shape
      !> (2, 4, n_points).
      real(wp), intent(in) :: vertices(:, :, :)
      !> Corners nearer than this are one.
      real(wp), intent(in) :: tolerance
      !> Displacement field of every polygon, if there are several: those of different fields share
      !> no corners, shape (n_points).
      integer, intent(in), optional :: field(:)
      integer :: p

      allocate (tiling%corner(4, size(vertices, 3)), tiling%hourglass(4, size(vertices, 3)))
      allocate (tiling%first_jacobian(4, size(vertices, 3)), tiling%first_aspect(size(vertices, 3)))
      if (present(field)) then
         if (any(field > 1)) tiling%field = field
      end if
      call merge_corners(tiling, reshape(vertices, [2, 4*size(vertices, 3)]), tolerance)
      call find_outer_edges(tiling)
      do p = 1, size(vertices, 3)
         associate (corner => values_at(tiling%corner(:, p), tiling%position))
            tiling%hourglass(:, p) = hourglass_vector(corner)
            tiling%first_jacobian(:, p) = corner_jacobians(corner)
            tiling%first_aspect(p) = aspect_ratio(corner)
         end associate
      end do
   end subroutine new_tiling

   !> Let tiles remember hourglass forces, none so far.
   pure subroutine remember_pulls(tiling)
      !> Tiling to equip.
      type(tiling_type), intent(inout) :: tiling

      allocate (tiling%pull(2, size(tiling%corner, 2)), source=0.0_wp)
      allocate (tiling%largest_pull(size(tiling%corner, 2)), source=huge(1.0_wp))
   end subroutine remember_pulls

   !> Gradients of the corner functions of a tile and its area:
   !> g_c = (y_{c+1} - y_{c-1}, x_{c-1} - x_{c+1})/(2 A).
   pure subroutine corner_gradients(corner, gradient, area)
      !> Corners, counter-clockwise, length units.
      real(wp), intent(in) :: corner(2, 4)
      !> Gradients, per length.
      real(wp), intent(out) :: gradient(2, 4)
      !> Area.
      real(wp), intent(out) :: area
      real(wp) :: first(2), second(2)

      first = corner(:, 3) - corner(:, 1)
      second = corner(:, 4) - corner(:, 2)
      area = 0.5_wp*(first(1)*second(2) - first(2)*second(1))
      gradient(:, 1) = 0.5_wp*[-second(2), second(1)]/area
      gradient(:, 2) = 0.5_wp*[first(2), -first(1)]/area
      gradient(:, 3) = -gradient(:, 1)
      gradient(:, 4) = -gradient(:, 2)
   end subroutine corner_gradients

   !> Shares of a uniform load on a tile that go to its corners: the means of the bilinear corner
   !> functions of a parallelogram, and of the linear ones of a triangle.
   pure function corner_weights(corner) result(weight)
      !> Corners, counter-clockwise, length units.
      real(wp), intent(in) :: corner(2, 4)
      real(wp) :: weight(4)
      integer, parameter :: half(3, 4) = reshape([1, 2, 3, 1, 3, 4, 2, 3, 4, 2, 4, 1], [3, 4])
      real(wp) :: edge(2), next(2)
      integer :: k

      ! the tile is cut into two triangles along either diagonal, and the two answers are averaged
      weight = 0.0_wp
      do k = 1, 4
         edge = corner(:, half(2, k)) - corner(:, half(1, k))
         next = corner(:, half(3, k)) - corner(:, half(1, k))
         weight(half(:, k)) = weight(half(:, k)) + edge(1)*next(2) - edge(2)*next(1)
      end do
      weight = weight/sum(weight)
   end function corner_weights

   !> Centroid of a tile.
   pure function tile_centroid(corner) result(centroid)
      !> Corners, counter-clockwise, length units.
      real(wp), intent(in) :: corner(2, 4)
      real(wp) :: centroid(2)
      real(wp) :: area

      call area_and_centroid(corner, area, centroid)
   end function tile_centroid

   !> Corners of every tile, x1 y1 .. x4 y4, counter-clockwise; a triangle repeats its third one.
   pure function tile_outlines(tiling) result(outline)
      !> Tiles in their present position.
      type(tiling_type), intent(in) :: tiling
      real(wp), allocatable :: outline(:, :)
      integer :: p

      allocate (outline(8, size(tiling%corner, 2)))
      do p = 1, size(outline, 2)
         outline(:, p) = reshape(tiling%position(:, tiling%corner(:, p)), [8])
      end do
   end function tile_outlines

   !> Outer edge that is nearest to a position, and where along it the foot of that lies: 0 at its
   !> first end, 1 at its last, beyond for feet beside it.
   pure subroutine nearest_outer_edge(tiling, position, edge, share, mask)
      !> Tiles.
      type(tiling_type), intent(in) :: tiling
      !> Position, length units.
      real(wp), intent(in) :: position(2)
      !> Number of the edge, 0 if none is allowed.
      integer, intent(out) :: edge
      !> Place of the foot over the length of the edge.
      real(wp), intent(out) :: share
      !> Edges that are allowed, shape (n_edges); all if absent.
      logical, intent(in), optional :: mask(:)
      real(wp) :: first(2), along(2), here, distance, nearest
      integer :: e

      edge = 0
      share = 0.0_wp
      nearest = huge(nearest)
      do e = 1, size(tiling%outer_edge, 2)
         if (present(mask)) then
            if (.not. mask(e)) cycle
         end if
         first = tiling%position(:, tiling%outer_edge(1, e))
         along = tiling%position(:, tiling%outer_edge(2, e)) - first
         here = dot_product(position - first, along)/dot_product(along, along)
         distance = norm2(position - first - min(max(here, 0.0_wp), 1.0_wp)*along)
         if (distance >= nearest) cycle
         nearest = distance
         edge = e
         share = here
      end do
   end subroutine nearest_outer_edge

   !> How deep a position is in the tiles, 0 if it is in none. What is on an edge that does not
   !> bound its body, as on the axis of half a scene, is in the body, too.
   pure function depth_in_tiles(tiling, position, bounds) result(depth)
      !> Tiles.
      type(tiling_type), intent(in) :: tiling
      !> Position, length units.
      real(wp), intent(in) :: position(2)
      !> Does an outer edge bound its body? Shape (n_edges); all do if absent.
      logical, intent(in), optional :: bounds(:)
      real(wp) :: depth
      logical :: is_inside

      depth = 0.0_wp
      is_inside = winding_number(tiling%position(:, tiling%outer_edge(1, :)), &
                                 tiling%position(:, tiling%outer_edge(2, :)), position) > 0
      if (present(bounds) .and. .not. is_inside) is_inside = is_on_edge(tiling, position, &
                                                                        .not. bounds)
      if (is_inside) depth = distance_to_outline(tiling, position, bounds)
   end function depth_in_tiles

   !> Is a position on an outer edge?
   pure function is_on_edge(tiling, position, mask) result(answer)
      type(tiling_type), intent(in) :: tiling
      real(wp), intent(in) :: position(2)
      !> Edges that count, shape (n_edges).
      logical, intent(in) :: mask(:)
      logical :: answer
      real(wp) :: share
      integer :: e

      call nearest_outer_edge(tiling, position, e, share, mask)
      answer = e > 0
      if (.not. answer) return
      associate (ends => tiling%position(:, tiling%outer_edge(:2, e)))
         answer = distance_to_outline(tiling, position, mask) &
            < on_edge*norm2(ends(:, 2) - ends(:, 1))
      end associate
   end function is_on_edge

   !> Distance of a position from the nearest outer edge, huge if there is none.
   pure function distance_to_outline(tiling, position, mask) result(distance)
      !> Tiles.
      type(tiling_type), intent(in) :: tiling
      !> Position, length units.
      real(wp), intent(in) :: position(2)
      !> Edges that count, shape (n_edges); all if absent.
      logical, intent(in), optional :: mask(:)
      real(wp) :: distance
      real(wp) :: ends(2, 2), share
      integer :: edge

      distance = huge(distance)
      call nearest_outer_edge(tiling, position, edge, share, mask)
      if (edge == 0) return
      ends = tiling%position(:, tiling%outer_edge(:2, edge))
      share = min(max(share, 0.0_wp), 1.0_wp)
      distance = norm2((1.0_wp - share)*ends(:, 1) + share*ends(:, 2) - position)
   end function distance_to_outline

   !> How far the worst tiles are from their undeformed shape.
   pure subroutine measure_quality(tiling, worst_corner, worst_aspect)
      !> Tiles in their present position.
      type(tiling_type), intent(in) :: tiling
      !> Least Jacobian of a corner relative to the first one, see `relative_jacobian`.
      real(wp), intent(out) :: worst_corner
      !> Largest aspect over the first one.
      real(wp), intent(out) :: worst_aspect
      integer :: p

      worst_corner = 1.0_wp
      worst_aspect = 1.0_wp
      do p = 1, size(tiling%corner, 2)
         associate (corner => values_at(tiling%corner(:, p), tiling%position))
            worst_corner = min(worst_corner, relative_jacobian(corner_jacobians(corner), &
                                                               tiling%first_jacobian(:, p)))
            worst_aspect = max(worst_aspect, aspect_ratio(corner)/tiling%first_aspect(p))
         end associate
      end do
   end subroutine measure_quality

   !> Values of a corner field at the vertices of a tile; an array section would be a copy on the
   !> heap.
   pure function values_at(corner, field) result(values)
      !> Corners of the tile.
      integer, intent(in) :: corner(4)
      !> Values at all corners, shape (2, n_corners).
      real(wp), intent(in) :: field(:, :)
      real(wp) :: values(2, 4)
      integer :: v

      do v = 1, 4
         values(:, v) = field(:, corner(v))
      end do
   end function values_at

   !> Hourglass vector of an undeformed tile.
   pure function hourglass_vector(corner) result(gamma)
      real(wp), intent(in) :: corner(2, 4)
      real(wp) :: gamma(4)
      real(wp) :: gradient(2, 4), area

      call corner_gradients(corner, gradient, area)
      gamma = current_hourglass(corner, gradient)
   end function hourglass_vector

   !> Gamma = (h - (h.X) g)/4 with h = (1, -1, 1, -1), orthogonal to all linear fields. In triangles
   !> it sees nothing: the shares of the repeated corner cancel, the others vanish.
   pure function current_hourglass(corner, gradient) result(gamma)
      !> Corners of the tile, counter-clockwise, length units.
      real(wp), intent(in) :: corner(2, 4)
      !> Gradients of its corner functions, per length.
      real(wp), intent(in) :: gradient(2, 4)
      real(wp) :: gamma(4)
      real(wp), parameter :: pattern(4) = [1.0_wp, -1.0_wp, 1.0_wp, -1.0_wp]
      real(wp) :: skew(2)

      ! relative to the first corner, so that far from the origin no digits are lost
      skew = (corner(:, 3) - corner(:, 1)) - (corner(:, 2) - corner(:, 1)) &
         - (corner(:, 4) - corner(:, 1))
      gamma = 0.25_wp*(pattern - matmul(skew, gradient))
   end function current_hourglass

   !> Number the distinct corners in the order of their x coordinate.
   pure subroutine merge_corners(tiling, vertex, tolerance)
      type(tiling_type), intent(inout) :: tiling
      real(wp), intent(in) :: vertex(:, :)
      real(wp), intent(in) :: tolerance
      integer :: number(size(vertex, 2)), i

      if (allocated(tiling%field)) then
         call weld_fields(vertex, tolerance, tiling%field, number, tiling%n_corners)
      else
         call weld(vertex, tolerance, number, tiling%n_corners)
      end if
      allocate (tiling%position(2, tiling%n_corners))
      do i = size(number), 1, -1
         tiling%position(:, number(i)) = vertex(:, i)
      end do
      tiling%corner = reshape(number, shape(tiling%corner))
   end subroutine merge_corners

   !> Number the distinct corners of every displacement field, field by field.
   pure subroutine weld_fields(vertex, tolerance, field, number, n)
      real(wp), intent(in) :: vertex(:, :)
      real(wp), intent(in) :: tolerance
      !> Field of every tile, shape (n_tiles).
      integer, intent(in) :: field(:)
      integer, intent(out) :: number(:), n
      integer, allocatable :: own(:)
      integer :: f, i, n_own

      n = 0
      do f = 1, maxval(field)
         own = pack([(i, i=1, size(number))], [(field((i + 3)/4) == f, i=1, size(number))])
         block
            integer :: of_own(size(own))

            call weld(vertex(:, own), tolerance, of_own, n_own)
            number(own) = n + of_own
         end block
         n = n + n_own
      end do
   end subroutine weld_fields

   !> List the edges that no other tile runs along in the opposite sense.
   pure subroutine find_outer_edges(tiling)
      type(tiling_type), intent(inout) :: tiling
      type(bucket_type) :: leaving
      integer :: p, k, a, b, n
      integer :: edge(3, 4*size(tiling%corner, 2))

      call list_leaving_edges(tiling, leaving)
      n = 0
      do p = 1, size(tiling%corner, 2)
         do k = 1, 4
            a = tiling%corner(k, p)
            b = tiling%corner(modulo(k, 4) + 1, p)
            if (a == b) cycle
            if (any(leaving%item(leaving%start(b):leaving%start(b + 1) - 1) == a)) cycle
            n = n + 1
            edge(:, n) = [a, b, p]
         end do
      end do
      tiling%outer_edge = edge(:, :n)
   end subroutine find_outer_edges

   !> For every corner, the corners that edges leaving it run to.
   pure subroutine list_leaving_edges(tiling, leaving)
      type(tiling_type), intent(in) :: tiling
      type(bucket_type), intent(out) :: leaving
      integer :: p, k, a, b

      allocate (leaving%start(tiling%n_corners + 1), source=0)
      allocate (leaving%item(4*size(tiling%corner, 2)), source=0)
      do p = 1, size(tiling%corner, 2)
         do k = 1, 4
            a = tiling%corner(k, p)
            leaving%start(a) = leaving%start(a) + 1
         end do
      end do
      leaving%start(tiling%n_corners + 1) = size(leaving%item) + 1
      do a = tiling%n_corners, 1, -1
         leaving%start(a) = leaving%start(a + 1) - leaving%start(a)
      end do
      ! filled from the front of each row; zeros remain where a triangle repeats a corner
      do p = 1, size(tiling%corner, 2)
         do k = 1, 4
            a = tiling%corner(k, p)
            b = tiling%corner(modulo(k, 4) + 1, p)
            if (a == b) cycle
            associate (row => leaving%item(leaving%start(a):leaving%start(a + 1) - 1))
               row(findloc(row, 0, dim=1)) = b
            end associate
         end do
      end do
   end subroutine list_leaving_edges

   !> Tiles around every corner, in ragged rows; one that has a corner twice is there twice.
   pure subroutine list_tiles(corner, start, tile)
      !> Corners of every tile, shape (4, n_tiles).
      integer, intent(in) :: corner(:, :)
      !> First entry of every corner, shape (n_corners + 1), and the tiles, shape (4 n_tiles).
      integer, intent(out) :: start(:), tile(:)
      integer :: place(size(corner))

      call sort_by_number(reshape(corner, [size(corner)]), start, place)
      tile = (place + 3)/4
   end subroutine list_tiles

end module coulter_points_tiling
