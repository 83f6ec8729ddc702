!> Stations: the places on boundaries where the material is held in the current step.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_stations
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type, kind_fixed
   use coulter_boundary_ibm, only: station_law_type
   use coulter_boundary_segment, only: cut_segment, new_segment, segment_type
   use coulter_grid, only: grid_type
   use coulter_grid_cells, only: cells_type
   use coulter_grid_shape, only: shape_gradients_2d, shape_values_2d
   implicit none(type, external)
   private
   public :: station_type, stations_type, reach_type, build_stations, recall_tractions

   !> One station. There are few of them, so that an array of values serves as well as a structure
   !> of arrays.
   type :: station_type
      !> Number of its boundary and of the segment in it.
      integer :: boundary = 0, segment = 0
      !> Active cell that it lies in, and the cell with points whose material it holds.
      integer :: cell = 0, material_cell = 0
      !> Distance from the first end of the segment, length units.
      real(wp) :: distance = 0.0_wp
      !> Length of boundary that it stands for.
      real(wp) :: weight = 0.0_wp
      !> Constants of its law.
      type(station_law_type) :: law
      !> Shape functions of the nodes of its cell.
      real(wp) :: shape(4) = 0.0_wp
      !> Their gradients, per length.
      real(wp) :: gradient(2, 4) = 0.0_wp
      !> Traction (normal, tangential) remembered from earlier steps.
      real(wp) :: memory(2) = 0.0_wp
      !> Traction (normal, tangential) of the current iteration.
      real(wp) :: traction(2) = 0.0_wp
   end type station_type

   !> All stations of a step.
   type :: stations_type
      !> Number of stations.
      integer :: n = 0
      !> The stations, in the order of the boundaries; only the first `n` are meaningful.
      type(station_type), allocatable :: item(:)
      !> Length of every boundary that acts on material, length units, shape (n_boundaries).
      real(wp), allocatable :: loaded_length(:)
      !> Length of every boundary that material reaches but that cannot act, since its cell is
      !> empty or left out, length units, shape (n_boundaries).
      real(wp), allocatable :: lost_length(:)
   end type stations_type

   !> Which cells a boundary may act in.
   type :: reach_type
      !> Does a cell hold enough material to be kept, shape (n_with_points)?
      logical, allocatable :: is_filled(:)
      !> May a boundary act in a kept cell only (the paper leaves the others out)?
      logical :: is_filled_only = .false.
      !> May a boundary act in a cell without points that lies beside a filled one? This needs node
      !> aggregation, since nothing else holds the far nodes of such a cell.
      logical :: has_empty_cells = .false.
   end type reach_type

   !> Gauss points and weights on 0..1 for 1, 2 and 3 points.
   real(wp), parameter :: far_2 = 0.5_wp/sqrt(3.0_wp), far_3 = 0.5_wp*sqrt(0.6_wp)
   real(wp), parameter :: gauss_point(3, 3) = reshape([ &
      0.5_wp, 0.0_wp, 0.0_wp, &
      0.5_wp - far_2, 0.5_wp + far_2, 0.0_wp, &
      0.5_wp - far_3, 0.5_wp, 0.5_wp + far_3], [3, 3])
   real(wp), parameter :: gauss_weight(3, 3) = reshape([ &
      1.0_wp, 0.0_wp, 0.0_wp, &
      0.5_wp, 0.5_wp, 0.0_wp, &
      5.0_wp/18.0_wp, 8.0_wp/18.0_wp, 5.0_wp/18.0_wp], [3, 3])
   !> How far into the material the middle of a piece is moved to find its cell, over the spacing:
   !> this decides for boundaries that lie on grid lines.
   real(wp), parameter :: nudge = 1.0e-7_wp
   !> Distances along the normal, over the spacing, at which material beside an empty cell is
   !> looked for.
   real(wp), parameter :: feelers(4) = [0.25_wp, 0.5_wp, 0.75_wp, 1.0_wp]

contains

   !> Place stations on all boundaries: the pieces of each segment inside cells that hold material,
   !> with Gauss points on each piece. Empty cells that a boundary acts in become active.
   subroutine build_stations(stations, boundaries, grid, cells, reach)
      !> Stations to make; moduli and memories are left to the caller.
      type(stations_type), intent(out) :: stations
      !> Boundaries at their position at the start of the step.
      type(boundary_type), intent(in) :: boundaries(:)
      !> Background grid.
      type(grid_type), intent(in) :: grid
      !> Active cells.
      type(cells_type), intent(inout) :: cells
      !> Which cells may carry a boundary.
      type(reach_type), intent(in) :: reach
      integer :: b, s

      allocate (stations%item(64))
      allocate (stations%loaded_length(size(boundaries)), source=0.0_wp)
      allocate (stations%lost_length(size(boundaries)), source=0.0_wp)
      do b = 1, size(boundaries)
         if (.not. boundaries(b)%is_active) cycle
         do s = 1, size(boundaries(b)%vertices, 2) - 1
            call place_on_segment(stations, boundaries(b), b, s, grid, cells, reach)
         end do
      end do
   end subroutine build_stations

   !> Stations of one segment.
   subroutine place_on_segment(stations, boundary, b, s, grid, cells, reach)
      type(stations_type), intent(inout) :: stations
      type(boundary_type), intent(in) :: boundary
      !> Numbers of the boundary and of the segment.
      integer, intent(in) :: b, s
      type(grid_type), intent(in) :: grid
      type(cells_type), intent(inout) :: cells
      type(reach_type), intent(in) :: reach
      real(wp), allocatable :: from(:), to(:)
      type(segment_type) :: segment
      type(station_type) :: station
      integer :: k
      logical :: is_reached

      call new_segment(segment, boundary%vertices(:, s), boundary%vertices(:, s + 1))
      station%boundary = b
      station%segment = s
      station%law%normal = segment%normal
      station%law%n_held = merge(2, 1, boundary%kind == kind_fixed)
      station%law%has_coupling = boundary%has_coupling_term
      station%law%band = boundary%band_ratio*grid%smallest_spacing()
      call cut_segment(segment, grid, from, to)
      do k = 1, size(from)
         call find_cells(segment%position_at(0.5_wp*(from(k) + to(k))), segment%normal, grid, &
                         cells, reach, station, is_reached)
         if (station%cell > 0) then
            stations%loaded_length(b) = stations%loaded_length(b) + to(k) - from(k)
            call place_on_piece(stations, station, segment, [from(k), to(k)], boundary%n_gauss, &
                                grid, cells)
         else if (is_reached) then
            stations%lost_length(b) = stations%lost_length(b) + to(k) - from(k)
         end if
      end do
   end subroutine place_on_segment

   !> The cell in which a piece of boundary acts, and the cell whose material it holds.
   pure subroutine find_cells(middle, normal, grid, cells, reach, station, is_reached)
      real(wp), intent(in) :: middle(2), normal(2)
      type(grid_type), intent(in) :: grid
      type(cells_type), intent(inout) :: cells
      type(reach_type), intent(in) :: reach
      type(station_type), intent(inout) :: station
      logical, intent(out) :: is_reached
      real(wp) :: position(2)
      integer :: own, beside

      station%cell = 0
      is_reached = .false.
      position = middle + nudge*grid%smallest_spacing()*normal
      if (.not. grid%contains_position(position)) return
      own = cells%number_at(grid%cell_of(position))
      if (own > 0 .and. own <= cells%n_with_points) then
         is_reached = .true.
         station%material_cell = own
         if (reach%is_filled(own) .or. .not. reach%is_filled_only) station%cell = own
         return
      end if
      beside = filled_cell_beside(middle, normal, grid, cells, reach)
      is_reached = beside > 0
      if (.not. (is_reached .and. reach%has_empty_cells)) return
      if (own == 0) call cells%append_cell(grid%cell_of(position), own)
      station%cell = own
      station%material_cell = beside
   end subroutine find_cells

   !> First filled cell within one spacing along the normal, or 0.
   pure function filled_cell_beside(middle, normal, grid, cells, reach) result(number)
      real(wp), intent(in) :: middle(2), normal(2)
      type(grid_type), intent(in) :: grid
      type(cells_type), intent(in) :: cells
      type(reach_type), intent(in) :: reach
      integer :: number
      real(wp) :: position(2)
      integer :: k

      do k = 1, size(feelers)
         position = middle + feelers(k)*grid%smallest_spacing()*normal
         number = 0
         if (.not. grid%contains_position(position)) return
         number = cells%number_at(grid%cell_of(position))
         if (number > cells%n_with_points) number = 0
         if (number > 0) then
            if (reach%is_filled(number)) return
            number = 0
         end if
      end do
   end function filled_cell_beside

   !> Gauss points on a piece.
   pure subroutine place_on_piece(stations, station, segment, ends, n_gauss, grid, cells)
      type(stations_type), intent(inout) :: stations
      type(station_type), intent(inout) :: station
      type(segment_type), intent(in) :: segment
      !> Distances of its ends from the first one of the segment, length units.
      real(wp), intent(in) :: ends(2)
      integer, intent(in) :: n_gauss
      type(grid_type), intent(in) :: grid
      type(cells_type), intent(in) :: cells
      real(wp) :: local(2)
      integer :: k

      do k = 1, n_gauss
         station%distance = ends(1) + gauss_point(k, n_gauss)*(ends(2) - ends(1))
         station%weight = gauss_weight(k, n_gauss)*(ends(2) - ends(1))
         local = cells%local_position(grid, station%cell, segment%position_at(station%distance))
         station%shape = shape_values_2d(local)
         station%gradient = shape_gradients_2d(local, grid%spacing)
         call append(stations, station)
      end do
   end subroutine place_on_piece

   !> Add a station at the end of the list.
   pure subroutine append(stations, station)
      type(stations_type), intent(inout) :: stations
      type(station_type), intent(in) :: station
      type(station_type), allocatable :: grown(:)

      if (stations%n == size(stations%item)) then
         allocate (grown(2*stations%n))
         grown(:stations%n) = stations%item
         call move_alloc(grown, stations%item)
      end if
      stations%n = stations%n + 1
      stations%item(stations%n) = station
   end subroutine append

   !> Give stations of boundaries with memory the tractions that the last step left on the same
   !> segment: interpolated along it, so that memory moves with the tool.
   pure subroutine recall_tractions(stations, previous, boundaries, spacing)
      !> Stations to equip.
      type(stations_type), intent(inout) :: stations
      !> Stations of the last accepted step.
      type(stations_type), intent(in) :: previous
      !> Boundaries.
      type(boundary_type), intent(in) :: boundaries(:)
      !> Grid spacing: tractions reach no further than this.
      real(wp), intent(in) :: spacing
      integer :: k

      do k = 1, stations%n
         if (.not. boundaries(stations%item(k)%boundary)%has_memory) cycle
         stations%item(k)%memory = traction_at(previous, stations%item(k), spacing)
      end do
   end subroutine recall_tractions

   !> Traction of earlier stations at the place of a station; zero where there was none.
   pure function traction_at(previous, station, spacing) result(traction)
      type(stations_type), intent(in) :: previous
      type(station_type), intent(in) :: station
      real(wp), intent(in) :: spacing
      real(wp) :: traction(2)
      real(wp) :: offset, below, above
      integer :: k, lower, upper

      lower = 0
      upper = 0
      below = -spacing
      above = spacing
      do k = 1, previous%n
         if (previous%item(k)%boundary /= station%boundary) cycle
         if (previous%item(k)%segment /= station%segment) cycle
         offset = previous%item(k)%distance - station%distance
         if (offset <= 0.0_wp .and. offset > below) then
            lower = k
            below = offset
         else if (offset > 0.0_wp .and. offset < above) then
            upper = k
            above = offset
         end if
      end do
      traction = 0.0_wp
      if (lower > 0 .and. upper > 0) then
         traction = (above*previous%item(lower)%traction - below*previous%item(upper)%traction) &
            /(above - below)
      else if (max(lower, upper) > 0) then
         traction = previous%item(max(lower, upper))%traction
      end if
   end function traction_at

end module coulter_boundary_stations
