!> What stations of boundaries that hold tension remember: have they touched, and how far have they
!> opened? Unlike other memories it outlasts steps in which they are far apart.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_setup_bonds
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type
   use coulter_contact, only: contact_type, contacts_type, untouched
   use coulter_contact_tip, only: place_on_edge
   use coulter_points_tiling, only: nearest_outer_edge, tiling_type
   implicit none(type, external)
   private
   public :: recall_bonds, remember_bonds, carry_bonds

   !> Places of an edge that remember: its ends, and any sharp corner of a tool between them.
   integer, parameter :: n_slots = 3
   !> Gaps at the start of a step below this share of the spacing are closed.
   real(wp), parameter :: closed = 1.0e-6_wp

contains

   !> Tell all stations of boundaries that hold tension what is remembered of them.
   pure subroutine recall_bonds(contacts, bonds, boundaries, tiling, spacing)
      !> Stations of the step.
      type(contacts_type), intent(inout) :: contacts
      !> Largest openings so far, length units, shape (n_slots, n_edges, n_boundaries); made if need
      !> be.
      real(wp), allocatable, intent(inout) :: bonds(:, :, :)
      !> Boundaries and tiles at the start of the step.
      type(boundary_type), intent(in) :: boundaries(:)
      type(tiling_type), intent(in) :: tiling
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      integer :: k

      if (.not. allocated(bonds)) allocate (bonds(n_slots, size(tiling%outer_edge, 2), &
                                                  size(boundaries)), source=untouched)
      do k = 1, contacts%n
         associate (contact => contacts%item(k), boundary => boundaries(contacts%item(k)%boundary))
            if (.not. boundary%tension_limit > 0.0_wp) cycle
            contact%opening = bonds(slot_of(contact), contact%edge, contact%boundary)
            if (.not. contact%opening > untouched) then
               if (abs(first_gap(contact, boundary, tiling)) <= closed*spacing) then
                  contact%opening = 0.0_wp
               end if
            end if
            contact%was_acting = contact%was_acting .or. .not. abs(contact%opening) > 0.0_wp
         end associate
      end do
   end subroutine recall_bonds

   !> Gap of a station at the start of the step.
   pure function first_gap(contact, boundary, tiling) result(gap)
      type(contact_type), intent(in) :: contact
      type(boundary_type), intent(in) :: boundary
      type(tiling_type), intent(in) :: tiling
      real(wp) :: gap
      type(face_type) :: face
      type(place_type) :: place
      real(wp) :: ends(2, 2)

      ends = tiling%position(:, [contact%corner, contact%other_corner])
      if (contact%tip > 0) then
         ends = ends - spread(boundary%vertices(:, contact%tip), 2, 2)
         associate (on_edge => place_on_edge(ends))
            gap = on_edge%gap
         end associate
      else
         associate (s => contact%segment)
            call new_face(face, boundary%vertices(:, s), boundary%vertices(:, s + 1), &
                          boundary%bulge(s))
            place = place_on(face, ends(:, 1) - face%first, [0.0_wp, 0.0_wp])
            gap = place%gap
         end associate
      end if
   end function first_gap

   !> Remember what stations leave at the end of a step: those that press have touched.
   pure subroutine remember_bonds(contacts, bonds)
      !> Stations in equilibrium.
      type(contacts_type), intent(in) :: contacts
      !> See `recall_bonds`.
      real(wp), intent(inout) :: bonds(:, :, :)
      integer :: k

      do k = 1, contacts%n
         associate (contact => contacts%item(k), &
                    bond => bonds(slot_of(contacts%item(k)), contacts%item(k)%edge, &
                                  contacts%item(k)%boundary))
            if (contact%opening > untouched) then
               bond = max(bond, contact%new_opening)
            else if (contact%is_acting) then
               bond = max(bond, 0.0_wp)
            end if
         end associate
      end do
   end subroutine remember_bonds

   !> Where the edges of new tiles remember what those remembered that lay there.
   pure subroutine carry_bonds(bonds, tiling, old_tiling)
      !> See `recall_bonds`; on entry of the old tiles, on return of the new ones.
      real(wp), allocatable, intent(inout) :: bonds(:, :, :)
      !> New and old tiles.
      type(tiling_type), intent(in) :: tiling, old_tiling
      real(wp), allocatable :: fresh(:, :, :)
      real(wp) :: share
      integer :: e, k, old

      allocate (fresh(n_slots, size(tiling%outer_edge, 2), size(bonds, 3)), source=untouched)
      do e = 1, size(fresh, 2)
         do k = 1, 2
            call nearest_outer_edge(old_tiling, tiling%position(:, tiling%outer_edge(k, e)), old, &
                                    share)
            fresh(k, e, :) = bonds(merge(1, 2, share < 0.5_wp), old, :)
         end do
      end do
      call move_alloc(fresh, bonds)
   end subroutine carry_bonds

   !> Place of an edge that a station stands for.
   pure function slot_of(contact) result(slot)
      type(contact_type), intent(in) :: contact
      integer :: slot

      slot = contact%end_of_edge
      if (contact%tip > 0) slot = n_slots
   end function slot_of

end module coulter_setup_bonds
