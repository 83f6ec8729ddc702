!> Cuts the text of a deck into words and signs, without blanks and comments.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_tokens
   implicit none(type, external)
   private
   public :: token_type, cut_tokens, token_text
   public :: token_word, token_group, token_equals, token_comma, token_slash, token_open_quote

   !> A name or value, quoted texts included.
   integer, parameter :: token_word = 1
   !> The word that opens a group: `&name`.
   integer, parameter :: token_group = 2
   !> The sign `=`.
   integer, parameter :: token_equals = 3
   !> The sign `,`.
   integer, parameter :: token_comma = 4
   !> The sign `/`, which ends a group.
   integer, parameter :: token_slash = 5
   !> A word whose quote is still open at the end of its line.
   integer, parameter :: token_open_quote = 6

   !> A word or sign.
   type :: token_type
      !> One of `token_*`.
      integer :: kind = token_word
      !> Place of its first character in the text.
      integer :: first = 0
      !> Place of its last character in the text.
      integer :: last = 0
      !> Line on which it stands, from 1.
      integer :: line = 0
   end type token_type

   character(len=*), parameter :: newline = achar(10)
   character(len=*), parameter :: blanks = " "//achar(9)//achar(13)
   character(len=*), parameter :: quotes = "'"""
   !> What ends a word outside quotes.
   character(len=*), parameter :: word_ends = blanks//newline//"=,/!"

contains

   !> Cut a text into tokens.
   pure subroutine cut_tokens(text, tokens)
      !> Text with line ends.
      character(len=*), intent(in) :: text
      !> Its words and signs in their order.
      type(token_type), allocatable, intent(out) :: tokens(:)
      type(token_type), allocatable :: found(:)
      integer :: n, i, line

      allocate (found(len(text)))
      n = 0
      i = 1
      line = 1
      do while (i <= len(text))
         if (text(i:i) == newline) then
            line = line + 1
         else if (text(i:i) == "!") then
            i = end_of_line(text, i)
         else if (scan(text(i:i), blanks) == 0) then
            n = n + 1
            found(n) = token_at(text, i, line)
            i = found(n)%last
         end if
         i = i + 1
      end do
      tokens = found(:n)
   end subroutine cut_tokens

   !> Text of a token.
   pure function token_text(text, token) result(word)
      !> Text that was cut.
      character(len=*), intent(in) :: text
      !> One of its tokens.
      type(token_type), intent(in) :: token
      character(len=:), allocatable :: word

      word = text(token%first:token%last)
   end function token_text

   !> The token that begins at a place.
   pure function token_at(text, first, line) result(token)
      character(len=*), intent(in) :: text
      integer, intent(in) :: first, line
      type(token_type) :: token

      token = token_type(token_word, first, first, line)
      select case (text(first:first))
      case ("=")
         token%kind = token_equals
      case (",")
         token%kind = token_comma
      case ("/")
         token%kind = token_slash
      case default
         if (text(first:first) == "&") token%kind = token_group
         call find_word_end(text, token)
      end select
   end function token_at

   !> Last character of the word that begins at `token%first`; separators in quotes belong to it.
   pure subroutine find_word_end(text, token)
      character(len=*), intent(in) :: text
      type(token_type), intent(inout) :: token
      character(len=1) :: quote
      integer :: i

      quote = " "
      do i = token%first, end_of_line(text, token%first)
         if (quote /= " ") then
            if (text(i:i) == quote) quote = " "
         else if (scan(text(i:i), quotes) > 0) then
            quote = text(i:i)
         else if (scan(text(i:i), word_ends) > 0) then
            exit
         end if
         token%last = i
      end do
      if (quote /= " ") token%kind = token_open_quote
   end subroutine find_word_end

   !> Place of the last character of the line to which a place belongs, without the line end.
   pure function end_of_line(text, place) result(last)
      character(len=*), intent(in) :: text
      integer, intent(in) :: place
      integer :: last

      last = index(text(place:), newline)
      last = merge(len(text), place + last - 2, last == 0)
   end function end_of_line

end module coulter_deck_tokens
