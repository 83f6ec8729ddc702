!> Sharp corners of tools, which press on the edges of bodies where no corner of a body meets them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_tip
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: turn, winding_number
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type
   use coulter_contact_open_end, only: ends_openly, look_at_way, recedes
   use coulter_points_tiling, only: distance_to_outline, nearest_outer_edge, tiling_type
   implicit none(type, external)
   private
   public :: tip_type, edge_place_type, find_tips, side_of, covered_share, place_on_edge, &
      is_closed, look_at_corner, first_corner, faces_at

   !> A sharp corner and the edge of a body that it may press on.
   type :: tip_type
      !> Vertex of the tool, and its faces before and after it.
      integer :: vertex = 0, faces(2) = 0
      !> Is it the end of an arc that rounds the corner off? Then faces beyond a short arc, 0 if
      !> there are none; normals and tangents below are those of the corner without the arc.
      logical :: is_round = .false.
      integer :: beyond(2) = 0
      !> Unit normals of these faces at the corner, and unit tangents that lead from it along them,
      !> shape (component, face).
      real(wp) :: normal(2, 2) = 0.0_wp, inward(2, 2) = 0.0_wp
      !> Do these faces end openly here?
      logical :: is_open(2) = .false.
      !> Do they recede?
      logical :: recedes(2) = .false.
      !> Does it cut in, so that edges near it press as their other ends do?
      logical :: cuts = .false.
      !> Way of the tool along these faces, away from the corner, over that against them.
      real(wp) :: slide(2) = 0.0_wp
      !> Outer edge that is nearest, and where on it the tip is: 0 at its first end, 1 at its last.
      integer :: edge = 0
      real(wp) :: share = 0.0_wp
      !> Corner of the body up to which that is cut ahead of the tip, 0 if it is not: the tip gets
      !> there in the step.
      integer :: root = 0
   end type tip_type

   !> Where a tip is relative to an edge that moves.
   type, extends(place_type) :: edge_place_type
      !> Length of the edge, and place of the foot along it, beyond 0 to 1 if it lies beside it.
      real(wp) :: length = 0.0_wp, share = 0.0_wp
      !> Derivatives of the share by both ends of the edge, per length, shape (component, end).
      real(wp) :: share_slope(2, 2) = 0.0_wp
   end type edge_place_type

   !> Sine of the angle between two faces from which on a convex corner is sharp.
   real(wp), parameter :: sharp = 0.1_wp
   !> Edges whose outward normal has this or a smaller component along the corner's may meet it; at
   !> a slender one, those that have this share of the component of its own faces.
   real(wp), parameter :: facing = -0.3_wp, slender = 0.9_wp
   !> A corner this little behind an edge is on it, over the spacing.
   real(wp), parameter :: touching = 1.0e-3_wp
   !> Edges farther away than this, over the spacing and beyond the way of the tool, do not meet it
   !> in a step.
   real(wp), parameter :: reach = 2.0_wp

contains

   !> Sharp corners of a tool that may press on an edge in this step.
   pure subroutine find_tips(tips, tool, tiling, spacing)
      !> Corners, each with its edge.
      type(tip_type), allocatable, intent(out) :: tips(:)
      !> Tool at the start of the step.
      type(boundary_type), intent(in) :: tool
      !> Tiles at the start of the step.
      type(tiling_type), intent(in) :: tiling
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      type(tip_type) :: tip
      real(wp) :: ends(2, 2), foot(2)
      integer :: v, k
      logical :: is_sharp

      allocate (tips(0))
      if (.not. tool%is_tool) return
      do v = first_corner(tool), size(tool%vertices, 2) - 1
         tip%vertex = v
         tip%faces = faces_at(tool, v)
         call look_at_corner(tool, tip%faces, is_sharp, tip%normal)
         if (.not. is_sharp) cycle
         call nearest_outer_edge(tiling, tool%vertices(:, v), tip%edge, tip%share, &
                                 may_meet(tiling, tool%vertices(:, v), sum(tip%normal, dim=2), &
                                          touching*spacing))
         if (tip%edge == 0) cycle
         ends = tiling%position(:, tiling%outer_edge(:2, tip%edge))
         tip%share = min(max(tip%share, 0.0_wp), 1.0_wp)
         foot = ends(:, 1) + tip%share*(ends(:, 2) - ends(:, 1))
         if (norm2(foot - tool%vertices(:, v)) > reach*spacing) cycle
         ! the face before the corner runs towards it
         tip%inward = reshape([-tip%normal(2, 1), tip%normal(1, 1), &
                               tip%normal(2, 2), -tip%normal(1, 2)], [2, 2])
         do k = 1, 2
            tip%is_open(k) = ends_openly(tool, tip%faces(k), v, tip%normal(:, [k, 3 - k]), &
                                         tip%inward(:, [k, 3 - k]), tiling, spacing)
            tip%recedes(k) = recedes(tool, tip%normal(:, k))
         end do
         call look_at_way(tool, tip%normal, tip%inward, tip%cuts, tip%slide)
         tips = [tips, tip]
      end do
   end subroutine find_tips

   !> On which side of a tip a face is, 1 before and 2 after it; 0 if it is none of its faces.
   pure function side_of(tip, segment) result(k)
      !> The tip.
      type(tip_type), intent(in) :: tip
      !> Number of the face.
      integer, intent(in) :: segment
      integer :: k

      k = findloc(tip%faces, segment, dim=1)
      if (k == 0) k = findloc(tip%beyond, segment, dim=1)
   end function side_of

   !> Share of an edge that a face of a tool covers: less than 1 where it ends above the edge.
   pure function covered_share(tips, tool, segment, edge, ends) result(covered)
      !> Sharp corners of the tool.
      type(tip_type), intent(in) :: tips(:)
      !> The tool.
      type(boundary_type), intent(in) :: tool
      !> Number of the face.
      integer, intent(in) :: segment
      !> Number of the edge.
      integer, intent(in) :: edge
      !> Ends of the edge, length units.
      real(wp), intent(in) :: ends(2, 2)
      real(wp) :: covered
      real(wp) :: along(2), from, to
      integer :: i

      covered = 1.0_wp
      do i = 1, size(tips)
         if (tips(i)%edge /= edge .or. .not. any(tips(i)%faces == segment)) cycle
         along = ends(:, 2) - ends(:, 1)
         along = along/dot_product(along, along)
         from = dot_product(tool%vertices(:, segment) - ends(:, 1), along)
         to = dot_product(tool%vertices(:, segment + 1) - ends(:, 1), along)
         covered = max(0.0_wp, min(1.0_wp, max(from, to)) - max(0.0_wp, min(from, to)))
         return
      end do
   end function covered_share

   !> Place of a tip relative to an edge: gap along the edge's normal into the body, positive while
   !> the tip is outside; the tangent runs along the edge.
   pure function place_on_edge(ends) result(place)
      !> Ends of the edge, tile on its left, from the tip, length units.
      real(wp), intent(in) :: ends(2, 2)
      type(edge_place_type) :: place
      real(wp) :: along(2)

      along = ends(:, 2) - ends(:, 1)
      place%length = norm2(along)
      place%tangent = along/place%length
      place%normal = [-place%tangent(2), place%tangent(1)]
      place%gap = dot_product(place%normal, ends(:, 1))
      place%share = -dot_product(place%tangent, ends(:, 1))/place%length
      place%distance = place%share*place%length
      associate (t => place%tangent, n => place%normal, l => place%length)
         place%share_slope(:, 2) = -(place%gap/l*n + place%share*t)/l
         place%share_slope(:, 1) = -t/l - place%share_slope(:, 2)
      end associate
   end function place_on_edge

   !> First vertex that has a face before and after it; the last one is that of the last face.
   pure function first_corner(tool) result(vertex)
      !> The tool.
      type(boundary_type), intent(in) :: tool
      integer :: vertex

      vertex = merge(1, 2, is_closed(tool))
   end function first_corner

   !> Faces before and after a vertex.
   pure function faces_at(tool, vertex) result(faces)
      !> The tool.
      type(boundary_type), intent(in) :: tool
      !> Number of the vertex.
      integer, intent(in) :: vertex
      integer :: faces(2)

      faces = [merge(vertex - 1, size(tool%vertices, 2) - 1, vertex > 1), vertex]
   end function faces_at

   !> Does the chain of faces close?
   pure function is_closed(tool)
      !> The tool.
      type(boundary_type), intent(in) :: tool
      logical :: is_closed

      associate (v => tool%vertices)
         is_closed = norm2(v(:, 1) - v(:, size(v, 2))) <= epsilon(1.0_wp)*norm2(v(:, 1))
      end associate
   end function is_closed

   !> Is the corner between two faces sharp and convex, and which way do they look?
   pure subroutine look_at_corner(tool, faces, is_sharp, normal)
      !> The tool.
      type(boundary_type), intent(in) :: tool
      !> Its faces before and after the corner.
      integer, intent(in) :: faces(2)
      !> Is it sharp and convex?
      logical, intent(out) :: is_sharp
      !> Unit normals of both faces there, shape (component, face).
      real(wp), intent(out) :: normal(2, 2)
      type(face_type) :: face
      type(place_type) :: place(2)
      integer :: k

      do k = 1, 2
         associate (s => faces(k))
            call new_face(face, tool%vertices(:, s), tool%vertices(:, s + 1), tool%bulge(s))
            place(k) = place_on(face, tool%vertices(:, faces(2)) - face%first, [0.0_wp, 0.0_wp])
         end associate
      end do
      associate (before => place(1)%tangent, after => place(2)%tangent)
         is_sharp = before(1)*after(2) - before(2)*after(1) < -sharp
      end associate
      normal(:, 1) = place(1)%normal
      normal(:, 2) = place(2)%normal
   end subroutine look_at_corner

   !> Which outer edges look at a corner? One that is outside the bodies meets only edges that it is
   !> in front of: it is below a lip of a body where it is behind one, and not in it.
   pure function may_meet(tiling, corner, normal, slack) result(answer)
      type(tiling_type), intent(in) :: tiling
      !> The corner, the sum of the normals of its faces, and how far behind an edge it may be.
      real(wp), intent(in) :: corner(2), normal(2), slack
      logical :: answer(size(tiling%outer_edge, 2))
      real(wp) :: along(2), least, depth
      logical :: is_inside
      integer :: e

      least = max(facing, -0.5_wp*slender*norm2(normal))*norm2(normal)
      associate (first => tiling%position(:, tiling%outer_edge(1, :)), &
                 last => tiling%position(:, tiling%outer_edge(2, :)))
         depth = slack
         is_inside = winding_number(first, last, corner) > 0
         ! on an outer edge, such as that on the axis of half a scene
         if (.not. is_inside) is_inside = distance_to_outline(tiling, corner) < slack
         if (is_inside) depth = huge(depth)
         do e = 1, size(answer)
            along = (last(:, e) - first(:, e))/norm2(last(:, e) - first(:, e))
            answer(e) = along(2)*normal(1) - along(1)*normal(2) < least &
               .and. turn(first(:, e), first(:, e) + along, corner) < depth
         end do
      end associate
   end function may_meet

end module coulter_contact_tip
