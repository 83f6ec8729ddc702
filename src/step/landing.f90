!> Lets free tools land: what they will rest on acts from the first iteration on, else nothing would
!> hold them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_landing
   use coulter_base_kinds, only: wp
   use coulter_boundary_contact, only: contact_type
   use coulter_boundary_face, only: place_type
   use coulter_boundary_motion, only: moved_by, turn_matrix
   use coulter_step_border, only: mode_at
   use coulter_step_contact_state, only: locate, motion_of
   use coulter_step_system, only: system_type
   implicit none(type, external)
   private
   public :: land_free_tools

   !> Loads and gaps change by less than this share of a motion only by round-off.
   real(wp), parameter :: negligible = 1.0e-9_wp
   !> Stations whose gap closes by less than this share of the way of the tool do not hold it.
   real(wp), parameter :: glancing = 1.0e-3_wp

   !> A free tool on its way to the stations that will hold it.
   type :: flight_type
      !> Its free components, shape (n).
      integer, allocatable :: component(:)
      !> Motions that its stations resist, orthonormal, shape (n, n_resisted).
      real(wp), allocatable :: resisted(:, :)
      !> Its stations, how their gaps change with the components, and the gaps, shapes (n_stations),
      !> (n, n_stations) and (n_stations), length units.
      integer, allocatable :: station(:)
      real(wp), allocatable :: slope(:, :), gap(:)
   end type flight_type

contains

   !> Let stations of free tools act, as if they had before: those that the tools meet first as their
   !> loads pull them, until these can move them no farther.
   pure subroutine land_free_tools(system, has_changed)
      !> System whose contacts have been evaluated.
      type(system_type), intent(inout) :: system
      !> Has any tool landed?
      logical, intent(out) :: has_changed
      type(flight_type) :: flight
      integer :: j, k

      has_changed = .false.
      do j = 1, system%border%n
         if (any(system%border%boundary(:j - 1) == system%border%boundary(j))) cycle
         call begin_flight(flight, system, system%border%boundary(j))
         do
            call fly_on(flight, system%border%load(flight%component), k)
            if (k == 0) exit
            system%contacts%item(k)%was_acting = .true.
            has_changed = .true.
         end do
      end do
   end subroutine land_free_tools

   !> Components and stations of a tool; those that act resist from the start.
   pure subroutine begin_flight(flight, system, boundary)
      type(flight_type), intent(out) :: flight
      type(system_type), intent(in) :: system
      integer, intent(in) :: boundary
      real(wp) :: normal(2), tangent(2), position(2)
      integer :: i, j, k

      flight%component = pack([(j, j=1, system%border%n)], system%border%boundary == boundary)
      flight%station = pack([(k, k=1, system%contacts%n)], &
                            system%contacts%item(:system%contacts%n)%boundary == boundary)
      allocate (flight%resisted(size(flight%component), 0), flight%gap(size(flight%station)))
      allocate (flight%slope(size(flight%component), size(flight%station)))
      do i = 1, size(flight%station)
         associate (contact => system%contacts%item(flight%station(i)))
            call look_at(system, contact, flight%gap(i), normal, tangent, position)
            flight%slope(:, i) = slopes(normal)
            if (.not. contact%is_acting) cycle
            call resist(flight, slopes(normal))
            if (contact%rubs .and. contact%slip == 0) call resist(flight, slopes(tangent))
         end associate
      end do

   contains

      !> How the way along a direction changes with the components.
      pure function slopes(direction)
         real(wp), intent(in) :: direction(2)
         real(wp) :: slopes(size(flight%component))
         integer :: c

         slopes = [(-dot_product(direction, mode_at(system%border, flight%component(c), position)), &
                    c=1, size(slopes))]
      end function slopes

   end subroutine begin_flight

   !> Gap of a station, its normal and tangent, and where it is.
   pure subroutine look_at(system, contact, gap, normal, tangent, position)
      type(system_type), intent(in) :: system
      type(contact_type), intent(in) :: contact
      real(wp), intent(out) :: gap, normal(2), tangent(2), position(2)
      type(place_type) :: place

      call locate(contact, motion_of(system, contact), place, position)
      associate (free => system%border%motion(contact%boundary))
         position = moved_by(free, position)
         normal = matmul(turn_matrix(free%rotation), place%normal)
         tangent = matmul(turn_matrix(free%rotation), place%tangent)
      end associate
      gap = place%gap
   end subroutine look_at

   !> Follow the load to the next station; 0 if nothing more is met or nothing can move.
   pure subroutine fly_on(flight, load, station)
      type(flight_type), intent(inout) :: flight
      real(wp), intent(in) :: load(:)
      integer, intent(out) :: station
      real(wp) :: way(size(load)), closing(size(flight%station)), time(size(flight%station))
      integer :: i

      station = 0
      way = load - matmul(flight%resisted, matmul(load, flight%resisted))
      if (size(time) == 0 .or. .not. norm2(way) > negligible*norm2(load)) return
      closing = -matmul(way/norm2(way), flight%slope)
      time = huge(time)
      where (closing > glancing) time = max(flight%gap, 0.0_wp)/closing
      i = minloc(time, dim=1)
      if (.not. time(i) < huge(time)) return
      station = flight%station(i)
      flight%gap = flight%gap - time(i)*closing
      call resist(flight, flight%slope(:, i))
   end subroutine fly_on

   !> A station resists motions along a slope from now on.
   pure subroutine resist(flight, slope)
      type(flight_type), intent(inout) :: flight
      real(wp), intent(in) :: slope(:)
      real(wp) :: new(size(slope))

      new = slope - matmul(flight%resisted, matmul(slope, flight%resisted))
      if (norm2(new) <= glancing*norm2(slope)) return
      flight%resisted = reshape([flight%resisted, new/norm2(new)], &
                                [size(slope), size(flight%resisted, 2) + 1])
   end subroutine resist

end module coulter_step_landing
