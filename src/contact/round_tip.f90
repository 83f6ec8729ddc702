!> Rounded corners of tools: what a sharp corner would part, a rounded one does, at the end of its
!> arc beside the face that the tool goes along.
!>
!> Where a grid does not resolve the arc, nodes that it moves drag what is below that face along,
!> as a sharp corner would if its face did not end openly. Theory, section 4.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_round_tip
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type
   use coulter_contact_open_end, only: look_at_way, parts_here, recedes
   use coulter_contact_tip, only: faces_at, first_corner, is_closed, tip_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: add_round_tips

   !> The body is at the end of the arc if a corner of it is this near, over the spacing; it goes on
   !> beyond if others are this far from there, and below it or behind the arc by an angle of this
   !> sine.
   real(wp), parameter :: near = 0.5_wp, beyond(2) = [0.5_wp, 3.0_wp], beside = 0.2_wp

contains

   !> Add the places where rounded corners of a tool part what flows: ends of arcs, whose face ends
   !> openly there.
   pure subroutine add_round_tips(tips, tool, tiling, spacing)
      !> Corners of the tool so far.
      type(tip_type), allocatable, intent(inout) :: tips(:)
      !> Tool at the start of the step.
      type(boundary_type), intent(in) :: tool
      !> Tiles at the start of the step.
      type(tiling_type), intent(in) :: tiling
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      type(tip_type) :: tip
      integer :: v, k

      ! nothing parts where all is elastic
      if (.not. (tool%is_tool .and. allocated(tool%bulges) .and. allocated(tiling%pull))) return
      do v = first_corner(tool), size(tool%vertices, 2) - 1
         do k = 1, 2
            tip = tip_type(vertex=v, faces=faces_at(tool, v), is_round=.true.)
            call look_at_arc(tip, tool, k, spacing)
            if (.not. tip%is_open(k)) cycle
            if (goes_on(tip, tool, k, tiling, spacing)) tips = [tips, tip]
         end do
      end do
   end subroutine add_round_tips

   !> Does an arc end openly where a straight face carries on, as the sharp corner would that it
   !> rounds off? Both faces at that corner are taken for those at the tip.
   pure subroutine look_at_arc(tip, tool, k, spacing)
      type(tip_type), intent(inout) :: tip
      type(boundary_type), intent(in) :: tool
      !> Which of the faces of the tip is the arc: the one before the vertex or the one after it.
      integer, intent(in) :: k
      real(wp), intent(in) :: spacing
      type(face_type) :: arc, face
      type(place_type) :: far
      real(wp) :: way, slide(2)
      logical :: cuts

      associate (s => tip%faces(k), other => tip%faces(3 - k))
         call new_face(arc, tool%vertices(:, s), tool%vertices(:, s + 1), tool%bulge(s))
         if (.not. arc%radius > 0.0_wp .or. abs(tool%bulge(other)) > 0.0_wp) return
         call new_face(face, tool%vertices(:, other), tool%vertices(:, other + 1), 0.0_wp)
      end associate
      ! faces run with the material on their left, and the tip looks along them from the vertex
      way = real(2*k - 3, wp)
      far = place_on(arc, merge([0.0_wp, 0.0_wp], tool%vertices(:, tip%faces(k) + 1) - arc%first, &
                                k == 1), [0.0_wp, 0.0_wp])
      tip%normal(:, k) = far%normal
      tip%normal(:, 3 - k) = face%normal
      tip%inward(:, k) = way*far%tangent
      tip%inward(:, 3 - k) = -way*face%tangent
      ! one that cuts in with both faces parts in the middle of the arc
      call look_at_way(tool, tip%normal, tip%inward, cuts, slide)
      tip%is_open(k) = .not. (cuts .or. recedes(tool, tip%normal(:, k))) &
         .and. parts_here(tool, tip%normal(:, [k, 3 - k]), tip%inward(:, [k, 3 - k]))
      if (rise(tip, tool, k) < spacing) tip%beyond(k) = face_beyond(tool, tip%faces(k), 2*k - 3)
   end subroutine look_at_arc

   !> The face before another one, or after it, 0 where the chain ends.
   pure function face_beyond(tool, segment, way) result(next)
      type(boundary_type), intent(in) :: tool
      !> Number of the other one, and -1 or 1.
      integer, intent(in) :: segment, way
      integer :: next
      integer :: n

      n = size(tool%vertices, 2) - 1
      next = modulo(segment + way - 1, n) + 1
      if (next /= segment + way .and. .not. is_closed(tool)) next = 0
   end function face_beyond

   !> How far an arc rises above the line of the straight face beside it, length units.
   pure function rise(tip, tool, k)
      type(tip_type), intent(in) :: tip
      type(boundary_type), intent(in) :: tool
      integer, intent(in) :: k
      real(wp) :: rise

      associate (ends => tool%vertices(:, tip%faces(k):tip%faces(k) + 1))
         rise = abs(dot_product(tip%normal(:, 3 - k), ends(:, 2) - ends(:, 1)))
      end associate
   end function rise

   !> Is the body there, and does it go on beyond the end of the arc?
   pure function goes_on(tip, tool, k, tiling, spacing) result(answer)
      type(tip_type), intent(in) :: tip
      type(boundary_type), intent(in) :: tool
      integer, intent(in) :: k
      type(tiling_type), intent(in) :: tiling
      real(wp), intent(in) :: spacing
      logical :: answer
      real(wp) :: place(2), distance, height
      logical :: is_there, is_beyond
      integer :: e

      is_there = .false.
      is_beyond = .false.
      do e = 1, size(tiling%outer_edge, 2)
         place = (tiling%position(:, tiling%outer_edge(1, e)) - tool%vertices(:, tip%vertex)) &
            /spacing
         distance = norm2(place)
         height = -dot_product(place, tip%normal(:, 3 - k))
         is_there = is_there .or. distance < near
         is_beyond = is_beyond .or. (distance > beyond(1) .and. distance < beyond(2) &
                                     .and. min(height, dot_product(place, tip%normal(:, k))) &
                                     < -beside*distance)
      end do
      answer = is_there .and. is_beyond
   end function goes_on

end module coulter_contact_round_tip
