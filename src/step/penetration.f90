!> How deep bodies are in walls and tools, and tools in bodies.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_penetration
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid, contains_point, distance_to_segment
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, flatten, new_face, place_on, place_type
   use coulter_contact_tip, only: faces_at, first_corner, is_closed, look_at_corner
   use coulter_model, only: model_type
   use coulter_model_observer, only: step_report_type
   use coulter_points_tiling, only: depth_in_tiles, tiling_type
   implicit none(type, external)
   private
   public :: measure_penetrations

   !> Sagitta of the chords that stand for arcs, over the spacing.
   real(wp), parameter :: flatness = 1.0e-4_wp

contains

   !> Depth of the deepest point, or corner of a tile, behind every boundary, among those whose foot
   !> lies on one of its faces, of solid ones among those inside; and of the deepest corner of
   !> every tool in a tiled body.
   pure subroutine measure_penetrations(report, model, bounds)
      !> Report of a step; gets `penetrations` and `tip_penetrations`.
      type(step_report_type), intent(inout) :: report
      !> Scene at the end of the step.
      type(model_type), intent(in) :: model
      !> Does an outer edge of the tiles bound its body, and is not on the axis of half a scene?
      !> Shape (n_edges); all do if absent.
      logical, intent(in), optional :: bounds(:)
      integer :: b

      allocate (report%penetrations(size(model%boundaries)), source=0.0_wp)
      allocate (report%tip_penetrations(size(model%boundaries)), source=0.0_wp)
      do b = 1, size(report%penetrations)
         if (.not. model%boundaries(b)%is_active) cycle
         if (allocated(model%tiling)) then
            report%penetrations(b) = penetration(model%boundaries(b), model%tiling%position, &
                                                 model%grid%smallest_spacing())
            if (model%boundaries(b)%is_tool) report%tip_penetrations(b) = &
               depth_of_tips(model%boundaries(b), model%tiling, bounds)
         else
            report%penetrations(b) = penetration(model%boundaries(b), model%points%position, &
                                                 model%grid%smallest_spacing())
         end if
      end do
   end subroutine measure_penetrations

   !> Largest depth behind a boundary, 0 if nothing is there.
   pure function penetration(boundary, position, spacing) result(deepest)
      type(boundary_type), intent(in) :: boundary
      real(wp), intent(in) :: position(:, :), spacing
      real(wp) :: deepest
      integer :: s

      if (is_solid(boundary)) then
         deepest = depth_inside(boundary, position, flatness*spacing)
         return
      end if
      deepest = 0.0_wp
      do s = 1, size(boundary%vertices, 2) - 1
         deepest = max(deepest, depth_behind(boundary, s, position))
      end do
   end function penetration

   !> Does a closed chain of faces look outwards? They have the material on their left.
   pure function is_solid(boundary) result(answer)
      type(boundary_type), intent(in) :: boundary
      logical :: answer
      real(wp) :: area, centroid(2)

      answer = boundary%is_solid
      if (answer .or. .not. is_closed(boundary)) return
      call area_and_centroid(boundary%vertices, area, centroid)
      answer = area < 0.0_wp
   end function is_solid

   !> Depth of the deepest point inside a closed chain of faces, whose arcs are flattened.
   pure function depth_inside(boundary, position, sagitta) result(deepest)
      type(boundary_type), intent(in) :: boundary
      real(wp), intent(in) :: position(:, :), sagitta
      real(wp) :: deepest
      real(wp), allocatable :: polyline(:, :)
      real(wp) :: depth, lower(2), upper(2)
      integer :: p, k

      call flatten(boundary%vertices, [(boundary%bulge(k), k=1, size(boundary%vertices, 2) - 1)], &
                   sagitta, polyline)
      lower = minval(polyline, dim=2)
      upper = maxval(polyline, dim=2)
      deepest = 0.0_wp
      do p = 1, size(position, 2)
         if (any(position(:, p) < lower .or. position(:, p) > upper)) cycle
         if (.not. contains_point(polyline(:, 2:), position(:, p))) cycle
         depth = huge(depth)
         do k = 2, size(polyline, 2)
            depth = min(depth, distance_to_segment(position(:, p), polyline(:, k - 1), &
                                                   polyline(:, k)))
         end do
         deepest = max(deepest, depth)
      end do
   end function depth_inside

   !> Depth of the deepest point behind a face, 0 if none is.
   pure function depth_behind(boundary, s, position) result(deepest)
      type(boundary_type), intent(in) :: boundary
      integer, intent(in) :: s
      real(wp), intent(in) :: position(:, :)
      real(wp) :: deepest
      type(face_type) :: face
      type(place_type) :: place
      integer :: p

      call new_face(face, boundary%vertices(:, s), boundary%vertices(:, s + 1), boundary%bulge(s))
      deepest = 0.0_wp
      do p = 1, size(position, 2)
         place = place_on(face, position(:, p) - face%first, [0.0_wp, 0.0_wp])
         if (place%distance < 0.0_wp .or. place%distance > face%length) cycle
         deepest = max(deepest, -place%gap)
      end do
   end function depth_behind

   !> Distance from the outline of the deepest sharp corner of a tool inside tiles, 0 if none is.
   !> Ends of arcs do not count: edges of bodies are chords of these.
   pure function depth_of_tips(tool, tiling, bounds) result(deepest)
      type(boundary_type), intent(in) :: tool
      type(tiling_type), intent(in) :: tiling
      logical, intent(in), optional :: bounds(:)
      real(wp) :: deepest
      real(wp) :: normal(2, 2)
      integer :: v
      logical :: is_sharp

      deepest = 0.0_wp
      do v = first_corner(tool), size(tool%vertices, 2) - 1
         call look_at_corner(tool, faces_at(tool, v), is_sharp, normal)
         if (is_sharp) deepest = max(deepest, depth_in_tiles(tiling, tool%vertices(:, v), bounds))
      end do
   end function depth_of_tips

end module coulter_step_penetration
