!> What a deck may hold, as one row of a table: a group, or a variable with its type and range.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_rule
   implicit none(type, external)
   private
   public :: group_rule_type, variable_rule_type, required

   !> What a group is for.
   type :: group_rule_type
      !> Name, lower case.
      character(len=14) :: name
      !> How often it stands in a deck: "1", "0 or 1", "1 or more" or "any number"; "1 or &NAME":
      !> once, unless another group stands for it.
      character(len=11) :: number
      !> What it describes.
      character(len=100) :: meaning
   end type group_rule_type

   !> What a variable may hold.
   type :: variable_rule_type
      !> Group to which it belongs.
      character(len=14) :: group
      !> Name, lower case.
      character(len=21) :: name
      !> "real", "integer", "logical", "text" (any text) or "choice" (one of the words in `range`).
      character(len=7) :: type
      !> Least number of values.
      integer :: least
      !> Largest number of values.
      integer :: most
      !> Unit; empty for a pure number.
      character(len=13) :: unit
      !> Default as written in a deck, `required`, or a remark in parentheses.
      character(len=20) :: default
      !> Conditions such as "> 0 <= 1", or the words of a choice; empty if all is allowed.
      character(len=200) :: range
      !> What it means.
      character(len=110) :: meaning
   end type variable_rule_type

   !> Default of a variable that has none.
   character(len=*), parameter :: required = "required"

end module coulter_deck_rule
