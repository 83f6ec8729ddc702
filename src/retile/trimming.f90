!> The outline of a body without what reaches behind walls and tools.
!>
!> New tiles fill the outline: what is left behind a face in it stays there for good, and a corner
!> of a tool that its chords cut off sits inside the body (theory, section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_trimming
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face, place_type
   use coulter_contact_cut, only: cut_type
   use coulter_contact_tip, only: is_closed
   use coulter_points_outline, only: insert_corner, outline_type
   use coulter_points_tiling, only: tiling_type
   use coulter_retile_beside_faces, only: edge_from, find_place, looks_at
   use coulter_retile_tool_corners, only: add_vertex, lead_of
   implicit none(type, external)
   private
   public :: trim_outline, push_corners_out

   !> Corners deeper behind a face than this belong to something else, over the spacing.
   real(wp), parameter :: deepest = 0.5_wp
   !> Corners less deep than this stay there: the gap is what contacts press with, and without it
   !> tools would lose a tenth of their force until the next step; over the spacing.
   real(wp), parameter :: shallow = 0.01_wp
   !> Edges of the outline that pass deeper than this behind an arc get a corner on it, over the
   !> spacing.
   real(wp), parameter :: sagitta = 0.05_wp
   !> Corners of new tiles on chords of arcs are at most this deep, over the spacing.
   real(wp), parameter :: chord_depth = 0.3_wp
   !> Corners this near to a boundary that holds for good stay on it, over the spacing, unless a
   !> face meets it at an angle with a smaller sine.
   real(wp), parameter :: on_line = 0.02_wp, steepest = 0.1_wp

contains

   !> Move corners behind faces onto them, and give the outline the corners of tools that are inside
   !> the body.
   pure subroutine trim_outline(outline, boundaries, spacing, cuts)
      !> Outline to trim.
      type(outline_type), intent(inout) :: outline
      !> Boundaries in their present position; those that hold for good are left alone.
      type(boundary_type), intent(in) :: boundaries(:)
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      !> Where the outline gets corners ahead of those of tools.
      type(cut_type), intent(in), optional :: cuts(:)
      real(wp) :: lead(2)
      integer :: b, c, v, pass

      ! a corner behind two faces that meet in a concave corner takes a pass for each
      do pass = 1, 3
         do c = 1, outline%n
            call push_out(outline, c, boundaries, spacing)
         end do
      end do
      do b = 1, size(boundaries)
         if (boundaries(b)%is_bilateral .or. .not. boundaries(b)%is_active) cycle
         ! the first vertex of a closed chain is also its last
         do v = 1, size(boundaries(b)%vertices, 2) - merge(1, 0, is_closed(boundaries(b)))
            lead = 0.0_wp
            if (present(cuts)) lead = lead_of(cuts, b, boundaries(b)%vertices(:, v))
            call add_vertex(outline, boundaries, b, v, spacing, lead)
         end do
         do v = 1, size(boundaries(b)%vertices, 2) - 1
            call bend_along(outline, boundaries(b), v, spacing)
         end do
      end do
   end subroutine trim_outline

   !> Move a corner onto the face that it is least behind.
   pure subroutine push_out(outline, c, boundaries, spacing)
      type(outline_type), intent(inout) :: outline
      integer, intent(in) :: c
      type(boundary_type), intent(in) :: boundaries(:)
      real(wp), intent(in) :: spacing
      type(place_type) :: place
      real(wp) :: least, shift(2)
      integer :: b, s

      least = -deepest*spacing
      shift = 0.0_wp
      do b = 1, size(boundaries)
         if (boundaries(b)%is_bilateral .or. .not. boundaries(b)%is_active) cycle
         do s = 1, size(boundaries(b)%vertices, 2) - 1
            call find_place(boundaries(b), s, outline%corner(:, c), 0.0_wp, place)
            if (.not. (place%gap < -shallow*spacing .and. place%gap > least)) cycle
            if (.not. (looks_at(edge_from(outline, c), place%normal) &
                       .or. looks_at(edge_from(outline, outline%previous(c)), place%normal))) cycle
            least = place%gap
            shift = shift_onto(place, boundaries, outline%corner(:, c), spacing)
         end do
      end do
      outline%corner(:, c) = outline%corner(:, c) + shift
   end subroutine push_out

   !> Way onto a face: along its normal, or along the boundary that holds the corner for good, as on
   !> the axis of half a scene; none where that runs along the face.
   pure function shift_onto(place, boundaries, corner, spacing) result(shift)
      type(place_type), intent(in) :: place
      type(boundary_type), intent(in) :: boundaries(:)
      real(wp), intent(in) :: corner(2), spacing
      real(wp) :: shift(2)
      type(place_type) :: held
      real(wp) :: slope
      integer :: b, s

      shift = -place%gap*place%normal
      do b = 1, size(boundaries)
         if (.not. (boundaries(b)%is_bilateral .and. boundaries(b)%is_active)) cycle
         do s = 1, size(boundaries(b)%vertices, 2) - 1
            call find_place(boundaries(b), s, corner, 0.0_wp, held)
            slope = dot_product(place%normal, held%tangent)
            if (abs(held%gap) > on_line*spacing) cycle
            shift = 0.0_wp
            if (abs(slope) < steepest) cycle
            shift = -place%gap/slope*held%tangent
            return
         end do
      end do
   end function shift_onto

   !> Move outer corners of new tiles that are a little behind faces onto them: those that lie on
   !> chords of arcs, mostly.
   pure subroutine push_corners_out(tiling, boundaries, spacing)
      !> Tiles whose corners move.
      type(tiling_type), intent(inout) :: tiling
      !> Boundaries in their present position.
      type(boundary_type), intent(in) :: boundaries(:)
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      integer :: b, s

      do b = 1, size(boundaries)
         if (boundaries(b)%is_bilateral .or. .not. boundaries(b)%is_active) cycle
         do s = 1, size(boundaries(b)%vertices, 2) - 1
            call push_off_segment(tiling, boundaries(b), s, spacing)
         end do
      end do
   end subroutine push_corners_out

   !> The same for one segment of a boundary.
   pure subroutine push_off_segment(tiling, boundary, s, spacing)
      type(tiling_type), intent(inout) :: tiling
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: s
      real(wp), intent(in) :: spacing
      type(place_type) :: place
      real(wp) :: along(2), band(2)
      integer :: e, k

      band = [shallow, 2.0_wp*sagitta]*spacing
      if (abs(boundary%bulge(s)) > 0.0_wp) band = [0.0_wp, chord_depth]*spacing
      do e = 1, size(tiling%outer_edge, 2)
         along = tiling%position(:, tiling%outer_edge(2, e)) &
            - tiling%position(:, tiling%outer_edge(1, e))
         do k = 1, 2
            associate (corner => tiling%position(:, tiling%outer_edge(k, e)))
               call find_place(boundary, s, corner, 0.0_wp, place)
               if (.not. (place%gap < -band(1) .and. place%gap > -band(2))) cycle
               if (looks_at(along, place%normal)) corner = corner - place%gap*place%normal
            end associate
         end do
      end do
   end subroutine push_off_segment

   !> Let edges of the outline that cut off a part of an arc run along it.
   pure subroutine bend_along(outline, boundary, s, spacing)
      type(outline_type), intent(inout) :: outline
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: s
      real(wp), intent(in) :: spacing
      type(face_type) :: face
      type(place_type) :: place
      real(wp) :: centre(2), foot(2), along(2), share
      integer :: c

      call new_face(face, boundary%vertices(:, s), boundary%vertices(:, s + 1), boundary%bulge(s))
      if (.not. face%radius > 0.0_wp) return
      centre = face%first + face%centre
      c = 1
      ! the last corners are those that have been put in
      do while (c <= outline%n)
         along = outline%corner(:, outline%next(c)) - outline%corner(:, c)
         share = dot_product(centre - outline%corner(:, c), along)/dot_product(along, along)
         foot = outline%corner(:, c) + share*along
         call find_place(boundary, s, foot, 0.0_wp, place)
         if (share > 0.0_wp .and. share < 1.0_wp .and. looks_at(along, place%normal) &
             .and. place%gap < -sagitta*spacing .and. place%gap > -deepest*spacing) then
            call insert_corner(outline, c, foot - place%gap*place%normal)
         else
            c = c + 1
         end if
      end do
   end subroutine bend_along

end module coulter_retile_trimming
