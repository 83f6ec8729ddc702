!> Interfaces: edges where tiles of two bodies share their corners, so that the bodies are bonded.
!>
!> New tiles of both bodies come from the same lattice and the same line between them, and have the
!> same corners on it; whether that is so must be checked.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_interfaces
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: distance_to_segment
   use coulter_points_outline, only: outline_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: interfaces_type, find_interfaces, edges_of_tiles, keep_ends, is_on_interface, is_torn

   !> The outlines of all bodies, and which of their edges lie between two of them.
   type :: interfaces_type
      !> First and last corner and tile of every edge of an outline, tile on the left, shape
      !> (3, n_edges).
      integer, allocatable :: edge(:, :)
      !> Body on the left of every edge, and that on the right or 0, shape (2, n_edges).
      integer, allocatable :: body(:, :)
      !> Ends of the edges between two bodies, length units, shape (2, 2, n): component, end.
      real(wp), allocatable :: ends(:, :, :)
      !> Places where lines between two bodies end or branch, length units, shape (2, n).
      real(wp), allocatable :: branch(:, :)
   end type interfaces_type

   !> Edges lie along an interface if the cosine between them is above this.
   real(wp), parameter :: parallel = 0.9_wp

contains

   !> Find the outlines of all bodies and their interfaces.
   pure subroutine find_interfaces(interfaces, tiling, body)
      !> What is found.
      type(interfaces_type), intent(out) :: interfaces
      !> Tiles.
      type(tiling_type), intent(in) :: tiling
      !> Body of every tile, shape (n_tiles).
      integer, intent(in) :: body(:)
      integer :: edge(3, 4*size(body)), owner(2, 4*size(body))
      integer :: leaving(tiling%n_corners), after(4*size(body)), a, b, k, n, p

      leaving = 0
      after = 0
      do p = 1, size(body)
         do k = 1, 4
            a = tiling%corner(k, p)
            if (a == tiling%corner(modulo(k, 4) + 1, p)) cycle
            after(4*p + k - 4) = leaving(a)
            leaving(a) = 4*p + k - 4
         end do
      end do
      n = 0
      do p = 1, size(body)
         do k = 1, 4
            a = tiling%corner(k, p)
            b = tiling%corner(modulo(k, 4) + 1, p)
            if (a == b) cycle
            owner(:, n + 1) = [body(p), body_beside(tiling, body, leaving, after, a, b)]
            if (owner(2, n + 1) == body(p)) cycle
            n = n + 1
            edge(:, n) = [a, b, p]
         end do
      end do
      interfaces%edge = edge(:, :n)
      interfaces%body = owner(:, :n)
      call list_lines(interfaces, tiling)
   end subroutine find_interfaces

   !> Body of the tile on the right of an edge, 0 if there is none.
   pure function body_beside(tiling, body, leaving, after, a, b) result(beside)
      type(tiling_type), intent(in) :: tiling
      integer, intent(in) :: body(:), leaving(:), after(:), a, b
      integer :: beside
      integer :: k, p

      k = leaving(b)
      do while (k > 0)
         p = (k + 3)/4
         beside = body(p)
         if (tiling%corner(modulo(k - 4*p + 4, 4) + 1, p) == a) return
         k = after(k)
      end do
      beside = 0
   end function body_beside

   !> Edges between two bodies, and corners where not two of one pair of bodies meet.
   pure subroutine list_lines(interfaces, tiling)
      type(interfaces_type), intent(inout) :: interfaces
      type(tiling_type), intent(in) :: tiling
      integer :: touching(tiling%n_corners), pair(2, tiling%n_corners), both(2), c, e, k
      logical :: is_branch(tiling%n_corners)

      associate (between => pack([(e, e=1, size(interfaces%edge, 2))], interfaces%body(2, :) > 0))
         interfaces%ends = reshape(tiling%position(:, [interfaces%edge(:2, between)]), &
                                   [2, 2, size(between)])
         touching = 0
         is_branch = .false.
         do e = 1, size(between)
            both = interfaces%body(:, between(e))
            both = [minval(both), maxval(both)]
            do k = 1, 2
               c = interfaces%edge(k, between(e))
               touching(c) = touching(c) + 1
               if (touching(c) > 1) is_branch(c) = is_branch(c) .or. any(pair(:, c) /= both)
               pair(:, c) = both
            end do
         end do
      end associate
      ! each edge is there for both bodies: four ends meet where a line goes on
      is_branch = is_branch .or. (touching > 0 .and. touching /= 4)
      interfaces%branch = tiling%position(:, pack([(k, k=1, size(touching))], is_branch))
   end subroutine list_lines

   !> First and last corner of the edges of an outline around some tiles.
   pure function edges_of_tiles(interfaces, is_mine) result(edges)
      !> Outlines of all bodies.
      type(interfaces_type), intent(in) :: interfaces
      !> Which tiles, of one body, shape (n_tiles)?
      logical, intent(in) :: is_mine(:)
      integer, allocatable :: edges(:, :)
      integer :: e

      edges = interfaces%edge(:2, pack([(e, e=1, size(interfaces%edge, 2))], &
                                       is_mine(interfaces%edge(3, :))))
   end function edges_of_tiles

   !> Keep the ends and branches of interfaces as corners of an outline.
   pure subroutine keep_ends(outline, interfaces)
      !> Outline of a body.
      type(outline_type), intent(inout) :: outline
      !> Interfaces.
      type(interfaces_type), intent(in) :: interfaces
      integer :: c, k

      do k = 1, size(interfaces%branch, 2)
         do c = 1, outline%n
            outline%is_feature(c) = outline%is_feature(c) &
               .or. all(abs(outline%corner(:, c) - interfaces%branch(:, k)) <= 0.0_wp)
         end do
      end do
   end subroutine keep_ends

   !> Does a place lie on an interface?
   pure function is_on_interface(interfaces, place, distance) result(answer)
      !> Interfaces.
      type(interfaces_type), intent(in) :: interfaces
      !> The place, and how far it may be away, length units.
      real(wp), intent(in) :: place(2), distance
      logical :: answer
      integer :: e

      answer = .true.
      do e = 1, size(interfaces%ends, 3)
         associate (ends => interfaces%ends(:, :, e))
            if (distance_to_segment(place, ends(:, 1), ends(:, 2)) <= distance) return
         end associate
      end do
      answer = .false.
   end function is_on_interface

   !> Have new tiles an outer edge along what was an interface, since corners of both sides differ?
   pure function is_torn(interfaces, tiling, distance) result(answer)
      !> Interfaces before.
      type(interfaces_type), intent(in) :: interfaces
      !> New tiles of all bodies.
      type(tiling_type), intent(in) :: tiling
      !> How far new edges may be away, length units.
      real(wp), intent(in) :: distance
      logical :: answer
      real(wp) :: along(2), middle(2), line(2)
      integer :: e, k

      answer = .true.
      do k = 1, size(tiling%outer_edge, 2)
         associate (a => tiling%position(:, tiling%outer_edge(1, k)), &
                    b => tiling%position(:, tiling%outer_edge(2, k)))
            along = b - a
            middle = 0.5_wp*(a + b)
         end associate
         do e = 1, size(interfaces%ends, 3)
            associate (ends => interfaces%ends(:, :, e))
               line = ends(:, 2) - ends(:, 1)
               if (abs(dot_product(along, line)) < parallel*norm2(along)*norm2(line)) cycle
               if (distance_to_segment(middle, ends(:, 1), ends(:, 2)) <= distance) return
            end associate
         end do
      end do
      answer = .false.
   end function is_torn

end module coulter_retile_interfaces
