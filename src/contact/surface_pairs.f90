!> The search for edges that may press against each other in a step.
!>
!> A station is half an outer edge of the softer body against one outer edge of the other, or of the
!> body itself (theory, section 8). Which of them act is found with the displacements.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_surface_pairs
   use coulter_base_bins, only: bins_type, new_bins
   use coulter_base_kinds, only: wp
   use coulter_contact_body_contact, only: body_contact_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: surface_pair_type, find_surface_pairs, recall_surface_pairs, push_apart, reach_along

   !> Half an edge of a body against an edge of another one.
   type :: surface_pair_type
      !> Number of the contact between two bodies, and tile that owns the edge.
      integer :: contact = 0, tile = 0
      !> Vertices of the tile at the first and last end of the edge; corners of the tile, then first
      !> and last corner of the other edge.
      integer :: vertex(2) = 0, corner(6) = 0
      !> Number of the edge, end that the half belongs to, number of the other edge.
      integer :: edge = 0, half = 0, other_edge = 0
      !> Length at the start of the step that the edge stands for, half of its own within a body,
      !> and unit vector against its outward normal.
      real(wp) :: length = 0.0_wp, inward(2) = 0.0_wp
      !> Do both press, and did they in the last step?
      logical :: is_acting = .false., was_acting = .false.
      !> Sign of the shear while they slip, 0 while they stick; and in the last step.
      integer :: slip = 0, last_slip = 0
      !> Way along the edge from where both stick, before and after the step, and way in the step,
      !> length units.
      real(wp) :: lag = 0.0_wp, new_lag = 0.0_wp, way = 0.0_wp
      !> Traction (normal, along the edge), stress units; length that it acts on, and least
      !> distance of both there, negative where they overlap, length units; force on the own body;
      !> place.
      real(wp) :: traction(2) = 0.0_wp, weight = 0.0_wp, gap = 0.0_wp, force(2) = 0.0_wp, &
         place(2) = 0.0_wp
      !> Overlap that earlier rounds of the step left, not positive: both press as if they
      !> overlapped by that much more, length units.
      real(wp) :: shift = 0.0_wp
   end type surface_pair_type

   !> Outer edges of a body.
   type :: surface_type
      !> Their numbers, middles, outward normals, and lengths.
      integer, allocatable :: edge(:)
      real(wp), allocatable :: middle(:, :), normal(:, :), length(:)
   end type surface_type

   !> Edges face each other if the product of their outward normals is below this.
   real(wp), parameter :: opposed = -0.4_wp
   !> How far edges may be apart and overlap, and how far they may slide in a step, over the
   !> spacing.
   real(wp), parameter :: farthest = 1.5_wp, deepest = 0.5_wp, reach_along = 1.0_wp

contains

   !> Find all pairs, ordered by contact and edge.
   pure subroutine find_surface_pairs(pairs, contacts, tiling, body, spacing)
      !> What is found.
      type(surface_pair_type), allocatable, intent(out) :: pairs(:)
      !> Contacts between bodies.
      type(body_contact_type), intent(in) :: contacts(:)
      !> Tiles at the start of the step, and their bodies.
      type(tiling_type), intent(in) :: tiling
      integer, intent(in) :: body(:)
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      type(surface_type) :: own, other
      type(bins_type) :: bins
      integer, allocatable :: near(:)
      integer :: half, i, j, k, n

      allocate (pairs(64))
      n = 0
      do k = 1, size(contacts)
         associate (softer => contacts(k)%softer)
            call list_surface(own, tiling, body, contacts(k)%body(softer))
            call list_surface(other, tiling, body, contacts(k)%body(3 - softer))
         end associate
         call new_bins(bins, other%middle, 0.5_wp*(longest(own) + longest(other)) &
                       + (farthest + reach_along)*spacing)
         do i = 1, size(own%edge)
            near = bins%near(own%middle(:, i))
            do j = 1, size(near)
               if (.not. may_meet(own, i, other, near(j), spacing)) cycle
               if (n + 2 > size(pairs)) pairs = [pairs, pairs]
               do half = 1, 2
                  n = n + 1
                  pairs(n) = new_pair(tiling, own%edge(i), other%edge(near(j)), k, half)
                  ! both sides of a surface that meets itself are own ones, and each carries half
                  if (contacts(k)%is_within()) pairs(n)%length = 0.5_wp*pairs(n)%length
               end do
            end do
         end do
      end do
      pairs = pairs(:n)
   end subroutine find_surface_pairs

   !> Length of the longest edge.
   pure function longest(surface) result(length)
      type(surface_type), intent(in) :: surface
      real(wp) :: length

      length = maxval([0.0_wp, surface%length])
   end function longest

   !> Outer edges of a body.
   pure subroutine list_surface(surface, tiling, body, number)
      type(surface_type), intent(out) :: surface
      type(tiling_type), intent(in) :: tiling
      integer, intent(in) :: body(:), number
      real(wp) :: ends(2, 2)
      integer :: e, k

      surface%edge = pack([(e, e=1, size(tiling%outer_edge, 2))], &
                          body(tiling%outer_edge(3, :)) == number)
      allocate (surface%middle(2, size(surface%edge)), surface%normal(2, size(surface%edge)))
      allocate (surface%length(size(surface%edge)))
      do k = 1, size(surface%edge)
         ends = tiling%position(:, tiling%outer_edge(:2, surface%edge(k)))
         surface%middle(:, k) = 0.5_wp*sum(ends, dim=2)
         associate (along => ends(:, 2) - ends(:, 1))
            surface%length(k) = norm2(along)
            surface%normal(:, k) = [along(2), -along(1)]/surface%length(k)
         end associate
      end do
   end subroutine list_surface

   !> May two edges meet in the step?
   pure function may_meet(own, i, other, j, spacing) result(answer)
      type(surface_type), intent(in) :: own, other
      integer, intent(in) :: i, j
      real(wp), intent(in) :: spacing
      logical :: answer
      real(wp) :: way(2), apart

      way = other%middle(:, j) - own%middle(:, i)
      answer = maxval(abs(way)) <= 0.5_wp*(own%length(i) + other%length(j)) &
         + (farthest + reach_along)*spacing
      if (.not. answer) return
      associate (n => own%normal(:, i))
         apart = dot_product(n, way)
         answer = dot_product(n, other%normal(:, j)) < opposed &
            .and. apart <= farthest*spacing + 0.5_wp*other%length(j) &
            .and. apart >= -deepest*spacing - 0.5_wp*other%length(j) &
            .and. abs(n(1)*way(2) - n(2)*way(1)) <= 0.5_wp*(own%length(i) + other%length(j)) &
            + reach_along*spacing
      end associate
   end function may_meet

   !> A pair of edges of which nothing is known.
   pure function new_pair(tiling, edge, other_edge, contact, half) result(pair)
      type(tiling_type), intent(in) :: tiling
      integer, intent(in) :: edge, other_edge, contact, half
      type(surface_pair_type) :: pair

      pair%contact = contact
      pair%edge = edge
      pair%half = half
      pair%other_edge = other_edge
      associate (ends => tiling%outer_edge(:, edge))
         pair%tile = ends(3)
         pair%corner = [tiling%corner(:, ends(3)), tiling%outer_edge(:2, other_edge)]
         pair%vertex = [findloc(pair%corner(:4), ends(1), dim=1), &
                        findloc(pair%corner(:4), ends(2), dim=1)]
         associate (along => tiling%position(:, ends(2)) - tiling%position(:, ends(1)))
            pair%length = norm2(along)
            pair%inward = [-along(2), along(1)]/pair%length
         end associate
      end associate
   end function new_pair

   !> Give pairs what the last step left: at the same pair of edges, else at the same half edge,
   !> whatever it met.
   pure subroutine recall_surface_pairs(pairs, last)
      !> Pairs to equip, ordered by contact and edge.
      type(surface_pair_type), intent(inout) :: pairs(:)
      !> Those of the last accepted step, on the same edges, in the same order.
      type(surface_pair_type), intent(in) :: last(:)
      integer :: i, j, first
      real(wp) :: weight

      first = 1
      do i = 1, size(pairs)
         associate (new => pairs(i))
            do while (first <= size(last))
               if (last(first)%contact == new%contact .and. last(first)%edge >= new%edge &
                   .or. last(first)%contact > new%contact) exit
               first = first + 1
            end do
            weight = 0.0_wp
            do j = first, size(last)
               if (last(j)%contact /= new%contact .or. last(j)%edge /= new%edge) exit
               if (last(j)%half /= new%half .or. .not. last(j)%is_acting) cycle
               if (last(j)%other_edge == new%other_edge) then
                  call recall(new, last(j))
                  exit
               end if
               if (last(j)%weight <= weight) cycle
               weight = last(j)%weight
               call recall(new, last(j))
            end do
         end associate
      end do
   end subroutine recall_surface_pairs

   !> Let pairs that overlap too far in equilibrium press harder: a step of Uzawa's method, as for
   !> corners behind faces. It takes pairs that do not press, too: where a corner pokes into an
   !> edge, or two corners meet, edges may be open in the mean.
   pure subroutine push_apart(pairs, depth, spacing, has_changed)
      !> All pairs in equilibrium; some get more `shift`.
      type(surface_pair_type), intent(inout) :: pairs(:)
      !> Largest overlap that is left alone, and grid spacing, length units.
      real(wp), intent(in) :: depth, spacing
      !> Set if any pair gets more.
      logical, intent(inout) :: has_changed
      logical :: is_deep(size(pairs))

      is_deep = pairs%gap < -depth .and. pairs%gap > -deepest*spacing
      has_changed = has_changed .or. any(is_deep)
      where (is_deep) pairs%shift = pairs%shift + pairs%gap
   end subroutine push_apart

   !> What one pair remembers of another.
   pure subroutine recall(new, last)
      type(surface_pair_type), intent(inout) :: new
      type(surface_pair_type), intent(in) :: last

      new%was_acting = last%is_acting
      new%last_slip = last%slip
      new%lag = last%new_lag
   end subroutine recall

end module coulter_contact_surface_pairs
