!> The union of what overlapping loops of an outline enclose.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_outline_union
   use coulter_base_kinds, only: wp
   use coulter_points_folds, only: find_folds, fold_type
   use coulter_points_outline, only: encloses, outline_type, trace_outline
   implicit none(type, external)
   private
   public :: unite_loops

   !> How far beside an edge it is asked whether that is buried, over its length.
   real(wp), parameter :: beside = 1.0e-4_wp

contains

   !> Where edges of an outline cross, leave out what lies inside the union. An outline whose parts
   !> cannot be told from each other is left as it is.
   pure subroutine unite_loops(outline, least_area)
      !> Outline.
      type(outline_type), intent(inout) :: outline
      !> Smallest area of a loop that is kept.
      real(wp), intent(in) :: least_area
      type(fold_type), allocatable :: folds(:)
      real(wp), allocatable :: position(:, :)
      integer, allocatable :: edge(:, :)
      integer :: c

      call find_folds(folds, outline%corner, &
                      reshape([(c, outline%next(c), c=1, outline%n)], [2, outline%n]), 0.0_wp)
      if (size(folds) == 0) return
      call split_edges(outline, folds, position, edge)
      call drop_buried(outline, position, edge)
      if (.not. is_closed(edge, size(position, 2))) return
      call trace_outline(outline, position, edge, least_area)
   end subroutine unite_loops

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

end module coulter_points_outline_union
