!> The search for contacts: every outer edge of a body against every face and every sharp corner of
!> a tool that it may meet in the step, with the gap at the end of the step.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_search
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type, kind_fixed
   use coulter_boundary_face, only: new_face
   use coulter_boundary_held_edge, only: held_edge_type
   use coulter_boundary_motion, only: motion_type, moved_by
   use coulter_contact, only: append_contact, contact_type, contacts_type
   use coulter_contact_approach, only: approach_type, find_roots, list_open_tips, look_ahead
   use coulter_contact_beside_tips, only: cover, looks_at_open_end, settle_reach
   use coulter_contact_cut, only: cut_type
   use coulter_contact_overlap, only: overlap_type
   use coulter_contact_station, only: are_beyond, settle_end, weigh
   use coulter_contact_tip_stations, only: press_tips
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: build_contacts

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
      if (allocated(approach%thickness)) then
         weight = merge(0.0_wp, weight, are_beyond(boundary, s, approach%thickness(s), ends))
      end if
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

end module coulter_contact_search
