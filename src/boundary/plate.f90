!> Tools that are plates: so thin that what is on both sides of them lies in the same cells of the
!> grid.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_plate
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type
   implicit none(type, external)
   private
   public :: find_plates, find_thicknesses, is_beside

   !> Faces are two sides of a plate if the product of their normals is below this: behind tips,
   !> which are less slender, what shares nodes presses openly.
   real(wp), parameter, public :: opposed = -0.95_wp
   !> They are sides of one if they are nearer than this, too, over the spacing: thicker tools do as
   !> well with nodes in common.
   real(wp), parameter :: thickest = 1.15_wp
   !> What is this near to a side of a plate shares nodes with what is on the other, over the
   !> spacing.
   real(wp), parameter, public :: beside_plate = 2.0_wp

contains

   !> Find the sides of all plates that have bodies on both.
   pure subroutine find_plates(sides, boundaries, place, spacing)
      !> The faces.
      type(face_type), allocatable, intent(out) :: sides(:)
      !> Boundaries in their present position.
      type(boundary_type), intent(in) :: boundaries(:)
      !> Where bodies are: the places of their points, length units, shape (2, n_points).
      real(wp), intent(in) :: place(:, :)
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      type(face_type), allocatable :: face(:), thin(:)
      real(wp), allocatable :: thickness(:)
      integer :: b

      allocate (sides(0))
      do b = 1, size(boundaries)
         if (.not. (boundaries(b)%is_active .and. boundaries(b)%is_solid)) cycle
         call find_thicknesses(thickness, face, boundaries(b))
         thin = pack(face, thickness < thickest*spacing)
         if (n_met(thin, place, spacing) > 1) sides = [sides, thin]
      end do
   end subroutine find_plates

   !> Find how thick a tool is behind the middle of every face.
   pure subroutine find_thicknesses(thickness, face, tool)
      !> Distance to the nearest face that looks the other way, length units, huge if there is none,
      !> shape (n_faces).
      real(wp), allocatable, intent(out) :: thickness(:)
      !> The faces.
      type(face_type), allocatable, intent(out) :: face(:)
      !> The tool.
      type(boundary_type), intent(in) :: tool
      type(place_type) :: foot
      integer :: i, k

      allocate (face(size(tool%vertices, 2) - 1))
      allocate (thickness(size(face)), source=huge(1.0_wp))
      do k = 1, size(face)
         call new_face(face(k), tool%vertices(:, k), tool%vertices(:, k + 1), tool%bulge(k))
      end do
      do k = 1, size(face)
         do i = 1, size(face)
            if (dot_product(face(i)%normal, face(k)%normal) > opposed) cycle
            foot = place_on(face(i), face(k)%first - face(i)%first &
                            + 0.5_wp*face(k)%length*face(k)%tangent, [0.0_wp, 0.0_wp])
            if (foot%gap < 0.0_wp) thickness(k) = min(thickness(k), -foot%gap)
         end do
      end do
   end subroutine find_thicknesses

   !> How many faces have places right before them?
   pure function n_met(faces, place, spacing) result(n)
      type(face_type), intent(in) :: faces(:)
      real(wp), intent(in) :: place(:, :), spacing
      integer :: n
      type(place_type) :: foot
      integer :: p, s

      n = 0
      do s = 1, size(faces)
         do p = 1, size(place, 2)
            foot = place_on(faces(s), place(:, p) - faces(s)%first, [0.0_wp, 0.0_wp])
            if (foot%gap < 0.0_wp .or. foot%gap > beside_plate*spacing .or. foot%distance < 0.0_wp &
                .or. foot%distance > faces(s)%length) cycle
            n = n + 1
            exit
         end do
      end do
   end function n_met

   !> Is a place near one of some faces?
   pure function is_beside(faces, place, distance, slack) result(answer)
      !> The faces.
      type(face_type), intent(in) :: faces(:)
      !> The place, the distance to them that is near, and how far they reach beyond their ends,
      !> length units.
      real(wp), intent(in) :: place(2), distance, slack
      logical :: answer
      type(place_type) :: foot
      integer :: s

      answer = .false.
      do s = 1, size(faces)
         foot = place_on(faces(s), place - faces(s)%first, [0.0_wp, 0.0_wp])
         answer = answer .or. (abs(foot%gap) < distance .and. foot%distance > -slack &
                               .and. foot%distance < faces(s)%length + slack)
      end do
   end function is_beside

end module coulter_boundary_plate
