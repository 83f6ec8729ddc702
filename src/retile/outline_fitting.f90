!> Polygons that follow the outline of a body where their chords would leave it.
!>
!> A chord that cuts off a corner of a tool lies inside the tool, and one that spans a dent loses
!> area: outer edges get the corners of the outline between their ends (theory, section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_outline_fitting
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid, distance_to_segment, turn
   use coulter_points_domains, only: add_domain, domain_list_type
   use coulter_points_outline, only: outline_type
   use coulter_points_welding, only: weld
   implicit none(type, external)
   private
   public :: follow_outline, runs_along

   !> Corners of the outline farther than this from a chord are kept, over the spacing.
   real(wp), parameter :: tolerance = 0.05_wp
   !> Corners of the outline this near to one that is kept are left out, over the spacing.
   real(wp), parameter :: merging = 0.2_wp
   !> The outline between both ends of an edge is at most this long, over the spacing.
   real(wp), parameter :: longest_path = 3.0_wp
   !> An outline that is longer than this times its chord, a semicircle, turns back.
   real(wp), parameter :: most_bent = 1.6_wp
   !> Places this near to the outline lie on it, over the spacing.
   real(wp), parameter :: round_off = 1.0e-6_wp

contains

   !> Give the outer edges of welded polygons the corners of the outline that they leave out, as
   !> long as no polygon crosses itself.
   pure subroutine follow_outline(domains, outline, spacing)
      !> Polygons; only corners that coincide exactly are one.
      type(domain_list_type), intent(inout) :: domains
      !> The outline.
      type(outline_type), intent(in) :: outline
      !> Spacing of the corners.
      real(wp), intent(in) :: spacing
      type(domain_list_type) :: fitted
      logical :: is_outer(domains%n_corners)
      real(wp), allocatable :: polygon(:, :)
      integer :: d

      call find_outer_edges(domains, is_outer)
      do d = 1, domains%n
         associate (first => domains%start(d), last => domains%start(d + 1) - 1)
            call fit(domains%corner(:, first:last), is_outer(first:last), outline, spacing, polygon)
         end associate
         call add_domain(fitted, polygon, domains%body(d))
      end do
      domains = fitted
   end subroutine follow_outline

   !> Which edges, given by the corners where they start, are those of one polygon only?
   pure subroutine find_outer_edges(domains, is_outer)
      type(domain_list_type), intent(in) :: domains
      logical, intent(out) :: is_outer(:)
      integer :: number(domains%n_corners), end_of(domains%n_corners)
      integer :: leaving(domains%n_corners), after(domains%n_corners)
      integer :: d, i, k, n

      call weld(domains%corner(:, :domains%n_corners), 0.0_wp, number, n)
      ! edges that leave a place, as linked lists
      leaving = 0
      do d = 1, domains%n
         associate (first => domains%start(d), last => domains%start(d + 1) - 1)
            end_of(first:last) = cshift(number(first:last), 1)
         end associate
      end do
      do i = 1, domains%n_corners
         after(i) = leaving(number(i))
         leaving(number(i)) = i
      end do
      do i = 1, domains%n_corners
         k = leaving(end_of(i))
         do while (k > 0)
            if (end_of(k) == number(i)) exit
            k = after(k)
         end do
         is_outer(i) = k == 0
      end do
   end subroutine find_outer_edges

   !> One polygon with the corners that its outer edges leave out, but those that would let it cross
   !> itself.
   pure subroutine fit(corner, is_outer, outline, spacing, fitted)
      real(wp), intent(in) :: corner(:, :)
      logical, intent(in) :: is_outer(:)
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: spacing
      real(wp), allocatable, intent(out) :: fitted(:, :)
      real(wp), allocatable :: path(:, :), longer(:, :)
      integer :: i, k, at, n

      fitted = corner
      at = 0
      do i = 1, size(corner, 2)
         at = at + 1
         if (.not. is_outer(i)) cycle
         call find_path(outline, corner(:, i), corner(:, modulo(i, size(corner, 2)) + 1), spacing, &
                        path)
         do k = 1, size(path, 2)
            n = size(fitted, 2) + 1
            longer = reshape([fitted(:, :at), path(:, k), fitted(:, at + 1:)], [2, n])
            if (.not. is_simple(longer)) cycle
            call move_alloc(longer, fitted)
            at = at + 1
         end do
      end do
   end subroutine fit

   !> Corners that the outline needs between two places on it, in its own sense.
   pure subroutine find_path(outline, from, to, spacing, path)
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: from(2), to(2), spacing
      real(wp), allocatable, intent(out) :: path(:, :)
      logical, allocatable :: is_kept(:)
      logical :: is_root(outline%n)
      integer :: start, n, k
      integer, allocatable :: between(:)

      allocate (path(2, 0))
      do start = 1, outline%n
         if (.not. is_on(outline, start, from, round_off*spacing)) cycle
         ! where the place is the end of an edge, the next edge starts there
         if (norm2(outline%corner(:, outline%next(start)) - from) <= round_off*spacing) cycle
         call collect(outline, start, from, to, spacing, between)
         if (.not. allocated(between)) cycle
         n = size(between)
         allocate (is_kept(n), source=.false.)
         is_root = .false.
         if (allocated(outline%roots)) is_root(:n) = [(any(outline%roots == between(k)), k=1, n)]
         associate (place => reshape([from, outline%corner(:, between), to], [2, n + 2]))
            call keep_far_ones(place, outline%is_feature(between), is_root(:n), spacing, is_kept)
         end associate
         path = outline%corner(:, pack(between, is_kept))
         return
      end do
   end subroutine find_path

   !> Corners of the outline between two places on it; unallocated if the second does not follow
   !> within reach.
   pure subroutine collect(outline, start, from, to, spacing, between)
      type(outline_type), intent(in) :: outline
      !> Edge of the outline that the first place lies on.
      integer, intent(in) :: start
      real(wp), intent(in) :: from(2), to(2), spacing
      integer, allocatable, intent(out) :: between(:)
      integer :: list(outline%n), n, c
      real(wp) :: length, here(2)

      n = 0
      length = 0.0_wp
      here = from
      c = start
      do while (n < outline%n .and. length <= longest_path*spacing)
         associate (next => outline%corner(:, outline%next(c)))
            if (is_on(outline, c, to, round_off*spacing) &
                .and. dot_product(to - here, next - here) > 0.0_wp) then
               between = list(:n)
               return
            end if
            length = length + norm2(next - here)
            here = next
         end associate
         c = outline%next(c)
         n = n + 1
         list(n) = c
      end do
   end subroutine collect

   !> Does the outline run, in its own sense and without turning back, from one place to another?
   pure function runs_along(outline, from, to, beside) result(answer)
      !> The outline.
      type(outline_type), intent(in) :: outline
      !> Both places, length units.
      real(wp), intent(in) :: from(2), to(2)
      !> A place that it must not pass on the way, length units.
      real(wp), intent(in), optional :: beside(2)
      logical :: answer
      integer, allocatable :: between(:)
      real(wp), allocatable :: path(:, :)
      real(wp) :: chord
      integer :: start, n

      answer = .false.
      chord = norm2(to - from)
      do start = 1, outline%n
         if (.not. is_on(outline, start, from, round_off*chord)) cycle
         call collect(outline, start, from, to, chord, between)
         if (.not. allocated(between)) cycle
         n = size(between)
         path = reshape([from, outline%corner(:, between), to], [2, n + 2])
         answer = sum(norm2(path(:, 2:) - path(:, :n + 1), dim=1)) <= most_bent*chord
         if (answer .and. present(beside)) answer = .not. any( &
            norm2(path(:, 2:n + 1) - spread(beside, 2, n), dim=1) <= round_off*chord)
         return
      end do
   end function runs_along

   !> Does a place lie on the edge that starts at a corner of the outline?
   pure function is_on(outline, c, place, slack) result(answer)
      type(outline_type), intent(in) :: outline
      integer, intent(in) :: c
      real(wp), intent(in) :: place(2), slack
      logical :: answer

      associate (a => outline%corner(:, c), b => outline%corner(:, outline%next(c)))
         answer = all(place >= min(a, b) - slack .and. place <= max(a, b) + slack)
         if (answer) answer = distance_to_segment(place, a, b) <= slack
      end associate
   end function is_on

   !> Keep the inner corners of a chain that its chords would pass by too far (Douglas, D. H. and
   !> Peucker, T. K. (1973), Cartographica 10, 112-122), and features; none beside another that is
   !> kept: the short edge between them would be turned by the least gap.
   pure recursive subroutine keep_far_ones(place, is_feature, is_root, spacing, is_kept)
      !> Chain from end to end, shape (2, n + 2); is an inner one a feature, the root of a cut, and
      !> is it kept, shape (n).
      real(wp), intent(in) :: place(:, :), spacing
      logical, intent(in) :: is_feature(:), is_root(:)
      logical, intent(inout) :: is_kept(:)
      real(wp) :: distance(size(is_kept))
      integer :: i, n

      n = size(is_kept)
      if (n == 0) return
      do i = 1, n
         distance(i) = distance_to_segment(place(:, i + 1), place(:, 1), place(:, n + 2))
         if (is_feature(i)) distance(i) = max(distance(i), 2.0_wp*tolerance*spacing)
         if (is_root(i)) cycle
         if (min(norm2(place(:, i + 1) - place(:, 1)), &
                 norm2(place(:, i + 1) - place(:, n + 2))) < merging*spacing) distance(i) = 0.0_wp
      end do
      i = maxloc(distance, dim=1)
      if (distance(i) <= tolerance*spacing) return
      is_kept(i) = .true.
      call keep_far_ones(place(:, :i + 1), is_feature(:i - 1), is_root(:i - 1), spacing, &
                         is_kept(:i - 1))
      call keep_far_ones(place(:, i + 1:), is_feature(i + 1:), is_root(i + 1:), spacing, &
                         is_kept(i + 1:))
   end subroutine keep_far_ones

   !> Is the area positive, and do no two edges cross?
   pure function is_simple(corner) result(answer)
      real(wp), intent(in) :: corner(:, :)
      logical :: answer
      real(wp) :: area, centroid(2)
      integer :: i, j, n

      n = size(corner, 2)
      call area_and_centroid(corner, area, centroid)
      answer = area > 0.0_wp
      do i = 1, n
         do j = i + 2, n - merge(1, 0, i == 1)
            associate (a => corner(:, i), b => corner(:, modulo(i, n) + 1), &
                       c => corner(:, j), d => corner(:, modulo(j, n) + 1))
               answer = answer .and. .not. (turn(a, b, c)*turn(a, b, d) < 0.0_wp &
                                            .and. turn(c, d, a)*turn(c, d, b) < 0.0_wp)
            end associate
         end do
      end do
   end function is_simple

end module coulter_retile_outline_fitting
