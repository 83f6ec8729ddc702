!> What a deck may hold: every group and variable with its type, range and meaning.
!>
!> The checks, the messages and the deck reference all come from these tables. A new variable is
!> one entry here and one line where its group is read.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_schema
   use coulter_base_text, only: lower_case, split_words, to_text
   use coulter_law, only: law_models, law_parameters
   implicit none(type, external)
   private
   public :: group_rule_type, variable_rule_type, group_rules, variable_rules, required
   public :: find_variable, choice_number, allowed_text, count_text, max_text, umat_parameters

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
   !> Kinds of law: words of `law_models`, with blanks between, and user materials.
   character(len=*), parameter :: law_words = transfer(law_models%word, repeat(" ", &
      size(law_models)*len(law_models%word)))//" umat"
   !> Parameters of user materials alone.
   character(len=*), parameter :: umat_parameters(*) = [character(len=15) :: &
      "library", "constants", "n_state", "initial_state", "umat_components", "material"]
   integer, private :: i
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

   type(variable_rule_type), parameter :: boundary_rules(*) = [ &
      variable_rule_type("fixity", "name", "text", 1, 1, "", required, "", &
         "name under which the reaction is reported"), &
      variable_rule_type("fixity", "side", "choice", 1, 1, "", "(or a box)", &
         "left right bottom top", "side of the grid whose nodes are held"), &
      variable_rule_type("fixity", "lower", "real", 2, 2, "length", "(or side)", "", &
         "lower left corner of a box whose nodes are held"), &
      variable_rule_type("fixity", "upper", "real", 2, 2, "length", "(or side)", "", &
         "upper right corner of the box"), &
      variable_rule_type("fixity", "held", "choice", 1, 1, "", required, "x y xy", &
         "components of the displacement that are held"), &
      variable_rule_type("fixity", "first_phase", "text", 1, 1, "", "(first)", "", &
         "name of the first phase in which it acts"), &
      variable_rule_type("fixity", "last_phase", "text", 1, 1, "", "(last)", "", &
         "name of the last phase in which it acts"), &
      variable_rule_type("boundary", "name", "text", 1, 1, "", required, "", &
         "name under which the reaction is reported"), &
      variable_rule_type("boundary", "kind", "choice", 1, 1, "", required, &
         "roller fixed prescribed", &
         "`roller` holds the normal component; `fixed` and `prescribed` (moving) hold both"), &
      variable_rule_type("boundary", "vertices", "real", 4, 1000, "length", required, "", &
         "corners x1, y1, x2, y2, ... of the polyline"), &
      variable_rule_type("boundary", "material_side", "choice", 1, 1, "", "'left'", &
         "left right", &
         "side of the material for one who walks along the polyline"), &
      variable_rule_type("boundary", "displacement", "real", 2, 2, "length", "0.0, 0.0", "", &
         "total displacement at a table value of 1; a roller uses its normal part"), &
      variable_rule_type("boundary", "displacement_per_step", "real", 2, 2, "length", &
         "(none)", "", "the same per step, for `count` equal steps without table"), &
      variable_rule_type("boundary", "table", "text", 1, 1, "", "(ramp)", "", &
         "name of the table that schedules it; else it grows evenly over ramp_phase"), &
      variable_rule_type("boundary", "first_phase", "text", 1, 1, "", "(first)", "", &
         "name of the first phase in which it acts"), &
      variable_rule_type("boundary", "last_phase", "text", 1, 1, "", "(last)", "", &
         "name of the last phase in which it acts"), &
      variable_rule_type("boundary", "ramp_phase", "text", 1, 1, "", "(first_phase)", "", &
         "name of the phase over which it moves without a table; it need not act then"), &
      variable_rule_type("boundary", "formulation", "choice", 1, 1, "", "(by domains)", &
         "nitsche augmented implicit penalty", "cpdi2: `nitsche`, or `augmented` Lagrangian; " &
         //"others: `implicit`, the paper's K2 + K2^T + K3, or `penalty`, K3"), &
      variable_rule_type("boundary", "bilateral", "logical", 1, 1, "", ".false.", "", &
         "cpdi2: is material that starts on the boundary held against pulling off?"), &
      variable_rule_type("boundary", "friction", "real", 1, 1, "", "0.0", ">= 0", &
         "cpdi2, roller: coefficient of Coulomb friction"), &
      variable_rule_type("boundary", "adhesion", "real", 1, 1, "stress", "0.0", ">= 0", &
         "cpdi2, roller: shear beside friction; in full from a pressure of a third of it on"), &
      variable_rule_type("boundary", "shear_limit", "real", 1, 1, "stress", "(none)", "> 0", &
         "cpdi2, roller: largest shear, such as a share of the undrained strength"), &
      variable_rule_type("boundary", "rough", "logical", 1, 1, "", ".false.", "", &
         "cpdi2, roller: does what presses on it stick, up to `shear_limit`?"), &
      variable_rule_type("boundary", "tension_limit", "real", 1, 1, "stress", "0.0", ">= 0", &
         "cpdi2, roller: tension that it holds where material has touched it, until it opens"), &
      variable_rule_type("boundary", "tension_opening", "real", 1, 1, "length", "0.0", ">= 0", &
         "cpdi2, roller: opening over which that tension fades; 0: it is lost at once"), &
      variable_rule_type("boundary", "band_ratio", "real", 1, 1, "", "(by formulation)", &
         "> 0 <= 1", "penalty band over the spacing: 0.1 nitsche, 0.02 augmented, " &
         //"5.0e-6 implicit (at most 0.01), penalty"), &
      variable_rule_type("boundary", "gauss_points", "integer", 1, 1, "", "(2)", ">= 1 <= 3", &
         "on points: per segment and cell; one misses uniform stress, more lock in bending"), &
      variable_rule_type("boundary", "memory", "logical", 1, 1, "", "(.false.)", "", &
         "on points: are tractions kept from step to step, so that held steps do not drift?"), &
      variable_rule_type("boundary", "may_start_apart", "logical", 1, 1, "", ".false.", "", &
         "may the boundary start away from all material?")]

   type(variable_rule_type), parameter :: tool_rules(*) = [ &
      variable_rule_type("tool", "name", "text", 1, 1, "", required, "", &
         "name under which its force is reported"), &
      variable_rule_type("tool", "shape", "choice", 1, 1, "", required, &
         "polygon polyline circle rectangle wedge fluke", "rectangle: footing, blade or wall; " &
         //"wedge: tip at `position`, back above; fluke: plate pointed at both ends"), &
      variable_rule_type("tool", "vertices", "real", 4, 1000, "length", "(or file)", "", &
         "polygon, polyline: corners x1, y1, x2, y2, ..., before `angle` and `position`"), &
      variable_rule_type("tool", "file", "text", 1, 1, "", "(or vertices)", "", &
         "polygon, polyline: file with a row x, y for every corner, beside the deck"), &
      variable_rule_type("tool", "size", "real", 2, 2, "length", "(by shape)", "", &
         "rectangle, wedge, fluke: width and height, or length and thickness"), &
      variable_rule_type("tool", "radius", "real", 1, 1, "length", "(by shape)", "> 0", &
         "circle: its radius"), &
      variable_rule_type("tool", "position", "real", 2, 2, "length", "0.0, 0.0", "", &
         "place of the origin of the shape: centre, tip, or middle of the lower side"), &
      variable_rule_type("tool", "angle", "real", 1, 1, "degrees", "0.0", "", &
         "angle by which the shape is turned about `position`, counter-clockwise"), &
      variable_rule_type("tool", "rounding", "real", 1, 1, "length", "0.0", ">= 0", &
         "polygon, rectangle, wedge, fluke: radius of convex corners"), &
      variable_rule_type("tool", "inside", "logical", 1, 1, "", ".false.", "", &
         "closed shapes: is the material inside?"), &
      variable_rule_type("tool", "embedded", "logical", 1, 1, "", ".false.", "", &
         "closed shapes: are regions cut out where it stands at the start?"), &
      variable_rule_type("tool", "material_side", "choice", 1, 1, "", "'left'", "left right", &
         "polyline: side of the material for one who walks along it"), &
      variable_rule_type("tool", "displacement", "real", 2, 2, "length", "0.0, 0.0", "", &
         "total displacement at a table value of 1"), &
      variable_rule_type("tool", "displacement_per_step", "real", 2, 2, "length", "(none)", "", &
         "the same per step, for `count` equal steps without table"), &
      variable_rule_type("tool", "table", "text", 1, 1, "", "(ramp)", "", &
         "name of the table that schedules the displacement; else proportional to time"), &
      variable_rule_type("tool", "first_phase", "text", 1, 1, "", "(first)", "", &
         "name of the first phase in which it acts"), &
      variable_rule_type("tool", "last_phase", "text", 1, 1, "", "(last)", "", &
         "name of the last phase in which it acts"), &
      variable_rule_type("tool", "ramp_phase", "text", 1, 1, "", "(first_phase)", "", &
         "name of the phase over which it moves without a table; it need not act then"), &
      variable_rule_type("tool", "rotation", "real", 1, 1, "degrees", "0.0", "", &
         "total rotation at a table value of 1, counter-clockwise"), &
      variable_rule_type("tool", "rotation_table", "text", 1, 1, "", "(ramp)", "", &
         "name of the table that schedules the rotation; else proportional to time"), &
      variable_rule_type("tool", "pivot", "real", 2, 2, "length", "(position)", "", &
         "centre of rotation and of moments at the start; moves with the displacement"), &
      variable_rule_type("tool", "free", "choice", 1, 1, "", "(none)", "x y xy", &
         "components of the displacement that `load` decides"), &
      variable_rule_type("tool", "free_rotation", "logical", 1, 1, "", ".false.", "", &
         "does it turn freely about `pivot`, as on a hinge, until moments balance?"), &
      variable_rule_type("tool", "load", "real", 2, 2, "force", "0.0, 0.0", "", &
         "force on the tool per thickness, such as its weight, at a table value of 1"), &
      variable_rule_type("tool", "load_point", "real", 2, 2, "length", "(pivot)", "", &
         "free_rotation: where the load acts at the start; moves and turns with the tool"), &
      variable_rule_type("tool", "moment", "real", 1, 1, "force*length", "0.0", "", &
         "free_rotation: moment beside the load, counter-clockwise, at a table value of 1"), &
      variable_rule_type("tool", "load_table", "text", 1, 1, "", "(ramp)", "", &
         "name of the table that schedules load and moment; else proportional to time"), &
      variable_rule_type("tool", "friction", "real", 1, 1, "", "0.0", ">= 0", &
         "coefficient of Coulomb friction"), &
      variable_rule_type("tool", "adhesion", "real", 1, 1, "stress", "0.0", ">= 0", &
         "shear beside friction; in full from a pressure of a third of it on"), &
      variable_rule_type("tool", "shear_limit", "real", 1, 1, "stress", "(none)", "> 0", &
         "largest shear, such as a share of the undrained strength"), &
      variable_rule_type("tool", "rough", "logical", 1, 1, "", ".false.", "", &
         "does what presses on it stick, up to `shear_limit`?"), &
      variable_rule_type("tool", "tension_limit", "real", 1, 1, "stress", "0.0", ">= 0", &
         "tension that it holds where material has touched it, until it opens"), &
      variable_rule_type("tool", "tension_opening", "real", 1, 1, "length", "0.0", ">= 0", &
         "opening over which that tension fades; 0: it is lost at once"), &
      variable_rule_type("tool", "band_ratio", "real", 1, 1, "", "0.1", "> 0 <= 1", &
         "penalty band over the spacing")]

   type(variable_rule_type), parameter :: step_rules(*) = [ &
      variable_rule_type("motion", "tool", "text", 1, 1, "", "(or boundary)", "", &
         "name of the tool that moves"), &
      variable_rule_type("motion", "boundary", "text", 1, 1, "", "(or tool)", "", &
         "name of the boundary that moves"), &
      variable_rule_type("motion", "displacement", "real", 2, 2, "length", "0.0, 0.0", "", &
         "displacement over the phase, or at a table value of 1; all motions add up"), &
      variable_rule_type("motion", "velocity", "real", 2, 2, "length/time", "(none)", "", &
         "the same over the duration of the phase"), &
      variable_rule_type("motion", "rotation", "real", 1, 1, "degrees", "0.0", "", &
         "tools: rotation about the pivot, counter-clockwise"), &
      variable_rule_type("motion", "rotation_rate", "real", 1, 1, "degrees/time", "(none)", "", &
         "tools: the same over the duration of the phase"), &
      variable_rule_type("motion", "phase", "text", 1, 1, "", "(first)", "", &
         "name of the phase over which it moves evenly; it stays where that ends"), &
      variable_rule_type("motion", "table", "text", 1, 1, "", "(phase)", "", &
         "name of the table that schedules it over the whole run instead"), &
      variable_rule_type("edge_load", "name", "text", 1, 1, "", required, "", &
         "name for messages"), &
      variable_rule_type("edge_load", "vertices", "real", 4, 1000, "length", required, "", &
         "corners x1, y1, x2, y2, ... of a polyline; edges on it at the start carry the load"), &
      variable_rule_type("edge_load", "traction", "real", 2, 2, "stress", "(or pressure)", "", &
         "dead load per undeformed area at a table value of 1; keeps its direction"), &
      variable_rule_type("edge_load", "pressure", "real", 1, 1, "stress", "(or traction)", "", &
         "follower load on the deformed edge at a table value of 1, positive when it pushes"), &
      variable_rule_type("edge_load", "table", "text", 1, 1, "", "(ramp)", "", &
         "name of the table that schedules it; else it grows evenly over ramp_phase"), &
      variable_rule_type("edge_load", "from_start", "logical", 1, 1, "", ".false.", "", &
         "does it act in full from the start, instead of growing?"), &
      variable_rule_type("edge_load", "ramp_phase", "text", 1, 1, "", "(first)", "", &
         "name of the phase over which it grows from 0 to 1 without a table"), &
      variable_rule_type("edge_load", "last_phase", "text", 1, 1, "", "(last)", "", &
         "name of the last phase with all of it; it is taken off evenly over the next"), &
      variable_rule_type("body_force", "acceleration", "real", 2, 2, "length/time^2", required, &
         "", "acceleration at a table value of 1"), &
      variable_rule_type("body_force", "table", "text", 1, 1, "", "(ramp)", "", &
         "name of the table that schedules it; else it grows evenly over ramp_phase"), &
      variable_rule_type("body_force", "from_start", "logical", 1, 1, "", ".false.", "", &
         "does it act in full from the start, instead of growing?"), &
      variable_rule_type("body_force", "ramp_phase", "text", 1, 1, "", "(first)", "", &
         "name of the phase over which it grows from 0 to 1 without a table"), &
      variable_rule_type("body_force", "last_phase", "text", 1, 1, "", "(last)", "", &
         "name of the last phase with all of it; it is taken off evenly over the next"), &
      variable_rule_type("table", "name", "text", 1, 1, "", required, "", &
         "name by which loads refer to the table"), &
      variable_rule_type("table", "time", "real", 1, 1000, "time", required, "", &
         "times, increasing"), &
      variable_rule_type("table", "value", "real", 1, 1000, "", required, "", &
         "factors at these times, linear between them and constant beyond"), &
      variable_rule_type("table", "period", "real", 1, 1, "time", "(no wave)", "> 0", &
         "sine wave of this period from the first time on; `value` is its amplitude"), &
      variable_rule_type("steps", "count", "integer", 1, 1, "", "(or end_times)", &
         ">= 1 <= 100000", "number of equal steps from time 0 to time 1"), &
      variable_rule_type("steps", "end_times", "real", 1, 1000, "time", "(or count)", "> 0", &
         "time at the end of every step, increasing; the start is time 0"), &
      variable_rule_type("phase", "name", "text", 1, 1, "", required, "", &
         "name by which loads and boundaries refer to the phase"), &
      variable_rule_type("phase", "count", "integer", 1, 1, "", "(or end_times)", &
         ">= 1 <= 100000", "number of equal steps"), &
      variable_rule_type("phase", "duration", "real", 1, 1, "time", "1.0", "> 0", &
         "time that these take together"), &
      variable_rule_type("phase", "end_times", "real", 1, 1000, "time", "(or count)", "> 0", &
         "time at the end of every step, increasing, from the start of the phase"), &
      variable_rule_type("phase", "reset_displacements", "logical", 1, 1, "", ".false.", "", &
         "do displacements count anew from the end of the phase?")]

   type(variable_rule_type), parameter :: run_rules(*) = [ &
      variable_rule_type("control", "domains", "choice", 1, 1, "", "'cpdi2'", "cpdi2 gimp mpm", &
         "points own polygons that tile the body, boxes, or are mere quadrature points"), &
      variable_rule_type("control", "volumetric", "choice", 1, 1, "", "'standard'", &
         "standard fbar", "`fbar`: a cell's points share volume changes; no locking"), &
      variable_rule_type("control", "hourglass", "real", 1, 1, "", "0.5", ">= 0 <= 1", &
         "cpdi2: stiffness against hourglass modes of tiles, 1 is exact for squares in bending"), &
      variable_rule_type("control", "hourglass_limit", "real", 1, 1, "", "0.1", "> 0 <= 1", &
         "cpdi2: its share of the stress where tiles flow; 0.02 for small-strain limit loads"), &
      variable_rule_type("control", "ghost_penalty", "real", 1, 1, "", "1.0e-3", ">= 0 <= 0.1", &
         "cpdi2: stabilisation near the outline over the shear modulus"), &
      variable_rule_type("control", "retile", "choice", 1, 1, "", "'auto'", "auto never", &
         "cpdi2: `auto` tiles the bodies anew between steps when tiles are distorted"), &
      variable_rule_type("control", "solver", "choice", 1, 1, "", "'auto'", "auto umfpack", &
         "`auto` takes Cholesky where it works and LU elsewhere, `umfpack` always LU"), &
      variable_rule_type("control", "condition", "logical", 1, 1, "", ".false.", "", &
         "estimate the condition of every step's tangent: it costs more than a Newton iteration"), &
      variable_rule_type("control", "tolerance", "real", 1, 1, "", "1.0e-8", "> 0 < 1", &
         "largest accepted residual norm over the norm of the internal or external force"), &
      variable_rule_type("control", "increment_tolerance", "real", 1, 1, "", "1.0e-11", &
         "> 0 < 1", "largest accepted Newton correction over the displacement of the step"), &
      variable_rule_type("control", "augmentations", "integer", 1, 1, "", "1", ">= 0 <= 20", &
         "updates of `augmented` boundaries in a step"), &
      variable_rule_type("control", "max_iterations", "integer", 1, 1, "", "75", &
         ">= 1 <= 1000", "Newton iterations before a step counts as failed"), &
      variable_rule_type("control", "max_halvings", "integer", 1, 1, "", "6", ">= 0 <= 30", &
         "how often a failed step may be halved"), &
      variable_rule_type("control", "settle", "logical", 1, 1, "", ".false.", "", &
         "where halving does not help, let bodies slide against a drag until they come to rest"), &
      variable_rule_type("control", "small_cells", "choice", 1, 1, "", "'aggregate'", &
         "keep drop aggregate", &
         "cells with little material are kept, left out (points), or tied to the next full cell"), &
      variable_rule_type("control", "fill_tolerance", "real", 1, 1, "", "0.05", ">= 0 < 1", &
         "share of a cell that is little material, for nodes (cpdi2) or cells (others)"), &
      variable_rule_type("output", "every", "integer", 1, 1, "", "1", ">= 1", &
         "write every so many steps; the last step is always written"), &
      variable_rule_type("output", "at_steps", "integer", 1, 1000, "", "(or every)", ">= 1", &
         "write at these steps instead, increasing"), &
      variable_rule_type("output", "precision", "choice", 1, 1, "", "'double'", "double single", &
         "size of the numbers in the fields"), &
      variable_rule_type("output", "compression", "integer", 1, 1, "", "0", ">= 0 <= 9", &
         "deflate level of the fields"), &
      variable_rule_type("output", "name", "text", 1, 1, "", "(name of deck)", "", &
         "base name of the result files")]

   type(variable_rule_type), parameter :: sample_rules(*) = [ &
      variable_rule_type("sample", "name", "text", 1, 1, "", required, "", &
         "name by which stages refer to the sample"), &
      variable_rule_type("sample", "law", "text", 1, 1, "", required, "", "name of its law"), &
      variable_rule_type("sample", "initial_stress", "real", 4, 4, "stress", "4*0.0", "", &
         "Cauchy stress xx, yy, zz, xy at the start, tension positive; y is the axis"), &
      variable_rule_type("sample", "void_ratio", "real", 1, 1, "", "(none)", ">= 0", &
         "void ratio at the start, to be reported along"), &
      variable_rule_type("stage", "sample", "text", 1, 1, "", required, "", &
         "name of the sample"), &
      variable_rule_type("stage", "test", "choice", 1, 1, "", required, &
         "oedometer triaxial undrained biaxial shear free", &
         "held: lateral strain, lateral stress, volume, zz, lateral strain; or see `control`"), &
      variable_rule_type("stage", "axial_strain", "real", 1, 1, "", "(or axial_stress)", "", &
         "change of the logarithmic strain yy"), &
      variable_rule_type("stage", "axial_stress", "real", 1, 1, "stress", "(or axial_strain)", "", &
         "Cauchy stress yy to reach"), &
      variable_rule_type("stage", "lateral_stress", "real", 1, 1, "stress", "(kept)", "", &
         "triaxial: Cauchy stress to reach as the mean of xx and zz; biaxial: xx"), &
      variable_rule_type("stage", "shear_strain", "real", 1, 1, "", "(or shear_stress)", "", &
         "shear: change of the shear strain, displacement along x over height"), &
      variable_rule_type("stage", "shear_stress", "real", 1, 1, "stress", "(or shear_strain)", "", &
         "shear: Cauchy stress xy to reach; shear keeps the axial stress unless one is given"), &
      variable_rule_type("stage", "control", "text", 1, 1, "", "(free only)", "", &
         "free: a letter each for xx, yy, zz, xy: `e` strain, `s` stress; such as 'sees'"), &
      variable_rule_type("stage", "target", "real", 4, 4, "", "(free only)", "", &
         "free: for each component the change of its strain, or the Cauchy stress to reach"), &
      variable_rule_type("stage", "increments", "integer", 1, 1, "", "100", ">= 1 <= 1000000", &
         "number of equal increments"), &
      variable_rule_type("stage", "duration", "real", 1, 1, "time", "1.0", "> 0", &
         "how long the stage takes")]

   !> All variables, group by group in the order of the groups.
   type(variable_rule_type), parameter :: variable_rules(*) = &
      [scene_rules, law_rules, body_rules, contact_rules, boundary_rules, tool_rules, step_rules, &
       run_rules, sample_rules]

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
