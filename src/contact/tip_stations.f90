!> Stations where sharp corners of tools press on outer edges of bodies.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_tip_stations
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face
   use coulter_boundary_held_edge, only: held_edge_type
   use coulter_boundary_motion, only: moved_by
   use coulter_contact, only: append_contact, contact_type, contacts_type
   use coulter_contact_approach, only: approach_type
   use coulter_contact_station, only: settle_end, weigh
   use coulter_contact_tip, only: covered_share, tip_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: press_tips

contains

   !> Stations where sharp corners of a tool press on an edge: for half of what their faces cover of
   !> it.
   pure subroutine press_tips(contacts, boundary, approach, tiling, e)
      !> Stations to add to.
      type(contacts_type), intent(inout) :: contacts
      !> The tool at the start of the step, and what it does in it.
      type(boundary_type), intent(in) :: boundary
      type(approach_type), intent(in) :: approach
      !> Tiles at the start of the step, and the outer edge.
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

end module coulter_contact_tip_stations
