!> The outline of a body without what reaches behind walls and tools.
!>
!> New tiles fill the outline: what is left behind a face in it stays there for good, and a corner
!> of a tool that its chords cut off sits inside the body (theory, section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_trimming
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type
   use coulter_points_outline, only: encloses, insert_corner, outline_type
   use coulter_points_tiling, only: tiling_type
   use coulter_contact_cut, only: cut_type
   implicit none(type, external)
   private
   public :: trim_outline, push_corners_out, is_near_face

   !> Corners deeper behind a face than this belong to something else, over the spacing.
   real(wp), parameter :: deepest = 0.5_wp
   !> Corners less deep than this stay there: the gap is what contacts press with, and without it
   !> tools would lose a tenth of their force until the next step; over the spacing.
   real(wp), parameter :: shallow = 0.01_wp
   !> A face acts on edges that look at it: the product of both normals is below this.
   real(wp), parameter :: facing = -0.3_wp
   !> Outlines that pass a corner of a tool by less than this keep a corner there, over the spacing:
   !> outside the body, and inside it, where bodies that gave beside the tool cut that off.
   real(wp), parameter :: passing = 0.25_wp, cut_off = 1.0_wp
   !> Corners of the outline nearer than this to one of a tool move there, over the spacing.
   real(wp), parameter :: merging = 0.2_wp
   !> Corners this near to a face lie on it, over the spacing.
   real(wp), parameter :: on_face = 0.02_wp
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
         do v = 1, size(boundaries(b)%vertices, 2)
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

   !> Let the outline have a corner where a boundary has a vertex: at it if that is inside the body,
   !> else where the outline passes by.
   pure subroutine add_vertex(outline, boundaries, b, v, spacing, lead)
      type(outline_type), intent(inout) :: outline
      type(boundary_type), intent(in) :: boundaries(:)
      !> Boundary, and its vertex.
      integer, intent(in) :: b, v
      real(wp), intent(in) :: spacing, lead(2)
      real(wp) :: share, foot(2), limit, ends(2, 2)
      real(wp) :: vertex(2), vertices(2, size(boundaries(b)%vertices, 2))
      integer :: edge, c, k
      logical :: is_inside, is_near(2), is_cut

      is_cut = any(abs(lead) > 0.0_wp)
      vertices = boundaries(b)%vertices + spread(lead, 2, size(vertices, 2))
      vertex = vertices(:, v)
      is_inside = encloses(outline, vertex)
      limit = merge(cut_off, passing, is_inside)*spacing
      call nearest_edge(outline, boundaries, b, v, vertex, limit, spacing, edge, share)
      if (edge == 0) return
      ends = outline%corner(:, [edge, outline%next(edge)])
      foot = (1.0_wp - share)*ends(:, 1) + share*ends(:, 2)
      is_near = norm2(spread(foot, 2, 2) - ends, dim=1) < merging*spacing
      do k = 1, 2
         if (.not. (is_near(k) .and. is_inside)) cycle
         ! what is held stays, and a tip in the body gets a corner beside it
         is_near(k) = .not. leaves_hold(boundaries, ends(:, k), vertex, spacing)
         if (.not. is_near(k) .and. is_cut) call keep_root(outline, &
                                                           merge(edge, outline%next(edge), k == 1))
      end do
      if (is_near(1)) then
         c = edge
      else if (is_near(2)) then
         c = outline%next(edge)
      else
         call insert_corner(outline, edge, foot)
         c = outline%n
         if (is_inside) call add_crossings(outline, edge, c, ends, vertices, v, &
                                           merging*spacing)
      end if
      if (is_cut .and. is_inside) then
         call keep_root(outline, c)
      else if (leaves_hold(boundaries, outline%corner(:, c), vertex, spacing)) then
         return
      end if
      outline%is_feature(c) = .true.
      if (is_inside) outline%corner(:, c) = vertex
   end subroutine add_vertex

   !> Keep a corner of the outline beside others, too.
   pure subroutine keep_root(outline, c)
      type(outline_type), intent(inout) :: outline
      integer, intent(in) :: c

      outline%is_feature(c) = .true.
      if (.not. allocated(outline%roots)) allocate (outline%roots(0))
      outline%roots = [outline%roots, c]
   end subroutine keep_root

   !> How far the outline is cut ahead of a vertex.
   pure function lead_of(cuts, b, vertex) result(lead)
      type(cut_type), intent(in) :: cuts(:)
      !> Number of the boundary, and its vertex: the first one is also the last where it is closed.
      integer, intent(in) :: b
      real(wp), intent(in) :: vertex(2)
      real(wp) :: lead(2)
      integer :: i

      lead = 0.0_wp
      do i = 1, size(cuts)
         if (cuts(i)%boundary /= b) cycle
         if (norm2(cuts(i)%tip - vertex) <= epsilon(1.0_wp)*norm2(vertex)) then
            lead = cuts(i)%place - cuts(i)%tip
         end if
      end do
   end function lead_of

   !> Would a corner that a boundary holds for good leave it for the vertex of another one? It would
   !> be pulled back.
   pure function leaves_hold(boundaries, corner, vertex, spacing) result(answer)
      type(boundary_type), intent(in) :: boundaries(:)
      real(wp), intent(in) :: corner(2), vertex(2), spacing
      logical :: answer
      integer :: other

      answer = .true.
      do other = 1, size(boundaries)
         if (.not. (boundaries(other)%is_bilateral .and. boundaries(other)%is_active)) cycle
         if (is_near_face(boundaries(other), corner, on_face*spacing) &
             .and. .not. is_near_face(boundaries(other), vertex, on_face*spacing)) return
      end do
      answer = .false.
   end function leaves_hold

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

   !> Where the faces beside a vertex leave the body through the edge that has got a corner for it,
   !> the outline gets corners too: both run with the material on their left.
   pure subroutine add_crossings(outline, edge, c, ends, vertices, v, tolerance)
      type(outline_type), intent(inout) :: outline
      !> Corner at which the edge started, and the new one on it.
      integer, intent(in) :: edge, c
      !> Ends of the edge, and the polyline with its vertex.
      real(wp), intent(in) :: ends(2, 2), vertices(:, :)
      integer, intent(in) :: v
      !> Crossings this near to the ends are left out.
      real(wp), intent(in) :: tolerance
      real(wp) :: place(2)

      if (v < size(vertices, 2)) then
         place = crossing(ends, vertices(:, v:v + 1))
         if (minval(norm2(ends - spread(place, 2, 2), dim=1)) > tolerance) then
            call insert_corner(outline, c, place)
         end if
      end if
      if (v > 1) then
         place = crossing(ends, vertices(:, v - 1:v))
         if (minval(norm2(ends - spread(place, 2, 2), dim=1)) > tolerance) then
            call insert_corner(outline, edge, place)
         end if
      end if
   end subroutine add_crossings

   !> Place where two segments cross; the first end of the first if they do not.
   pure function crossing(first, second) result(place)
      real(wp), intent(in) :: first(2, 2), second(2, 2)
      real(wp) :: place(2)
      real(wp) :: along(2), normal(2), offset(2), share(2)

      place = first(:, 1)
      along = first(:, 2) - first(:, 1)
      normal = [second(2, 1) - second(2, 2), second(1, 2) - second(1, 1)]
      if (.not. abs(dot_product(normal, along)) > 0.0_wp) return
      offset = first(:, 1) - second(:, 1)
      share(1) = -dot_product(normal, offset)/dot_product(normal, along)
      share(2) = dot_product(offset + share(1)*along, second(:, 2) - second(:, 1)) &
         /dot_product(normal, normal)
      if (all(share > 0.0_wp .and. share < 1.0_wp)) place = first(:, 1) + share(1)*along
   end function crossing

   !> Nearest edge of the outline that looks at a face beside a vertex, within a limit, and where on
   !> it the foot of the vertex lies: 0 at its first corner, 1 at its last.
   pure subroutine nearest_edge(outline, boundaries, b, v, vertex, limit, spacing, edge, share)
      type(outline_type), intent(in) :: outline
      type(boundary_type), intent(in) :: boundaries(:)
      integer, intent(in) :: b, v
      !> Where the vertex counts to be.
      real(wp), intent(in) :: vertex(2), limit, spacing
      integer, intent(out) :: edge
      real(wp), intent(out) :: share
      type(place_type) :: place
      real(wp) :: along(2), here, distance, nearest
      integer :: c, s
      logical :: looks, is_cut

      is_cut = norm2(vertex - boundaries(b)%vertices(:, v)) > 0.0_wp
      edge = 0
      share = 0.0_wp
      nearest = limit
      do c = 1, outline%n
         along = outline%corner(:, outline%next(c)) - outline%corner(:, c)
         if (.not. norm2(along) > 0.0_wp) cycle
         here = dot_product(vertex - outline%corner(:, c), along) &
            /dot_product(along, along)
         here = min(max(here, 0.0_wp), 1.0_wp)
         distance = norm2(vertex - outline%corner(:, c) - here*along)
         if (distance >= nearest) cycle
         looks = .false.
         associate (boundary => boundaries(b))
            do s = max(v - 1, 1), min(v, size(boundary%vertices, 2) - 1)
               call find_place(boundary, s, boundary%vertices(:, v), limit, place)
               looks = looks .or. looks_at(along, place%normal)
            end do
         end associate
         if (.not. looks) cycle
         ! a cut leaves edges that are held
         if (is_cut .and. leaves_hold(boundaries, outline%corner(:, c), vertex, spacing) .and. &
             leaves_hold(boundaries, outline%corner(:, outline%next(c)), vertex, spacing)) cycle
         nearest = distance
         edge = c
         share = here
      end do
   end subroutine nearest_edge

   !> Edge that starts at a corner of the outline.
   pure function edge_from(outline, c) result(along)
      type(outline_type), intent(in) :: outline
      integer, intent(in) :: c
      real(wp) :: along(2)

      along = outline%corner(:, outline%next(c)) - outline%corner(:, c)
   end function edge_from

   !> Does an edge with the material on its left look at a face with some normal?
   pure function looks_at(along, normal) result(answer)
      real(wp), intent(in) :: along(2), normal(2)
      logical :: answer

      answer = along(2)*normal(1) - along(1)*normal(2) < facing*norm2(along)
   end function looks_at

   !> Is a position within a distance of a face of a boundary?
   pure function is_near_face(boundary, position, distance) result(answer)
      !> The boundary.
      type(boundary_type), intent(in) :: boundary
      !> Position, length units.
      real(wp), intent(in) :: position(2)
      !> Distance, length units.
      real(wp), intent(in) :: distance
      logical :: answer
      type(place_type) :: place
      integer :: s

      answer = .false.
      do s = 1, size(boundary%vertices, 2) - 1
         call find_place(boundary, s, position, distance, place)
         answer = answer .or. abs(place%gap) <= distance
      end do
   end function is_near_face

   !> Place of a position relative to a face; the gap is huge when its foot lies beyond the ends by
   !> more than some slack.
   pure subroutine find_place(boundary, s, position, slack, place)
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: s
      real(wp), intent(in) :: position(2), slack
      type(place_type), intent(out) :: place
      type(face_type) :: face

      call new_face(face, boundary%vertices(:, s), boundary%vertices(:, s + 1), boundary%bulge(s))
      place = place_on(face, position - face%first, [0.0_wp, 0.0_wp])
      if (place%distance < -slack .or. place%distance > face%length + slack) then
         place%gap = huge(1.0_wp)
      end if
   end subroutine find_place

end module coulter_retile_trimming
