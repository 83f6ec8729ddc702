!> Values of a group's variables: checked against the schema, faults noted, absent ones untouched.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_values
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: lower_case, to_text
   use coulter_deck_document, only: assignment_type, blame, deck_type, find_assignment, &
      groups_named
   use coulter_deck_names, only: suggestion
   use coulter_deck_namelist, only: read_value, value_type
   use coulter_deck_schema, only: allowed_text, choice_number, count_text, find_variable, &
      is_in_range, max_text, variable_rule_type, variable_rules
   implicit none(type, external)
   private
   public :: get_value, get_list, get_choice, get_reference
   public :: is_given, check_unique_names

   !> Replace a preset value by that of the deck. A variable that is absent or at fault leaves it.
   interface get_value
      module procedure :: get_real, get_vector, get_integer, get_logical, get_text
   end interface get_value

   !> Values of a variable of any length; unallocated when it is absent or at fault.
   interface get_list
      module procedure :: get_real_list, get_integer_list
   end interface get_list

   character(len=*), parameter :: digits = "0123456789"

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

   !> Number of the law, body or table to which a variable of this name refers; `number` keeps its
   !> value when the variable is absent or at fault.
   subroutine get_reference(deck, group, variable, number)
      !> Deck that notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Variable name, which is that of the group to which it refers.
      character(len=*), intent(in) :: variable
      !> Number of the object among its kind, from 1.
      integer, intent(inout) :: number
      character(len=max_text), allocatable :: names(:)
      type(value_type) :: value
      logical :: is_read
      integer :: i

      call read_variable(deck, group, variable, value, is_read)
      if (.not. is_read) return
      names = names_of(deck, variable)
      do i = 1, size(names)
         if (names(i) /= value%text) cycle
         number = i
         return
      end do
      ! the name that is meant may be one that could not be read
      if (any(names == "")) return
      call blame(deck, group, variable, "is no "//variable//" of this deck" &
                 //suggestion(value%text, names))
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

      names = names_of(deck, kind)
      groups = groups_named(deck, kind)
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
   pure function names_of(deck, kind) result(names)
      type(deck_type), intent(in) :: deck
      character(len=*), intent(in) :: kind
      character(len=max_text), allocatable :: names(:)
      integer, allocatable :: groups(:)
      integer :: i

      groups = groups_named(deck, kind)
      allocate (names(size(groups)))
      do i = 1, size(groups)
         names(i) = deck%groups(groups(i))%object
      end do
   end function names_of

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

   !> Read and check the values of a variable; note what is wrong with them.
   subroutine read_variable(deck, group, variable, value, is_read)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      character(len=*), intent(in) :: variable
      type(value_type), intent(out) :: value
      !> Is the variable there, and without fault?
      logical, intent(out) :: is_read
      character(len=:), allocatable :: message
      type(variable_rule_type) :: rule
      type(assignment_type) :: item
      integer :: i

      is_read = .false.
      i = find_assignment(deck%groups(group), variable)
      if (i == 0) return
      item = deck%groups(group)%assignments(i)
      if (item%n_values < 1) return
      rule = rule_of(deck, group, variable)
      call check_writing(rule, item, message)
      if (message == "") call convert(rule, item, value, message)
      if (message == "") call check_value(rule, value, message)
      is_read = message == ""
      if (.not. is_read) call blame(deck, group, variable, message)
   end subroutine read_variable

   !> Is the number of values right, and is each written as its type demands? The compiler would
   !> also take `1+5` for 1.0e5, `tomato` for true and a text of any length.
   pure subroutine check_writing(rule, item, message)
      type(variable_rule_type), intent(in) :: rule
      type(assignment_type), intent(in) :: item
      character(len=:), allocatable, intent(out) :: message
      logical :: is_right

      message = ""
      if (item%n_values < rule%least .or. item%n_values > rule%most) then
         message = "takes "//count_text(rule)//trim(merge(" value ", " values", rule%most == 1)) &
            //", not "//to_text(item%n_values)
         return
      end if
      select case (rule%type)
      case ("real")
         is_right = is_number(item%value, digits//"+-.eEdD*, ")
      case ("integer")
         is_right = is_number(item%value, digits//"+-*, ")
      case ("logical")
         is_right = any(lower_case(item%value) == [character(len=7) :: "t", "f", "true", "false", &
                                                    ".t.", ".f.", ".true.", ".false."])
      case default
         is_right = scan(item%value(:1), "'""") == 1
      end select
      if (.not. is_right) message = "must be "//allowed_text(rule)
   end subroutine check_writing

   !> Do all characters belong to numbers, and are signs only at the start or in an exponent?
   pure function is_number(written, characters)
      character(len=*), intent(in) :: written, characters
      logical :: is_number
      integer :: i

      is_number = verify(written, characters) == 0
      do i = 2, len(written)
         if (scan(written(i:i), "+-") == 1) &
            is_number = is_number .and. scan(written(i - 1:i - 1), digits//".+-") == 0
      end do
   end function is_number

   !> Have the compiler convert values to numbers or text.
   subroutine convert(rule, item, value, message)
      type(variable_rule_type), intent(in) :: rule
      type(assignment_type), intent(in) :: item
      type(value_type), intent(out) :: value
      character(len=:), allocatable, intent(out) :: message
      character(len=:), allocatable :: type

      type = trim(rule%type)
      if (type == "choice") type = "text"
      call read_value(type, item%n_values, item%value, value, message)
      if (message /= "") message = "must be "//allowed_text(rule)//" ("//message//")"
   end subroutine convert

   !> Are values finite, in range, among the choices, short enough?
   pure subroutine check_value(rule, value, message)
      type(variable_rule_type), intent(in) :: rule
      type(value_type), intent(in) :: value
      character(len=:), allocatable, intent(out) :: message
      logical :: is_right
      integer :: i

      message = ""
      is_right = .true.
      select case (rule%type)
      case ("real")
         is_right = all(ieee_is_finite(value%reals)) &
            .and. all([(is_in_range(rule, value%reals(i)), i=1, size(value%reals))])
      case ("integer")
         is_right = all([(is_in_range(rule, real(value%integers(i), wp)), i=1, &
                          size(value%integers))])
      case ("choice")
         is_right = choice_number(rule, value%text) > 0
      case ("text")
         if (len(value%text) > max_text) &
            message = "is longer than "//to_text(max_text)//" characters"
         if (value%text == "") message = "must not be empty"
      end select
      if (.not. is_right) message = "must be "//allowed_text(rule)
   end subroutine check_value

   !> Rule of a variable.
   pure function rule_of(deck, group, variable) result(rule)
      type(deck_type), intent(in) :: deck
      integer, intent(in) :: group
      character(len=*), intent(in) :: variable
      type(variable_rule_type) :: rule

      rule = variable_rules(find_variable(deck%groups(group)%name, variable))
   end function rule_of

end module coulter_deck_values
