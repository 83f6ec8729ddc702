!> Corners of the outline of a body where boundaries have vertices, or ahead of them, where tools
!> cut it open.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_tool_corners
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: distance_to_segment
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: place_type
   use coulter_contact_cut, only: cut_type
   use coulter_contact_tip, only: is_closed
   use coulter_points_outline, only: encloses, insert_corner, outline_type
   use coulter_retile_beside_faces, only: edge_from, find_place, is_near_face, looks_at
   implicit none(type, external)
   private
   public :: add_vertex, lead_of

   !> A vertex of a boundary for which the outline is to have a corner.
   type :: vertex_type
      !> Number of the boundary, and of its faces before and after the vertex, 0 where the chain
      !> ends.
      integer :: boundary = 0, faces(2) = 0
      !> Where the outline is to have the corner, and how far ahead of the vertex that is.
      real(wp) :: place(2) = 0.0_wp, lead(2) = 0.0_wp
      !> Is the outline cut ahead of the vertex, and is the place inside the body?
      logical :: is_cut = .false., is_inside = .false.
      !> Edges farther away are left alone.
      real(wp) :: limit = 0.0_wp
      !> Nearest edge, 0 if there is none, and where on it the foot of the place lies: 0 at its
      !> first corner, 1 at its last.
      integer :: edge = 0
      real(wp) :: share = 0.0_wp
   end type vertex_type

   !> Outlines that pass a corner of a tool by less than this keep a corner there, over the spacing:
   !> outside the body, and inside it, where bodies that gave beside the tool cut that off.
   real(wp), parameter :: passing = 0.25_wp, cut_off = 1.0_wp
   !> Corners of the outline nearer than this to one of a tool move there, over the spacing.
   real(wp), parameter :: merging = 0.2_wp
   !> Corners this near to a face lie on it, over the spacing.
   real(wp), parameter :: on_face = 0.02_wp

contains

   !> Let the outline have a corner where a boundary has a vertex: at it if that is inside the body,
   !> else where the outline passes by.
   pure subroutine add_vertex(outline, boundaries, b, v, spacing, lead)
      !> Outline of a body.
      type(outline_type), intent(inout) :: outline
      !> Boundaries in their present position.
      type(boundary_type), intent(in) :: boundaries(:)
      !> Boundary, and its vertex.
      integer, intent(in) :: b, v
      !> Grid spacing, and how far the outline is cut ahead of the vertex.
      real(wp), intent(in) :: spacing, lead(2)
      type(vertex_type) :: vertex
      integer :: c

      vertex%boundary = b
      vertex%faces = faces_beside(boundaries(b), v)
      vertex%place = boundaries(b)%vertices(:, v) + lead
      vertex%lead = lead
      vertex%is_cut = any(abs(lead) > 0.0_wp)
      vertex%is_inside = encloses(outline, vertex%place)
      if (vertex%is_cut .and. .not. vertex%is_inside) vertex%is_inside &
         = is_on_hold(boundaries, outline, vertex%place, spacing)
      vertex%limit = merge(cut_off, passing, vertex%is_inside)*spacing
      call find_edge(vertex, outline, boundaries, spacing)
      if (vertex%edge == 0) return
      call find_corner(c, vertex, outline, boundaries, spacing)
      if (vertex%is_cut .and. vertex%is_inside) then
         call keep_root(outline, c)
      else if (leaves_hold(boundaries, outline%corner(:, c), vertex%place, spacing)) then
         return
      end if
      outline%is_feature(c) = .true.
      if (vertex%is_inside) outline%corner(:, c) = vertex%place
   end subroutine add_vertex

   !> The corner of the outline that stands for a vertex: one at hand if it is near, else a new one.
   pure subroutine find_corner(c, vertex, outline, boundaries, spacing)
      integer, intent(out) :: c
      type(vertex_type), intent(in) :: vertex
      type(outline_type), intent(inout) :: outline
      type(boundary_type), intent(in) :: boundaries(:)
      real(wp), intent(in) :: spacing
      real(wp) :: foot(2), ends(2, 2)
      integer :: at_end(2), k
      logical :: is_near

      at_end = [vertex%edge, outline%next(vertex%edge)]
      ends = outline%corner(:, at_end)
      foot = (1.0_wp - vertex%share)*ends(:, 1) + vertex%share*ends(:, 2)
      c = 0
      do k = 1, 2
         is_near = norm2(foot - ends(:, k)) < merging*spacing
         if (is_near .and. vertex%is_inside) then
            ! what is held stays, and a tip in the body gets a corner beside it
            is_near = .not. leaves_hold(boundaries, ends(:, k), vertex%place, spacing)
            if (.not. is_near .and. vertex%is_cut) call keep_root(outline, at_end(k))
         end if
         if (.not. is_near) cycle
         ! thin tools have two corners as near as that
         if (c == 0 .or. vertex%share > 0.5_wp) c = at_end(k)
      end do
      if (c > 0) return
      call insert_corner(outline, vertex%edge, foot)
      c = outline%n
      if (vertex%is_inside) call add_crossings(outline, vertex, c, boundaries(vertex%boundary), &
                                               ends, merging*spacing)
   end subroutine find_corner

   !> Nearest edge of the outline that looks at a face beside a vertex, within its limit, and where
   !> on it the foot of the vertex lies.
   pure subroutine find_edge(vertex, outline, boundaries, spacing)
      type(vertex_type), intent(inout) :: vertex
      type(outline_type), intent(in) :: outline
      type(boundary_type), intent(in) :: boundaries(:)
      real(wp), intent(in) :: spacing
      real(wp) :: along(2), here, distance, nearest
      integer :: c

      nearest = vertex%limit
      do c = 1, outline%n
         along = edge_from(outline, c)
         if (.not. norm2(along) > 0.0_wp) cycle
         here = dot_product(vertex%place - outline%corner(:, c), along) &
            /dot_product(along, along)
         here = min(max(here, 0.0_wp), 1.0_wp)
         distance = norm2(vertex%place - outline%corner(:, c) - here*along)
         if (distance >= nearest) cycle
         if (.not. looks_at_vertex(along, boundaries(vertex%boundary), vertex)) cycle
         ! a cut leaves edges that are held
         if (vertex%is_cut .and. is_held(boundaries, outline, c, spacing)) cycle
         nearest = distance
         vertex%edge = c
         vertex%share = here
      end do
   end subroutine find_edge

   !> Does an edge look at a face beside a vertex?
   pure function looks_at_vertex(along, boundary, vertex) result(answer)
      real(wp), intent(in) :: along(2)
      type(boundary_type), intent(in) :: boundary
      type(vertex_type), intent(in) :: vertex
      logical :: answer
      type(place_type) :: place
      integer :: k

      answer = .false.
      do k = 1, 2
         if (vertex%faces(k) == 0) cycle
         call find_place(boundary, vertex%faces(k), vertex%place - vertex%lead, vertex%limit, place)
         answer = answer .or. looks_at(along, place%normal)
      end do
   end function looks_at_vertex

   !> Faces before and after a vertex, 0 where the chain ends.
   pure function faces_beside(boundary, v) result(faces)
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: v
      integer :: faces(2)

      associate (n => size(boundary%vertices, 2) - 1)
         faces = [v - 1, merge(v, 0, v <= n)]
         if (v == 1 .and. is_closed(boundary)) faces(1) = n
      end associate
   end function faces_beside

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
      !> Cuts ahead of corners of tools.
      type(cut_type), intent(in) :: cuts(:)
      !> Number of the boundary, and its vertex.
      integer, intent(in) :: b
      real(wp), intent(in) :: vertex(2)
      !> The way to the root of the cut, 0 where there is none.
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

   !> Does a boundary hold an edge for good?
   pure function is_held(boundaries, outline, edge, spacing) result(answer)
      type(boundary_type), intent(in) :: boundaries(:)
      type(outline_type), intent(in) :: outline
      !> Corner at which the edge starts.
      integer, intent(in) :: edge
      real(wp), intent(in) :: spacing
      logical :: answer
      integer :: b

      answer = .false.
      do b = 1, size(boundaries)
         if (.not. (boundaries(b)%is_bilateral .and. boundaries(b)%is_active)) cycle
         answer = is_near_face(boundaries(b), outline%corner(:, edge), on_face*spacing) &
            .and. is_near_face(boundaries(b), outline%corner(:, outline%next(edge)), &
                               on_face*spacing)
         if (answer) return
      end do
   end function is_held

   !> Is a place on an edge that a boundary holds for good, as on the axis of half a scene?
   pure function is_on_hold(boundaries, outline, place, spacing) result(answer)
      type(boundary_type), intent(in) :: boundaries(:)
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: place(2), spacing
      logical :: answer
      integer :: c

      answer = .false.
      do c = 1, outline%n
         if (distance_to_segment(place, outline%corner(:, c), outline%corner(:, outline%next(c))) &
             > on_face*spacing) cycle
         answer = is_held(boundaries, outline, c, spacing)
         if (answer) return
      end do
   end function is_on_hold

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

   !> Where the faces beside a vertex leave the body through the edge that has got a corner for it,
   !> the outline gets corners too: both run with the material on their left.
   pure subroutine add_crossings(outline, vertex, c, boundary, ends, tolerance)
      type(outline_type), intent(inout) :: outline
      type(vertex_type), intent(in) :: vertex
      !> The new corner on its edge.
      integer, intent(in) :: c
      type(boundary_type), intent(in) :: boundary
      !> Ends of the edge before it got that.
      real(wp), intent(in) :: ends(2, 2)
      !> Crossings this near to the ends are left out.
      real(wp), intent(in) :: tolerance
      real(wp) :: place(2)
      integer :: k, s

      do k = 2, 1, -1
         s = vertex%faces(k)
         if (s == 0) cycle
         place = crossing(ends, boundary%vertices(:, s:s + 1) + spread(vertex%lead, 2, 2))
         if (minval(norm2(ends - spread(place, 2, 2), dim=1)) > tolerance) then
            call insert_corner(outline, merge(vertex%edge, c, k == 1), place)
         end if
      end do
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

end module coulter_retile_tool_corners
