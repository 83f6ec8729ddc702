!> Edges of an outline and positions beside faces: which look at each other, how far apart they are.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_beside_faces
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type
   use coulter_points_outline, only: outline_type
   implicit none(type, external)
   private
   public :: edge_from, looks_at, is_near_face, find_place

   !> A face acts on edges that look at it: the product of both normals is below this.
   real(wp), parameter :: facing = -0.3_wp

contains

   !> Edge that starts at a corner of the outline.
   pure function edge_from(outline, c) result(along)
      !> The outline, and its corner.
      type(outline_type), intent(in) :: outline
      integer, intent(in) :: c
      !> From end to end.
      real(wp) :: along(2)

      along = outline%corner(:, outline%next(c)) - outline%corner(:, c)
   end function edge_from

   !> Does an edge with the material on its left look at a face with some normal?
   pure function looks_at(along, normal) result(answer)
      !> The edge from end to end, and the normal of the face into the body.
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
      !> The boundary, and its segment.
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: s
      !> Position and slack, length units.
      real(wp), intent(in) :: position(2), slack
      !> Its place.
      type(place_type), intent(out) :: place
      type(face_type) :: face

      call new_face(face, boundary%vertices(:, s), boundary%vertices(:, s + 1), boundary%bulge(s))
      place = place_on(face, position - face%first, [0.0_wp, 0.0_wp])
      if (place%distance < -slack .or. place%distance > face%length + slack) then
         place%gap = huge(1.0_wp)
      end if
   end subroutine find_place

end module coulter_retile_beside_faces
