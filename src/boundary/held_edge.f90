!> Outer edges of bodies that bilateral boundaries hold for good.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_held_edge
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_segment, only: lies_on, new_segment, segment_type
   use coulter_points_tiling, only: nearest_outer_edge, tiling_type
   implicit none(type, external)
   private
   public :: held_edge_type, find_held_edges, carry_held_edges

   !> An outer edge that a bilateral boundary keeps for good.
   type :: held_edge_type
      !> Boundary and segment, 0 if the edge is free.
      integer :: boundary = 0, segment = 0
      !> Where its two ends are held, from the first end of the segment, length units.
      real(wp) :: distance(2) = 0.0_wp
   end type held_edge_type

   !> Edges this close to a bilateral boundary at the start belong to it, over the spacing.
   real(wp), parameter :: touching = 1.0e-6_wp
   !> Ends of a new edge may be this far from the line of an old one that it replaces, over its
   !> length.
   real(wp), parameter :: askew = 0.25_wp

contains

   !> Find the outer edges that lie on bilateral boundaries at the start of a run.
   pure subroutine find_held_edges(held, boundaries, tiling, spacing)
      !> What holds every outer edge, shape (n_edges).
      type(held_edge_type), allocatable, intent(out) :: held(:)
      !> Boundaries in their first position.
      type(boundary_type), intent(in) :: boundaries(:)
      !> Tiles in their first position.
      type(tiling_type), intent(in) :: tiling
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      type(segment_type) :: segment
      integer :: b, s, e

      allocate (held(size(tiling%outer_edge, 2)))
      do b = 1, size(boundaries)
         if (.not. (boundaries(b)%is_bilateral .and. boundaries(b)%is_active)) cycle
         do s = 1, size(boundaries(b)%vertices, 2) - 1
            call new_segment(segment, boundaries(b)%vertices(:, s), &
                             boundaries(b)%vertices(:, s + 1))
            do e = 1, size(held)
               if (held(e)%boundary > 0) cycle
               call hold_edge(held(e), segment, b, s, &
                              tiling%position(:, tiling%outer_edge(:2, e)), touching*spacing)
            end do
         end do
      end do
   end subroutine find_held_edges

   !> Give an edge to a segment if it lies on it.
   pure subroutine hold_edge(held, segment, b, s, ends, tolerance)
      type(held_edge_type), intent(inout) :: held
      type(segment_type), intent(in) :: segment
      integer, intent(in) :: b, s
      real(wp), intent(in) :: ends(2, 2), tolerance

      if (.not. lies_on(segment, ends, tolerance)) return
      held = held_edge_type(b, s, matmul(segment%tangent, ends - spread(segment%first, 2, 2)))
   end subroutine hold_edge

   !> Hold the outer edges of new tiles as those of the old ones were that lay there.
   pure subroutine carry_held_edges(held, tiling, old_held, old_tiling)
      !> What holds every new outer edge, shape (n_edges).
      type(held_edge_type), allocatable, intent(out) :: held(:)
      !> New tiles.
      type(tiling_type), intent(in) :: tiling
      !> What holds every old outer edge.
      type(held_edge_type), intent(in) :: old_held(:)
      !> Old tiles.
      type(tiling_type), intent(in) :: old_tiling
      real(wp) :: ends(2, 2), share
      integer :: e, k, old

      allocate (held(size(tiling%outer_edge, 2)))
      if (.not. any(old_held%boundary > 0)) return
      do e = 1, size(held)
         ends = tiling%position(:, tiling%outer_edge(:2, e))
         call nearest_outer_edge(old_tiling, 0.5_wp*sum(ends, dim=2), old, share)
         if (old_held(old)%boundary == 0) cycle
         if (.not. runs_along(ends, old_tiling%position(:, old_tiling%outer_edge(:2, old)))) cycle
         held(e) = old_held(old)
         do k = 1, 2
            call nearest_outer_edge(old_tiling, ends(:, k), old, share, &
                                    old_held%boundary == held(e)%boundary &
                                    .and. old_held%segment == held(e)%segment)
            held(e)%distance(k) = (1.0_wp - share)*old_held(old)%distance(1) &
               + share*old_held(old)%distance(2)
         end do
      end do
   end subroutine carry_held_edges

   !> Does an edge run along the line of another one? Where a tool leaves what is held, the first
   !> edge on its face is near that, too.
   pure function runs_along(ends, line) result(answer)
      real(wp), intent(in) :: ends(2, 2), line(2, 2)
      logical :: answer
      real(wp) :: normal(2)

      normal = [line(2, 1) - line(2, 2), line(1, 2) - line(1, 1)]
      normal = normal/norm2(normal)
      answer = maxval(abs(matmul(normal, ends - spread(line(:, 1), 2, 2)))) &
         <= askew*norm2(ends(:, 2) - ends(:, 1))
   end function runs_along

end module coulter_boundary_held_edge
