!> Two straight edges that face each other: how much of one the other covers, and how far it is.
!>
!> The half of an edge that stands for one of its ends is seen along the normal of the edge. On what
!> another edge covers of it, both are linear, so that the middle speaks for all of it: forces
!> there, shared by the ends of both edges, are in balance, and uniform tractions are those of
!> either side. Theory, section 8.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_edge_pair
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: edge_pair_type, compare_edges, most_slopes

   !> Coordinates that an answer depends on: first and last end of the own edge, then of the other.
   integer, parameter :: most_slopes = 8

   !> What the other edge covers; derivatives by the eight coordinates are called slopes.
   type :: edge_pair_type
      !> Share of the own edge that the other one covers, 0 if nothing.
      real(wp) :: width = 0.0_wp, width_slope(most_slopes) = 0.0_wp
      !> Middle of that: share of the last end of the own edge, and of that of the other one.
      real(wp) :: own = 0.0_wp, own_slope(most_slopes) = 0.0_wp
      real(wp) :: other = 0.0_wp, other_slope(most_slopes) = 0.0_wp
      !> Distance between the edges there, negative where they overlap, length units.
      real(wp) :: gap = 0.0_wp, gap_slope(most_slopes) = 0.0_wp
      !> The least distance, at one of the ends of what is covered: of the other edge from a corner
      !> of the own one, or the other way round, length units.
      real(wp) :: least = 0.0_wp
      !> Unit vector along the own edge and unit normal into its material.
      real(wp) :: tangent(2) = 0.0_wp, normal(2) = 0.0_wp
      !> How both turn counter-clockwise, radians per length.
      real(wp) :: turn_slope(most_slopes) = 0.0_wp
   end type edge_pair_type

contains

   !> Compare the half of an edge beside one of its ends with another edge.
   pure subroutine compare_edges(pair, ends, half)
      !> What is found.
      type(edge_pair_type), intent(out) :: pair
      !> Ends of the own edge, material on the left, then of the other one, length units.
      real(wp), intent(in) :: ends(2, 4)
      !> 1 for the half beside the first end, 2 for that beside the last one.
      integer, intent(in) :: half
      real(wp) :: length, along(2), away(2), way(2), limit(2), stretch(most_slopes)
      real(wp), dimension(most_slopes, 2) :: along_slope, away_slope, limit_slope
      integer :: i, low, high

      length = norm2(ends(:, 2) - ends(:, 1))
      pair%tangent = (ends(:, 2) - ends(:, 1))/length
      pair%normal = [-pair%tangent(2), pair%tangent(1)]
      associate (t => pair%tangent, n => pair%normal)
         stretch = [-t, t, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]/length
         pair%turn_slope = [-n, n, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]/length
         do i = 1, 2
            way = ends(:, 2 + i) - ends(:, 1)
            along(i) = dot_product(t, way)/length
            away(i) = -dot_product(n, way)
            along_slope(:, i) = from_first(i, t/length) - pair%turn_slope*away(i)/length &
               - along(i)*stretch
            away_slope(:, i) = -from_first(i, n) + pair%turn_slope*along(i)*length
         end do
      end associate
      low = minloc(along, dim=1)
      high = 3 - low
      limit = 0.5_wp*real([half - 1, half], wp)
      limit_slope = 0.0_wp
      if (along(low) > limit(1)) then
         limit(1) = along(low)
         limit_slope(:, 1) = along_slope(:, low)
      end if
      if (along(high) < limit(2)) then
         limit(2) = along(high)
         limit_slope(:, 2) = along_slope(:, high)
      end if
      if (.not. limit(2) > limit(1)) return
      pair%width = limit(2) - limit(1)
      pair%width_slope = limit_slope(:, 2) - limit_slope(:, 1)
      pair%own = 0.5_wp*sum(limit)
      pair%own_slope = 0.5_wp*sum(limit_slope, dim=2)
      call find_foot(pair, along, along_slope)
      pair%gap = away(1) + pair%other*(away(2) - away(1))
      pair%gap_slope = away_slope(:, 1) + pair%other*(away_slope(:, 2) - away_slope(:, 1)) &
         + pair%other_slope*(away(2) - away(1))
      pair%least = minval(deep_ends(limit, along, away, length))
   end subroutine compare_edges

   !> Distances at both ends of what is covered, from the edge whose corner that is not.
   pure function deep_ends(limit, along, away, length) result(gap)
      !> Ends of what is covered and of the other edge along the own one, over its length, and
      !> distances of the latter, length units.
      real(wp), intent(in) :: limit(2), along(2), away(2)
      !> Length of the own edge.
      real(wp), intent(in) :: length
      real(wp) :: gap(2), slope

      slope = (away(2) - away(1))/(along(2) - along(1))
      gap = away(1) + (limit - along(1))*slope
      where (limit > minval(along) .and. limit < maxval(along)) &
         gap = gap/hypot(1.0_wp, slope/length)
   end function deep_ends

   !> Slopes of a product of a vector with the way from the first end of the own edge to an end of
   !> the other one.
   pure function from_first(i, vector) result(slope)
      !> Which end of the other edge, and the vector.
      integer, intent(in) :: i
      real(wp), intent(in) :: vector(2)
      real(wp) :: slope(most_slopes)

      slope = 0.0_wp
      slope(1:2) = -vector
      slope(2*i + 3:2*i + 4) = vector
   end function from_first

   !> Where on the other edge the middle is.
   pure subroutine find_foot(pair, along, along_slope)
      !> Pair with `own`; gets `other`.
      type(edge_pair_type), intent(inout) :: pair
      !> Places of the ends of the other edge along the own one, over its length, and their slopes.
      real(wp), intent(in) :: along(2), along_slope(most_slopes, 2)

      associate (span => along(2) - along(1))
         pair%other = (pair%own - along(1))/span
         pair%other_slope = (pair%own_slope - along_slope(:, 1) &
                             - pair%other*(along_slope(:, 2) - along_slope(:, 1)))/span
      end associate
   end subroutine find_foot

end module coulter_contact_edge_pair
