!> What belongs to a station: one end of an outer edge of a body against one face.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_station
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type
   use coulter_boundary_held_edge, only: held_edge_type
   use coulter_contact, only: contact_type, lag_after
   use coulter_contact_approach, only: approach_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: settle_end, weigh, are_beyond

   !> Edges that look at a face by less than this product of their normals are met the less far
   !> behind it the less they look at it: beside a thin tool they tilt towards its far face.
   real(wp), parameter :: looking = 0.3_wp

contains

   !> What belongs to one end of the edge.
   pure subroutine settle_end(contact, k, tiling, approach, held)
      !> Station that knows its face and its edge.
      type(contact_type), intent(inout) :: contact
      !> End of the edge, 1 or 2.
      integer, intent(in) :: k
      !> Tiles at the start of the step.
      type(tiling_type), intent(in) :: tiling
      !> What the boundary does in the step.
      type(approach_type), intent(in) :: approach
      !> What holds the edge.
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
      !> The boundary at the start of the step.
      type(boundary_type), intent(in) :: boundary
      !> Its segment.
      integer, intent(in) :: s
      !> The face there at the end of the step.
      type(face_type), intent(in) :: moved
      !> Ends of the edge, one column each.
      real(wp), intent(in) :: ends(2, 2)
      !> Edges farther away or deeper behind the face cannot be met, length units.
      real(wp), intent(in) :: reach, deepest
      !> Length of either end.
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
      if (.not. maxval(place%gap) < 0.0_wp) return
      if (maxval(place%gap)*0.5_wp*looking*norm2(along) < -deepest*maxval(weight)) weight = 0.0_wp
   end subroutine weigh

   !> Are ends of an edge behind a face of a plate, nearer to its other side? Edges across the ends
   !> of a plate look at both sides a little.
   pure function are_beyond(boundary, s, thickness, ends) result(answer)
      !> The tool at the start of the step, and its segment.
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: s
      !> Thickness behind the face, length units.
      real(wp), intent(in) :: thickness
      !> Ends of the edge, one column each.
      real(wp), intent(in) :: ends(2, 2)
      logical :: answer(2)
      type(face_type) :: face
      type(place_type) :: place
      integer :: k

      call new_face(face, boundary%vertices(:, s), boundary%vertices(:, s + 1), boundary%bulge(s))
      do k = 1, 2
         place = place_on(face, ends(:, k) - face%first, [0.0_wp, 0.0_wp])
         answer(k) = place%gap < -0.5_wp*thickness
      end do
   end function are_beyond

end module coulter_contact_station
