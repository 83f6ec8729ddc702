!> Cutting a polygon into quadrilaterals and triangles.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_splitting
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid, turn
   implicit none(type, external)
   private
   public :: split_polygon

   !> Areas smaller than this share of the square of a length are round-off.
   real(wp), parameter :: round_off = 1.0e-12_wp

contains

   !> Cut a simple polygon into tiles. Convex ones lose the best quadrilateral first; at a
   !> re-entrant corner triangles are cut off until the rest is convex.
   pure subroutine split_polygon(corner, tolerance, tile, n_tiles)
      !> Corners, counter-clockwise, shape (2, n).
      real(wp), intent(in) :: corner(:, :)
      !> Corners in a row that are nearer than this are one.
      real(wp), intent(in) :: tolerance
      !> Corners of the tiles; a triangle repeats its last one, shape (2, 4, >= n_tiles).
      real(wp), allocatable, intent(out) :: tile(:, :, :)
      !> Number of tiles; 0 if nothing is left.
      integer, intent(out) :: n_tiles
      real(wp), allocatable :: rest(:, :)
      integer :: n, first, n_cut

      rest = corner
      call drop_repeated(rest, tolerance, n)
      allocate (tile(2, 4, max(n, 1)))
      n_tiles = 0
      do while (n >= 3)
         call choose_cut(rest(:, :n), first, n_cut)
         n_tiles = n_tiles + 1
         rest(:, :n) = cshift(rest(:, :n), first - 1, dim=2)
         tile(:, :, n_tiles) = rest(:, [1, 2, 3, n_cut])
         ! the chord from the last corner of the tile back to its first stays as an edge
         rest(:, 2:n - n_cut + 2) = rest(:, n_cut:n)
         n = n - n_cut + 2
      end do
   end subroutine split_polygon

   !> Remove corners that repeat the one before them, and spikes: corners between two that are one.
   pure subroutine drop_repeated(corner, tolerance, n)
      real(wp), intent(inout) :: corner(:, :)
      real(wp), intent(in) :: tolerance
      integer, intent(out) :: n
      integer :: i, last

      n = 0
      do i = 1, size(corner, 2)
         n = n + 1
         corner(:, n) = corner(:, i)
         if (n > 1) then
            if (are_one(n, n - 1)) n = n - 1
         end if
         if (n > 2) then
            if (are_one(n, n - 2)) n = n - 2
         end if
      end do
      ! the same where the last corners meet the first ones
      last = n + 1
      do while (n > 1 .and. n < last)
         last = n
         if (are_one(n, 1) .or. n == 2) then
            n = n - 1
         else if (are_one(n - 1, 1)) then
            n = n - 2
         else if (are_one(n, 2)) then
            corner(:, :n - 2) = corner(:, 2:n - 1)
            n = n - 2
         end if
      end do

   contains

      pure function are_one(first, second) result(answer)
         integer, intent(in) :: first, second
         logical :: answer

         answer = norm2(corner(:, first) - corner(:, second)) <= tolerance
      end function are_one

   end subroutine drop_repeated

   !> Which corners to cut off next: `n_cut` of them from `first` on. The choice makes the smaller
   !> one of tile and rest as large as possible.
   pure subroutine choose_cut(corner, first, n_cut)
      real(wp), intent(in) :: corner(:, :)
      integer, intent(out) :: first, n_cut
      real(wp) :: score, best
      integer :: i, n

      n = size(corner, 2)
      first = 1
      n_cut = merge(4, 3, n >= 4 .and. is_convex(corner))
      if (n == n_cut) return
      best = -huge(best)
      do i = 1, n
         score = cut_score(cshift(corner, i - 1, dim=2), n_cut)
         if (score <= best) cycle
         best = score
         first = i
      end do
   end subroutine choose_cut

   !> Area of the smaller one of the first `n_cut` corners and the rest; not chosen if the cut
   !> leaves the polygon or runs through another of its corners, which would hang between tiles.
   pure function cut_score(corner, n_cut) result(score)
      real(wp), intent(in) :: corner(:, :)
      integer, intent(in) :: n_cut
      real(wp) :: score
      real(wp) :: cut, rest, centroid(2)
      integer :: i, n

      n = size(corner, 2)
      call area_and_centroid(corner(:, :n_cut), cut, centroid)
      call area_and_centroid(corner(:, [1, (i, i=n_cut, n)]), rest, centroid)
      score = min(cut, rest)
      if (n_cut > 3) return
      do i = 4, n
         if (touches(corner(:, :3), corner(:, i))) score = -huge(score)/2.0_wp
      end do
   end function cut_score

   !> Are there no re-entrant corners?
   pure function is_convex(corner) result(answer)
      real(wp), intent(in) :: corner(:, :)
      logical :: answer
      real(wp) :: size_of
      integer :: i, n

      n = size(corner, 2)
      size_of = maxval(maxval(corner, dim=2) - minval(corner, dim=2))
      answer = .true.
      do i = 1, n
         answer = answer .and. turn(corner(:, i), corner(:, modulo(i, n) + 1), &
                                    corner(:, modulo(i + 1, n) + 1)) >= -round_off*size_of**2
      end do
   end function is_convex

   !> Does a point lie in a counter-clockwise triangle or on its edges, but not at its corners?
   pure function touches(corner, position) result(answer)
      real(wp), intent(in) :: corner(2, 3), position(2)
      logical :: answer
      real(wp) :: distance(3), slack
      integer :: i

      distance = norm2(corner - spread(position, 2, 3), dim=1)
      slack = round_off*maxval(distance)**2
      answer = minval(distance)**2 > slack
      do i = 1, 3
         answer = answer .and. turn(corner(:, i), corner(:, modulo(i, 3) + 1), position) >= -slack
      end do
   end function touches

end module coulter_points_splitting
