!> Names by which the objects of a deck refer to one another.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_references
   use coulter_base_text, only: to_text
   use coulter_deck_document, only: blame, deck_type, find_groups
   use coulter_deck_names, only: suggestion
   use coulter_deck_schema, only: max_text
   use coulter_deck_values, only: get_value
   implicit none(type, external)
   private
   public :: get_reference, check_unique_names

contains

   !> Number of the law, body, table or phase to which a variable refers; `number` keeps its
   !> value when the variable is absent or at fault.
   subroutine get_reference(deck, group, variable, number, kind)
      !> Deck that notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Variable name, which is that of the group to which it refers unless `kind` is.
      character(len=*), intent(in) :: variable
      !> Number of the object among its kind, from 1.
      integer, intent(inout) :: number
      !> Name of the group to which it refers.
      character(len=*), intent(in), optional :: kind
      character(len=max_text), allocatable :: names(:)
      character(len=:), allocatable :: name, group_name
      integer :: i

      name = ""
      call get_value(deck, group, variable, name)
      if (name == "") return
      group_name = variable
      if (present(kind)) group_name = kind
      call find_names(deck, group_name, names)
      do i = 1, size(names)
         if (names(i) /= name) cycle
         number = i
         return
      end do
      ! the name that is meant may be one that could not be read
      if (any(names == "")) return
      call blame(deck, group, variable, "is no "//group_name//" of this deck" &
                 //suggestion(name, names))
   end subroutine get_reference

   !> Note objects of a kind that share a name.
   pure subroutine check_unique_names(deck, kind)
      !> Deck that notes faults.
      type(deck_type), intent(inout) :: deck
      !> Group name.
      character(len=*), intent(in) :: kind
      character(len=max_text), allocatable :: names(:)
      integer, allocatable :: groups(:)
      integer :: i, first

      call find_names(deck, kind, names)
      call find_groups(deck, kind, groups)
      do i = 1, size(names)
         first = 1
         do while (names(first) /= names(i))
            first = first + 1
         end do
         if (first < i .and. names(i) /= "") call blame(deck, groups(i), "name", &
                                 "is also the name of &"//kind//" #"//to_text(first))
      end do
   end subroutine check_unique_names

   !> Names of all objects of a kind; empty where it could not be read.
   pure subroutine find_names(deck, kind, names)
      type(deck_type), intent(in) :: deck
      character(len=*), intent(in) :: kind
      character(len=max_text), allocatable, intent(out) :: names(:)
      integer, allocatable :: groups(:)
      integer :: i

      call find_groups(deck, kind, groups)
      allocate (names(size(groups)))
      do i = 1, size(groups)
         names(i) = deck%groups(groups(i))%object
      end do
   end subroutine find_names

end module coulter_deck_references
