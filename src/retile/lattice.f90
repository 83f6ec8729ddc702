!> A lattice of nodes that moves to the outline of a body, and where its edges cross that.
!>
!> Nodes move to the outline where they are near it; the outline itself is not simplified (theory,
!> section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_lattice
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: side_of => turn
   use coulter_points_outline, only: encloses, outline_type, sharp_corners
   use coulter_retile_outline_fitting, only: runs_along
   implicit none(type, external)
   private
   public :: lattice_type, fit_lattice, cell_node

   !> A lattice of nodes around the outline, with what is known about each.
   type :: lattice_type
      !> Position of every node, moved or not, length units, shape (2, nx, ny).
      real(wp), allocatable :: position(:, :, :)
      !> 1 inside, 0 moved to the outline, -1 outside, shape (nx, ny).
      integer, allocatable :: state(:, :)
      !> Where the edge from every node to the next one in x and in y crosses the outline, shape
      !> (2, 2, nx, ny): component, direction of the edge, node.
      real(wp), allocatable :: crossing(:, :, :, :)
      !> Does it, and does it lead across a gap, from there or from its first node on, shape
      !> (2, nx, ny)?
      logical, allocatable :: is_crossed(:, :, :), is_wide(:, :, :)
   end type lattice_type

   !> Nodes this near move to the outline, over the spacing: less leaves slivers.
   real(wp), parameter :: snap = 0.45_wp
   !> Corners of the outline that turn by more than this (40 degrees) get a node of their own.
   real(wp), parameter :: sharp = 0.698_wp
   !> Length of outline on either side over which that is measured, over the spacing.
   real(wp), parameter :: chord = 0.25_wp
   !> Gaps behind corners of tools stay open where they are wider than this, and up to this far from
   !> there, over the spacing.
   real(wp), parameter :: least_gap = 0.05_wp, longest_gap = 3.0_wp
   !> Where they are looked for between two places, as shares of the way: slits are narrow, and lie
   !> at its ends.
   real(wp), parameter :: along(3) = [0.5_wp, 0.05_wp, 0.95_wp]
   !> Nodes of a cell in counter-clockwise order.
   integer, parameter :: cell_node(2, 4) = reshape([0, 0, 1, 0, 1, 1, 0, 1], [2, 4])

contains

   !> Lay a lattice over an outline and move its nodes there.
   pure subroutine fit_lattice(lattice, outline, origin, spacing)
      !> Lattice to make.
      type(lattice_type), intent(out) :: lattice
      !> Outline of the body.
      type(outline_type), intent(in) :: outline
      !> A node of the lattice, and its spacing per direction, length units.
      real(wp), intent(in) :: origin(2), spacing(2)
      real(wp) :: h

      h = minval(spacing)
      call make_lattice(lattice, outline, origin, spacing)
      call mark_inside(lattice, outline)
      call move_to_corners(lattice, outline, h)
      call move_to_outline(lattice, outline, h)
      call find_crossings(lattice, outline, h)
   end subroutine fit_lattice

   !> Nodes around the outline with a margin of a cell.
   pure subroutine make_lattice(lattice, outline, origin, spacing)
      type(lattice_type), intent(out) :: lattice
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: origin(2), spacing(2)
      integer :: i, j, first(2), last(2)

      first = floor((minval(outline%corner, dim=2) - origin)/spacing) - 1
      last = ceiling((maxval(outline%corner, dim=2) - origin)/spacing) + 1
      associate (n => last - first + 1)
         allocate (lattice%position(2, n(1), n(2)), lattice%crossing(2, 2, n(1), n(2)))
         allocate (lattice%is_crossed(2, n(1), n(2)), source=.false.)
         allocate (lattice%is_wide(2, n(1), n(2)), source=.false.)
         allocate (lattice%state(n(1), n(2)), source=-1)
         do j = 1, n(2)
            do i = 1, n(1)
               lattice%position(:, i, j) = origin + spacing*real(first + [i, j] - 1, wp)
            end do
         end do
      end associate
      lattice%crossing = 0.0_wp
   end subroutine make_lattice

   !> Find the nodes that the outline runs round: its edges are counted on the right of each.
   pure subroutine mark_inside(lattice, outline)
      type(lattice_type), intent(inout) :: lattice
      type(outline_type), intent(in) :: outline
      integer :: winding(size(lattice%state, 1), size(lattice%state, 2))
      real(wp) :: x
      integer :: c, j

      winding = 0
      do c = 1, outline%n
         associate (a => outline%corner(:, c), b => outline%corner(:, outline%next(c)))
            do j = 1, size(winding, 2)
               associate (y => lattice%position(2, 1, j))
                  if ((a(2) > y) .eqv. (b(2) > y)) cycle
                  x = a(1) + (b(1) - a(1))*(y - a(2))/(b(2) - a(2))
                  where (lattice%position(1, :, j) < x) &
                     winding(:, j) = winding(:, j) + merge(1, -1, b(2) > a(2))
               end associate
            end do
         end associate
      end do
      where (winding > 0) lattice%state = 1
   end subroutine mark_inside

   !> Move the nearest node to every sharp corner, the sharpest first; where gaps are kept, those at
   !> corners of tools and then the nearest first, and a corner whose node is taken takes the next
   !> one: both sides of a slit do.
   pure subroutine move_to_corners(lattice, outline, h)
      type(lattice_type), intent(inout) :: lattice
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: h
      real(wp), allocatable :: turn(:)
      integer :: c, node(2)

      turn = sharp_corners(outline, chord*h)
      where (outline%is_feature) turn = huge(1.0_wp)
      if (allocated(outline%is_slit)) then
         do c = 1, outline%n
            if (.not. outline%is_slit(c)) cycle
            node = node_near(lattice, outline%corner(:, c))
            if (turn(c) >= sharp) turn(c) = merge(20.0_wp, 10.0_wp, outline%is_feature(c))*sharp &
               - min(9.0_wp*sharp, norm2(lattice%position(:, node(1), node(2)) &
                                         - outline%corner(:, c))/h)
         end do
      end if
      do
         c = maxloc(turn, dim=1)
         if (turn(c) < sharp) exit
         turn(c) = 0.0_wp
         node = node_near(lattice, outline%corner(:, c))
         if (lattice%state(node(1), node(2)) == 0 .and. allocated(outline%is_slit)) then
            if (outline%is_slit(c)) node = free_node(lattice, node, outline, c)
         end if
         if (lattice%state(node(1), node(2)) == 0) cycle
         lattice%position(:, node(1), node(2)) = outline%corner(:, c)
         lattice%state(node(1), node(2)) = 0
      end do
   end subroutine move_to_corners

   !> The node that was nearest to a place before nodes moved.
   pure function node_near(lattice, place) result(node)
      type(lattice_type), intent(in) :: lattice
      real(wp), intent(in) :: place(2)
      integer :: node(2)
      real(wp) :: local(2)

      associate (first => lattice%position(:, 1, 1), n => shape(lattice%state))
         ! the first nodes are outside and far from the outline: they have not moved
         local = (place - first)/(lattice%position(:, n(1), n(2)) - first)
         node = 1 + nint(local*real(n - 1, wp))
      end associate
   end function node_near

   !> The nearest to a corner of the nodes around one that is neither on the outline nor across it;
   !> the node itself if there is none.
   pure function free_node(lattice, node, outline, c) result(free)
      type(lattice_type), intent(in) :: lattice
      integer, intent(in) :: node(2)
      type(outline_type), intent(in) :: outline
      integer, intent(in) :: c
      integer :: free(2)
      real(wp) :: least
      integer :: i, j

      free = node
      least = huge(least)
      do j = node(2) - 1, node(2) + 1
         do i = node(1) - 1, node(1) + 1
            associate (place => lattice%position(:, i, j))
               if (lattice%state(i, j) == 0) cycle
               if (norm2(place - outline%corner(:, c)) >= least) cycle
               if (is_cut_off(outline, c, place)) cycle
               least = norm2(place - outline%corner(:, c))
            end associate
            free = [i, j]
         end do
      end do
   end function free_node

   !> Does the way from a corner to a place cross an edge of the outline that is not at the corner?
   pure function is_cut_off(outline, c, place) result(answer)
      type(outline_type), intent(in) :: outline
      integer, intent(in) :: c
      real(wp), intent(in) :: place(2)
      logical :: answer
      integer :: k

      answer = .true.
      do k = 1, outline%n
         if (k == c .or. k == outline%previous(c)) cycle
         associate (a => outline%corner(:, k), b => outline%corner(:, outline%next(k)), &
                    from => outline%corner(:, c))
            if ((side_of(a, b, from) > 0.0_wp) .eqv. (side_of(a, b, place) > 0.0_wp)) cycle
            if ((side_of(from, place, a) > 0.0_wp) .eqv. (side_of(from, place, b) > 0.0_wp)) cycle
            return
         end associate
      end do
      answer = .false.
   end function is_cut_off

   !> Move the other nodes that are near the outline to it.
   pure subroutine move_to_outline(lattice, outline, h)
      type(lattice_type), intent(inout) :: lattice
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: h
      real(wp) :: nearest(size(lattice%state, 1), size(lattice%state, 2))
      real(wp) :: foot(2, size(lattice%state, 1), size(lattice%state, 2))
      integer :: c, i, j

      nearest = snap*h
      do c = 1, outline%n
         call find_feet(lattice, reshape([outline%corner(:, c), &
                                          outline%corner(:, outline%next(c))], [2, 2]), h, &
                        nearest, foot)
      end do
      do j = 1, size(nearest, 2)
         do i = 1, size(nearest, 1)
            if (nearest(i, j) >= snap*h) cycle
            lattice%position(:, i, j) = foot(:, i, j)
            lattice%state(i, j) = 0
         end do
      end do
   end subroutine move_to_outline

   !> Feet of nodes on an edge where that is nearer than what they have.
   pure subroutine find_feet(lattice, ends, h, nearest, foot)
      type(lattice_type), intent(in) :: lattice
      real(wp), intent(in) :: ends(2, 2), h
      !> Distances so far, and feet.
      real(wp), intent(inout) :: nearest(:, :), foot(:, :, :)
      real(wp) :: place(2), distance
      integer :: i, j, low(2), high(2)

      call nodes_around(lattice, minval(ends, dim=2) - snap*h, maxval(ends, dim=2) + snap*h, low, &
                        high)
      do j = low(2), high(2)
         do i = low(1), high(1)
            if (lattice%state(i, j) == 0) cycle
            place = foot_on_edge(lattice%position(:, i, j), ends(:, 1), ends(:, 2))
            distance = norm2(place - lattice%position(:, i, j))
            if (distance >= nearest(i, j)) cycle
            nearest(i, j) = distance
            foot(:, i, j) = place
         end do
      end do
   end subroutine find_feet

   !> Range of nodes in a box, by their place before they moved.
   pure subroutine nodes_around(lattice, lower, upper, low, high)
      type(lattice_type), intent(in) :: lattice
      real(wp), intent(in) :: lower(2), upper(2)
      integer, intent(out) :: low(2), high(2)

      associate (n => shape(lattice%state))
         associate (first => lattice%position(:, 1, 1), &
                    step => (lattice%position(:, n(1), n(2)) - lattice%position(:, 1, 1)) &
                    /real(n - 1, wp))
            low = max(floor((lower - first)/step) + 1, 1)
            high = min(ceiling((upper - first)/step) + 1, n)
         end associate
      end associate
   end subroutine nodes_around

   !> Nearest place on an edge.
   pure function foot_on_edge(position, first, last) result(place)
      real(wp), intent(in) :: position(2), first(2), last(2)
      real(wp) :: place(2)
      real(wp) :: along(2)

      along = last - first
      place = first + along*min(max(dot_product(position - first, along) &
                                    /max(dot_product(along, along), tiny(1.0_wp)), 0.0_wp), 1.0_wp)
   end function foot_on_edge

   !> For every lattice edge that leaves the body from an inside node, the crossing nearest to that.
   pure subroutine find_crossings(lattice, outline, h)
      type(lattice_type), intent(inout) :: lattice
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: h
      integer :: i, j, k, other(2), states(2)
      real(wp) :: ends(2, 2), place(2)

      do j = 1, size(lattice%state, 2)
         do i = 1, size(lattice%state, 1)
            do k = 1, 2
               other = [i, j] + cell_node(:, merge(2, 4, k == 1))
               if (any(other > shape(lattice%state))) cycle
               states = [lattice%state(i, j), lattice%state(other(1), other(2))]
               if (maxval(states) < 0 .or. minval(states) > 0) cycle
               ends(:, 1) = lattice%position(:, i, j)
               ends(:, 2) = lattice%position(:, other(1), other(2))
               if (maxval(states) == 0) then
                  if (allocated(outline%is_slit) .and. minval(states) == 0) then
                     lattice%is_wide(k, i, j) = is_across(outline, ends(:, 1), ends(:, 2), h)
                  end if
                  cycle
               end if
               if (states(1) < 1) ends = ends(:, [2, 1])
               place = first_crossing(outline, ends(:, 1), ends(:, 2))
               if (minval(states) == 0) lattice%is_wide(k, i, j) = &
                  is_across(outline, place, ends(:, 2), h)
               lattice%is_crossed(k, i, j) = minval(states) < 0 .or. lattice%is_wide(k, i, j)
               lattice%crossing(:, k, i, j) = place
            end do
         end do
      end do
   end subroutine find_crossings

   !> Is a node on the outline beyond the gap behind a corner of a tool for one inside, whose way to
   !> it crosses the outline somewhere? Where that is rugged it may be crossed, too, but runs on to
   !> the node.
   pure function is_across(outline, place, node, h) result(answer)
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: place(2), node(2), h
      logical :: answer, is_slit
      integer :: c

      answer = .false.
      if (norm2(node - place) <= least_gap*h) return
      is_slit = .false.
      do c = 1, outline%n
         if (outline%is_feature(c)) answer = answer &
            .or. norm2(outline%corner(:, c) - node) < longest_gap*h
         if (.not. allocated(outline%is_slit)) cycle
         if (outline%is_slit(c)) is_slit = is_slit .or. norm2(outline%corner(:, c) - node) &
            < longest_gap*h
      end do
      answer = answer .or. is_slit
      if (answer) answer = .not. all([(encloses(outline, place + along(c)*(node - place)), &
                                       c=1, merge(3, 1, is_slit))])
      if (answer) answer = .not. (runs_along(outline, place, node) &
                                  .or. runs_along(outline, node, place))
   end function is_across

   !> First place where the way from one node to another meets the outline; half the way if
   !> round-off hides it.
   pure function first_crossing(outline, from, to) result(place)
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: from(2), to(2)
      real(wp) :: place(2)
      real(wp) :: normal(2), side(2), share, nearest
      integer :: c

      nearest = 2.0_wp
      normal = [from(2) - to(2), to(1) - from(1)]
      do c = 1, outline%n
         associate (a => outline%corner(:, c), b => outline%corner(:, outline%next(c)))
            side = [dot_product(normal, a - from), dot_product(normal, b - from)]
            if ((side(1) > 0.0_wp) .eqv. (side(2) > 0.0_wp)) cycle
            share = dot_product(to - from, a + (b - a)*(side(1)/(side(1) - side(2))) - from) &
               /dot_product(to - from, to - from)
            if (share >= 0.0_wp .and. share <= 1.0_wp) nearest = min(nearest, share)
         end associate
      end do
      if (nearest > 1.0_wp) nearest = 0.5_wp
      place = from + nearest*(to - from)
   end function first_crossing

end module coulter_retile_lattice
