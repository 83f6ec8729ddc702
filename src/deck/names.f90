!> Checks that a deck holds known groups and variables, each as often as it may, and none too few.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_names
   use coulter_base_text, only: lower_case, to_text
   use coulter_deck_document, only: blame, blame_line, deck_type, find_assignment, group_label, &
      group_type, find_groups
   use coulter_deck_schema, only: allowed_text, find_variable, group_rules, required, &
      variable_rules
   implicit none(type, external)
   private
   public :: check_names, suggestion

contains

   !> Note unknown, repeated and missing groups and variables.
   pure subroutine check_names(deck, needed)
      !> Scanned deck.
      type(deck_type), intent(inout) :: deck
      !> Groups that must be there, for decks that describe no scene.
      character(len=*), intent(in), optional :: needed(:)
      logical :: is_needed
      integer :: i

      do i = 1, size(group_rules)
         associate (rule => group_rules(i))
            is_needed = rule%number(:1) == "1"
            if (present(needed)) is_needed = any(needed == rule%name)
            call check_number(deck, trim(rule%name), rule%number, is_needed)
         end associate
      end do
      do i = 1, size(deck%groups)
         if (is_group(deck%groups(i)%name)) then
            call check_assignments(deck, i)
            call check_required(deck, i)
            call mark_unknown(deck%groups(i))
         else
            call blame_line(deck, deck%groups(i)%line, "&"//deck%groups(i)%name &
                            //" is no group of a deck"//suggestion(deck%groups(i)%name, &
                                                                   group_rules%name))
         end if
      end do
   end subroutine check_names

   !> Note a group that is missing or stands too often.
   pure subroutine check_number(deck, name, number, is_needed)
      type(deck_type), intent(inout) :: deck
      character(len=*), intent(in) :: name
      !> How often it may stand, see `group_rule_type`.
      character(len=*), intent(in) :: number
      logical, intent(in) :: is_needed
      integer, allocatable :: found(:)
      integer :: i, substitute

      call find_groups(deck, name, found)
      if (size(found) == 0 .and. is_needed) then
         substitute = index(number, "&")
         if (substitute > 0) then
            call find_groups(deck, trim(number(substitute + 1:)), found)
            if (size(found) > 0) return
         end if
         do i = 1, size(deck%groups)
            if (closest_name(deck%groups(i)%name, group_rules%name) == name) return
         end do
         call deck%faults%add(name, 0, "", "is missing from the deck")
      else if (number == "1" .or. number == "0 or 1" .or. index(number, "&") > 0) then
         do i = 2, size(found)
            call blame(deck, found(i), "", "may stand only once; the first is on line " &
                       //to_text(deck%groups(found(1))%line))
         end do
      end if
   end subroutine check_number

   !> Note unknown, repeated and empty assignments of a group.
   pure subroutine check_assignments(deck, number)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: number
      integer :: i, first

      associate (items => deck%groups(number)%assignments)
         do i = 1, size(items)
            if (items(i)%name == "") cycle
            first = find_assignment(deck%groups(number), items(i)%name)
            if (find_variable(deck%groups(number)%name, items(i)%name) == 0) then
               call blame(deck, number, items(i)%name, "is no variable of this group" &
                          //suggestion(items(i)%name, variables_of(deck%groups(number)%name)))
            else if (first < i) then
               call blame_line(deck, items(i)%line, group_label(deck%groups(number))//": " &
                               //items(i)%name//": is given twice, first on line " &
                               //to_text(items(first)%line))
            else if (items(i)%n_values == 0 .and. items(i)%value == "") then
               call blame(deck, number, items(i)%name, "has no value")
            else if (items(i)%n_values == 0) then
               call blame(deck, number, items(i)%name, "has an empty value between its commas")
            end if
         end do
      end associate
   end subroutine check_assignments

   !> Note variables that a group needs and lacks, unless a misspelt one may be meant.
   pure subroutine check_required(deck, number)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: number
      integer :: i

      if (deck%groups(number)%is_broken) return
      do i = 1, size(variable_rules)
         associate (rule => variable_rules(i))
            if (rule%group /= deck%groups(number)%name .or. rule%default /= required) cycle
            if (find_assignment(deck%groups(number), trim(rule%name)) > 0) cycle
            if (is_misspelt(deck%groups(number), trim(rule%name))) cycle
            call blame(deck, number, trim(rule%name), "is missing; it takes "//allowed_text(rule))
         end associate
      end do
   end subroutine check_required

   !> Mark a group as broken when it holds an unknown variable: a known one may be meant.
   pure subroutine mark_unknown(group)
      type(group_type), intent(inout) :: group
      integer :: i

      do i = 1, size(group%assignments)
         if (find_variable(group%name, group%assignments(i)%name) == 0) group%is_broken = .true.
      end do
   end subroutine mark_unknown

   !> Does a group hold an unknown variable that resembles a known one?
   pure function is_misspelt(group, variable)
      type(group_type), intent(in) :: group
      character(len=*), intent(in) :: variable
      logical :: is_misspelt
      integer :: i

      is_misspelt = .false.
      do i = 1, size(group%assignments)
         if (find_variable(group%name, group%assignments(i)%name) > 0) cycle
         is_misspelt = is_misspelt &
            .or. closest_name(group%assignments(i)%name, variables_of(group%name)) == variable
      end do
   end function is_misspelt

   !> Is there a group of this name?
   pure function is_group(name)
      character(len=*), intent(in) :: name
      logical :: is_group

      is_group = any(group_rules%name == name)
   end function is_group

   !> Names of the variables of a group.
   pure function variables_of(group) result(names)
      character(len=*), intent(in) :: group
      character(len=len(variable_rules%name)), allocatable :: names(:)

      names = pack(variable_rules%name, variable_rules%group == group)
   end function variables_of

   !> "; did you mean grid?", or the list of known names when none is near.
   pure function suggestion(name, known) result(text)
      !> Name that is not known.
      character(len=*), intent(in) :: name
      !> Names that would be.
      character(len=*), intent(in) :: known(:)
      character(len=:), allocatable :: text
      integer :: i

      text = closest_name(name, known)
      if (text /= "") then
         text = "; did you mean "//text//"?"
      else if (size(known) > 0) then
         text = "; known are "//trim(known(1))
         do i = 2, size(known)
            text = text//", "//trim(known(i))
         end do
      end if
   end function suggestion

   !> The known name that differs in the fewest letters; empty when all differ much.
   pure function closest_name(name, known) result(found)
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: known(:)
      character(len=:), allocatable :: found
      integer :: i, distance, smallest

      found = ""
      smallest = max(2, len(name)/3) + 1
      do i = 1, size(known)
         distance = edit_distance(lower_case(name), lower_case(trim(known(i))))
         if (distance >= min(smallest, len(name), len_trim(known(i)))) cycle
         smallest = distance
         found = trim(known(i))
      end do
   end function closest_name

   !> Letters to insert, remove or change to turn one word into another (Levenshtein).
   pure function edit_distance(a, b) result(distance)
      character(len=*), intent(in) :: a, b
      integer :: distance
      integer :: row(0:len(b)), i, j, diagonal, above

      row = [(j, j=0, len(b))]
      do i = 1, len(a)
         diagonal = row(0)
         row(0) = i
         do j = 1, len(b)
            above = row(j)
            row(j) = min(above + 1, row(j - 1) + 1, diagonal + merge(0, 1, a(i:i) == b(j:j)))
            diagonal = above
         end do
      end do
      distance = row(len(b))
   end function edit_distance

end module coulter_deck_names
