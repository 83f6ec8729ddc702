!> Tractions and pressures on the edges of bodies.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_edge_load
   use coulter_base_kinds, only: wp
   use coulter_boundary_segment, only: lies_on, new_segment, segment_type
   use coulter_points_tiling, only: nearest_outer_edge, tiling_type
   implicit none(type, external)
   private
   public :: edge_load_type, loaded_edge_type, find_loaded_edges, carry_loaded_edges

   !> A load on all edges of tiled bodies that lie on a polyline at the start.
   type :: edge_load_type
      !> Name for messages.
      character(len=:), allocatable :: name
      !> Polyline, length units, shape (2, n).
      real(wp), allocatable :: vertices(:, :)
      !> Dead load: force per undeformed area, which keeps its direction, stress units.
      real(wp) :: traction(2) = 0.0_wp
      !> Follower load: pressure on the deformed area, normal to it, positive when it pushes, stress
      !> units.
      real(wp) :: pressure = 0.0_wp
      !> Number of the table that schedules the load; 0: it grows evenly over `ramp_phase`.
      integer :: table = 0
      !> Phase over which the load grows without a table; 0: it acts in full from the start.
      integer :: ramp_phase = 1
      !> Last phase in which it acts in full; it is taken off evenly over the next.
      integer :: last_phase = huge(1)
   end type edge_load_type

   !> An outer edge that carries a load for good.
   type :: loaded_edge_type
      !> Number of the load.
      integer :: load = 0
      !> Tile that owns the edge, and the vertices of it at the ends of the edge.
      integer :: tile = 0, vertex(2) = 0
      !> Length at the start of the run.
      real(wp) :: length = 0.0_wp
   end type loaded_edge_type

   !> Edges this close to the polyline carry its load, over the spacing.
   real(wp), parameter :: touching = 1.0e-6_wp

contains

   !> Find the outer edges that lie on the polylines of loads at the start of a run. An edge may
   !> carry several loads.
   pure subroutine find_loaded_edges(edges, loads, tiling, spacing)
      !> Edges that carry loads.
      type(loaded_edge_type), allocatable, intent(out) :: edges(:)
      !> The loads.
      type(edge_load_type), intent(in) :: loads(:)
      !> Tiles in their first position.
      type(tiling_type), intent(in) :: tiling
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      type(loaded_edge_type) :: found(size(loads)*size(tiling%outer_edge, 2))
      integer :: load, e, n

      n = 0
      do load = 1, size(loads)
         do e = 1, size(tiling%outer_edge, 2)
            associate (edge => tiling%outer_edge(:, e))
               if (.not. is_loaded(loads(load), tiling%position(:, edge(:2)), &
                                   touching*spacing)) cycle
               n = n + 1
               call place_load(found(n), load, tiling, e)
            end associate
         end do
      end do
      edges = found(:n)
   end subroutine find_loaded_edges

   !> Let the outer edges of new tiles carry the loads of the old ones that lay there. The length at
   !> the start of the run is shared out anew, so that no part of a dead load is lost.
   pure subroutine carry_loaded_edges(edges, tiling, old_edges, old_tiling)
      !> New edges that carry loads.
      type(loaded_edge_type), allocatable, intent(out) :: edges(:)
      !> New tiles.
      type(tiling_type), intent(in) :: tiling
      !> Old edges that carry loads.
      type(loaded_edge_type), intent(in) :: old_edges(:)
      !> Old tiles.
      type(tiling_type), intent(in) :: old_tiling
      type(loaded_edge_type) :: found(maxval([0, old_edges%load])*size(tiling%outer_edge, 2))
      logical :: is_loaded(size(old_tiling%outer_edge, 2))
      real(wp) :: stretch(size(is_loaded)), share
      integer :: load, e, n, first, old

      n = 0
      do load = 1, maxval([0, old_edges%load])
         first = n + 1
         call mark_loaded(old_edges, load, old_tiling, is_loaded, stretch)
         if (.not. any(is_loaded)) cycle
         do e = 1, size(tiling%outer_edge, 2)
            associate (edge => tiling%outer_edge(:, e))
               call nearest_outer_edge(old_tiling, &
                                       0.5_wp*sum(tiling%position(:, edge(:2)), dim=2), old, share)
            end associate
            if (.not. is_loaded(old)) cycle
            n = n + 1
            call place_load(found(n), load, tiling, e)
            found(n)%length = stretch(old)*found(n)%length
         end do
         found(first:n)%length = found(first:n)%length &
            *sum(old_edges%length, mask=old_edges%load == load)/sum(found(first:n)%length)
      end do
      edges = found(:n)
   end subroutine carry_loaded_edges

   !> Outer edges that carry a load, and their length at the start of the run over the present one.
   pure subroutine mark_loaded(edges, load, tiling, is_loaded, stretch)
      type(loaded_edge_type), intent(in) :: edges(:)
      integer, intent(in) :: load
      type(tiling_type), intent(in) :: tiling
      logical, intent(out) :: is_loaded(:)
      real(wp), intent(out) :: stretch(:)
      integer :: k, e

      is_loaded = .false.
      stretch = 1.0_wp
      do k = 1, size(edges)
         if (edges(k)%load /= load) cycle
         associate (ends => tiling%corner(edges(k)%vertex, edges(k)%tile))
            do e = 1, size(is_loaded)
               if (any(tiling%outer_edge(:2, e) /= ends)) cycle
               is_loaded(e) = .true.
               stretch(e) = edges(k)%length &
                  /norm2(tiling%position(:, ends(2)) - tiling%position(:, ends(1)))
            end do
         end associate
      end do
   end subroutine mark_loaded

   !> Put a load on an outer edge.
   pure subroutine place_load(loaded, load, tiling, e)
      type(loaded_edge_type), intent(out) :: loaded
      integer, intent(in) :: load
      type(tiling_type), intent(in) :: tiling
      integer, intent(in) :: e

      associate (edge => tiling%outer_edge(:, e))
         loaded%load = load
         loaded%tile = edge(3)
         loaded%vertex = [findloc(tiling%corner(:, edge(3)), edge(1), dim=1), &
                          findloc(tiling%corner(:, edge(3)), edge(2), dim=1)]
         loaded%length = norm2(tiling%position(:, edge(2)) - tiling%position(:, edge(1)))
      end associate
   end subroutine place_load

   !> Does an edge lie on one of the segments of a load?
   pure function is_loaded(load, ends, tolerance) result(answer)
      type(edge_load_type), intent(in) :: load
      real(wp), intent(in) :: ends(2, 2), tolerance
      logical :: answer
      type(segment_type) :: segment
      integer :: s

      answer = .false.
      do s = 1, size(load%vertices, 2) - 1
         call new_segment(segment, load%vertices(:, s), load%vertices(:, s + 1))
         answer = answer .or. lies_on(segment, ends, tolerance)
      end do
   end function is_loaded

end module coulter_boundary_edge_load
