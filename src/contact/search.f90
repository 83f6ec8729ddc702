!> The search for contacts: every outer edge of a body against every face and every sharp corner of
!> a tool that it may meet in the step, with the gap at the end of the step.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_search
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type, kind_fixed
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type, reaches
   use coulter_boundary_held_edge, only: held_edge_type
   use coulter_boundary_motion, only: largest_shift, motion_type, moved_by
   use coulter_contact, only: append_contact, contact_type, contacts_type, end_slack, lag_after
   use coulter_contact_cut, only: cut_type
   use coulter_contact_overlap, only: belongs_to_next, depth_beside, find_overlap, overlap_type
   use coulter_contact_round_tip, only: add_round_tips
   use coulter_contact_tip, only: covered_share, find_tips, side_of, tip_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: build_contacts

   !> What a boundary does in the step, and how far it looks for edges.
   type :: approach_type
      !> Number of the boundary.
      integer :: number = 0
      !> How it moves, and may it turn in the step?
      type(motion_type) :: motion
      logical :: may_turn = .false.
      !> Its sharp corners, if it is a tool.
      type(tip_type), allocatable :: tips(:)
      !> Edges farther away than `reach` or behind a face by more than `deepest` cannot be met;
      !> faces reach `slack` beyond their ends; spacing of the grid, length units.
      real(wp) :: reach = 0.0_wp, deepest = 0.0_wp, slack = 0.0_wp, spacing = 0.0_wp
   end type approach_type

   !> Faces this far away may be met within a step, over the spacing.
   real(wp), parameter :: reach = 4.0_wp
   !> Edges deeper behind a face than this, over the spacing, and the way that the face has come in
   !> the step belong to something else.
   real(wp), parameter :: deepest = 1.0_wp
   !> A corner of a tool this near to a face of another one abuts on it, over the spacing, if the
   !> product of the normals of both faces is more than this.
   real(wp), parameter :: abutting = 1.0e-6_wp, same_way = 0.99_wp
   !> Edges whose outward normal has less than this component against that of a face beside an open
   !> end do not meet it: the corner that is let through there turns them a little.
   real(wp), parameter :: facing = 0.3_wp
   !> What came round a corner of a tool by less than this is pushed out at once, over the spacing.
   real(wp), parameter :: round_slack = 0.02_wp

contains

   !> Stations of a step: every outer edge against every face within reach that it looks at, with
   !> the faces where they are at the end of the step.
   pure subroutine build_contacts(contacts, boundaries, motion, tiling, held, spacing, cuts)
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
      !> Cuts ahead of corners of tools.
      type(cut_type), intent(in), optional :: cuts(:)
      type(approach_type) :: approach(size(boundaries))
      integer :: e, b, s

      allocate (contacts%item(64))
      call look_ahead(approach, boundaries, motion, tiling, spacing)
      call list_open_tips(contacts, approach)
      if (present(cuts)) call find_roots(approach, cuts)
      do e = 1, size(held)
         do b = 1, size(boundaries)
            if (.not. boundaries(b)%is_active) cycle
            if (boundaries(b)%is_bilateral .neqv. held(e)%boundary == b) cycle
            if (held(e)%boundary /= 0 .and. held(e)%boundary /= b) cycle
            do s = 1, size(boundaries(b)%vertices, 2) - 1
               if (held(e)%boundary == b .and. held(e)%segment /= s) cycle
               call meet(contacts, boundaries(b), s, approach(b), tiling, e, held(e))
            end do
            call press_tips(contacts, boundaries(b), approach(b), tiling, e)
         end do
      end do
   end subroutine build_contacts

   !> Note the sharp corners of tools beside which faces end openly.
   pure subroutine list_open_tips(contacts, approach)
      type(contacts_type), intent(inout) :: contacts
      type(approach_type), intent(in) :: approach(:)
      integer, allocatable :: list(:)
      integer :: b, i

      allocate (list(0))
      do b = 1, size(approach)
         do i = 1, size(approach(b)%tips)
            associate (tip => approach(b)%tips(i))
               ! rounded corners, and those that cut in with both faces, have no tiles cut ahead
               if (tip%is_round .or. tip%cuts .or. .not. any(tip%is_open)) cycle
               list = [list, b, tip%vertex]
            end associate
         end do
      end do
      if (size(list) > 0) contacts%open_tips = reshape(list, [2, size(list)/2])
   end subroutine list_open_tips

   !> Find the corners of bodies to which these are cut ahead of corners of tools.
   pure subroutine find_roots(approach, cuts)
      type(approach_type), intent(inout) :: approach(:)
      type(cut_type), intent(in) :: cuts(:)
      integer :: i

      do i = 1, size(cuts)
         associate (tips => approach(cuts(i)%boundary)%tips)
            where (tips%vertex == cuts(i)%vertex .and. .not. (tips%is_round .or. tips%cuts)) &
               tips%root = cuts(i)%corner
         end associate
      end do
   end subroutine find_roots

   !> What every boundary does in the step.
   pure subroutine look_ahead(approach, boundaries, motion, tiling, spacing)
      type(approach_type), intent(inout) :: approach(:)
      type(boundary_type), intent(in) :: boundaries(:)
      type(motion_type), intent(in) :: motion(:)
      type(tiling_type), intent(in) :: tiling
      real(wp), intent(in) :: spacing
      real(wp) :: shift(size(boundaries))
      integer :: b

      do b = 1, size(boundaries)
         shift(b) = largest_shift(motion(b), boundaries(b)%vertices)
         approach(b)%number = b
         approach(b)%motion = motion(b)
         approach(b)%may_turn = abs(motion(b)%rotation) > 0.0_wp .or. boundaries(b)%turns_freely
         call find_tips(approach(b)%tips, boundaries(b), tiling, spacing)
         call close_abutting_ends(approach(b)%tips, boundaries, b, tiling, spacing)
         call add_round_tips(approach(b)%tips, boundaries(b), tiling, spacing)
      end do
      approach%reach = reach*spacing + 2.0_wp*maxval([0.0_wp, shift])
      approach%deepest = deepest*spacing + shift
      approach%slack = end_slack*spacing
      approach%spacing = spacing
   end subroutine look_ahead

   !> Where a face of another tool carries on from the end of a face, that is not open: the body
   !> does not go on beyond it without a tool. Corners of the body at such a place need no tip.
   pure subroutine close_abutting_ends(tips, boundaries, b, tiling, spacing)
      !> Sharp corners of a tool.
      type(tip_type), allocatable, intent(inout) :: tips(:)
      type(boundary_type), intent(in) :: boundaries(:)
      !> Number of the tool.
      integer, intent(in) :: b
      type(tiling_type), intent(in) :: tiling
      real(wp), intent(in) :: spacing
      logical :: does_abut(2), is_kept(size(tips))
      real(wp) :: ends(2, 2)
      integer :: c, i

      is_kept = .true.
      do i = 1, size(tips)
         do c = 1, size(boundaries)
            if (c == b .or. .not. (boundaries(c)%is_tool .and. boundaries(c)%is_active)) cycle
            does_abut = carries_on(boundaries(c), boundaries(b)%vertices(:, tips(i)%vertex), &
                                   tips(i)%normal, abutting*spacing)
            tips(i)%is_open = tips(i)%is_open .and. .not. does_abut
            if (.not. any(does_abut)) cycle
            ends = tiling%position(:, tiling%outer_edge(:2, tips(i)%edge))
            is_kept(i) = min(tips(i)%share, 1.0_wp - tips(i)%share) &
               *norm2(ends(:, 2) - ends(:, 1)) > end_slack*spacing
         end do
      end do
      if (.not. all(is_kept)) tips = pack(tips, is_kept)
   end subroutine close_abutting_ends

   !> Does a face of a tool that looks the same way as one of two others pass through a place?
   pure function carries_on(tool, place, normal, slack) result(answer)
      type(boundary_type), intent(in) :: tool
      !> Place, normals of the other faces, and distance below which it is on the face.
      real(wp), intent(in) :: place(2), normal(2, 2), slack
      logical :: answer(2)
      type(face_type) :: face
      type(place_type) :: foot
      integer :: s

      answer = .false.
      do s = 1, size(tool%vertices, 2) - 1
         call new_face(face, tool%vertices(:, s), tool%vertices(:, s + 1), tool%bulge(s))
         foot = place_on(face, place - face%first, [0.0_wp, 0.0_wp])
         if (abs(foot%gap) > slack .or. foot%distance < -slack &
             .or. foot%distance > face%length + slack) cycle
         answer = answer .or. matmul(foot%normal, normal) > same_way
      end do
   end function carries_on

   !> Stations at both ends of an edge against one face.
   pure subroutine meet(contacts, boundary, s, approach, tiling, e, held)
      type(contacts_type), intent(inout) :: contacts
      type(boundary_type), intent(in) :: boundary
      !> Segment of the boundary, and outer edge.
      integer, intent(in) :: s, e
      type(approach_type), intent(in) :: approach
      type(tiling_type), intent(in) :: tiling
      type(held_edge_type), intent(in) :: held
      type(contact_type) :: contact
      type(overlap_type) :: overlap
      real(wp) :: weight(2), ends(2, 2)
      integer :: k

      ends = tiling%position(:, tiling%outer_edge(:2, e))
      call new_face(contact%face, moved_by(approach%motion, boundary%vertices(:, s)), &
                    moved_by(approach%motion, boundary%vertices(:, s + 1)), boundary%bulge(s))
      call weigh(boundary, s, contact%face, ends, approach%reach, approach%deepest, weight)
      if (.not. any(weight > 0.0_wp)) return
      contact%boundary = approach%number
      contact%segment = s
      contact%edge = e
      contact%tile = tiling%outer_edge(3, e)
      contact%is_bilateral = boundary%is_bilateral
      contact%is_fixed = boundary%kind == kind_fixed
      contact%rubs = boundary%has_friction() .and. .not. contact%is_fixed
      if (looks_at_open_end(boundary, approach%tips, s, ends, approach%spacing)) return
      ! what is cut ahead of a tip counts to be where the tip will meet it
      do k = 1, size(approach%tips)
         associate (tip => approach%tips(k))
            where (spread(tiling%outer_edge(:2, e) == tip%root, 1, 2)) &
               ends = spread(boundary%vertices(:, tip%vertex), 2, 2)
         end associate
      end do
      call cover(overlap, boundary, s, approach, e, ends)
      weight = 2.0_wp*weight*overlap%share
      do k = 1, 2
         contact%weight = weight(k)
         if (.not. weight(k) > 0.0_wp) cycle
         call settle_end(contact, k, tiling, approach, held)
         call settle_reach(contact, boundary, approach, overlap, ends(:, [k, 3 - k]))
         if (.not. contact%weight > 0.0_wp) cycle
         call append_contact(contacts, contact)
      end do
   end subroutine meet

   !> Does an edge beside a corner look at the next face, which ends openly there: more than at this
   !> one where the corner cuts in, and hardly at this one elsewhere?
   pure function looks_at_open_end(boundary, tips, s, ends, spacing) result(answer)
      type(boundary_type), intent(in) :: boundary
      type(tip_type), intent(in) :: tips(:)
      integer, intent(in) :: s
      real(wp), intent(in) :: ends(2, 2), spacing
      logical :: answer
      real(wp) :: outward(2), looks(2), least
      integer :: i, k

      answer = .false.
      outward = [ends(2, 2) - ends(2, 1), ends(1, 1) - ends(1, 2)]
      do i = 1, size(tips)
         k = side_of(tips(i), s)
         if (k == 0) cycle
         if (tips(i)%is_open(k) .or. .not. tips(i)%is_open(3 - k)) cycle
         if (minval(norm2(ends - spread(boundary%vertices(:, tips(i)%vertex), 2, 2), dim=1)) &
             > spacing) cycle
         looks = -matmul(outward, tips(i)%normal(:, [k, 3 - k]))
         least = merge(looks(2), min(looks(2), facing*norm2(outward)), tips(i)%cuts)
         answer = answer .or. looks(1) < least
      end do
   end function looks_at_open_end

   !> What a face covers of an edge.
   pure subroutine cover(overlap, boundary, s, approach, e, ends)
      type(overlap_type), intent(out) :: overlap
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: s, e
      type(approach_type), intent(in) :: approach
      real(wp), intent(in) :: ends(2, 2)

      if (size(approach%tips) == 0) return
      call find_overlap(overlap, boundary, approach%tips, s, ends, approach%spacing)
      if (overlap%is_partial) return
      overlap%share = 0.5_wp*covered_share(approach%tips, boundary, s, e, ends)
   end subroutine cover

   !> Beside sharp corners of a tool: does its face reach a corner of the body in this step, and how
   !> hard? The weight becomes 0 if it does not.
   pure subroutine settle_reach(contact, boundary, approach, overlap, ends)
      type(contact_type), intent(inout) :: contact
      type(boundary_type), intent(in) :: boundary
      type(approach_type), intent(in) :: approach
      type(overlap_type), intent(in) :: overlap
      !> The corner, and the other end of the edge.
      real(wp), intent(in) :: ends(2, 2)
      integer :: i

      associate (tips => approach%tips, s => contact%segment, k => contact%end_of_edge)
         contact%is_settled = .not. boundary%is_bilateral &
            .and. any([(side_of(tips(i), s) > 0, i=1, size(tips))])
         contact%give = overlap%give(k)
         contact%hold = overlap%hold(k)
         contact%leans = overlap%leans(k)
         contact%recedes = overlap%recedes
         if (overlap%is_partial .or. .not. contact%is_settled) return
         contact%give = depth_beside(boundary, tips, s, ends(:, 1), round_slack*approach%spacing)
         contact%hold = 0.0_wp
         if (.not. starts_on(boundary, s, ends, approach%slack)) contact%weight = 0.0_wp
         if (belongs_to_next(boundary, tips, s, ends(:, 1), approach%slack)) contact%weight = 0.0_wp
      end associate
   end subroutine settle_reach

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
   pure subroutine press_tips(contacts, boundary, approach, tiling, e)
      type(contacts_type), intent(inout) :: contacts
      type(boundary_type), intent(in) :: boundary
      type(approach_type), intent(in) :: approach
      type(tiling_type), intent(in) :: tiling
      integer, intent(in) :: e
      type(contact_type) :: contact
      real(wp) :: ends(2, 2), place(2), along
      integer :: i

      do i = 1, size(approach%tips)
         associate (tip => approach%tips(i))
            if (tip%edge /= e .or. any(tip%is_open)) cycle
            ends = tiling%position(:, tiling%outer_edge(:2, e))
            ! a corner of the body so near is reached by the face, and stands for its end
            along = min(tip%share, 1.0_wp - tip%share)*norm2(ends(:, 2) - ends(:, 1))
            if (along <= approach%slack) cycle
            contact = contact_type(boundary=approach%number, edge=e, tile=tiling%outer_edge(3, e), &
                                   tip=tip%vertex, share=tip%share, end_of_edge=1)
            contact%weight = tip_weight(boundary, approach%tips, tip, ends)
            if (.not. contact%weight > 0.0_wp) cycle
            place = moved_by(approach%motion, boundary%vertices(:, tip%vertex))
            contact%face%first = place
            contact%rubs = boundary%has_friction()
            call settle_end(contact, 1, tiling, approach, held_edge_type())
            contact%inward = [-(ends(2, 2) - ends(2, 1)), ends(1, 2) - ends(1, 1)] &
               /norm2(ends(:, 2) - ends(:, 1))
            contact%lag = boundary%vertices(:, tip%vertex) - place
            call append_contact(contacts, contact)
         end associate
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
   pure subroutine settle_end(contact, k, tiling, approach, held)
      type(contact_type), intent(inout) :: contact
      integer, intent(in) :: k
      type(tiling_type), intent(in) :: tiling
      type(approach_type), intent(in) :: approach
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
         contact%lag = lag_after(approach%motion, tiling%position(:, contact%corner), contact%lag)
      end if
      if (.not. (contact%rubs .or. abs(contact%face%radius) > 0.0_wp .or. approach%may_turn)) return
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

end module coulter_contact_search
