!> What contacts remember, carried to the edges of new tiles.
!>
!> The shear that a station carries lasts, not the way that it has crept: the stress of its new tile
!> is a mean, and the rest of the shear is the way from where it sticks (theory, section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_contact_transfer
   use coulter_assembly_contact_forces, only: penalties
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: formulation_augmented
   use coulter_boundary_face, only: place_on, place_type
   use coulter_boundary_motion, only: motion_type
   use coulter_contact, only: contact_type, contacts_type
   use coulter_contact_search, only: build_contacts
   use coulter_model, only: model_type
   use coulter_points_tiling, only: tiling_type
   use coulter_system, only: system_type
   implicit none(type, external)
   private
   public :: carry_contacts

   !> Stations farther from all old ones than this have none to ask, over the spacing.
   real(wp), parameter :: farthest = 0.5_wp

contains

   !> Give the stations of new tiles state and tractions of the old ones, interpolated along the
   !> edges of the body.
   pure subroutine carry_contacts(system, model, old_tiling)
      !> System between two steps; its `last_contacts` are replaced.
      type(system_type), intent(inout) :: system
      !> Scene with the new tiles.
      type(model_type), intent(in) :: model
      !> Tiles that the last contacts belong to, in the same position.
      type(tiling_type), intent(in) :: old_tiling
      type(contacts_type) :: contacts
      type(motion_type) :: rest(size(model%boundaries))
      integer :: k

      if (.not. any(model%boundaries%has_friction() &
                    .or. model%boundaries%formulation == formulation_augmented)) then
         system%last_contacts%n = 0
         return
      end if
      call build_contacts(contacts, model%boundaries, rest, model%tiling, system%held_edges, &
                          model%grid%smallest_spacing(), system%cuts)
      do k = 1, contacts%n
         call ask(contacts%item(k), system%last_contacts, model, old_tiling)
         if (contacts%item(k)%rubs) call set_lag(contacts%item(k), model)
      end do
      system%last_contacts = contacts
   end subroutine carry_contacts

   !> State and tractions at the place of a new station.
   pure subroutine ask(new, last, model, old_tiling)
      type(contact_type), intent(inout) :: new
      type(contacts_type), intent(in) :: last
      type(model_type), intent(in) :: model
      type(tiling_type), intent(in) :: old_tiling
      real(wp) :: middle(2), share, distance, nearest
      integer :: j, found

      found = 0
      middle = 0.75_wp*model%tiling%position(:, new%corner) &
         + 0.25_wp*model%tiling%position(:, new%other_corner)
      nearest = farthest*model%grid%smallest_spacing()
      do j = 1, last%n
         if (last%item(j)%boundary /= new%boundary .or. last%item(j)%segment /= new%segment) cycle
         if (last%item(j)%tip /= new%tip) cycle
         ! of both edges at a corner, the one that answers is that beside the half which the station
         ! stands for, of its ends the nearer one; a tip is where it was
         call measure(old_tiling, last%item(j), middle, share, distance)
         if (new%tip > 0) distance = 0.0_wp
         if ((share > 0.5_wp .and. new%tip == 0) .or. distance >= nearest) cycle
         nearest = distance
         found = j
      end do
      if (found == 0) return
      associate (old => last%item(found))
         new%is_acting = old%is_acting
         new%slip = old%slip
         new%traction = old%traction
         if (.not. old%is_acting) new%traction = 0.0_wp
      end associate
      if (new%tip > 0) return
      call measure(old_tiling, last%item(found), model%tiling%position(:, new%corner), share, &
                   distance)
      call interpolate(new, last, found, share)
   end subroutine ask

   !> Where a position lies on the edge of a station, 0 at its corner and 1 at the other end, and
   !> its distance from the edge.
   pure subroutine measure(tiling, old, position, share, distance)
      type(tiling_type), intent(in) :: tiling
      type(contact_type), intent(in) :: old
      real(wp), intent(in) :: position(2)
      real(wp), intent(out) :: share, distance
      real(wp) :: along(2), way(2)

      along = tiling%position(:, old%other_corner) - tiling%position(:, old%corner)
      way = position - tiling%position(:, old%corner)
      share = min(max(dot_product(way, along)/dot_product(along, along), 0.0_wp), 1.0_wp)
      distance = norm2(way - share*along)
   end subroutine measure

   !> Mix in the traction of the other end of an edge, if it acts as well.
   pure subroutine interpolate(new, last, found, share)
      type(contact_type), intent(inout) :: new
      type(contacts_type), intent(in) :: last
      integer, intent(in) :: found
      real(wp), intent(in) :: share
      integer :: j

      do j = max(found - 1, 1), min(found + 1, last%n)
         associate (other => last%item(j), old => last%item(found))
            if (other%edge /= old%edge .or. other%end_of_edge == old%end_of_edge) cycle
            if (other%boundary /= old%boundary .or. other%segment /= old%segment) cycle
            if (.not. (other%is_acting .and. old%is_acting) .or. other%tip /= old%tip) cycle
            new%traction = (1.0_wp - share)*old%traction + share*other%traction
         end associate
      end do
   end subroutine interpolate

   !> The way from where a station sticks that makes its shear up with the stress of its tile.
   pure subroutine set_lag(contact, model)
      type(contact_type), intent(inout) :: contact
      type(model_type), intent(in) :: model
      type(place_type) :: place
      real(wp) :: material(2), penalty(2)

      if (.not. contact%is_acting) return
      if (contact%tip > 0) then
         place%tangent = [contact%inward(2), -contact%inward(1)]
      else
         place = place_on(contact%face, contact%offset, [0.0_wp, 0.0_wp])
      end if
      associate (stress => model%points%converged%kirchhoff_stress([1, 4, 4, 2], contact%tile))
         material = matmul(reshape(stress, [2, 2]), contact%inward) &
            /model%points%volume_ratio(contact%tile)
      end associate
      penalty = penalties(model, contact)
      contact%new_lag = (contact%traction(2) - dot_product(place%tangent, material))/penalty(2) &
         *place%tangent
   end subroutine set_lag

end module coulter_retile_contact_transfer
