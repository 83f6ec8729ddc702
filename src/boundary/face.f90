!> Faces of boundaries: straight segments and circular arcs, and places relative to them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_face
   use coulter_base_kinds, only: wp
   use coulter_boundary_segment, only: new_segment, segment_type
   implicit none(type, external)
   private
   public :: face_type, place_type, new_face, place_on, reaches, flatten

   !> A segment, or an arc over it, with the material on its left.
   type, extends(segment_type) :: face_type
      !> Radius of an arc: positive where material is outside the circle, negative where it is
      !> inside, 0 if the face is straight. `length` is along the arc, `tangent` and `normal` are
      !> those of its chord.
      real(wp) :: radius = 0.0_wp
      !> Centre of the circle, from the first end of the face, length units.
      real(wp) :: centre(2) = 0.0_wp
   end type face_type

   !> Where a position is relative to a face.
   type :: place_type
      !> Distance from the face, negative behind it, length units.
      real(wp) :: gap = 0.0_wp
      !> Distance of the foot from the first end along the face, length units.
      real(wp) :: distance = 0.0_wp
      !> Unit normal into the material and unit tangent at the foot.
      real(wp) :: normal(2) = 0.0_wp, tangent(2) = 0.0_wp
      !> How the normal turns: dn = curvature t (t . dx), per length.
      real(wp) :: curvature = 0.0_wp
   end type place_type

   !> Arcs with less bulge than this are straight.
   real(wp), parameter :: least_bulge = 1.0e-9_wp

contains

   !> Make a face from its ends, which must differ.
   pure subroutine new_face(face, first, last, bulge)
      !> Face to make.
      type(face_type), intent(out) :: face
      !> Ends; looking from the first to the last, the material is on the left.
      real(wp), intent(in) :: first(2), last(2)
      !> Tangent of a quarter of the angle of the arc, positive when it runs counter-clockwise; 0
      !> for a straight face.
      real(wp), intent(in) :: bulge
      real(wp) :: chord

      call new_segment(face%segment_type, first, last)
      if (abs(bulge) < least_bulge) return
      chord = face%length
      face%radius = -chord*(1.0_wp + bulge**2)/(4.0_wp*bulge)
      face%centre = 0.5_wp*chord*face%tangent &
         + chord*(1.0_wp - bulge**2)/(4.0_wp*bulge)*face%normal
      face%length = abs(face%radius*4.0_wp*atan(bulge))
   end subroutine new_face

   !> Place of a corner that has moved. Both parts of its position are kept apart, so that far from
   !> the end of the face no digits of the motion are lost.
   pure function place_on(face, offset, moved) result(place)
      !> The face.
      type(face_type), intent(in) :: face
      !> Position before the motion from the first end of the face, length units.
      real(wp), intent(in) :: offset(2)
      !> Motion, length units.
      real(wp), intent(in) :: moved(2)
      type(place_type) :: place
      real(wp) :: arm(2), distance, side

      if (.not. abs(face%radius) > 0.0_wp) then
         place%normal = face%normal
         place%tangent = face%tangent
         place%gap = dot_product(face%normal, offset) + dot_product(face%normal, moved)
         place%distance = dot_product(face%tangent, offset) + dot_product(face%tangent, moved)
         return
      end if
      side = sign(1.0_wp, face%radius)
      arm = offset - face%centre + moved
      distance = max(norm2(arm), tiny(1.0_wp))
      place%normal = side*arm/distance
      place%tangent = [place%normal(2), -place%normal(1)]
      place%gap = side*distance - face%radius
      place%curvature = side/distance
      ! the angle from the middle of the arc, whose normal is that of the chord
      place%distance = 0.5_wp*face%length &
         + face%radius*atan2(dot_product(place%normal, face%tangent), &
                             dot_product(place%normal, face%normal))
   end function place_on

   !> Does a face act on the end of an edge? It does where the foot lies on it or hardly beyond;
   !> where it ends, on edges whose middle it reaches: those beyond belong to the next face, and the
   !> corner between them must not be pushed twice.
   pure function reaches(face, distance, other, slack) result(answer)
      !> The face.
      type(face_type), intent(in) :: face
      !> Places along it of the end and of the other end, length units.
      real(wp), intent(in) :: distance, other
      !> How far it acts beyond its ends, length units.
      real(wp), intent(in) :: slack
      logical :: answer
      real(wp) :: middle

      middle = 0.5_wp*(distance + other)
      answer = distance >= -slack .and. distance <= face%length + slack
      if (distance < slack) answer = answer .and. middle > 0.0_wp
      if (distance > face%length - slack) answer = answer .and. middle < face%length
   end function reaches

   !> Polyline along a chain of faces that leaves its arcs by no more than a sagitta.
   pure subroutine flatten(vertices, bulges, sagitta, polyline)
      !> Ends of the faces, length units, shape (2, n + 1).
      real(wp), intent(in) :: vertices(:, :)
      !> Bulge of every face, shape (n).
      real(wp), intent(in) :: bulges(:)
      !> Largest distance between arc and chord, length units.
      real(wp), intent(in) :: sagitta
      !> Points of the polyline, shape (2, >= n + 1).
      real(wp), allocatable, intent(out) :: polyline(:, :)
      type(face_type) :: face
      real(wp) :: first(2), angle
      integer :: s, i, n

      polyline = vertices(:, :1)
      do s = 1, size(bulges)
         call new_face(face, vertices(:, s), vertices(:, s + 1), bulges(s))
         n = 1
         if (abs(face%radius) > sagitta) then
            n = ceiling(4.0_wp*abs(atan(bulges(s))) &
                        /(2.0_wp*acos(1.0_wp - sagitta/abs(face%radius))))
         end if
         do i = 1, n - 1
            angle = 4.0_wp*atan(bulges(s))*real(i, wp)/real(n, wp)
            first = face%first + face%centre - cos(angle)*face%centre &
               + sin(angle)*[face%centre(2), -face%centre(1)]
            polyline = reshape([polyline, first], [2, size(polyline, 2) + 1])
         end do
         polyline = reshape([polyline, vertices(:, s + 1)], [2, size(polyline, 2) + 1])
      end do
   end subroutine flatten

end module coulter_boundary_face
