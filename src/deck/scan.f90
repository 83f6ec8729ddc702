!> Cuts a deck into groups and assignments, and notes what is not written as a namelist should be.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_scan
   use coulter_base_text, only: lower_case
   use coulter_deck_document, only: assignment_type, blame_line, deck_type, group_type
   use coulter_deck_tokens, only: cut_tokens, token_comma, token_equals, token_group, &
      token_open_quote, token_slash, token_text, token_type
   implicit none(type, external)
   private
   public :: scan_deck

   character(len=*), parameter :: name_characters = "abcdefghijklmnopqrstuvwxyz0123456789_"
   !> More values than this are not counted.
   integer, parameter :: max_values = 10**9

contains

   !> Fill `deck%groups` from `deck%text`.
   pure subroutine scan_deck(deck)
      !> Deck whose path and text are known.
      type(deck_type), intent(inout) :: deck
      type(token_type), allocatable :: tokens(:)
      integer, allocatable :: starts(:)
      integer :: k

      call cut_tokens(deck%text, tokens)
      call find_tokens(tokens, token_group, starts)
      starts = [starts, size(tokens) + 1]
      call check_outside(deck, tokens(:starts(1) - 1), 0)
      allocate (deck%groups(size(starts) - 1))
      do k = 1, size(deck%groups)
         call scan_group(deck, tokens(starts(k):starts(k + 1) - 1), k)
      end do
      do k = 1, size(deck%groups)
         call number_group(deck%groups, k)
      end do
   end subroutine scan_deck

   !> Make one group from the tokens from its `&` to the next.
   pure subroutine scan_group(deck, tokens, number)
      type(deck_type), intent(inout) :: deck
      type(token_type), intent(in) :: tokens(:)
      integer, intent(in) :: number
      type(group_type) :: group
      integer :: slash

      group%name = lower_case(token_text(deck%text, tokens(1)))
      group%name = group%name(2:)
      group%line = tokens(1)%line
      slash = findloc(tokens%kind, token_slash, dim=1)
      if (slash == 0) then
         call scan_assignments(deck, group, tokens(2:))
         if (all(tokens%kind /= token_open_quote)) then
           call blame_line(deck, group%line, "&"//group%name//" is not ended by a /")
         end if
         group%is_broken = .true.
      else
         call scan_assignments(deck, group, tokens(2:slash - 1))
         call check_outside(deck, tokens(slash + 1:), tokens(slash)%line, group)
      end if
      deck%groups(number) = group
   end subroutine scan_group

   !> Note text that stands behind the end of a group, or before the first one.
   pure subroutine check_outside(deck, tokens, slash_line, group)
      type(deck_type), intent(inout) :: deck
      !> What stands there.
      type(token_type), intent(in) :: tokens(:)
      !> Line of the / before it, 0 if none.
      integer, intent(in) :: slash_line
      !> Group before it, which may have ended too early.
      type(group_type), intent(inout), optional :: group
      character(len=:), allocatable :: message
      integer :: n

      if (size(tokens) == 0) return
      message = """"//token_text(deck%text, tokens(1))//""" stands outside all groups"
      if (scan(token_text(deck%text, tokens(1)), "#%/;-") == 1) then
         message = message//"; comments begin with !"
      end if
      if (present(group)) then
         if (group%is_broken) return
         group%is_broken = .true.
         if (tokens(1)%line == slash_line) then
            message = "a / ends the group &"//group%name//", but """ &
               //token_text(deck%text, tokens(1))//""" follows it; write quotients as numbers, " &
               //"texts in quotes, and ! before comments"
            n = size(group%assignments)
            if (n > 0) group%assignments(n)%n_values = -1
         end if
      end if
      call blame_line(deck, tokens(1)%line, message)
   end subroutine check_outside

   !> Make the assignments of a group from the tokens between its name and its /.
   pure subroutine scan_assignments(deck, group, tokens)
      type(deck_type), intent(inout) :: deck
      type(group_type), intent(inout) :: group
      type(token_type), intent(in) :: tokens(:)
      integer, allocatable :: signs(:)
      integer :: i, k, last

      call find_tokens(tokens, token_equals, signs)
      allocate (group%assignments(size(signs)))
      last = size(tokens)
      if (size(signs) > 0) last = signs(1) - 2
      if (last >= 1) then
         call blame_token(deck, group, tokens(1), "stands before the first variable = value")
      end if
      do k = 1, size(signs)
         i = signs(k)
         last = size(tokens)
         if (k < size(signs)) last = signs(k + 1) - 2
         call read_name(deck, group, tokens(max(i - 1, 1)), group%assignments(k))
         call read_values(deck, group, tokens(i + 1:last), group%assignments(k))
      end do
   end subroutine scan_assignments

   !> Name of a variable, from the token before its equals sign.
   pure subroutine read_name(deck, group, token, assignment)
      type(deck_type), intent(inout) :: deck
      type(group_type), intent(inout) :: group
      type(token_type), intent(in) :: token
      type(assignment_type), intent(inout) :: assignment

      assignment%line = token%line
      assignment%name = lower_case(token_text(deck%text, token))
      if (verify(assignment%name, name_characters) == 0) return
      assignment%name = ""
      if (token%kind == token_open_quote) return
      if (scan(token_text(deck%text, token), "()") > 0) then
         call blame_token(deck, group, token, "has a subscript; give all values at once, as in " &
                          //"origin = 0.0, 1.0")
      else
         call blame_token(deck, group, token, "stands where the name of a variable should be")
      end if
   end subroutine read_name

   !> Values of a variable, from the tokens behind its equals sign.
   pure subroutine read_values(deck, group, tokens, assignment)
      type(deck_type), intent(inout) :: deck
      type(group_type), intent(inout) :: group
      type(token_type), intent(in) :: tokens(:)
      type(assignment_type), intent(inout) :: assignment
      character(len=:), allocatable :: word
      integer :: i
      logical :: is_complete, is_expected

      assignment%value = ""
      is_complete = .true.
      is_expected = .true.
      do i = 1, size(tokens)
         if (tokens(i)%kind == token_comma) then
            is_complete = is_complete .and. .not. is_expected
            is_expected = .true.
            cycle
         end if
         word = token_text(deck%text, tokens(i))
         if (assignment%value /= "") assignment%value = assignment%value//", "
         assignment%value = assignment%value//word
         assignment%n_values = min(assignment%n_values + repeat_count(word), max_values)
         is_complete = is_complete .and. index(word, "*", back=.true.) /= len(word)
         is_expected = .false.
      end do
      if (.not. is_complete) assignment%n_values = 0
      i = findloc(tokens%kind, token_open_quote, dim=1)
      if (i == 0) return
      assignment%n_values = -1
      call blame_token(deck, group, tokens(i), "has a quote that is not closed on its line")
   end subroutine read_values

   !> Places of the tokens of a kind.
   pure subroutine find_tokens(tokens, kind, places)
      type(token_type), intent(in) :: tokens(:)
      integer, intent(in) :: kind
      integer, allocatable, intent(out) :: places(:)
      integer :: i

      places = pack([(i, i=1, size(tokens))], tokens%kind == kind)
   end subroutine find_tokens

   !> 3 for "3*0.0", 1 for an ordinary value.
   pure function repeat_count(word) result(n)
      character(len=*), intent(in) :: word
      integer :: n
      integer, parameter :: max_digits = 8
      integer :: star

      n = 1
      star = index(word, "*")
      if (star < 2) return
      if (verify(word(:star - 1), "0123456789") > 0) return
      n = max_values
      if (star <= max_digits + 1) read (word(:star - 1), *) n
   end function repeat_count

   !> Note a fault of a word or sign.
   pure subroutine blame_token(deck, group, token, message)
      type(deck_type), intent(inout) :: deck
      type(group_type), intent(inout) :: group
      type(token_type), intent(in) :: token
      character(len=*), intent(in) :: message

      group%is_broken = .true.
      call blame_line(deck, token%line, "&"//group%name//": " &
                      //token_text(deck%text, token)//" "//message)
   end subroutine blame_token

   !> Count a group among those of its name, and find the name of its object.
   pure subroutine number_group(groups, number)
      type(group_type), intent(inout) :: groups(:)
      integer, intent(in) :: number
      integer :: i

      associate (group => groups(number))
         do i = 1, size(groups)
            if (groups(i)%name /= group%name) cycle
            if (i <= number) group%instance = group%instance + 1
            if (i /= number) group%is_alone = .false.
         end do
         group%object = ""
         if (group%name == "output") return
         do i = size(group%assignments), 1, -1
            associate (item => group%assignments(i))
               if (item%n_values /= 1) cycle
               if (item%name /= "name" .and. item%name /= "body") cycle
               group%object = without_quotes(item%value)
            end associate
         end do
      end associate
   end subroutine number_group

   !> What stands between quotes; empty if there are none.
   pure function without_quotes(value) result(text)
      character(len=*), intent(in) :: value
      character(len=:), allocatable :: text

      text = ""
      if (scan(value, "'""") == 1) text = trim(value(2:len(value) - 1))
   end function without_quotes

end module coulter_deck_scan
