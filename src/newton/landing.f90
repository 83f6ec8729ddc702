!> Lets free tools land: moves those that nothing holds as their loads pull them, until stations
!> hold them. Newton's method alone would send them through the bodies.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_newton_landing
   use coulter_base_kinds, only: wp
   use coulter_boundary_face, only: place_on, place_type, reaches
   use coulter_boundary_motion, only: moved_by, turn_matrix
   use coulter_contact, only: contact_type, end_slack
   use coulter_system, only: system_type
   use coulter_system_border, only: border_type, direction_of_turning, load_on, mode_at, set_motion
   use coulter_system_contact_state, only: locate, motion_of
   implicit none(type, external)
   private
   public :: land_free_tools

   !> A load that pulls by less than this share of itself is round-off.
   real(wp), parameter :: negligible = 1.0e-9_wp
   !> Stations whose gap closes by less than this share of the way of the tool do not hold it.
   real(wp), parameter :: glancing = 1.0e-3_wp
   !> Gaps below this share of the spacing are closed; what is deeper behind a face than its
   !> deepest share belongs to something else.
   real(wp), parameter :: closed = 1.0e-6_wp, deepest = 0.02_wp
   !> Largest angle of a part of a flight, and most parts.
   real(wp), parameter :: largest_angle = 0.1_wp
   integer, parameter :: most_parts = 100

   !> A tool at a moment of its flight.
   type :: flight_type
      !> Free components, shape (n).
      integer, allocatable :: component(:)
      !> Stations, and have they been met? Shape (n_stations).
      integer, allocatable :: station(:)
      logical, allocatable :: is_met(:)
      !> Where the load pulls the tool, past all that resists: a unit vector, shape (n), 0 if it
      !> cannot move the tool.
      real(wp), allocatable :: way(:)
      !> Way to every station, length units, shape (n_stations); huge for those that are not met.
      real(wp), allocatable :: distance(:)
   end type flight_type

contains

   !> Move all free tools that their stations do not hold, and let the stations on which they land
   !> act in the next evaluation, whatever their tractions.
   pure subroutine land_free_tools(system, spacing, unknowns, has_changed)
      !> System whose contacts have been evaluated.
      type(system_type), intent(inout) :: system
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      !> Free motions, length units, shape (border%n).
      real(wp), intent(inout) :: unknowns(:)
      !> Has any tool moved or landed?
      logical, intent(out) :: has_changed
      type(flight_type) :: flight
      real(wp) :: part
      integer :: j, k

      has_changed = .false.
      do j = 1, system%border%n
         if (any(system%border%boundary(:j - 1) == system%border%boundary(j))) cycle
         call begin_flight(flight, system, system%border%boundary(j))
         do k = 1, most_parts
            call look_ahead(flight, system, spacing)
            part = minval([flight%distance, huge(part)])
            if (.not. part < huge(part)) exit
            has_changed = .true.
            if (part <= closed*spacing) then
               flight%is_met = flight%is_met .or. flight%distance <= closed*spacing
               cycle
            end if
            unknowns(flight%component) = unknowns(flight%component) &
               + min(part, longest_part(flight, system%border))*flight%way
            call set_motion(system%border, unknowns)
         end do
         system%contacts%item(flight%station)%has_landed = flight%is_met
      end do
   end subroutine land_free_tools

   !> Components and stations of a tool.
   pure subroutine begin_flight(flight, system, boundary)
      type(flight_type), intent(out) :: flight
      type(system_type), intent(in) :: system
      integer, intent(in) :: boundary
      integer :: i

      flight%component = pack([(i, i=1, system%border%n)], system%border%boundary == boundary)
      flight%station = pack([(i, i=1, system%contacts%n)], &
                            system%contacts%item(:system%contacts%n)%boundary == boundary)
      allocate (flight%is_met(size(flight%station)), source=.false.)
      allocate (flight%way(size(flight%component)), flight%distance(size(flight%station)))
   end subroutine begin_flight

   !> Where the load pulls the tool past the stations that act or have been met, and how far away
   !> the others are.
   pure subroutine look_ahead(flight, system, spacing)
      type(flight_type), intent(inout) :: flight
      type(system_type), intent(in) :: system
      real(wp), intent(in) :: spacing
      real(wp) :: load(size(flight%way)), size_of_load
      real(wp), dimension(size(flight%way), size(flight%station)) :: along_normal, along_tangent
      type(place_type) :: place(size(flight%station))
      real(wp) :: other(size(flight%station))
      integer :: i

      load = [(load_on(system%border, flight%component(i)), i=1, size(load))]
      size_of_load = norm2(load)
      call measure(flight, system, place, other, along_normal, along_tangent)
      call resist(load, flight, system, along_normal, along_tangent)
      flight%distance = huge(1.0_wp)
      if (.not. norm2(load) > negligible*size_of_load) return
      flight%way = load/norm2(load)
      do i = 1, size(flight%station)
         associate (contact => system%contacts%item(flight%station(i)), d => flight%distance(i), &
                    closing => -dot_product(flight%way, along_normal(:, i)))
            if (contact%is_acting .or. flight%is_met(i) .or. closing < glancing &
                .or. place(i)%gap < -deepest*spacing) cycle
            d = max(place(i)%gap, 0.0_wp)/closing
            associate (slid => d*dot_product(flight%way, along_tangent(:, i)))
               if (.not. is_met(contact, place(i)%distance + slid, other(i) + slid, &
                                end_slack*spacing)) d = huge(d)
            end associate
         end associate
      end do
   end subroutine look_ahead

   !> Does a face reach a corner, or a tip its edge?
   pure function is_met(contact, foot, other, slack) result(answer)
      type(contact_type), intent(in) :: contact
      !> Places of the station and of the other end of its edge along the face, or of the tip along
      !> the edge; how far faces and edges reach beyond their ends; length units.
      real(wp), intent(in) :: foot, other, slack
      logical :: answer

      if (contact%tip > 0) then
         answer = foot >= -slack &
            .and. foot <= norm2(contact%other_offset - contact%offset) + slack
      else
         answer = contact%is_settled .or. reaches(contact%face, foot, other, slack)
      end if
   end function is_met

   !> Places of all stations, those of the other ends of their edges along the faces, and how gaps
   !> and feet move with the components.
   pure subroutine measure(flight, system, place, other, along_normal, along_tangent)
      type(flight_type), intent(in) :: flight
      type(system_type), intent(in) :: system
      type(place_type), intent(out) :: place(:)
      real(wp), intent(out) :: other(:), along_normal(:, :), along_tangent(:, :)
      type(place_type) :: place_of_other
      real(wp) :: position(2), mode(2), turn(2, 2), moved(2, 2)
      integer :: i, k

      do i = 1, size(flight%station)
         associate (contact => system%contacts%item(flight%station(i)))
            moved = motion_of(system, contact)
            call locate(contact, moved, place(i), position)
            place_of_other = place_on(contact%face, contact%other_offset, moved(:, 2))
            other(i) = place_of_other%distance
            associate (free => system%border%motion(contact%boundary))
               position = moved_by(free, position)
               turn = transpose(turn_matrix(free%rotation))
            end associate
            do k = 1, size(flight%component)
               mode = matmul(turn, mode_at(system%border, flight%component(k), position))
               along_normal(k, i) = -dot_product(place(i)%normal, mode)
               along_tangent(k, i) = -dot_product(place(i)%tangent, mode)
               ! a tip moves along the edge, a face under its corner
               if (contact%tip > 0) along_tangent(k, i) = -along_tangent(k, i)
            end do
         end associate
      end do
   end subroutine measure

   !> Take from the load what stations resist that act or have been met: along their normals, and
   !> along their faces if they rub.
   pure subroutine resist(load, flight, system, along_normal, along_tangent)
      real(wp), intent(inout) :: load(:)
      type(flight_type), intent(in) :: flight
      type(system_type), intent(in) :: system
      real(wp), intent(in) :: along_normal(:, :), along_tangent(:, :)
      real(wp) :: resisted(size(load), size(load))
      integer :: i, n

      n = 0
      do i = 1, size(flight%station)
         associate (contact => system%contacts%item(flight%station(i)))
            if (.not. (contact%is_acting .or. flight%is_met(i))) cycle
            call take_off(load, resisted, n, along_normal(:, i))
            if (contact%rubs) call take_off(load, resisted, n, along_tangent(:, i))
         end associate
      end do
   end subroutine resist

   !> Take from the load what pulls along a motion that nothing has resisted so far.
   pure subroutine take_off(load, resisted, n, motion)
      real(wp), intent(inout) :: load(:), resisted(:, :)
      integer, intent(inout) :: n
      real(wp), intent(in) :: motion(:)
      real(wp) :: new(size(motion))

      if (n == size(load)) return
      new = motion - matmul(resisted(:, :n), matmul(motion, resisted(:, :n)))
      if (norm2(new) <= glancing*norm2(motion)) return
      n = n + 1
      resisted(:, n) = new/norm2(new)
      load = load - dot_product(load, resisted(:, n))*resisted(:, n)
   end subroutine take_off

   !> Longest part of a flight: one that turns the tool by little.
   pure function longest_part(flight, border) result(longest)
      type(flight_type), intent(in) :: flight
      type(border_type), intent(in) :: border
      real(wp) :: longest
      integer :: i

      longest = huge(longest)
      do i = 1, size(flight%component)
         associate (j => flight%component(i))
            if (border%direction(j) == direction_of_turning) longest = largest_angle*border%reach(j)
         end associate
      end do
   end function longest_part

end module coulter_newton_landing
