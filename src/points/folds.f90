!> Where surfaces of tiled bodies meet: outer edges that face each other across less than some
!> distance, and those that cross.
!>
!> The grid carries both parts along with one field once they share a cell (theory, section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_folds
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: turn
   use coulter_base_sorting, only: sort_ascending
   implicit none(type, external)
   private
   public :: fold_type, find_folds, deepest_overlap

   !> Two edges that meet.
   type :: fold_type
      !> Their numbers, and those of their bodies, the smaller one first, for who knows them.
      integer :: edge(2) = 0, body(2) = 0
      !> Middle of the gap or place of the crossing, length units.
      real(wp) :: place(2) = 0.0_wp
      !> Middle of the first edge, and the place of the other one that is nearest to it, length
      !> units.
      real(wp) :: ends(2, 2) = 0.0_wp
      !> Width of the gap, negative by the depth of an overlap, length units.
      real(wp) :: gap = 0.0_wp
   end type fold_type

   !> Outer edges with what the search asks of them.
   type :: edges_type
      !> Corners at their ends, shape (2, n).
      integer, allocatable :: corner(:, :)
      !> First end, last end and middle, length units, shape (2, n); outward normal, shape (2, n).
      real(wp), allocatable :: first(:, :), last(:, :), middle(:, :), normal(:, :)
      !> Half lengths, length units, shape (n).
      real(wp), allocatable :: half(:)
      !> Edges that begin and end where another ends and begins, shape (n).
      integer, allocatable :: next(:), previous(:)
   end type edges_type

   !> Edges face each other if the product of their normals is below this.
   real(wp), parameter :: opposed = -0.5_wp
   !> The other edge lies ahead if the way to it has this share of its length along the normal.
   real(wp), parameter :: ahead = 0.5_wp
   !> Ends nearer than this to the other edge, over its length, lie on it.
   real(wp), parameter :: round_off = 1.0e-9_wp
   !> The surface between two edges that meet is longer than this, over the distance searched: both
   !> sides of a notch meet near its tip.
   real(wp), parameter :: longest_notch = 4.0_wp

contains

   !> Find all pairs of edges that meet; pairs of neighbours at a notch do not count.
   pure subroutine find_folds(folds, position, edge, distance)
      !> What is found; no pair twice.
      type(fold_type), allocatable, intent(out) :: folds(:)
      !> Positions of all corners, length units, shape (2, n_corners).
      real(wp), intent(in) :: position(:, :)
      !> First and last corner of every outer edge, tile on its left, shape (>= 2, n_edges).
      integer, intent(in) :: edge(:, :)
      !> Largest gap, length units.
      real(wp), intent(in) :: distance
      type(edges_type) :: edges
      type(fold_type) :: fold
      real(wp) :: place(size(edge, 2)), reach
      integer :: order(size(edge, 2)), e, f, j, k, n
      logical :: do_meet

      allocate (folds(16))
      n = 0
      call measure_edges(edges, position, edge)
      ! a sweep along the longer way: only edges that are abreast are compared
      k = maxloc(maxval(edges%middle, dim=2) - minval(edges%middle, dim=2), dim=1)
      call sort_ascending(edges%middle(k, :), order)
      place = edges%middle(k, order)
      reach = distance + 2.0_wp*maxval([0.0_wp, edges%half])
      do k = 1, size(order)
         do j = k + 1, size(order)
            if (place(j) - place(k) > reach) exit
            e = min(order(k), order(j))
            f = max(order(k), order(j))
            if (.not. may_meet(edges, e, f, distance)) cycle
            call meet(fold, edges, e, f, distance, do_meet)
            if (.not. do_meet) cycle
            if (n == size(folds)) folds = [folds, folds]
            n = n + 1
            folds(n) = fold
         end do
      end do
      folds = folds(:n)
   end subroutine find_folds

   !> How far do edges of an outline lie over each other? 0 where they do not.
   pure function deepest_overlap(position, edge) result(depth)
      !> See `find_folds`.
      real(wp), intent(in) :: position(:, :)
      integer, intent(in) :: edge(:, :)
      real(wp) :: depth
      type(fold_type), allocatable :: folds(:)

      call find_folds(folds, position, edge, 0.0_wp)
      depth = -minval([0.0_wp, folds%gap])
   end function deepest_overlap

   !> Places, normals and neighbours of all edges.
   pure subroutine measure_edges(edges, position, edge)
      type(edges_type), intent(out) :: edges
      real(wp), intent(in) :: position(:, :)
      integer, intent(in) :: edge(:, :)
      integer :: leaving(size(position, 2)), e

      edges%corner = edge(:2, :)
      edges%first = position(:, edge(1, :))
      edges%last = position(:, edge(2, :))
      edges%middle = 0.5_wp*(edges%first + edges%last)
      edges%half = 0.5_wp*norm2(edges%last - edges%first, dim=1)
      allocate (edges%normal(2, size(edge, 2)), edges%next(size(edge, 2)))
      allocate (edges%previous(size(edge, 2)), source=0)
      ! chains need not close: tiles that overlap hide edges from each other
      leaving = 0
      do e = 1, size(edge, 2)
         associate (along => edges%last(:, e) - edges%first(:, e))
            edges%normal(:, e) = [along(2), -along(1)] &
               /max(2.0_wp*edges%half(e), tiny(1.0_wp))
         end associate
         leaving(edge(1, e)) = e
      end do
      do e = 1, size(edge, 2)
         edges%next(e) = leaving(edge(2, e))
         if (edges%next(e) > 0) edges%previous(edges%next(e)) = e
      end do
   end subroutine measure_edges

   !> May two edges meet? A look at their middles and normals spares most the rest.
   pure function may_meet(edges, e, f, distance) result(answer)
      type(edges_type), intent(in) :: edges
      integer, intent(in) :: e, f
      real(wp), intent(in) :: distance
      logical :: answer
      real(wp) :: way

      way = maxval(abs(edges%middle(:, f) - edges%middle(:, e)))
      answer = way <= edges%half(e) + edges%half(f)
      if (answer .or. way > distance + max(edges%half(e), edges%half(f))) return
      answer = dot_product(edges%normal(:, e), edges%normal(:, f)) <= opposed
   end function may_meet

   !> Do two edges meet, and how?
   pure subroutine meet(fold, edges, e, f, distance, answer)
      type(fold_type), intent(out) :: fold
      type(edges_type), intent(in) :: edges
      integer, intent(in) :: e, f
      real(wp), intent(in) :: distance
      logical, intent(out) :: answer

      answer = .false.
      if (any(edges%corner(:, e) == edges%corner(1, f)) &
          .or. any(edges%corner(:, e) == edges%corner(2, f))) return
      call cross(fold, edges, e, f, answer)
      if (answer) return
      if (dot_product(edges%normal(:, e), edges%normal(:, f)) > opposed) return
      call look_ahead(fold, edges, e, f, distance, answer)
      if (.not. answer) call look_ahead(fold, edges, f, e, distance, answer)
      if (answer) answer = .not. are_neighbours(edges, e, f, longest_notch*distance)
   end subroutine meet

   !> Does one edge lie ahead of the middle of another?
   pure subroutine look_ahead(fold, edges, e, f, distance, answer)
      type(fold_type), intent(inout) :: fold
      type(edges_type), intent(in) :: edges
      integer, intent(in) :: e, f
      real(wp), intent(in) :: distance
      logical, intent(out) :: answer
      real(wp) :: way(2), along(2)

      along = edges%last(:, f) - edges%first(:, f)
      way = edges%first(:, f) - edges%middle(:, e)
      way = way - min(max(dot_product(way, along)/dot_product(along, along), -1.0_wp), 0.0_wp)*along
      fold%edge = [e, f]
      fold%gap = norm2(way)
      fold%ends(:, 1) = edges%middle(:, e)
      fold%ends(:, 2) = edges%middle(:, e) + way
      fold%place = edges%middle(:, e) + 0.5_wp*way
      answer = fold%gap < distance .and. dot_product(way, edges%normal(:, e)) > ahead*fold%gap
   end subroutine look_ahead

   !> Do two edges cross, and how deep is the overlap: how far is the end of one behind the other?
   pure subroutine cross(fold, edges, e, f, answer)
      type(fold_type), intent(inout) :: fold
      type(edges_type), intent(in) :: edges
      integer, intent(in) :: e, f
      logical, intent(out) :: answer
      real(wp) :: of_f(2), of_e(2), share

      ! twice the areas of the triangles between one edge and the ends of the other
      associate (a => edges%first(:, e), b => edges%last(:, e), c => edges%first(:, f), &
                 d => edges%last(:, f))
         of_e = [turn(c, d, a), turn(c, d, b)]
         of_f = [turn(a, b, c), turn(a, b, d)]
         answer = of_e(1)*of_e(2) < 0.0_wp .and. of_f(1)*of_f(2) < 0.0_wp
         if (.not. answer) return
         share = of_e(1)/(of_e(1) - of_e(2))
         fold%edge = [e, f]
         fold%place = a + share*(b - a)
         fold%ends = spread(fold%place, 2, 2)
         fold%gap = -min(maxval(of_e)/norm2(d - c), maxval(of_f)/norm2(b - a))
         ! what touches with a corner does not cross
         answer = minval(abs(of_e)) > round_off*dot_product(d - c, d - c) &
            .and. minval(abs(of_f)) > round_off*dot_product(b - a, b - a)
      end associate
   end subroutine cross

   !> Is the surface between two edges shorter than some length?
   pure function are_neighbours(edges, e, f, longest) result(answer)
      type(edges_type), intent(in) :: edges
      integer, intent(in) :: e, f
      real(wp), intent(in) :: longest
      logical :: answer

      answer = follows(edges%next) .or. follows(edges%previous)

   contains

      !> Does the second edge follow the first in one of both senses?
      pure function follows(next) result(answer)
         integer, intent(in) :: next(:)
         logical :: answer
         real(wp) :: length
         integer :: k

         length = 0.0_wp
         k = next(e)
         do while (k > 0 .and. length < longest)
            answer = k == f
            if (answer) return
            length = length + norm2(edges%last(:, k) - edges%first(:, k))
            k = next(k)
         end do
         answer = .false.
      end function follows

   end function are_neighbours

end module coulter_points_folds
