!> Bodies as the user describes them: regions of one material, to be filled with points.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_body
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: region_type, stress_profile_type, body_type

   !> A simple polygon, convex or not.
   type :: region_type
      !> Corners in counter-clockwise order, length units, shape (2, n).
      real(wp), allocatable :: vertices(:, :)
   end type region_type

   !> Cauchy stress at the start by elevation.
   type :: stress_profile_type
      !> Elevations, y, strictly increasing, length units, shape (n).
      real(wp), allocatable :: elevation(:)
      !> Stress xx, yy, zz, xy at these elevations, tension positive, stress units, shape (4, n).
      real(wp), allocatable :: stress(:, :)
   end type stress_profile_type

   !> A solid of one law. Its regions must not overlap each other nor those of other bodies.
   type :: body_type
      !> Name by which regions and messages refer to the body.
      character(len=:), allocatable :: name
      !> Number of its law in the model.
      integer :: law = 0
      !> Number of the displacement field that carries it: bodies of one field are bonded where they
      !> touch, those of several press and rub (`coulter_contact_body_contact`).
      integer :: field = 1
      !> Do its own surfaces press and rub where they meet? Else they stick within a cell.
      logical :: meets_itself = .false.
      !> Mass per unit volume of the undeformed body, >= 0.
      real(wp) :: density = 0.0_wp
      !> Points per cell in each direction.
      integer :: points_per_cell = 1
      !> Uniform Cauchy stress at the start: xx, yy, zz, xy, tension positive, stress units.
      real(wp) :: initial_stress(4) = 0.0_wp
      !> Instead: stresses at elevations, linear between them and constant beyond.
      type(stress_profile_type), allocatable :: stress_profile
      !> Instead: horizontal over vertical stress, where the weight above makes the vertical one;
      !> negative: not given.
      real(wp) :: earth_pressure = -1.0_wp
      !> Pressure on the ground above the body, on top of the weight, stress units.
      real(wp) :: overburden = 0.0_wp
      !> What the body fills.
      type(region_type), allocatable :: regions(:)
   end type body_type

end module coulter_points_body
