!> One variable of a group: its values as the compiler reads them, checked against the schema.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_variable
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use coulter_base_kinds, only: wp
   use coulter_base_range, only: is_in_range
   use coulter_base_text, only: lower_case, to_text
   use coulter_deck_document, only: assignment_type, blame, deck_type, find_assignment
   use coulter_deck_namelist, only: read_value, value_type
   use coulter_deck_schema, only: allowed_text, choice_number, count_text, find_variable, &
      max_text, variable_rule_type, variable_rules
   implicit none(type, external)
   private
   public :: read_variable, rule_of

   character(len=*), parameter :: digits = "0123456789"

contains

   !> Read and check the values of a variable; note what is wrong with them.
   subroutine read_variable(deck, group, variable, value, is_read)
      !> Scanned deck.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Variable name.
      character(len=*), intent(in) :: variable
      !> What the deck gives.
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
         if (scan(written(i:i), "+-") == 1) then
           is_number = is_number .and. scan(written(i - 1:i - 1), digits//".+-") == 0
         end if
      end do
   end function is_number

   !> Have the compiler convert values to numbers or text.
   subroutine convert(rule, item, value, message)
      type(variable_rule_type), intent(in) :: rule
      type(assignment_type), intent(in) :: item
      type(value_type), intent(out) :: value
      character(len=:), allocatable, intent(out) :: message
      character(len=:), allocatable :: type
      logical :: is_valid

      type = trim(rule%type)
      if (type == "choice") type = "text"
      call read_value(type, item%n_values, item%value, value, is_valid, message)
      if (message == "" .and. .not. is_valid) message = "must be "//allowed_text(rule)
   end subroutine convert

   !> Are values finite, in range, among the choices, short enough?
   pure subroutine check_value(rule, value, message)
      type(variable_rule_type), intent(in) :: rule
      type(value_type), intent(in) :: value
      character(len=:), allocatable, intent(out) :: message
      logical :: is_right
      integer :: i

      message = ""
      select case (rule%type)
      case ("real")
         is_right = all(ieee_is_finite(value%reals)) &
            .and. all([(is_in_range(rule%range, value%reals(i)), i=1, size(value%reals))])
      case ("integer")
         is_right = all([(is_in_range(rule%range, real(value%integers(i), wp)), i=1, &
                          size(value%integers))])
      case ("choice")
         is_right = choice_number(rule, value%text) > 0
      case ("logical")
         is_right = .true.
      case default
         if (len(value%text) > max_text) then
           message = "is longer than "//to_text(max_text)//" characters"
         end if
         if (value%text == "") message = "must not be empty"
         is_right = .true.
      end select
      if (.not. is_right) message = "must be "//allowed_text(rule)
   end subroutine check_value

   !> Rule of a variable.
   pure function rule_of(deck, group, variable) result(rule)
      !> Scanned deck.
      type(deck_type), intent(in) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Variable name, which the schema must know.
      character(len=*), intent(in) :: variable
      type(variable_rule_type) :: rule

      rule = variable_rules(find_variable(deck%groups(group)%name, variable))
   end function rule_of

end module coulter_deck_variable
