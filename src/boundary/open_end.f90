!> Faces of tools that end openly: the body goes on beyond the sharp corner, and no other face of
!> the tool presses on it there, as beside a footing.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_open_end
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: ends_openly, end_reach

   !> From this distance on, over the spacing, a face holds corners of bodies for good, if their
   !> edges are a cell long.
   real(wp), parameter :: end_reach = 0.4_wp
   !> Least cosine of the angle between the normals at the corner: both faces of one that is sharper
   !> than 80 degrees press on what is before it.
   real(wp), parameter :: bluntest = -0.18_wp
   !> Faces shorter than this, over the spacing, are too short to be told from their ends.
   real(wp), parameter :: shortest = 4.0_wp
   !> The tool moves against the other face by less than this share of its way against this one.
   real(wp), parameter :: most_shared = 0.5_wp
   !> A body rests on a face if corners are this near to it, over the spacing, up to this share of
   !> its length from the end, as under a footing; and goes on if another one is this far beyond the
   !> end and not farther than this before its line, over the spacing.
   real(wp), parameter :: near = 0.1_wp, covered = 0.45_wp, beyond(2) = [0.5_wp, 2.0_wp], &
      before = 1.0_wp

contains

   !> Does a face end openly at a corner?
   pure function ends_openly(tool, segment, corner, normal, inward, tiling, spacing) result(answer)
      !> The tool at the start of the step.
      type(boundary_type), intent(in) :: tool
      !> Number of the face.
      integer, intent(in) :: segment
      !> The corner, length units; unit normals of the face and of the next one; unit tangent from
      !> the corner along the face.
      real(wp), intent(in) :: corner(2), normal(2, 2), inward(2)
      !> Tiles at the start of the step.
      type(tiling_type), intent(in) :: tiling
      !> Spacing of the grid.
      real(wp), intent(in) :: spacing
      logical :: answer
      real(wp) :: way(2), length, place(2), distance, gap
      logical :: rests, goes_on
      integer :: e

      length = norm2(tool%vertices(:, segment + 1) - tool%vertices(:, segment))
      way = merge(tool%displacement, tool%load, any(abs(tool%displacement) > 0.0_wp))
      answer = .not. abs(tool%bulge(segment)) > 0.0_wp .and. length >= shortest*spacing &
         .and. dot_product(normal(:, 1), normal(:, 2)) > bluntest &
         .and. abs(dot_product(way, normal(:, 2))) < most_shared*abs(dot_product(way, normal(:, 1)))
      if (.not. answer) return
      rests = .false.
      goes_on = .false.
      do e = 1, size(tiling%outer_edge, 2)
         place = tiling%position(:, tiling%outer_edge(1, e)) - corner
         distance = dot_product(place, inward)/spacing
         gap = dot_product(place, normal(:, 1))/spacing
         rests = rests .or. (abs(gap) < near .and. distance > covered*length/spacing &
                             .and. distance < length/spacing - end_reach)
         goes_on = goes_on .or. (gap < before .and. -distance > beyond(1) &
                                 .and. -distance < beyond(2))
      end do
      answer = rests .and. goes_on
   end function ends_openly

end module coulter_boundary_open_end
