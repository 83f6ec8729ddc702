!> What a deck may hold: every group and variable with its type, range and meaning.
!>
!> The checks, the messages and the deck reference all come from these tables. A new variable is
!> one entry in `scene_rules`, `boundary_rules` or `run_rules` and one line where its group is read.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_schema
   use coulter_base_text, only: lower_case, split_words, to_text
   use coulter_deck_boundary_rules, only: boundary_rules, motion_rules, tool_rules
   use coulter_deck_rule, only: group_rule_type, required, variable_rule_type
   use coulter_deck_run_rules, only: run_rules, sample_rules, step_rules
   use coulter_deck_scene_rules, only: body_rules, contact_rules, law_rules, scene_rules, &
      umat_parameters
   implicit none(type, external)
   private
   public :: group_rule_type, variable_rule_type, group_rules, variable_rules, required
   public :: find_variable, choice_number, allowed_text, count_text, max_text, umat_parameters

   !> Longest text that a variable may hold.
   integer, parameter :: max_text = 120

   !> Groups in the order of the deck reference.
   type(group_rule_type), parameter :: group_rules(*) = [ &
      group_rule_type("scene", "0 or 1", "Title and labels of the units for logs and plots."), &
      group_rule_type("grid", "1", "The background grid: a box of equal cells."), &
      group_rule_type("law", "1 or more", "A constitutive law."), &
      group_rule_type("body", "1 or more", "A solid of one law, to be filled with points."), &
      group_rule_type("stress_profile", "any number", &
                      "Stress of a body before the first step, by elevation."), &
      group_rule_type("region", "1 or more", "What a body fills: a rectangle or polygon each." &
                      //" With cpdi2, what touches without &contact bonds."), &
      group_rule_type("contact", "any number", &
                      "Surfaces of two bodies, or of one, that press and rub; needs cpdi2."), &
      group_rule_type("fixity", "any number", "Zero displacement at grid nodes."), &
      group_rule_type("boundary", "any number", &
                      "An implicit boundary: a polyline that need not match the grid."), &
      group_rule_type("tool", "any number", &
                      "A rigid tool that pushes and rubs, moves and turns; needs cpdi2."), &
      group_rule_type("motion", "any number", &
                      "A part of the way of a tool or boundary, beside its own."), &
      group_rule_type("edge_load", "any number", &
                      "A traction or pressure on edges of bodies; needs cpdi2."), &
      group_rule_type("body_force", "0 or 1", "A force per unit mass, such as gravity."), &
      group_rule_type("table", "any number", &
                      "A factor over time: piecewise linear, or a wave."), &
      group_rule_type("steps", "1 or &phase", "The load steps: either `count` or `end_times`."), &
      group_rule_type("phase", "any number", &
                      "A part of a run, in the order of the deck, with steps of its own."), &
      group_rule_type("control", "0 or 1", "How a load step is solved."), &
      group_rule_type("output", "0 or 1", "When results are written, and how."), &
      group_rule_type("sample", "any number", &
                      "A soil sample for `coulter point`: one material point of a law."), &
      group_rule_type("stage", "any number", "A stage of the test on a sample; they run in order.")]

   !> All variables, group by group in the order of the groups.
   type(variable_rule_type), parameter :: variable_rules(*) = &
      [scene_rules, law_rules, body_rules, contact_rules, boundary_rules, tool_rules, &
       motion_rules, step_rules, run_rules, sample_rules]

contains

   !> Number of the rule of a variable; 0 if there is none.
   pure function find_variable(group, name) result(number)
      !> Group name, lower case.
      character(len=*), intent(in) :: group
      !> Variable name, lower case.
      character(len=*), intent(in) :: name
      integer :: number

      do number = 1, size(variable_rules)
         if (variable_rules(number)%group /= group) cycle
         if (variable_rules(number)%name == name) return
      end do
      number = 0
   end function find_variable

   !> Number of a word among the choices of a variable, in upper or lower case; 0 if it is none.
   pure function choice_number(rule, word) result(number)
      !> Rule of a variable of type "choice".
      type(variable_rule_type), intent(in) :: rule
      !> Word to find.
      character(len=*), intent(in) :: word
      integer :: number
      character(len=16), allocatable :: choices(:)

      call split_words(rule%range, choices)
      do number = 1, size(choices)
         if (choices(number) == lower_case(word)) return
      end do
      number = 0
   end function choice_number

   !> What a variable may hold, in words: "a real number > 0", "'x', 'y' or 'xy'".
   pure function allowed_text(rule) result(text)
      !> Rule of the variable.
      type(variable_rule_type), intent(in) :: rule
      character(len=:), allocatable :: text
      character(len=16), allocatable :: words(:)
      integer :: i

      call split_words(rule%range, words)
      select case (rule%type)
      case ("choice")
         text = "'"//trim(words(1))//"'"
         do i = 2, size(words)
            text = text//trim(merge(" or", ",  ", i == size(words)))//" '"//trim(words(i))//"'"
         end do
         return
      case ("text")
         text = "a text in quotes"
      case ("logical")
         text = ".true. or .false."
      case ("integer")
         text = "an integer"
         if (rule%most > 1) text = count_text(rule)//" integers"
      case default
         text = "a real number"
         if (rule%most > 1) text = count_text(rule)//" real numbers"
      end select
      do i = 1, size(words), 2
         if (i > 1) text = text//" and"
         text = text//" "//trim(words(i))//" "//trim(words(i + 1))
      end do
   end function allowed_text

   !> How many values a variable takes: "1", "1 or 2", "6 to 1000".
   pure function count_text(rule) result(text)
      !> Rule of the variable.
      type(variable_rule_type), intent(in) :: rule
      character(len=:), allocatable :: text

      text = to_text(rule%least)
      if (rule%most == rule%least + 1) text = text//" or "//to_text(rule%most)
      if (rule%most > rule%least + 1) text = text//" to "//to_text(rule%most)
   end function count_text

end module coulter_deck_schema
