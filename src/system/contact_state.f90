!> Which contacts act, how they move against their faces, and what they remember.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_contact_state
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: formulation_augmented
   use coulter_boundary_face, only: place_on, place_type, reaches
   use coulter_boundary_motion, only: followed_by, motion_type, seen_from
   use coulter_contact, only: contact_type, end_slack
   use coulter_contact_tip, only: edge_place_type, place_on_edge
   use coulter_contact_surface_pairs, only: push_apart
   use coulter_model, only: boundary_motion, model_type
   use coulter_system, only: system_type
   implicit none(type, external)
   private
   public :: motion_of, whole_motion, locate, decide, augment_contacts, push_out, touching, &
      depth_given

   !> Gaps below this share of the spacing count as closed: round-off of a body that starts on a
   !> wall.
   real(wp), parameter :: touching = 1.0e-10_wp
   !> A tip may slide this far beyond the ends of its edge within a step, over the length of that.
   real(wp), parameter :: tip_slack = 0.5_wp
   !> A corner that has changed its face more often than this in a step stays with the last one.
   integer, parameter :: most_changes = 6
   !> Corners that are deeper behind a face than the first in equilibrium, over the spacing, are
   !> pushed out. A step that leaves any deeper than the second went past the face; what hardly
   !> looks at it, by a share of the spacing, does not count.
   real(wp), parameter :: too_deep(2) = [0.018_wp, 0.05_wp], hardly = 1.0e-3_wp

contains

   !> How a boundary moves in the step: as prescribed, then freely.
   pure function whole_motion(system, model, boundary) result(motion)
      !> System at the present unknowns.
      type(system_type), intent(in) :: system
      !> Scene.
      type(model_type), intent(in) :: model
      !> Number of the boundary.
      integer, intent(in) :: boundary
      type(motion_type) :: motion

      motion = boundary_motion(model, boundary, system%start_time, system%end_time)
      if (system%border%n > 0) motion = followed_by(motion, system%border%motion(boundary))
   end function whole_motion

   !> Motion of both ends of an edge for one who moves freely with the tool, and to whom its faces
   !> are where the prescribed motion takes them.
   pure function motion_of(system, contact) result(moved)
      !> System at the present unknowns.
      type(system_type), intent(in) :: system
      !> The station.
      type(contact_type), intent(in) :: contact
      !> Motion of its corner and of the other end of the edge, length units.
      real(wp) :: moved(2, 2)

      moved = system%map%increment(:, [contact%corner, contact%other_corner])
      if (system%border%n == 0) return
      associate (free => system%border%motion(contact%boundary), origin => contact%face%first)
         moved(:, 1) = seen_from(free, origin + contact%offset, moved(:, 1))
         moved(:, 2) = seen_from(free, origin + contact%other_offset, moved(:, 2))
      end associate
   end function motion_of

   !> Place of a station at the end of the step, relative to its face and in the plane, for one who
   !> moves freely with the tool.
   pure subroutine locate(contact, moved, place, position)
      !> The station.
      type(contact_type), intent(in) :: contact
      !> What `motion_of` says of it.
      real(wp), intent(in) :: moved(2, 2)
      !> Place relative to its face, or to the edge that a tip presses on.
      type(place_type), intent(out) :: place
      !> Where it is in the plane, length units.
      real(wp), intent(out) :: position(2)
      type(edge_place_type) :: on_edge
      real(wp) :: ends(2, 2), share

      ends = reshape([contact%offset, contact%other_offset], [2, 2]) + moved
      position = contact%face%first + ends(:, 1)
      if (contact%tip == 0) then
         place = place_on(contact%face, contact%offset, moved(:, 1))
      else
         on_edge = place_on_edge(ends)
         place = on_edge%place_type
         share = min(max(on_edge%share, 0.0_wp), 1.0_wp)
         position = position + share*(ends(:, 2) - ends(:, 1))
      end if
   end subroutine locate

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
      contact%is_acting = contact%has_landed .or. (system%is_predicting .and. contact%was_acting)
      if (contact%is_acting) return
      if (contact%tip > 0) then
         contact%is_acting = overlap < touching*model%grid%smallest_spacing() &
            .and. abs(place%share - 0.5_wp) <= 0.5_wp + tip_slack
      else
         call judge(contact, system, place%place_type, overlap, model%grid%smallest_spacing())
      end if
   end subroutine decide

   !> Does the face act on the corner: held for good, or pressed while it slides along the face? A
   !> corner that goes to and fro between two faces stays with one of them at last.
   pure subroutine judge(contact, system, place, overlap, spacing)
      type(contact_type), intent(inout) :: contact
      type(system_type), intent(in) :: system
      !> Place of the corner.
      type(place_type), intent(in) :: place
      !> Traction over the penalty, and grid spacing, length units.
      real(wp), intent(in) :: overlap, spacing
      logical :: answer

      contact%is_acting = contact%is_bilateral
      if (contact%is_acting .or. .not. overlap < touching*spacing) return
      contact%is_acting = contact%is_reached
      if (contact%n_changes > most_changes) return
      answer = contact%is_settled .or. is_reached(system, contact, place, end_slack*spacing)
      if (answer .neqv. contact%is_reached) contact%n_changes = contact%n_changes + 1
      contact%is_reached = answer
      contact%is_acting = answer
   end subroutine judge

   !> Does the face reach the corner?
   pure function is_reached(system, contact, place, slack) result(answer)
      type(system_type), intent(in) :: system
      type(contact_type), intent(in) :: contact
      type(place_type), intent(in) :: place
      !> How far it reaches beyond its ends, length units.
      real(wp), intent(in) :: slack
      logical :: answer
      type(place_type) :: other
      real(wp) :: moved(2, 2)

      answer = place%distance >= slack .and. place%distance <= contact%face%length - slack
      if (answer) return
      moved = motion_of(system, contact)
      other = place_on(contact%face, contact%other_offset, moved(:, 2))
      answer = reaches(contact%face, place%distance, other%distance, slack)
   end function is_reached

   !> How deep a corner that gives near an open end of its face is behind that, length units.
   pure function depth_given(system, contact) result(depth)
      !> System in equilibrium.
      type(system_type), intent(in) :: system
      !> The station.
      type(contact_type), intent(in) :: contact
      real(wp) :: depth
      type(place_type) :: place
      real(wp) :: position(2)

      depth = 0.0_wp
      if (contact%recedes .or. .not. (contact%give > 0.0_wp .or. contact%leans)) return
      call locate(contact, motion_of(system, contact), place, position)
      if (place%distance < 0.0_wp .or. place%distance > contact%face%length) return
      depth = max(0.0_wp, -place%gap)
   end function depth_given

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

   !> Let faces press harder on corners that are too deep behind them, and bodies on each other, by
   !> what the penalty made of their depth: a step of Uzawa's method. Nothing is left of it after
   !> the step.
   pure subroutine push_out(system, model, has_changed)
      !> System in equilibrium.
      type(system_type), intent(inout) :: system
      !> Scene.
      type(model_type), intent(in) :: model
      !> Was anything too deep?
      logical, intent(out) :: has_changed
      type(place_type) :: place
      real(wp) :: position(2), depth(system%contacts%n), spacing
      integer :: k

      spacing = model%grid%smallest_spacing()
      depth = 0.0_wp
      do k = 1, system%contacts%n
         associate (contact => system%contacts%item(k))
            if (.not. contact%is_acting .or. contact%is_bilateral) cycle
            if (contact%give > 0.0_wp .or. contact%leans) cycle
            if (contact%weight < hardly*spacing) cycle
            call locate(contact, motion_of(system, contact), place, position)
            depth(k) = -place%gap
         end associate
      end do
      has_changed = any(depth > too_deep(1)*spacing) .and. .not. any(depth > too_deep(2)*spacing)
      if (has_changed) then
         where (depth > too_deep(1)*spacing) system%contacts%item(:system%contacts%n)%shift &
            = system%contacts%item(:system%contacts%n)%shift - depth
      end if
      if (.not. allocated(system%surfaces)) return
      call push_apart(system%surfaces%pairs, too_deep(1)*spacing, spacing, has_changed)
   end subroutine push_out

end module coulter_system_contact_state
