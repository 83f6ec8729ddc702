!> Turns lists of coordinates into corners, and judges them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_outline
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid, turn
   use coulter_base_text, only: to_text
   implicit none(type, external)
   private
   public :: new_polyline, new_polygon

   !> Distances and heights below this share of the lengths around them count as zero.
   real(wp), parameter :: tolerance = 1.0e-12_wp

contains

   !> Corners of a polyline.
   pure subroutine new_polyline(list, vertices, message)
      !> Coordinates x1, y1, x2, y2, ..., length units.
      real(wp), intent(in) :: list(:)
      !> Corners, shape (2, n); empty when the list is at fault.
      real(wp), allocatable, intent(out) :: vertices(:, :)
      !> What is wrong with the list; empty if nothing.
      character(len=:), allocatable, intent(out) :: message
      integer :: i, n

      message = ""
      n = size(list)/2
      if (2*n /= size(list)) then
         message = "has an odd number of coordinates; every corner takes x and y"
      else
         vertices = reshape(list, [2, n])
         do i = 1, n - 1
            if (are_same(vertices(:, i), vertices(:, i + 1))) then
              message = "corners "//to_text(i)//" and "//to_text(i + 1)//" are the same"
            end if
         end do
      end if
      if (message /= "") vertices = reshape([real(wp) ::], [2, 0])
   end subroutine new_polyline

   !> Corners of a simple polygon, counter-clockwise whatever their order in the list.
   pure subroutine new_polygon(list, vertices, message)
      !> Coordinates x1, y1, x2, y2, ..., length units.
      real(wp), intent(in) :: list(:)
      !> Corners, shape (2, n); empty when the list is at fault.
      real(wp), allocatable, intent(out) :: vertices(:, :)
      !> What is wrong with the list; empty if nothing.
      character(len=:), allocatable, intent(out) :: message
      real(wp) :: area, centroid(2)
      integer :: n

      call new_polyline(list, vertices, message)
      if (message /= "") return
      n = size(vertices, 2)
      if (are_same(vertices(:, 1), vertices(:, n))) then
         message = "the last corner repeats the first; a polygon closes by itself"
      else
         call check_simple(vertices, message)
      end if
      call area_and_centroid(vertices, area, centroid)
      if (area < 0.0_wp) vertices = vertices(:, n:1:-1)
      if (message /= "") vertices = reshape([real(wp) ::], [2, 0])
   end subroutine new_polygon

   !> Name a pair of edges that cross or touch, if there is one.
   pure subroutine check_simple(vertices, message)
      real(wp), intent(in) :: vertices(:, :)
      character(len=:), allocatable, intent(out) :: message
      integer :: i, j

      message = ""
      do i = 1, size(vertices, 2)
         do j = i + 1, size(vertices, 2)
            if (.not. are_crossing(vertices, i, j)) cycle
            message = "edges "//to_text(i)//" and "//to_text(j)//" cross or touch"
            return
         end do
      end do
   end subroutine check_simple

   !> Do the edges i < j of a polygon have more in common than the corner of neighbours?
   pure function are_crossing(vertices, i, j) result(answer)
      real(wp), intent(in) :: vertices(:, :)
      integer, intent(in) :: i, j
      logical :: answer

      associate (n => size(vertices, 2), a => vertices(:, i), c => vertices(:, j))
         associate (b => vertices(:, i + 1), d => vertices(:, modulo(j, n) + 1))
            if (j == i + 1) then
               answer = turns_back(a, b, d)
            else if (i == 1 .and. j == n) then
               answer = turns_back(c, d, b)
            else
               answer = are_touching(a, b, c, d)
            end if
         end associate
      end associate
   end function are_crossing

   !> Do the segments a-b and c-d have a point in common?
   pure function are_touching(a, b, c, d)
      real(wp), intent(in) :: a(2), b(2), c(2), d(2)
      logical :: are_touching

      are_touching = side_of(a, b, c)*side_of(a, b, d) <= 0 &
         .and. side_of(c, d, a)*side_of(c, d, b) <= 0 &
         .and. all(max(min(a, b), min(c, d)) <= min(max(a, b), max(c, d)))
   end function are_touching

   !> Does the edge b-d run back along the edge a-b?
   pure function turns_back(a, b, d)
      real(wp), intent(in) :: a(2), b(2), d(2)
      logical :: turns_back

      turns_back = side_of(a, b, d) == 0 .and. dot_product(b - a, d - b) < 0.0_wp
   end function turns_back

   !> 1 if c lies left of the line from a to b, -1 if right, 0 if on it.
   pure function side_of(a, b, c) result(side)
      real(wp), intent(in) :: a(2), b(2), c(2)
      integer :: side
      real(wp) :: twice_area

      twice_area = turn(a, b, c)
      side = 0
      if (abs(twice_area) > tolerance*norm2(b - a)*norm2(c - a)) then
         side = nint(sign(1.0_wp, twice_area))
      end if
   end function side_of

   !> Are two corners the same but for round-off?
   pure function are_same(a, b)
      real(wp), intent(in) :: a(2), b(2)
      logical :: are_same

      are_same = norm2(a - b) <= tolerance*max(norm2(a), norm2(b))
   end function are_same

end module coulter_deck_outline
