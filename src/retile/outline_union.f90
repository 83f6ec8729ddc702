!> The union of what overlapping loops of an outline enclose.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_outline_union
   use coulter_base_kinds, only: wp
   use coulter_points_folds, only: find_folds, fold_type
   use coulter_points_outline, only: edges_of, encloses, insert_corner, outline_type, &
      trace_outline
   implicit none(type, external)
   private
   public :: bridge_gaps, unite_loops

   !> How far beside an edge it is asked whether that is buried, over its length.
   real(wp), parameter :: beside = 1.0e-4_wp
   !> Slits whose sides are this far apart, over their length, are none (60 degrees); share of a
   !> side that is filled.
   real(wp), parameter :: widest = 1.0_wp, nearly_all = 0.9_wp
   !> Places this near to an end of an edge, over its length, are that end.
   real(wp), parameter :: near_end = 0.05_wp

contains

   !> Let edges that face each other bulge towards each other until they overlap a little: the union
   !> joins them, and leaves pin-holes between one pair and the next.
   pure subroutine bridge_gaps(outline, folds, overlap)
      !> Outline; gets corners, and some move.
      type(outline_type), intent(inout) :: outline
      !> Edges that face each other, given by the corners where they start.
      type(fold_type), intent(in) :: folds(:)
      !> How far bulges go beyond the middle of a gap, length units.
      real(wp), intent(in) :: overlap
      logical :: is_used(outline%n)
      real(wp) :: way(2)
      integer :: i, k

      is_used = .false.
      do k = 1, size(folds)
         if (any(is_used(folds(k)%edge)) .or. .not. folds(k)%gap > 0.0_wp) cycle
         is_used(folds(k)%edge) = .true.
         do i = 1, 2
            way = folds(k)%place - folds(k)%ends(:, i)
            call bulge(outline, folds(k)%edge(i), folds(k)%ends(:, i), &
                       folds(k)%place + way*(overlap/norm2(way)))
         end do
      end do
   end subroutine bridge_gaps

   !> Let an edge run by way of another place.
   pure subroutine bulge(outline, edge, from, to)
      type(outline_type), intent(inout) :: outline
      integer, intent(in) :: edge
      !> Place on the edge, and where it goes, length units.
      real(wp), intent(in) :: from(2), to(2)
      real(wp) :: length

      associate (next => outline%next(edge))
         length = norm2(outline%corner(:, next) - outline%corner(:, edge))
         if (norm2(from - outline%corner(:, edge)) < near_end*length) then
            outline%corner(:, edge) = to
         else if (norm2(from - outline%corner(:, next)) < near_end*length) then
            outline%corner(:, next) = to
         else
            call insert_corner(outline, edge, to)
         end if
      end associate
   end subroutine bulge

   !> Where edges of an outline cross, leave out what lies inside the union. An outline whose parts
   !> cannot be told from each other is left as it is.
   pure subroutine unite_loops(outline, least_area, width)
      !> Outline.
      type(outline_type), intent(inout) :: outline
      !> Smallest area of a loop that is kept.
      real(wp), intent(in) :: least_area
      !> Slits at the crossings are filled where they are narrower than this, length units.
      real(wp), intent(in) :: width
      type(fold_type), allocatable :: folds(:)
      real(wp), allocatable :: position(:, :)
      integer, allocatable :: edge(:, :)
      integer :: c, k

      call find_folds(folds, outline%corner, edges_of(outline), 0.0_wp)
      if (size(folds) == 0) return
      call split_edges(outline, folds, position, edge)
      call drop_buried(outline, position, edge)
      if (.not. is_closed(edge, size(position, 2))) return
      call trace_outline(outline, position, edge, least_area)
      do c = 1, outline%n
         do k = 1, size(folds)
            if (norm2(folds(k)%place - outline%corner(:, c)) > 0.0_wp) cycle
            call fill_slit(outline, c, width)
            exit
         end do
      end do
   end subroutine unite_loops

   !> Fill the slit at a re-entrant corner up to some width.
   pure subroutine fill_slit(outline, c, width)
      type(outline_type), intent(inout) :: outline
      integer, intent(in) :: c
      real(wp), intent(in) :: width
      real(wp) :: tip(2), way(2, 2), length(2), apart, filled

      tip = outline%corner(:, c)
      way = outline%corner(:, [outline%previous(c), outline%next(c)]) - spread(tip, 2, 2)
      length = norm2(way, dim=1)
      if (.not. minval(length) > 0.0_wp) return
      way = way/spread(length, 1, 2)
      apart = norm2(way(:, 2) - way(:, 1))
      ! material on the left: the slit opens from the way ahead to the way back
      if (way(1, 2)*way(2, 1) - way(2, 2)*way(1, 1) > 0.0_wp .or. apart > widest) return
      filled = nearly_all*min(minval(length), width/max(apart, tiny(1.0_wp)))
      call insert_corner(outline, outline%previous(c), tip + filled*way(:, 1))
      outline%corner(:, c) = tip + filled*way(:, 2)
   end subroutine fill_slit

   !> Cut all edges of an outline where others cross them.
   pure subroutine split_edges(outline, folds, position, edge)
      type(outline_type), intent(in) :: outline
      type(fold_type), intent(in) :: folds(:)
      !> Corners of the outline and crossings, length units, shape (2, n); ends of the pieces, shape
      !> (2, n_pieces).
      real(wp), allocatable, intent(out) :: position(:, :)
      integer, allocatable, intent(out) :: edge(:, :)
      real(wp) :: way(size(folds))
      integer :: c, k, last, n

      position = reshape([outline%corner, (folds(k)%place, k=1, size(folds))], &
                         [2, outline%n + size(folds)])
      allocate (edge(2, outline%n + 2*size(folds)))
      n = 0
      do c = 1, outline%n
         way = huge(1.0_wp)
         do k = 1, size(folds)
            if (any(folds(k)%edge == c)) way(k) = norm2(folds(k)%place - outline%corner(:, c))
         end do
         last = c
         do while (any(way < huge(1.0_wp)))
            k = minloc(way, dim=1)
            way(k) = huge(1.0_wp)
            n = n + 1
            edge(:, n) = [last, outline%n + k]
            last = outline%n + k
         end do
         n = n + 1
         edge(:, n) = [last, outline%next(c)]
      end do
   end subroutine split_edges

   !> Keep pieces with nothing beyond them.
   pure subroutine drop_buried(outline, position, edge)
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: position(:, :)
      integer, allocatable, intent(inout) :: edge(:, :)
      logical :: is_kept(size(edge, 2))
      integer :: e

      do e = 1, size(edge, 2)
         associate (a => position(:, edge(1, e)), b => position(:, edge(2, e)))
            is_kept(e) = .not. encloses(outline, 0.5_wp*(a + b) &
                                        + beside*[b(2) - a(2), a(1) - b(1)])
         end associate
      end do
      edge = edge(:, pack([(e, e=1, size(edge, 2))], is_kept))
   end subroutine drop_buried

   !> Do as many edges leave every position as end there?
   pure function is_closed(edge, n_positions) result(answer)
      integer, intent(in) :: edge(:, :), n_positions
      logical :: answer
      integer :: balance(n_positions), e

      balance = 0
      do e = 1, size(edge, 2)
         balance(edge(1, e)) = balance(edge(1, e)) + 1
         balance(edge(2, e)) = balance(edge(2, e)) - 1
      end do
      answer = all(balance == 0)
   end function is_closed

end module coulter_retile_outline_union
