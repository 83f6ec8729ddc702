!> Which contacts act, how they move against their faces, and what they remember.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_contact_state
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: formulation_augmented
   use coulter_boundary_contact, only: contact_type, end_slack
   use coulter_boundary_face, only: place_on, place_type, reaches
   use coulter_boundary_tip, only: edge_place_type
   use coulter_model, only: model_type
   use coulter_step_system, only: system_type
   implicit none(type, external)
   private
   public :: motion_of, decide, land_free_tools, augment_contacts

   !> Gaps below this share of the spacing count as closed: round-off of a body that starts on a
   !> wall.
   real(wp), parameter :: touching = 1.0e-10_wp
   !> A tip may slide this far beyond the ends of its edge within a step, over the length of that.
   real(wp), parameter :: tip_slack = 0.5_wp

contains

   !> Motion of both ends of an edge against a tool that may move freely.
   pure function motion_of(system, contact) result(moved)
      !> System at the present unknowns.
      type(system_type), intent(in) :: system
      !> The station.
      type(contact_type), intent(in) :: contact
      !> Motion of its corner and of the other end of the edge, length units.
      real(wp) :: moved(2, 2)

      moved = system%map%increment(:, [contact%corner, contact%other_corner])
      if (system%border%n == 0) return
      moved = moved - spread(system%border%motion(:, contact%boundary), 2, 2)
   end function motion_of

   !> Does the station act? A prediction keeps what acted in the last step.
   pure subroutine decide(system, model, contact, place, overlap)
      !> System at the present unknowns.
      type(system_type), intent(in) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> The station; gets `is_acting`, and loses slip and traction.
      type(contact_type), intent(inout) :: contact
      !> Place of its corner or of the tip.
      type(edge_place_type), intent(in) :: place
      !> Traction over the penalty, length units.
      real(wp), intent(in) :: overlap

      contact%slip = 0
      contact%traction = 0.0_wp
      contact%is_acting = system%is_predicting .and. contact%was_acting
      if (contact%is_acting) return
      if (contact%tip > 0) then
         contact%is_acting = overlap < touching*model%grid%smallest_spacing() &
            .and. abs(place%share - 0.5_wp) <= 0.5_wp + tip_slack
      else
         contact%is_acting = acts(system, contact, place%place_type, overlap, &
                                  model%grid%smallest_spacing())
      end if
   end subroutine decide

   !> Does the face act on the corner: held for good, or pressed while it slides along the face?
   pure function acts(system, contact, place, overlap, spacing) result(answer)
      type(system_type), intent(in) :: system
      type(contact_type), intent(in) :: contact
      !> Place of the corner.
      type(place_type), intent(in) :: place
      !> Traction over the penalty, and grid spacing, length units.
      real(wp), intent(in) :: overlap, spacing
      logical :: answer
      type(place_type) :: other
      real(wp) :: slack, moved(2, 2)

      answer = contact%is_bilateral
      if (answer .or. .not. overlap < touching*spacing) return
      slack = end_slack*spacing
      answer = contact%is_settled .or. (place%distance >= slack &
                                        .and. place%distance <= contact%face%length - slack)
      if (answer) return
      moved = motion_of(system, contact)
      other = place_on(contact%face, contact%other_offset, moved(:, 2))
      answer = reaches(contact%face, place%distance, other%distance, slack)
   end function acts

   !> Let the nearest stations of free tools that touch nothing act, as if they had before: they
   !> must carry the load.
   pure subroutine land_free_tools(system, has_changed)
      !> System whose contacts have been evaluated.
      type(system_type), intent(inout) :: system
      !> Was there such a tool?
      logical, intent(out) :: has_changed
      type(place_type) :: place(system%contacts%n)
      real(wp) :: moved(2, 2)
      integer :: j, k

      has_changed = .false.
      do j = 1, system%border%n
         associate (contacts => system%contacts%item(:system%contacts%n), &
                    b => system%border%boundary(j))
            if (any(contacts%is_acting .and. contacts%boundary == b)) cycle
            if (.not. any(contacts%boundary == b .and. contacts%tip == 0)) cycle
            do k = 1, size(contacts)
               moved = motion_of(system, contacts(k))
               place(k) = place_on(contacts(k)%face, contacts(k)%offset, moved(:, 1))
            end do
            k = minloc(place%gap, dim=1, mask=contacts%boundary == b .and. contacts%tip == 0)
            system%contacts%item(k)%was_acting = .true.
            has_changed = .true.
         end associate
      end do
   end subroutine land_free_tools

   !> End a round of the augmented Lagrangian method: what the penalty carries is remembered, so
   !> that it can relax.
   pure subroutine augment_contacts(system, model, has_changed)
      !> System in equilibrium.
      type(system_type), intent(inout) :: system
      !> Scene.
      type(model_type), intent(in) :: model
      !> Does any boundary remember?
      logical, intent(out) :: has_changed
      integer :: k

      has_changed = .false.
      do k = 1, system%contacts%n
         associate (contact => system%contacts%item(k))
            if (model%boundaries(contact%boundary)%formulation /= formulation_augmented) cycle
            contact%memory = contact%traction
            has_changed = .true.
         end associate
      end do
   end subroutine augment_contacts

end module coulter_step_contact_state
