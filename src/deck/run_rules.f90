!> Variables of decks that say what happens: loads, steps, how they are solved and written, and
!> tests on samples.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_run_rules
   use coulter_deck_rule, only: required, variable_rule_type
   implicit none(type, external)
   private
   public :: step_rules, run_rules, sample_rules

   !> Loads, tables and steps.
   type(variable_rule_type), parameter :: step_rules(*) = [ &
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

   !> Solution and output.
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

   !> Laboratory tests.
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

end module coulter_deck_run_rules
