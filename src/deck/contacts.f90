!> Reads contacts between bodies.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_contacts
   use coulter_contact_body_contact, only: body_contact_type
   use coulter_deck_document, only: blame, deck_type, find_groups
   use coulter_deck_references, only: get_reference
   use coulter_deck_values, only: get_value, is_given
   implicit none(type, external)
   private
   public :: read_contacts

contains

   !> All contacts between bodies.
   subroutine read_contacts(deck, contacts)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Contacts in the order of the deck.
      type(body_contact_type), allocatable, intent(out) :: contacts(:)
      integer, allocatable :: groups(:)
      integer :: i

      call find_groups(deck, "contact", groups)
      allocate (contacts(size(groups)))
      do i = 1, size(groups)
         associate (contact => contacts(i), friction => contacts(i)%friction)
            call get_reference(deck, groups(i), "body", contact%body(1))
            call get_reference(deck, groups(i), "against", contact%body(2), "body")
            call get_value(deck, groups(i), "friction", friction%coefficient)
            call get_value(deck, groups(i), "adhesion", friction%adhesion)
            call get_value(deck, groups(i), "shear_limit", friction%limit)
            call get_value(deck, groups(i), "rough", friction%is_rough)
            call get_value(deck, groups(i), "band_ratio", contact%band_ratio)
            if (contact%rubs() .or. .not. is_given(deck, groups(i), "shear_limit")) cycle
            call blame(deck, groups(i), "shear_limit", "limits no shear: give `friction`," &
                       //" `adhesion` or `rough` as well")
         end associate
      end do
   end subroutine read_contacts

end module coulter_deck_contacts
