!> Faces of tools that end openly: soil that flows parts at their sharp corner, as beside a footing,
!> at the toe of a blade, and at the tip of a wedge.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_open_end
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: ends_openly, parts_here, recedes, look_at_way, end_reach

   !> From this distance on, over the spacing, a face holds corners of bodies for good, if their
   !> edges are a cell long.
   real(wp), parameter :: end_reach = 0.4_wp
   !> Faces shorter than this, over the spacing, are too short to be told from their ends.
   real(wp), parameter :: shortest = 1.0_wp
   !> Soil goes round corners between faces whose normals have a larger product, without parting.
   real(wp), parameter :: bluntest = 0.7_wp
   !> The tool advances against the face by more than this share of its way, against the next one by
   !> less than the second share of that, or it cuts in with both; and what is ahead comes along
   !> neither face towards the corner by more than the third share of the way.
   real(wp), parameter :: least_advance = 0.1_wp, most_shared = 0.45_wp, most_along = 0.1_wp
   !> A corner cuts in if the tool advances against either face by this share of what it does
   !> against the other one or more, and its faces are longer than this, over the spacing.
   real(wp), parameter :: least_cut = 0.8_wp, shortest_cut = 4.0_wp
   !> A body rests on a face if corners are this near to it, over the spacing, at this distance from
   !> the end, over the spacing, or, under short faces, this share of their length.
   real(wp), parameter :: near = 0.1_wp, covered = 2.0_wp, covered_share = 0.45_wp
   !> It goes on beyond the end if others are this far from there, over the spacing, and beside what
   !> is before the face, or behind its line, by an angle of this sine.
   real(wp), parameter :: beyond(2) = [0.5_wp, 3.0_wp], beside = 0.2_wp

contains

   !> Does a face end openly at a corner?
   pure function ends_openly(tool, segment, vertex, normal, inward, tiling, spacing) result(answer)
      !> The tool at the start of the step.
      type(boundary_type), intent(in) :: tool
      !> Number of the face, and of the vertex that is the corner.
      integer, intent(in) :: segment, vertex
      !> Unit normals of the face and of the next one, and unit tangents from the corner along them,
      !> shape (component, face).
      real(wp), intent(in) :: normal(2, 2), inward(2, 2)
      !> Tiles at the start of the step.
      type(tiling_type), intent(in) :: tiling
      !> Spacing of the grid.
      real(wp), intent(in) :: spacing
      logical :: answer
      real(wp) :: length, place(2), along, gap
      logical :: rests, goes_on, is_held
      integer :: e, n_held

      length = norm2(tool%vertices(:, segment + 1) - tool%vertices(:, segment))/spacing
      ! nothing parts where all is elastic
      answer = allocated(tiling%pull) .and. .not. abs(tool%bulge(segment)) > 0.0_wp &
         .and. length >= shortest .and. dot_product(normal(:, 1), normal(:, 2)) < bluntest &
         .and. parts_here(tool, normal, inward)
      if (.not. answer) return
      rests = .false.
      goes_on = .false.
      n_held = 0
      do e = 1, size(tiling%outer_edge, 2)
         place = (tiling%position(:, tiling%outer_edge(1, e)) - tool%vertices(:, vertex))/spacing
         along = dot_product(place, inward(:, 1))
         gap = dot_product(place, normal(:, 1))
         is_held = abs(gap) < near .and. along < length - end_reach
         rests = rests .or. (is_held .and. along > min(covered, covered_share*length))
         if (is_held .and. along > end_reach) n_held = n_held + 1
         goes_on = goes_on .or. (norm2(place) > beyond(1) .and. norm2(place) < beyond(2) &
                                 .and. min(along, gap) < -beside*norm2(place))
      end do
      answer = rests .and. goes_on
      if (cuts_in(tool, normal)) answer = answer .and. n_held > 1 .and. length >= shortest_cut
   end function ends_openly

   !> Does the tool go against a face, hardly or as much against the next one, and part what is
   !> before it? What comes after a face that recedes, but not along the next one, parts the same.
   pure function parts_here(tool, normal, inward) result(answer)
      !> The tool at the start of the step.
      type(boundary_type), intent(in) :: tool
      !> Unit normals of the face and of the next one, and unit tangents from the corner along them,
      !> shape (component, face).
      real(wp), intent(in) :: normal(2, 2), inward(2, 2)
      logical :: answer
      real(wp) :: way(2), advance(2)

      way = way_of(tool)
      if (recedes(tool, normal(:, 1))) way = -way
      advance = matmul(way, normal)
      answer = advance(1) > least_advance*norm2(way) &
         .and. (advance(2) < most_shared*advance(1) .or. cuts_in(tool, normal)) &
         .and. maxval(matmul(way, inward)) < most_along*norm2(way)
   end function parts_here

   !> Does the tool go away from a face?
   pure function recedes(tool, normal) result(answer)
      !> The tool.
      type(boundary_type), intent(in) :: tool
      !> Unit normal of the face.
      real(wp), intent(in) :: normal(2)
      logical :: answer

      answer = dot_product(way_of(tool), normal) < 0.0_wp
   end function recedes

   !> Does the tool cut in with a corner, so that both of its faces press what they part? What
   !> sticks to rough faces goes along with them at the corner, too, unless it slides along them.
   pure function cuts_in(tool, normal) result(answer)
      type(boundary_type), intent(in) :: tool
      real(wp), intent(in) :: normal(2, 2)
      logical :: answer
      real(wp) :: advance(2)

      advance = matmul(way_of(tool), normal)
      answer = (tool%slides .or. .not. tool%is_rough) .and. minval(advance) > 0.0_wp &
         .and. minval(advance) >= least_cut*maxval(advance)
   end function cuts_in

   !> How a corner of a tool goes on its way.
   pure subroutine look_at_way(tool, normal, inward, cuts, slide)
      !> The tool.
      type(boundary_type), intent(in) :: tool
      !> Unit normals of both faces, and unit tangents from the corner along them, shape (component,
      !> face).
      real(wp), intent(in) :: normal(2, 2), inward(2, 2)
      !> Does it cut in, so that both faces press what they part?
      logical, intent(out) :: cuts
      !> Way along these faces, away from the corner, over that against them, if it cuts in.
      real(wp), intent(out) :: slide(2)
      real(wp) :: way(2)

      slide = 0.0_wp
      cuts = cuts_in(tool, normal)
      if (.not. cuts) return
      way = way_of(tool)
      slide = matmul(way, inward)/matmul(way, normal)
   end subroutine look_at_way

   !> Way, or load, of a tool.
   pure function way_of(tool) result(way)
      type(boundary_type), intent(in) :: tool
      real(wp) :: way(2)

      way = tool%heading
      if (.not. any(abs(way) > 0.0_wp)) way = tool%displacement
      if (.not. any(abs(way) > 0.0_wp)) way = tool%load
   end function way_of

end module coulter_contact_open_end
