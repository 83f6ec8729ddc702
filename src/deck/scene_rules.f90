!> Variables of decks that say what there is: grid, laws, bodies and how they meet.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_scene_rules
   use coulter_deck_rule, only: required, variable_rule_type
   use coulter_law, only: law_models, law_parameters
   implicit none(type, external)
   private
   public :: scene_rules, law_rules, body_rules, contact_rules, umat_parameters

   !> Kinds of law: words of `law_models`, with blanks between, and user materials.
   character(len=*), parameter :: law_words = transfer(law_models%word, repeat(" ", &
      size(law_models)*len(law_models%word)))//" umat"
   !> Parameters of user materials alone.
   character(len=*), parameter :: umat_parameters(*) = [character(len=15) :: &
      "library", "constants", "n_state", "initial_state", "umat_components", "material"]
   integer, private :: i

   !> Title and grid.
   type(variable_rule_type), parameter :: scene_rules(*) = [ &
      variable_rule_type("scene", "title", "text", 1, 1, "", "(none)", "", &
         "one line that describes the scene"), &
      variable_rule_type("scene", "length_unit", "text", 1, 1, "", "(none)", "", &
         "label of lengths, such as 'mm'"), &
      variable_rule_type("scene", "stress_unit", "text", 1, 1, "", "(none)", "", &
         "label of stresses, such as 'MPa'"), &
      variable_rule_type("scene", "force_unit", "text", 1, 1, "", "(none)", "", &
         "label of forces, such as 'N'"), &
      variable_rule_type("grid", "origin", "real", 2, 2, "length", required, "", &
         "lower left corner of the grid, within 1.0e7 cells of (0, 0)"), &
      variable_rule_type("grid", "spacing", "real", 1, 2, "length", required, "> 0", &
         "edge of a cell: one value for both directions, or one each"), &
      variable_rule_type("grid", "cells", "integer", 2, 2, "", required, ">= 1 <= 1000000", &
         "number of cells along x and y")]

   !> Constitutive laws.
   type(variable_rule_type), parameter :: law_rules(*) = [ &
      variable_rule_type("law", "name", "text", 1, 1, "", required, "", &
         "name by which bodies refer to the law"), &
      variable_rule_type("law", "model", "choice", 1, 1, "", "'hencky'", law_words, &
         "kind of law; the table below says which parameters it takes"), &
      (variable_rule_type("law", law_parameters(i)%name, "real", law_parameters(i)%least, &
                          law_parameters(i)%most, law_parameters(i)%unit, &
                          law_parameters(i)%default, law_parameters(i)%range, &
                          law_parameters(i)%meaning), i=1, size(law_parameters)), &
      variable_rule_type("law", "water_bulk_modulus", "real", 1, 1, "stress", "(no water)", "> 0", &
         "undrained by effective stress: bulk modulus of the pore water over the porosity"), &
      variable_rule_type("law", "library", "text", 1, 1, "", "(umat only)", "", &
         "shared library of an Abaqus UMAT; its path starts at the folder of the deck"), &
      variable_rule_type("law", "constants", "real", 1, 1000, "", "(none)", "", &
         "umat: material constants, PROPS"), &
      variable_rule_type("law", "n_state", "integer", 1, 1, "", "0", ">= 0 <= 10000", &
         "umat: number of state variables, NSTATV"), &
      variable_rule_type("law", "initial_state", "real", 1, 1000, "", "(zeros)", "", &
         "umat: the first state variables at the start; the others are zero"), &
      variable_rule_type("law", "umat_components", "integer", 1, 1, "", "4", ">= 4 <= 6", &
         "umat: stress components, NTENS: 4, or 6 for one that knows three dimensions only"), &
      variable_rule_type("law", "material", "text", 1, 1, "", "(name)", "", &
         "umat: name that the library is told, CMNAME")]

   !> Bodies, their stress at the start, and what they fill.
   type(variable_rule_type), parameter :: body_rules(*) = [ &
      variable_rule_type("body", "name", "text", 1, 1, "", required, "", &
         "name by which regions refer to the body"), &
      variable_rule_type("body", "law", "text", 1, 1, "", required, "", "name of its law"), &
      variable_rule_type("body", "density", "real", 1, 1, "mass/volume", required, ">= 0", &
         "mass per volume of the undeformed body"), &
      variable_rule_type("body", "points_per_cell", "integer", 1, 1, "", "(cpdi2: 1, else 2)", &
         ">= 1 <= 8", "material points per cell in each direction"), &
      variable_rule_type("body", "initial_stress", "real", 4, 4, "stress", "4*0.0", "", &
         "Cauchy stress xx, yy, zz, xy at the start, tension positive"), &
      variable_rule_type("body", "k0", "real", 1, 1, "", "(none)", ">= 0", &
         "instead: horizontal over vertical stress at the start, which the weight above makes"), &
      variable_rule_type("body", "overburden", "real", 1, 1, "stress", "(0.0)", ">= 0", &
         "pressure on the ground above, beside the weight; belongs to k0"), &
      variable_rule_type("stress_profile", "body", "text", 1, 1, "", required, "", &
         "name of the body whose stress it is"), &
      variable_rule_type("stress_profile", "elevation", "real", 1, 250, "length", required, "", &
         "elevations y, increasing; linear between them and constant beyond"), &
      variable_rule_type("stress_profile", "stress", "real", 4, 1000, "stress", required, "", &
         "Cauchy stress xx, yy, zz, xy at the first elevation, at the second, ..."), &
      variable_rule_type("region", "body", "text", 1, 1, "", required, "", &
         "name of the body to which the region belongs"), &
      variable_rule_type("region", "rectangle", "real", 4, 4, "length", "(or polygon)", "", &
         "left, bottom, right and top: x0, y0, x1, y1"), &
      variable_rule_type("region", "polygon", "real", 6, 1000, "length", "(or rectangle)", "", &
         "corners x1, y1, x2, y2, ... of a polygon that does not cross itself, in either " &
         //"orientation")]

   !> Surfaces that press and rub.
   type(variable_rule_type), parameter :: contact_rules(*) = [ &
      variable_rule_type("contact", "body", "text", 1, 1, "", required, "", &
         "name of one body, whose force by the other is reported"), &
      variable_rule_type("contact", "against", "text", 1, 1, "", required, "", &
         "name of the other body, or of the same for its surfaces among themselves"), &
      variable_rule_type("contact", "friction", "real", 1, 1, "", "0.0", ">= 0", &
         "coefficient of Coulomb friction"), &
      variable_rule_type("contact", "adhesion", "real", 1, 1, "stress", "0.0", ">= 0", &
         "shear beside friction; in full from a pressure of a third of it on"), &
      variable_rule_type("contact", "shear_limit", "real", 1, 1, "stress", "(none)", "> 0", &
         "largest shear, such as a share of the undrained strength"), &
      variable_rule_type("contact", "rough", "logical", 1, 1, "", ".false.", "", &
         "do both stick where they press, up to `shear_limit`?"), &
      variable_rule_type("contact", "band_ratio", "real", 1, 1, "", "0.1", "> 0 <= 1", &
         "penalty band over the spacing")]

end module coulter_deck_scene_rules
