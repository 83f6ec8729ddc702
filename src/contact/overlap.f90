!> How much of a body's edge a face of a tool covers beside its open ends, and how it holds the
!> corners of the body there.
!>
!> The pressure under the corner of a punch is singular. A corner of a body that is held there drags
!> along the tile beside the tool, as if the tool were half a tile wider. Near an open end the face
!> therefore presses with the traction of the material alone. Theory, section 4.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_overlap
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_contact_open_end, only: end_reach
   use coulter_contact_tip, only: side_of, tip_type
   implicit none(type, external)
   private
   public :: overlap_type, find_overlap, belongs_to_next, depth_beside

   !> What a face covers of an edge.
   type :: overlap_type
      !> Is there an open end of the face near the edge? Else nothing below is meant.
      logical :: is_partial = .false.
      !> Shares of the length of the edge that both ends stand for: 1/2 each if all is covered.
      real(wp) :: share(2) = 0.5_wp
      !> How far both ends may get behind the face before it holds them, length units.
      real(wp) :: give(2) = 0.0_wp
      !> Does the face recede, so that they may stay that far before it?
      logical :: recedes = .false.
      !> Do they press as the other end of the edge does, near a corner that cuts in?
      logical :: leans(2) = .false.
      !> What it adds until then at most to the pressure of the material, over that.
      real(wp) :: hold(2) = huge(1.0_wp)
   end type overlap_type

   !> Largest `hold`, at the distance from the end from which on bodies are held.
   real(wp), parameter :: most_held = 0.35_wp
   !> What is farther before a face that recedes, over the spacing, is left behind.
   real(wp), parameter :: left_behind = 0.1_wp
   !> Tips count as not more slender than this sine.
   real(wp), parameter :: slenderest = 0.2_wp
   !> Distances from the end below this, over the spacing, count as this.
   real(wp), parameter :: nearest = 1.0e-2_wp

contains

   !> What a face covers of an edge: where the edge is beside the face, and nearer to it than to the
   !> next one.
   pure subroutine find_overlap(overlap, tool, tips, segment, ends, spacing)
      !> What it covers.
      type(overlap_type), intent(out) :: overlap
      !> The tool.
      type(boundary_type), intent(in) :: tool
      !> Its sharp corners.
      type(tip_type), intent(in) :: tips(:)
      !> Number of the face.
      integer, intent(in) :: segment
      !> Ends of the edge, and spacing of the grid, length units.
      real(wp), intent(in) :: ends(2, 2), spacing
      real(wp) :: from, to, place(2, 2), distance(2), nearer(2), reach
      integer :: i, k

      from = 0.0_wp
      to = 1.0_wp
      do i = 1, size(tips)
         k = side_of(tips(i), segment)
         if (k == 0) cycle
         if (.not. tips(i)%is_open(k)) cycle
         place = ends - spread(tool%vertices(:, tips(i)%vertex), 2, 2)
         distance = matmul(tips(i)%inward(:, k), place)
         nearer = matmul(tips(i)%normal(:, k) - tips(i)%normal(:, 3 - k), place)
         if (tips(i)%cuts) then
            ! what was let through is where it met the face
            distance = distance - tips(i)%slide(k)*min(0.0_wp, matmul(tips(i)%normal(:, k), place))
            call lean(overlap, distance/(end_reach*spacing))
            distance = matmul(tips(i)%inward(:, k), place)
         else
            reach = held_from(tips(i), place, spacing)
            ! an arc leaves the line of the next face slowly: what counts is how far above that
            if (tips(i)%is_round) distance = -matmul(tips(i)%normal(:, 3 - k), place)
            ! what the tip has left behind on the next face is not held, wherever its foot is
            call ease(overlap, merge(distance/reach, 0.0_wp, nearer >= 0.0_wp), reach)
            overlap%recedes = overlap%recedes .or. tips(i)%recedes(k)
            if (overlap%recedes) overlap%give = min(overlap%give, left_behind*spacing)
         end if
         call clip(from, to, distance)
         call clip(from, to, nearer)
      end do
      overlap%is_partial = any(overlap%give > 0.0_wp .or. overlap%leans) &
         .or. from > 0.0_wp .or. to < 1.0_wp
      overlap%share = max(0.0_wp, to - from)*[1.0_wp - 0.5_wp*(from + to), 0.5_wp*(from + to)]
   end subroutine find_overlap

   !> Distance from an open end from which on a face holds the ends of an edge. Where two corners of
   !> a cell are held, so are its nodes, and with them the next corner. Corners on arcs are between
   !> nodes, and move both.
   pure function held_from(tip, place, spacing) result(reach)
      type(tip_type), intent(in) :: tip
      !> Ends of the edge from the tip, and spacing of the grid, length units.
      real(wp), intent(in) :: place(2, 2), spacing
      real(wp) :: reach

      reach = spacing
      if (tip%is_round) return
      associate (cell => spacing/sine_of(tip))
         reach = (1.0_wp + end_reach)*cell - min(cell, norm2(place(:, 2) - place(:, 1)))
      end associate
   end function held_from

   !> Sine of the angle between the faces of a tip, 1 if it is not acute. Behind a slender one, up
   !> to the spacing over it along a face, cells hold both sides of the gap that the tool fills.
   pure function sine_of(tip) result(sine)
      type(tip_type), intent(in) :: tip
      real(wp) :: sine
      real(wp) :: cosine

      cosine = min(1.0_wp, max(0.0_wp, dot_product(tip%inward(:, 1), tip%inward(:, 2))))
      sine = max(slenderest, sqrt(1.0_wp - cosine**2))
   end function sine_of

   !> Let corners give near an open end: little at the distance from which on they are held, and as
   !> far as they go at the end itself.
   pure subroutine ease(overlap, distance, reach)
      type(overlap_type), intent(inout) :: overlap
      !> Distances from the end, over that from which on corners are held, and that, length units.
      real(wp), intent(in) :: distance(2), reach

      where (distance < 1.0_wp)
         overlap%give = max(overlap%give, reach*(1.0_wp/max(distance, nearest) - 1.0_wp))
         overlap%hold = min(overlap%hold, most_held*max(0.0_wp, distance)**2)
      end where
   end subroutine ease

   !> Let the end that is nearer to a corner of the tool that cuts in press as the other one does:
   !> what is there parts.
   pure subroutine lean(overlap, distance)
      type(overlap_type), intent(inout) :: overlap
      !> Distances from the corner, over that from which on corners are held.
      real(wp), intent(in) :: distance(2)
      integer :: k

      k = minloc(distance, dim=1)
      if (distance(k) >= 1.0_wp) return
      overlap%leans(k) = .true.
      overlap%hold(k) = most_held*max(0.0_wp, distance(k))**2
   end subroutine lean

   !> Is a position that is deep behind a face nearer to the face beyond one of its sharp corners,
   !> or before that?
   pure function belongs_to_next(tool, tips, segment, position, slack) result(answer)
      !> The tool.
      type(boundary_type), intent(in) :: tool
      !> Its sharp corners.
      type(tip_type), intent(in) :: tips(:)
      !> Number of the face.
      integer, intent(in) :: segment
      !> The position, and by how much it must be nearer, length units.
      real(wp), intent(in) :: position(2), slack
      logical :: answer
      real(wp) :: gap(2)
      integer :: i, k

      answer = .false.
      do i = 1, size(tips)
         k = side_of(tips(i), segment)
         if (k == 0) cycle
         gap = matmul(position - tool%vertices(:, tips(i)%vertex), tips(i)%normal(:, [k, 3 - k]))
         answer = answer .or. gap(1) < min(gap(2), 0.0_wp) - slack
      end do
   end function belongs_to_next

   !> How far a position is behind a face whose neighbour ends openly: bodies that gave there come
   !> round the corner of the tool, and must not be pushed out at once. Zero up to a slack.
   pure function depth_beside(tool, tips, segment, position, slack) result(depth)
      !> The tool.
      type(boundary_type), intent(in) :: tool
      !> Its sharp corners.
      type(tip_type), intent(in) :: tips(:)
      !> Number of the face.
      integer, intent(in) :: segment
      !> The position, and the slack, length units.
      real(wp), intent(in) :: position(2), slack
      real(wp) :: depth
      integer :: i, k

      depth = 0.0_wp
      do i = 1, size(tips)
         k = side_of(tips(i), segment)
         if (k == 0) cycle
         if (tips(i)%is_open(k) .or. .not. tips(i)%is_open(3 - k)) cycle
         depth = max(depth, -slack - dot_product(tips(i)%normal(:, k), position &
                                                 - tool%vertices(:, tips(i)%vertex)))
      end do
   end function depth_beside

   !> Keep that part of an interval where a function that is linear over 0 to 1 is not negative.
   pure subroutine clip(from, to, value)
      !> Ends of the interval; it is empty if the first is not below the last.
      real(wp), intent(inout) :: from, to
      !> The function at 0 and 1.
      real(wp), intent(in) :: value(2)

      if (all(value < 0.0_wp)) then
         to = from
      else if (value(1) < 0.0_wp) then
         from = max(from, value(1)/(value(1) - value(2)))
      else if (value(2) < 0.0_wp) then
         to = min(to, value(1)/(value(1) - value(2)))
      end if
   end subroutine clip

end module coulter_contact_overlap
