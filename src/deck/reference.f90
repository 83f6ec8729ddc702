!> Writes the deck reference, docs/deck.md, from the schema.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_reference
   use coulter_deck_schema, only: allowed_text, group_rules, required, variable_rule_type, &
      variable_rules
   use coulter_law, only: law_models
   implicit none(type, external)
   private
   public :: write_deck_reference

   !> What a user must know before the tables.
   character(len=*), parameter :: introduction(*) = [character(len=92) :: &
      "# Deck reference", &
      "", &
      "A deck is a text file of Fortran namelists that describes one scene and how it is", &
      "computed: `coulter deck.nml`. This page is written by `coulter --deck-reference`.", &
      "", &
      "```fortran", &
      "&grid origin = 0.0, 0.0, spacing = 0.25, cells = 5, 5 /", &
      "&law name = 'rubber', youngs_modulus = 1000.0, poisson_ratio = 0.3 /", &
      "&body name = 'block', law = 'rubber', density = 0.0 /", &
      "&region body = 'block', rectangle = 0.0, 0.0, 1.0, 1.0 /", &
      "&fixity name = 'symmetry', side = 'left', held = 'x' /", &
      "&fixity name = 'base', side = 'bottom', held = 'y' /", &
      "&boundary                             ! pushes the top down by 0.1", &
      "   name = 'press', kind = 'roller'", &
      "   vertices = 1.25, 1.0,  0.0, 1.0    ! material on the left of the way", &
      "   displacement = 0.0, -0.1", &
      "/", &
      "&steps count = 5 /", &
      "```", &
      "", &
      "* A group starts with `&name` and ends with `/`. Groups stand in any order; objects of", &
      "  one kind are numbered in the order of the deck.", &
      "* Inside, `variable = value` or `variable = value, value, ...`, on one line or several,", &
      "  with blanks or commas between. `3*0.0` stands for three zeros.", &
      "* Texts stand in quotes, `'...'` or `""...""`, at most 120 characters on one line.", &
      "* `!` starts a comment. Upper and lower case are the same in the names of groups and", &
      "  variables and in the words of a choice; names that you give are repeated exactly.", &
      "* Any consistent units will do. Stresses are positive in tension. The scene is in plane", &
      "  strain: forces and volumes are per unit of thickness.", &
      "* All faults of a deck are reported together before anything is computed or written, and", &
      "  the exit status is 2:", &
      "", &
      "```", &
      "deck.nml:2: &law (rubber): poisson_ratio = 0.5: must be a real number > -1 and < 0.5", &
      "```"]

contains

   !> Write the reference as Markdown.
   subroutine write_deck_reference(unit)
      !> Unit to write to.
      integer, intent(in) :: unit
      integer :: i, k

      do i = 1, size(introduction)
         write (unit, "(a)") trim(introduction(i))
      end do
      do k = 1, size(group_rules)
         write (unit, "(a)") "", "## &"//trim(group_rules(k)%name), "", &
            trim(group_rules(k)%meaning)//" Stands "//times(group_rules(k)%number)//".", "", &
            "| variable | takes | unit | default | meaning |", "|---|---|---|---|---|"
         do i = 1, size(variable_rules)
            if (variable_rules(i)%group == group_rules(k)%name) then
              write (unit, "(a)") table_row(variable_rules(i))
            end if
         end do
         if (group_rules(k)%name == "law") call write_law_models(unit)
      end do
   end subroutine write_deck_reference

   !> What parameters the kinds of law take.
   subroutine write_law_models(unit)
      integer, intent(in) :: unit
      integer :: i

      write (unit, "(a)") "", "| model | is | needs | takes |", "|---|---|---|---|"
      do i = 1, size(law_models)
         write (unit, "(a)") "| `"//trim(law_models(i)%word)//"` | "//trim(law_models(i)%meaning) &
            //" | "//trim(law_models(i)%needs)//" | "//trim(law_models(i)%takes)//" |"
      end do
      write (unit, "(a)") "| `umat` | an Abaqus UMAT | library | constants n_state initial_state" &
         //" umat_components material, youngs_modulus with poisson_ratio |"
   end subroutine write_law_models

   !> "0 or 1" -> "at most once".
   pure function times(number) result(text)
      character(len=*), intent(in) :: number
      character(len=:), allocatable :: text

      select case (number)
      case ("1")
         text = "exactly once"
      case ("0 or 1")
         text = "at most once"
      case ("1 or more")
         text = "once or more often"
      case default
         text = "any number of times"
      end select
   end function times

   !> Row of the table of a group.
   pure function table_row(rule) result(row)
      type(variable_rule_type), intent(in) :: rule
      character(len=:), allocatable :: row
      character(len=:), allocatable :: default

      default = trim(rule%default)
      if (default == required) default = "**required**"
      if (verify(default(:1), "*(") > 0) default = "`"//default//"`"
      row = "| `"//trim(rule%name)//"` | "//allowed_text(rule)//" | "//trim(rule%unit)//" | " &
         //default//" | "//trim(rule%meaning)//" |"
   end function table_row

end module coulter_deck_reference
