!> Sums over the stations of walls and tools, once a step is accepted.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_contact_report
   use coulter_base_kinds, only: wp
   use coulter_boundary_face, only: place_type
   use coulter_boundary_motion, only: moved_by, turn_matrix
   use coulter_contact, only: contact_type
   use coulter_model, only: model_type
   use coulter_model_contact_report, only: contact_report_type, station_report_type
   use coulter_model_observer, only: step_report_type
   use coulter_system, only: system_type
   use coulter_system_contact_state, only: locate, motion_of
   implicit none(type, external)
   private
   public :: report_contacts, report_surfaces

contains

   !> What every boundary feels, and all stations in contact.
   pure subroutine report_contacts(report, model, system)
      !> Report with the forces of the boundaries; gets `contacts` and `stations`.
      type(step_report_type), intent(inout) :: report
      !> Scene at the end of the step.
      type(model_type), intent(in) :: model
      !> System in equilibrium; remembers the last forces, so that work can be summed up.
      type(system_type), intent(inout) :: system
      integer :: b, k, n

      allocate (report%contacts(size(model%boundaries)))
      do b = 1, size(report%contacts)
         report%contacts(b)%travel = model%boundaries(b)%travel
         report%contacts(b)%centre = model%boundaries(b)%centre
         report%contacts(b)%rotation = model%boundaries(b)%turned
      end do
      n = 0
      if (allocated(system%contacts%item)) n = count(system%contacts%item(:system%contacts%n) &
                                                     %is_acting)
      allocate (report%stations(n))
      n = 0
      do k = 1, system%contacts%n
         if (.not. system%contacts%item(k)%is_acting) cycle
         n = n + 1
         call add_station(report, report%stations(n), system, system%contacts%item(k))
      end do
      call sum_work(report, system)
   end subroutine report_contacts

   !> What bodies feel of each other.
   pure subroutine report_surfaces(report, model, system)
      !> Report; gets `surfaces` and more `stations`.
      type(step_report_type), intent(inout) :: report
      !> Scene.
      type(model_type), intent(in) :: model
      !> System in equilibrium, with surfaces.
      type(system_type), intent(in) :: system
      integer :: k, n

      allocate (report%surfaces(size(model%body_contacts)))
      n = size(report%stations)
      report%stations = [report%stations, spread(station_report_type(), 1, &
                                                 count(system%surfaces%pairs%is_acting))]
      do k = 1, size(system%surfaces%pairs)
         associate (pair => system%surfaces%pairs(k), &
                    sum => report%surfaces(system%surfaces%pairs(k)%contact))
            if (.not. pair%is_acting) cycle
            n = n + 1
            report%stations(n) = station_report_type( &
                                 boundary=-pair%contact, slip=pair%slip, position=pair%place, &
                                 weight=pair%weight, traction=pair%traction)
            if (model%body_contacts(pair%contact)%is_within()) then
               ! a body does nothing to itself
               sum%force = 0.0_wp
            else if (model%body_contacts(pair%contact)%softer == 1) then
               sum%force = sum%force + pair%force
            else
               sum%force = sum%force - pair%force
            end if
            sum%pressing = sum%pressing - pair%weight*pair%traction(1)
            sum%rubbing = sum%rubbing + pair%weight*abs(pair%traction(2))
            sum%length = sum%length + pair%weight
            sum%penetration = max(sum%penetration, -pair%gap)
            if (pair%slip /= 0) sum%slipping = sum%slipping + pair%weight
         end associate
      end do
      where (report%surfaces%length > 0.0_wp)
         report%surfaces%slipping = report%surfaces%slipping/report%surfaces%length
      end where
   end subroutine report_surfaces

   !> One station in contact.
   pure subroutine add_station(report, station, system, contact)
      type(step_report_type), intent(inout) :: report
      type(station_report_type), intent(out) :: station
      type(system_type), intent(in) :: system
      type(contact_type), intent(in) :: contact
      type(place_type) :: place
      real(wp) :: force(2), arm(2)

      call locate(contact, motion_of(system, contact), place, station%position)
      force = -contact%weight*(contact%traction(1)*place%normal &
                               + contact%traction(2)*place%tangent)
      if (system%border%n > 0) then
         associate (free => system%border%motion(contact%boundary))
            station%position = moved_by(free, station%position)
            force = matmul(turn_matrix(free%rotation), force)
         end associate
      end if
      station%boundary = contact%boundary
      station%slip = contact%slip
      station%weight = contact%weight
      station%traction = contact%traction
      associate (sum => report%contacts(contact%boundary))
         arm = station%position - sum%centre
         sum%moment = sum%moment + arm(1)*force(2) - arm(2)*force(1)
         sum%pressing = sum%pressing - contact%weight*contact%traction(1)
         sum%rubbing = sum%rubbing + contact%weight*abs(contact%traction(2))
         sum%n_acting = sum%n_acting + 1
         if (contact%slip /= 0) then
            sum%n_slipping = sum%n_slipping + 1
         else if (contact%rubs) then
            sum%n_sticking = sum%n_sticking + 1
         end if
      end associate
   end subroutine add_station

   !> Work by the trapezoidal rule.
   pure subroutine sum_work(report, system)
      type(step_report_type), intent(inout) :: report
      type(system_type), intent(inout) :: system
      integer :: b

      if (.not. allocated(system%last_report)) then
         allocate (system%last_report(size(report%contacts)))
         allocate (system%last_reaction, mold=report%boundary_reactions)
         system%last_reaction = 0.0_wp
      end if
      do b = 1, size(report%contacts)
         associate (new => report%contacts(b), old => system%last_report(b))
            new%work = old%work + 0.5_wp*( &
               dot_product(report%boundary_reactions(:, b) + system%last_reaction(:, b), &
                           new%travel - old%travel) &
               + (new%moment + old%moment)*(new%rotation - old%rotation))
         end associate
      end do
      system%last_report = report%contacts
      system%last_reaction = report%boundary_reactions
   end subroutine sum_work

end module coulter_step_contact_report
