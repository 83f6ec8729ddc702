!> Stations on the corners of tiles: where a body meets walls and tools.
!>
!> Every outer edge of a body is held against every face that it looks at, with the gap at the end
!> of the step; the traction of the material itself makes the constraint consistent, so that any
!> penalty passes the patch test (Nitsche; theory, section 4).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_contact
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type, kind_fixed
   use coulter_boundary_segment, only: lies_on, new_segment, segment_type
   use coulter_points_tiling, only: nearest_outer_edge, tiling_type
   implicit none(type, external)
   private
   public :: contact_type, contacts_type, held_edge_type, find_held_edges, build_contacts
   public :: carry_held_edges, recall_contacts

   !> One end of an outer edge against one face.
   type :: contact_type
      !> Number of the boundary and of its segment.
      integer :: boundary = 0, segment = 0
      !> Tile that owns the edge, and which of its vertices the station is.
      integer :: tile = 0, vertex = 0
      !> Corner of the tiling at that vertex.
      integer :: corner = 0
      !> Length of face that the station stands for.
      real(wp) :: weight = 0.0_wp
      !> Unit normal into the material, unit tangent.
      real(wp) :: normal(2) = 0.0_wp, tangent(2) = 0.0_wp
      !> Gap along the normal if the corner stays where it is and the face moves: negative when they
      !> overlap, length units.
      real(wp) :: gap = 0.0_wp
      !> The same along the tangent, from the place where the corner is held; for fixed kinds.
      real(wp) :: slide = 0.0_wp
      !> Distance of the corner from the first end of the moved segment, and length of that.
      real(wp) :: distance = 0.0_wp, length = 0.0_wp
      !> Number of the outer edge, and which of its ends the station is: its identity from step to
      !> step.
      integer :: edge = 0, end_of_edge = 0
      !> Traction (normal, tangential) that earlier rounds and steps left, for augmented
      !> formulations, and that of the current iteration, stress units.
      real(wp) :: memory(2) = 0.0_wp, traction(2) = 0.0_wp
      !> Corner at the other end of the edge, and its distance from the first end of the segment.
      integer :: other_corner = 0
      real(wp) :: other_distance = 0.0_wp
      !> Is the corner held in both directions and also against being pulled off?
      logical :: is_bilateral = .false., is_fixed = .false.
   end type contact_type

   !> All stations of a step, ordered by tile.
   type :: contacts_type
      !> Number of stations.
      integer :: n = 0
      !> The stations; only the first `n` are meaningful.
      type(contact_type), allocatable :: item(:)
   end type contacts_type

   !> An outer edge that a bilateral boundary keeps for good.
   type :: held_edge_type
      !> Boundary and segment, 0 if the edge is free.
      integer :: boundary = 0, segment = 0
      !> Where its two ends are held, from the first end of the segment, length units.
      real(wp) :: distance(2) = 0.0_wp
   end type held_edge_type

   !> Edges this close to a bilateral boundary at the start belong to it, over the spacing.
   real(wp), parameter :: touching = 1.0e-6_wp
   !> Faces this far away may be met within a step, over the spacing.
   real(wp), parameter :: reach = 4.0_wp
   !> Edges deeper behind a face than this, over the spacing, and the way that the face has come in
   !> the step belong to something else.
   real(wp), parameter :: deepest = 1.0_wp

contains

   !> Find the outer edges that lie on bilateral boundaries at the start of a run.
   pure subroutine find_held_edges(held, boundaries, tiling, spacing)
      !> What holds every outer edge, shape (n_edges).
      type(held_edge_type), allocatable, intent(out) :: held(:)
      !> Boundaries in their first position.
      type(boundary_type), intent(in) :: boundaries(:)
      !> Tiles in their first position.
      type(tiling_type), intent(in) :: tiling
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      type(segment_type) :: segment
      integer :: b, s, e

      allocate (held(size(tiling%outer_edge, 2)))
      do b = 1, size(boundaries)
         if (.not. boundaries(b)%is_bilateral) cycle
         do s = 1, size(boundaries(b)%vertices, 2) - 1
            call new_segment(segment, boundaries(b)%vertices(:, s), &
                             boundaries(b)%vertices(:, s + 1))
            do e = 1, size(held)
               if (held(e)%boundary > 0) cycle
               call hold_edge(held(e), segment, b, s, &
                              tiling%position(:, tiling%outer_edge(:2, e)), touching*spacing)
            end do
         end do
      end do
   end subroutine find_held_edges

   !> Give an edge to a segment if it lies on it.
   pure subroutine hold_edge(held, segment, b, s, ends, tolerance)
      type(held_edge_type), intent(inout) :: held
      type(segment_type), intent(in) :: segment
      integer, intent(in) :: b, s
      real(wp), intent(in) :: ends(2, 2), tolerance

      if (.not. lies_on(segment, ends, tolerance)) return
      held = held_edge_type(b, s, matmul(segment%tangent, ends - spread(segment%first, 2, 2)))
   end subroutine hold_edge

   !> Hold the outer edges of new tiles as those of the old ones were that lay there.
   pure subroutine carry_held_edges(held, tiling, old_held, old_tiling)
      !> What holds every new outer edge, shape (n_edges).
      type(held_edge_type), allocatable, intent(out) :: held(:)
      !> New tiles.
      type(tiling_type), intent(in) :: tiling
      !> What holds every old outer edge.
      type(held_edge_type), intent(in) :: old_held(:)
      !> Old tiles.
      type(tiling_type), intent(in) :: old_tiling
      real(wp) :: ends(2, 2), share
      integer :: e, k, old

      allocate (held(size(tiling%outer_edge, 2)))
      if (.not. any(old_held%boundary > 0)) return
      do e = 1, size(held)
         ends = tiling%position(:, tiling%outer_edge(:2, e))
         call nearest_outer_edge(old_tiling, 0.5_wp*sum(ends, dim=2), old, share)
         if (old_held(old)%boundary == 0) cycle
         held(e) = old_held(old)
         do k = 1, 2
            call nearest_outer_edge(old_tiling, ends(:, k), old, share, &
                                    old_held%boundary == held(e)%boundary &
                                    .and. old_held%segment == held(e)%segment)
            held(e)%distance(k) = (1.0_wp - share)*old_held(old)%distance(1) &
               + share*old_held(old)%distance(2)
         end do
      end do
   end subroutine carry_held_edges

   !> Stations of a step: every outer edge against every face within reach that it looks at, with
   !> the faces where they are at the end of the step.
   pure subroutine build_contacts(contacts, boundaries, motion, tiling, held, spacing)
      !> Stations to make.
      type(contacts_type), intent(out) :: contacts
      !> Boundaries at the start of the step.
      type(boundary_type), intent(in) :: boundaries(:)
      !> How far every boundary moves in the step, length units, shape (2, n_boundaries).
      real(wp), intent(in) :: motion(:, :)
      !> Tiles at the start of the step.
      type(tiling_type), intent(in) :: tiling
      !> What holds every outer edge, shape (n_edges).
      type(held_edge_type), intent(in) :: held(:)
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      type(segment_type) :: segment
      real(wp) :: largest_reach
      integer :: e, b, s

      allocate (contacts%item(64))
      largest_reach = reach*spacing
      if (size(motion) > 0) largest_reach = largest_reach + 2.0_wp*maxval(abs(motion))
      do e = 1, size(held)
         do b = 1, size(boundaries)
            if (boundaries(b)%is_bilateral .neqv. held(e)%boundary == b) cycle
            if (held(e)%boundary /= 0 .and. held(e)%boundary /= b) cycle
            do s = 1, size(boundaries(b)%vertices, 2) - 1
               if (held(e)%boundary == b .and. held(e)%segment /= s) cycle
               call new_segment(segment, boundaries(b)%vertices(:, s) + motion(:, b), &
                                boundaries(b)%vertices(:, s + 1) + motion(:, b))
               call meet(contacts, boundaries(b), b, s, segment, tiling, e, held(e), &
                         largest_reach, deepest*spacing + norm2(motion(:, b)))
            end do
         end do
      end do
   end subroutine build_contacts

   !> Give stations the tractions that the last step left at the same place.
   pure subroutine recall_contacts(contacts, last)
      !> Stations to equip, ordered by edge.
      type(contacts_type), intent(inout) :: contacts
      !> Stations of the last accepted step, ordered by edge.
      type(contacts_type), intent(in) :: last
      integer :: i, j, first

      first = 1
      do i = 1, contacts%n
         associate (new => contacts%item(i))
            do while (first <= last%n)
               if (last%item(first)%edge >= new%edge) exit
               first = first + 1
            end do
            do j = first, last%n
               if (last%item(j)%edge > new%edge) exit
               if (last%item(j)%end_of_edge /= new%end_of_edge) cycle
               if (last%item(j)%boundary /= new%boundary) cycle
               if (last%item(j)%segment == new%segment) new%memory = last%item(j)%traction
            end do
         end associate
      end do
   end subroutine recall_contacts

   !> Stations at both ends of an edge against one face.
   pure subroutine meet(contacts, boundary, b, s, segment, tiling, e, held, reach, deepest)
      type(contacts_type), intent(inout) :: contacts
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: b, s, e
      type(segment_type), intent(in) :: segment
      type(tiling_type), intent(in) :: tiling
      type(held_edge_type), intent(in) :: held
      real(wp), intent(in) :: reach, deepest
      type(contact_type) :: contact
      real(wp) :: ends(2, 2), along(2), gap(2), distance(2), facing
      integer :: k

      ends = tiling%position(:, tiling%outer_edge(:2, e)) - spread(segment%first, 2, 2)
      along = ends(:, 2) - ends(:, 1)
      gap = matmul(segment%normal, ends)
      distance = matmul(segment%tangent, ends)
      if (boundary%is_bilateral) then
         facing = norm2(along)
      else
         facing = segment%normal(2)*along(1) - segment%normal(1)*along(2)
         if (facing <= 1.0e-9_wp*norm2(along)) return
         if (minval(gap) > reach .or. maxval(gap) < -deepest) return
         if (maxval(distance) < -reach .or. minval(distance) > segment%length + reach) return
      end if
      contact%boundary = b
      contact%segment = s
      contact%tile = tiling%outer_edge(3, e)
      contact%weight = 0.5_wp*facing
      contact%normal = segment%normal
      contact%tangent = segment%tangent
      contact%length = segment%length
      contact%is_bilateral = boundary%is_bilateral
      contact%is_fixed = boundary%kind == kind_fixed
      do k = 1, 2
         contact%corner = tiling%outer_edge(k, e)
         contact%vertex = findloc(tiling%corner(:, contact%tile), contact%corner, dim=1)
         contact%gap = gap(k)
         contact%distance = distance(k)
         contact%slide = distance(k) - held%distance(k)
         contact%edge = e
         contact%end_of_edge = k
         contact%other_corner = tiling%outer_edge(3 - k, e)
         contact%other_distance = distance(3 - k)
         call append(contacts, contact)
      end do
   end subroutine meet

   !> Add a station at the end of the list.
   pure subroutine append(contacts, contact)
      type(contacts_type), intent(inout) :: contacts
      type(contact_type), intent(in) :: contact
      type(contact_type), allocatable :: grown(:)

      if (contacts%n == size(contacts%item)) then
         allocate (grown(2*contacts%n))
         grown(:contacts%n) = contacts%item
         call move_alloc(grown, contacts%item)
      end if
      contacts%n = contacts%n + 1
      contacts%item(contacts%n) = contact
   end subroutine append

end module coulter_boundary_contact
