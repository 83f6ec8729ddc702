!> A deck as groups of assignments that know where they stand, and the description of its faults.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_document
   use coulter_base_faults, only: fault_list_type, fault_type
   use coulter_base_text, only: to_text
   implicit none(type, external)
   private
   public :: deck_type, group_type, assignment_type
   public :: find_groups, first_group, find_assignment, group_label
   public :: blame, blame_line, describe_faults

   !> One `name = values`.
   type :: assignment_type
      !> Variable, lower case.
      character(len=:), allocatable :: name
      !> Values as written, separated by a comma and a blank.
      character(len=:), allocatable :: value
      !> Number of values, repeat counts unrolled; 0 if one is empty or none is there, -1 if their
      !> fault has been noted.
      integer :: n_values = 0
      !> Line of the name, from 1.
      integer :: line = 0
   end type assignment_type

   !> One `&name ... /`.
   type :: group_type
      !> Group name, lower case.
      character(len=:), allocatable :: name
      !> Name of the object that it describes, or of the body of a region; empty if none.
      character(len=:), allocatable :: object
      !> Number among the groups of this name, from 1.
      integer :: instance = 0
      !> Is it the only group of its name?
      logical :: is_alone = .true.
      !> Line of the `&`, from 1.
      integer :: line = 0
      !> May assignments be lost, so that missing ones say nothing?
      logical :: is_broken = .false.
      !> What it assigns, in the order of the deck.
      type(assignment_type), allocatable :: assignments(:)
   end type group_type

   !> A deck and all that is wrong with it.
   type :: deck_type
      !> Path of the file.
      character(len=:), allocatable :: path
      !> Full text, as it stands in the file.
      character(len=:), allocatable :: text
      !> Groups in the order of the deck.
      type(group_type), allocatable :: groups(:)
      !> Number of every region among the `&region` groups; regions in the order of the model:
      !> body by body, shape (n_regions).
      integer, allocatable :: region_order(:)
      !> Faults found so far. One without group name concerns the line `instance`.
      type(fault_list_type) :: faults
   end type deck_type

   !> Longest value that is repeated in a message.
   integer, parameter :: max_shown = 60

contains

   !> Numbers of the groups that bear a name, in the order of the deck.
   pure subroutine find_groups(deck, name, numbers)
      !> Scanned deck.
      type(deck_type), intent(in) :: deck
      !> Group name, lower case.
      character(len=*), intent(in) :: name
      !> Their numbers in the deck.
      integer, allocatable, intent(out) :: numbers(:)
      integer :: i

      allocate (numbers(0))
      do i = 1, size(deck%groups)
         if (deck%groups(i)%name == name) numbers = [numbers, i]
      end do
   end subroutine find_groups

   !> Number of the first group that bears a name; 0 if there is none.
   pure function first_group(deck, name) result(number)
      !> Scanned deck.
      type(deck_type), intent(in) :: deck
      !> Group name, lower case.
      character(len=*), intent(in) :: name
      integer :: number

      do number = 1, size(deck%groups)
         if (deck%groups(number)%name == name) return
      end do
      number = 0
   end function first_group

   !> Number of the assignment to a variable in a group; 0 if there is none.
   pure function find_assignment(group, variable) result(number)
      !> Group to search.
      type(group_type), intent(in) :: group
      !> Variable name, lower case.
      character(len=*), intent(in) :: variable
      integer :: number

      do number = 1, size(group%assignments)
         if (group%assignments(number)%name == variable) return
      end do
      number = 0
   end function find_assignment

   !> How messages call a group: "&body #2 (soil)".
   pure function group_label(group) result(label)
      !> Group of a scanned deck.
      type(group_type), intent(in) :: group
      character(len=:), allocatable :: label

      label = "&"//group%name
      if (.not. group%is_alone) label = label//" #"//to_text(group%instance)
      if (group%object /= "") label = label//" ("//group%object//")"
   end function group_label

   !> Note a fault of a variable, or of a whole group.
   pure subroutine blame(deck, group, variable, message)
      !> Deck that notes it.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Variable at fault; empty when it is the group.
      character(len=*), intent(in) :: variable
      !> What is wrong and what would be allowed.
      character(len=*), intent(in) :: message

      associate (at => deck%groups(group))
         call deck%faults%add(at%name, at%instance, variable, message)
      end associate
   end subroutine blame

   !> Note a fault that belongs to a line rather than to a variable.
   pure subroutine blame_line(deck, line, message)
      !> Deck that notes it.
      type(deck_type), intent(inout) :: deck
      !> Line number; 0 when the fault concerns the whole deck.
      integer, intent(in) :: line
      !> What is wrong and what would be allowed.
      character(len=*), intent(in) :: message

      call deck%faults%add("", line, "", message)
   end subroutine blame_line

   !> All faults, one line each without a newline at the end, in the order of the deck:
   !> `file:line: &group #k (name): variable = value: what is allowed`.
   pure function describe_faults(deck, faults) result(text)
      !> Deck in which they are.
      type(deck_type), intent(in) :: deck
      !> Faults of the deck or of the model that was read from it.
      type(fault_list_type), intent(in) :: faults
      character(len=:), allocatable :: text
      character(len=:), allocatable :: description
      integer, allocatable :: lines(:)
      integer :: i, next

      allocate (lines(faults%n_faults))
      do i = 1, faults%n_faults
         call locate(deck, faults%items(i), lines(i))
      end do
      text = ""
      do i = 1, faults%n_faults
         next = minloc(lines, dim=1)
         call locate(deck, faults%items(next), lines(next), description)
         if (i > 1) text = text//new_line("")
         text = text//deck%path//":"
         if (lines(next) > 0) text = text//to_text(lines(next))//":"
         text = text//" "//description
         lines(next) = huge(1)
      end do
   end function describe_faults

   !> Line to which a fault points, 0 for none, and its description.
   pure subroutine locate(deck, fault, line, description)
      type(deck_type), intent(in) :: deck
      type(fault_type), intent(in) :: fault
      integer, intent(out) :: line
      character(len=:), allocatable, intent(out), optional :: description
      character(len=:), allocatable :: place
      integer :: i

      i = 0
      if (fault%group == "") then
         line = fault%instance
         place = ""
      else
         i = group_of(deck, fault)
         line = 0
         place = "&"//fault%group//": "
         if (fault%variable /= "") place = place//fault%variable//": "
      end if
      if (i > 0) call locate_in_group(deck%groups(i), fault%variable, line, place)
      if (present(description)) description = place//fault%message
   end subroutine locate

   !> Number of the group in the deck that a fault concerns: the first of its name when it concerns
   !> all of them, 0 when there is none.
   pure function group_of(deck, fault) result(number)
      type(deck_type), intent(in) :: deck
      type(fault_type), intent(in) :: fault
      integer :: number
      integer, allocatable :: candidates(:)
      integer :: instance

      call find_groups(deck, fault%group, candidates)
      instance = max(fault%instance, 1)
      if (fault%group == "region" .and. allocated(deck%region_order)) then
         if (instance <= size(deck%region_order)) instance = deck%region_order(instance)
      end if
      number = 0
      if (instance <= size(candidates)) number = candidates(instance)
   end function group_of

   !> Line of a variable in its group, and the words by which it is called.
   pure subroutine locate_in_group(group, variable, line, place)
      type(group_type), intent(in) :: group
      character(len=*), intent(in) :: variable
      integer, intent(out) :: line
      character(len=:), allocatable, intent(out) :: place
      integer :: i

      line = group%line
      place = group_label(group)//": "
      if (variable == "") return
      place = place//variable
      i = find_assignment(group, variable)
      if (i > 0) then
         line = group%assignments(i)%line
         if (group%assignments(i)%value /= "") then
            place = place//" = "//shortened(group%assignments(i)%value)
         end if
      end if
      place = place//": "
   end subroutine locate_in_group

   !> The beginning of a long text.
   pure function shortened(text) result(short)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: short

      short = text
      if (len(text) > max_shown) short = text(:max_shown - 4)//" ..."
   end function shortened

end module coulter_deck_document
