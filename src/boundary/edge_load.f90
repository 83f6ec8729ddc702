!> Tractions and pressures on the edges of bodies.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_edge_load
   use coulter_base_kinds, only: wp
   use coulter_boundary_segment, only: lies_on, new_segment, segment_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: edge_load_type, loaded_edge_type, find_loaded_edges

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
      !> Number of the table that schedules the load; 0: proportional to time.
      integer :: table = 0
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
               found(n)%load = load
               found(n)%tile = edge(3)
               found(n)%vertex = [findloc(tiling%corner(:, edge(3)), edge(1), dim=1), &
                                  findloc(tiling%corner(:, edge(3)), edge(2), dim=1)]
               found(n)%length = norm2(tiling%position(:, edge(2)) - tiling%position(:, edge(1)))
            end associate
         end do
      end do
      edges = found(:n)
   end subroutine find_loaded_edges

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
