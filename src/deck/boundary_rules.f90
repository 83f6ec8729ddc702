!> Variables of decks that say what holds and moves bodies: fixities, boundaries and tools.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_boundary_rules
   use coulter_deck_rule, only: required, variable_rule_type
   implicit none(type, external)
   private
   public :: boundary_rules, tool_rules, motion_rules

   !> Fixities, and boundaries that need not match the grid.
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

   !> Rigid tools.
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

   !> Parts of the way of tools and boundaries.
   type(variable_rule_type), parameter :: motion_rules(*) = [ &
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
         "name of the table that schedules it over the whole run instead")]

end module coulter_deck_boundary_rules
