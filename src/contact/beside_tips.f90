!> What faces that end in sharp corners of tools reach of the edges beside these.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_beside_tips
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type, reaches
   use coulter_contact, only: contact_type
   use coulter_contact_approach, only: approach_type
   use coulter_contact_overlap, only: belongs_to_next, depth_beside, find_overlap, overlap_type
   use coulter_contact_tip, only: covered_share, side_of, tip_type
   implicit none(type, external)
   private
   public :: looks_at_open_end, cover, settle_reach

   !> Edges whose outward normal has less than this component against that of a face beside an open
   !> end do not meet it: the corner that is let through there turns them a little.
   real(wp), parameter :: facing = 0.3_wp
   !> What came round a corner of a tool by less than this is pushed out at once, over the spacing.
   real(wp), parameter :: round_slack = 0.02_wp
   !> Beside a corner that cuts in with both faces, the root of the cut does not go with them, and
   !> what they press there moves nothing: it carries this share of what linear functions give.
   real(wp), parameter :: share_of_root = 0.5_wp

contains

   !> Does an edge beside a corner look at the next face, which ends openly there: more than at this
   !> one where the corner cuts in, and hardly at this one elsewhere?
   pure function looks_at_open_end(boundary, tips, s, ends, spacing) result(answer)
      !> The tool, and its sharp corners.
      type(boundary_type), intent(in) :: boundary
      type(tip_type), intent(in) :: tips(:)
      !> Its segment.
      integer, intent(in) :: s
      !> Ends of the edge, one column each, and grid spacing.
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
      !> What is covered; all of it where no sharp corner is near.
      type(overlap_type), intent(out) :: overlap
      !> The boundary, its segment and the outer edge.
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: s, e
      !> What the boundary does in the step.
      type(approach_type), intent(in) :: approach
      !> Ends of the edge, one column each.
      real(wp), intent(in) :: ends(2, 2)

      if (size(approach%tips) == 0) return
      call find_overlap(overlap, boundary, approach%tips, s, ends, approach%spacing)
      if (overlap%is_partial) return
      overlap%share = 0.5_wp*covered_share(approach%tips, boundary, s, e, ends)
   end subroutine cover

   !> Beside sharp corners of a tool: does its face reach a corner of the body in this step, and how
   !> hard? The weight becomes 0 if it does not.
   pure subroutine settle_reach(contact, boundary, approach, overlap, ends)
      !> Station at one end of the edge.
      type(contact_type), intent(inout) :: contact
      !> The boundary, and what it does in the step.
      type(boundary_type), intent(in) :: boundary
      type(approach_type), intent(in) :: approach
      !> What its face covers of the edge.
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
         if (contact%leans .and. any(tips%root == contact%corner)) contact%weight &
            = share_of_root*contact%weight
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

end module coulter_contact_beside_tips
