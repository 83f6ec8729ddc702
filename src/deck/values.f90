!> Values of a group's variables: checked against the schema, faults noted, absent ones untouched.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_values
   use coulter_base_kinds, only: wp
   use coulter_deck_document, only: blame, deck_type, find_assignment
   use coulter_deck_namelist, only: value_type
   use coulter_deck_schema, only: allowed_text, choice_number
   use coulter_deck_variable, only: read_variable, rule_of
   implicit none(type, external)
   private
   public :: get_value, get_list, get_choice, is_given, refuse, demand, demand_one

   !> Replace a preset value by that of the deck. A variable that is absent or at fault leaves it.
   interface get_value
      module procedure :: get_real, get_vector, get_integer, get_logical, get_text
   end interface get_value

   !> Values of a variable of any length; unallocated when it is absent or at fault.
   interface get_list
      module procedure :: get_real_list, get_integer_list
   end interface get_list

contains

   !> Does a group assign a variable, rightly or wrongly?
   pure function is_given(deck, group, variable)
      !> Scanned deck.
      type(deck_type), intent(in) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Variable name.
      character(len=*), intent(in) :: variable
      logical :: is_given

      is_given = find_assignment(deck%groups(group), variable) > 0
   end function is_given

   !> Note a fault if a variable is given where it means nothing.
   subroutine refuse(deck, group, variable, reason)
      !> Deck that notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Variable name.
      character(len=*), intent(in) :: variable
      !> Where the variable belongs.
      character(len=*), intent(in) :: reason

      if (is_given(deck, group, variable)) call blame(deck, group, variable, reason)
   end subroutine refuse

   !> Note a fault if a variable is missing that this group needs.
   subroutine demand(deck, group, variable)
      !> Deck that notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Variable name.
      character(len=*), intent(in) :: variable

      if (is_given(deck, group, variable) .or. deck%groups(group)%is_broken) return
      call blame(deck, group, variable, &
                 "is missing; it takes "//allowed_text(rule_of(deck, group, variable)))
   end subroutine demand

   !> Note a fault unless just one of two variables is given.
   subroutine demand_one(deck, group, first, second)
      !> Deck that notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Variable names.
      character(len=*), intent(in) :: first, second

      if (is_given(deck, group, first)) then
         call refuse(deck, group, second, "stands beside `"//first//"`; give one of them")
      else if (.not. (is_given(deck, group, second) .or. deck%groups(group)%is_broken)) then
         call blame(deck, group, "", "needs either `"//first//"` or `"//second//"`")
      end if
   end subroutine demand_one

   !> Number of the chosen word among the choices of the schema; `choice` keeps its value when the
   !> variable is absent or at fault.
   subroutine get_choice(deck, group, variable, choice)
      !> Deck that notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Variable name.
      character(len=*), intent(in) :: variable
      !> Number of the choice, from 1.
      integer, intent(inout) :: choice
      type(value_type) :: value
      logical :: is_read

      call read_variable(deck, group, variable, value, is_read)
      if (is_read) choice = choice_number(rule_of(deck, group, variable), value%text)
   end subroutine get_choice

   !> A real number; see `get_value`.
   subroutine get_real(deck, group, variable, target)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      character(len=*), intent(in) :: variable
      real(wp), intent(inout) :: target
      type(value_type) :: value
      logical :: is_read

      call read_variable(deck, group, variable, value, is_read)
      if (is_read) target = value%reals(1)
   end subroutine get_real

   !> As many real numbers as the target holds; see `get_value`.
   subroutine get_vector(deck, group, variable, target)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      character(len=*), intent(in) :: variable
      real(wp), intent(inout) :: target(:)
      type(value_type) :: value
      logical :: is_read

      call read_variable(deck, group, variable, value, is_read)
      if (is_read) target = value%reals
   end subroutine get_vector

   !> An integer; see `get_value`.
   subroutine get_integer(deck, group, variable, target)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      character(len=*), intent(in) :: variable
      integer, intent(inout) :: target
      type(value_type) :: value
      logical :: is_read

      call read_variable(deck, group, variable, value, is_read)
      if (is_read) target = value%integers(1)
   end subroutine get_integer

   !> A logical value; see `get_value`.
   subroutine get_logical(deck, group, variable, target)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      character(len=*), intent(in) :: variable
      logical, intent(inout) :: target
      type(value_type) :: value
      logical :: is_read

      call read_variable(deck, group, variable, value, is_read)
      if (is_read) target = value%flag
   end subroutine get_logical

   !> A text; see `get_value`.
   subroutine get_text(deck, group, variable, target)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      character(len=*), intent(in) :: variable
      character(len=:), allocatable, intent(inout) :: target
      type(value_type) :: value
      logical :: is_read

      call read_variable(deck, group, variable, value, is_read)
      if (is_read) target = value%text
   end subroutine get_text

   !> Real numbers; see `get_list`.
   subroutine get_real_list(deck, group, variable, list)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      character(len=*), intent(in) :: variable
      real(wp), allocatable, intent(out) :: list(:)
      type(value_type) :: value
      logical :: is_read

      call read_variable(deck, group, variable, value, is_read)
      if (is_read) call move_alloc(value%reals, list)
   end subroutine get_real_list

   !> Integers; see `get_list`.
   subroutine get_integer_list(deck, group, variable, list)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      character(len=*), intent(in) :: variable
      integer, allocatable, intent(out) :: list(:)
      type(value_type) :: value
      logical :: is_read

      call read_variable(deck, group, variable, value, is_read)
      if (is_read) call move_alloc(value%integers, list)
   end subroutine get_integer_list

end module coulter_deck_values
