!> Stations on the corners of tiles: where a body meets walls and tools.
!>
!> Every outer edge of a body is held against every face that it looks at, with the gap at the end
!> of the step; the traction of the material itself makes the constraint consistent, so that any
!> penalty passes the patch test (Nitsche; theory, section 4).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_contact
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type, kind_fixed
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type, reaches
   use coulter_boundary_motion, only: largest_shift, motion_type, moved_by
   use coulter_boundary_segment, only: lies_on, new_segment, segment_type
   use coulter_boundary_tip, only: covered_share, find_tips, tip_type
   use coulter_points_tiling, only: nearest_outer_edge, tiling_type
   implicit none(type, external)
   private
   public :: contact_type, contacts_type, held_edge_type, find_held_edges, build_contacts
   public :: carry_held_edges, recall_contacts, end_slack

   !> One end of an outer edge against one face.
   type :: contact_type
      !> Number of the boundary and of its segment.
      integer :: boundary = 0, segment = 0
      !> Tile that owns the edge, and which of its vertices the station is.
      integer :: tile = 0, vertex = 0
      !> Corner of the tiling at that vertex, and corner at the other end of the edge.
      integer :: corner = 0, other_corner = 0
      !> Vertex at the other end of the edge; corner of the tool that presses between the ends, 0 if
      !> the station is a corner of the tile; place of that on the edge at the start.
      integer :: other_vertex = 0, tip = 0
      real(wp) :: share = 0.0_wp
      !> Number of the outer edge, and which of its ends the station is: its identity from step to
      !> step.
      integer :: edge = 0, end_of_edge = 0
      !> Length of face that the station stands for.
      real(wp) :: weight = 0.0_wp
      !> The face at the end of the step.
      type(face_type) :: face
      !> Corners of the edge at the start of the step, from the first end of the face, length units.
      real(wp) :: offset(2) = 0.0_wp, other_offset(2) = 0.0_wp
      !> Unit vector that the stress of the tile acts on: against the edge's outward normal, or the
      !> normal of the face where that is the same.
      real(wp) :: inward(2) = 0.0_wp
      !> Way from the place where the corner sticks to the face to the corner, if that stays where
      !> it is and the face moves, and the same after the step, length units.
      real(wp) :: lag(2) = 0.0_wp, new_lag(2) = 0.0_wp
      !> Traction (normal, tangential) that earlier rounds and steps left, for augmented
      !> formulations, and that of the current iteration, stress units.
      real(wp) :: memory(2) = 0.0_wp, traction(2) = 0.0_wp
      !> Is it settled for the step that the face reaches the corner? So it is beside sharp corners
      !> of tools, around which corners of bodies would come and go.
      logical :: is_settled = .false.
      !> Is the corner held in both directions and also against being pulled off, and does it rub?
      logical :: is_bilateral = .false., is_fixed = .false., rubs = .false.
      !> Does the face act on it, and did it in the last step?
      logical :: is_acting = .false., was_acting = .false.
      !> Sign of its shear while it slips, 0 while it sticks; and in the last step.
      integer :: slip = 0, last_slip = 0
   end type contact_type

   !> Sharp corners of one tool.
   type :: tips_type
      type(tip_type), allocatable :: item(:)
   end type tips_type

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
   !> A face reaches this far beyond its ends, over the spacing: a corner that sits at an end must
   !> not come and go with round-off.
   real(wp), parameter :: end_slack = 0.05_wp
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
         if (.not. (boundaries(b)%is_bilateral .and. boundaries(b)%is_active)) cycle
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
      !> How every boundary moves in the step, shape (n_boundaries).
      type(motion_type), intent(in) :: motion(:)
      !> Tiles at the start of the step.
      type(tiling_type), intent(in) :: tiling
      !> What holds every outer edge, shape (n_edges).
      type(held_edge_type), intent(in) :: held(:)
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      type(tips_type) :: tips(size(boundaries))
      real(wp) :: shift(size(boundaries)), largest_reach
      integer :: e, b, s

      allocate (contacts%item(64))
      do b = 1, size(boundaries)
         shift(b) = largest_shift(motion(b), boundaries(b)%vertices)
         call find_tips(tips(b)%item, boundaries(b), tiling, spacing)
      end do
      largest_reach = reach*spacing + 2.0_wp*maxval([0.0_wp, shift])
      do e = 1, size(held)
         do b = 1, size(boundaries)
            if (.not. boundaries(b)%is_active) cycle
            if (boundaries(b)%is_bilateral .neqv. held(e)%boundary == b) cycle
            if (held(e)%boundary /= 0 .and. held(e)%boundary /= b) cycle
            do s = 1, size(boundaries(b)%vertices, 2) - 1
               if (held(e)%boundary == b .and. held(e)%segment /= s) cycle
               call meet(contacts, boundaries(b), b, s, motion(b), tiling, e, held(e), &
                         largest_reach, deepest*spacing + shift(b), spacing, tips(b)%item)
            end do
            call press_tips(contacts, boundaries(b), b, motion(b), tiling, e, tips(b)%item)
         end do
      end do
   end subroutine build_contacts

   !> Give stations what the last step left at the same place.
   pure subroutine recall_contacts(contacts, last, motion, tiling)
      !> Stations to equip, ordered by edge.
      type(contacts_type), intent(inout) :: contacts
      !> Stations of the last accepted step, ordered by edge.
      type(contacts_type), intent(in) :: last
      !> How every boundary moves in the step, shape (n_boundaries).
      type(motion_type), intent(in) :: motion(:)
      !> Tiles at the start of the step.
      type(tiling_type), intent(in) :: tiling
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
               if (last%item(j)%segment /= new%segment .or. last%item(j)%tip /= new%tip) cycle
               new%memory = last%item(j)%traction
               new%was_acting = last%item(j)%is_acting
               new%last_slip = last%item(j)%slip
               if (new%rubs) new%lag = lag_after(motion(new%boundary), &
                                       tiling%position(:, new%corner), last%item(j)%new_lag)
            end do
         end associate
      end do
   end subroutine recall_contacts

   !> Way to a corner from the place where it sticks to a boundary, once that has moved.
   pure function lag_after(motion, corner, lag) result(way)
      type(motion_type), intent(in) :: motion
      real(wp), intent(in) :: corner(2), lag(2)
      real(wp) :: way(2)

      way = corner - moved_by(motion, corner - lag)
      ! without rotation no digits may be lost
      if (.not. abs(motion%rotation) > 0.0_wp) way = lag - motion%translation
   end function lag_after

   !> Stations at both ends of an edge against one face.
   pure subroutine meet(contacts, boundary, b, s, motion, tiling, e, held, reach, deepest, &
                        spacing, tips)
      type(contacts_type), intent(inout) :: contacts
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: b, s, e
      type(motion_type), intent(in) :: motion
      type(tiling_type), intent(in) :: tiling
      type(held_edge_type), intent(in) :: held
      real(wp), intent(in) :: reach, deepest
      real(wp), intent(in) :: spacing
      type(tip_type), intent(in) :: tips(:)
      type(contact_type) :: contact
      real(wp) :: weight(2)
      integer :: k

      associate (first => boundary%vertices(:, s), last => boundary%vertices(:, s + 1))
         call new_face(contact%face, moved_by(motion, first), moved_by(motion, last), &
                       boundary%bulge(s))
         call weigh(boundary, s, contact%face, tiling%position(:, tiling%outer_edge(:2, e)), &
                    reach, deepest, weight)
      end associate
      if (.not. any(weight > 0.0_wp)) return
      contact%boundary = b
      contact%segment = s
      contact%edge = e
      contact%tile = tiling%outer_edge(3, e)
      contact%is_bilateral = boundary%is_bilateral
      contact%is_fixed = boundary%kind == kind_fixed
      contact%rubs = boundary%has_friction() .and. .not. contact%is_fixed
      if (.not. boundary%is_bilateral) contact%is_settled = any(tips%faces(1) == s &
                                                                .or. tips%faces(2) == s)
      weight = weight*covered_share(tips, boundary, s, e, tiling%position(:, &
                                                               tiling%outer_edge(:2, e)))
      do k = 1, 2
         contact%weight = weight(k)
         if (.not. weight(k) > 0.0_wp) cycle
         call settle_end(contact, k, tiling, motion, held)
         if (contact%is_settled) then
            if (.not. starts_on(boundary, s, tiling%position(:, [contact%corner, &
                                                                 contact%other_corner]), &
                                end_slack*spacing)) cycle
         end if
         call append(contacts, contact)
      end do
   end subroutine meet

   !> Does a face reach the first end of an edge, given by both ends, before the step?
   pure function starts_on(boundary, s, ends, slack) result(answer)
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: s
      real(wp), intent(in) :: ends(2, 2), slack
      logical :: answer
      type(face_type) :: face
      type(place_type) :: place(2)
      integer :: k

      call new_face(face, boundary%vertices(:, s), boundary%vertices(:, s + 1), boundary%bulge(s))
      do k = 1, 2
         place(k) = place_on(face, ends(:, k) - face%first, [0.0_wp, 0.0_wp])
      end do
      answer = reaches(face, place(1)%distance, place(2)%distance, slack)
   end function starts_on

   !> Stations where sharp corners of a tool press on an edge: for half of what their faces cover of
   !> it.
   pure subroutine press_tips(contacts, boundary, b, motion, tiling, e, tips)
      type(contacts_type), intent(inout) :: contacts
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: b, e
      type(motion_type), intent(in) :: motion
      type(tiling_type), intent(in) :: tiling
      type(tip_type), intent(in) :: tips(:)
      type(contact_type) :: contact
      real(wp) :: ends(2, 2), tip(2)
      integer :: i

      do i = 1, size(tips)
         if (tips(i)%edge /= e) cycle
         contact = contact_type(boundary=b, edge=e, tile=tiling%outer_edge(3, e), &
                                tip=tips(i)%vertex, share=tips(i)%share, end_of_edge=1)
         ends = tiling%position(:, tiling%outer_edge(:2, e))
         contact%weight = tip_weight(boundary, tips, tips(i), ends)
         if (.not. contact%weight > 0.0_wp) cycle
         tip = moved_by(motion, boundary%vertices(:, tips(i)%vertex))
         contact%face%first = tip
         contact%rubs = boundary%has_friction()
         call settle_end(contact, 1, tiling, motion, held_edge_type())
         contact%inward = [-(ends(2, 2) - ends(2, 1)), ends(1, 2) - ends(1, 1)] &
            /norm2(ends(:, 2) - ends(:, 1))
         contact%lag = boundary%vertices(:, tips(i)%vertex) - tip
         call append(contacts, contact)
      end do
   end subroutine press_tips

   !> Half of what both faces at a sharp corner cover of an edge that they look at.
   pure function tip_weight(boundary, tips, tip, ends) result(weight)
      type(boundary_type), intent(in) :: boundary
      type(tip_type), intent(in) :: tips(:), tip
      real(wp), intent(in) :: ends(2, 2)
      real(wp) :: weight
      type(face_type) :: face
      real(wp) :: facing(2)
      integer :: k

      weight = 0.0_wp
      do k = 1, 2
         associate (s => tip%faces(k))
            call new_face(face, boundary%vertices(:, s), boundary%vertices(:, s + 1), &
                          boundary%bulge(s))
            call weigh(boundary, s, face, ends, huge(1.0_wp), huge(1.0_wp), facing)
            weight = weight + maxval(facing)*covered_share(tips, boundary, s, tip%edge, ends)
         end associate
      end do
   end function tip_weight

   !> What belongs to one end of the edge.
   pure subroutine settle_end(contact, k, tiling, motion, held)
      type(contact_type), intent(inout) :: contact
      integer, intent(in) :: k
      type(tiling_type), intent(in) :: tiling
      type(motion_type), intent(in) :: motion
      type(held_edge_type), intent(in) :: held
      real(wp) :: along(2)

      contact%end_of_edge = k
      contact%corner = tiling%outer_edge(k, contact%edge)
      contact%other_corner = tiling%outer_edge(3 - k, contact%edge)
      contact%vertex = findloc(tiling%corner(:, contact%tile), contact%corner, dim=1)
      contact%other_vertex = findloc(tiling%corner(:, contact%tile), contact%other_corner, dim=1)
      contact%offset = tiling%position(:, contact%corner) - contact%face%first
      contact%other_offset = tiling%position(:, contact%other_corner) - contact%face%first
      contact%inward = contact%face%normal
      contact%lag = 0.0_wp
      if (contact%is_fixed) then
         contact%lag = (dot_product(contact%face%tangent, contact%offset) - held%distance(k)) &
            *contact%face%tangent
      else if (contact%rubs) then
         contact%lag = lag_after(motion, tiling%position(:, contact%corner), contact%lag)
      end if
      if (.not. (contact%rubs .or. abs(contact%face%radius) > 0.0_wp &
                 .or. abs(motion%rotation) > 0.0_wp)) return
      along = real(3 - 2*k, wp)*(contact%other_offset - contact%offset)
      contact%inward = [-along(2), along(1)]/norm2(along)
   end subroutine settle_end

   !> Length of a face that both ends of an edge stand for: the half of the edge that faces it, 0
   !> if they cannot meet within the step.
   pure subroutine weigh(boundary, s, moved, ends, reach, deepest, weight)
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: s
      type(face_type), intent(in) :: moved
      real(wp), intent(in) :: ends(2, 2), reach, deepest
      real(wp), intent(out) :: weight(2)
      type(face_type) :: face
      type(place_type) :: place(2)
      real(wp) :: along(2)
      integer :: k

      along = ends(:, 2) - ends(:, 1)
      weight = 0.5_wp*norm2(along)
      if (boundary%is_bilateral) return
      call new_face(face, boundary%vertices(:, s), boundary%vertices(:, s + 1), boundary%bulge(s))
      do k = 1, 2
         place(k) = place_on(face, ends(:, k) - face%first, [0.0_wp, 0.0_wp])
         weight(k) = 0.5_wp*(place(k)%normal(2)*along(1) - place(k)%normal(1)*along(2))
         if (weight(k) <= 0.5e-9_wp*norm2(along)) weight(k) = 0.0_wp
         place(k) = place_on(moved, ends(:, k) - moved%first, [0.0_wp, 0.0_wp])
      end do
      if (minval(place%gap) > reach .or. maxval(place%gap) < -deepest &
          .or. maxval(place%distance) < -reach &
          .or. minval(place%distance) > moved%length + reach) weight = 0.0_wp
   end subroutine weigh

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
