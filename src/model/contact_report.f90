!> What walls and tools feel in a step, for logs and results.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_contact_report
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: contact_report_type, station_report_type, surface_report_type

   !> A boundary in an accepted step, beside its force and penetration.
   type :: contact_report_type
      !> Displacement since the start, length units.
      real(wp) :: travel(2) = 0.0_wp
      !> Pivot at the end of the step, length units, and rotation since the start, radians,
      !> counter-clockwise.
      real(wp) :: centre(2) = 0.0_wp, rotation = 0.0_wp
      !> Moment of its force on the bodies about the pivot, counter-clockwise, force times length.
      real(wp) :: moment = 0.0_wp
      !> Work on the bodies since the start, force times length.
      real(wp) :: work = 0.0_wp
      !> Sums of the pressing parts of all stations and of their shear along the face, whatever the
      !> direction, force units.
      real(wp) :: pressing = 0.0_wp, rubbing = 0.0_wp
      !> Stations in contact, and how many of them stick and slip; smooth ones do neither.
      integer :: n_acting = 0, n_sticking = 0, n_slipping = 0
   end type contact_report_type

   !> A station in contact.
   type :: station_report_type
      !> Number of its boundary, or that of the contact between two bodies, negative.
      integer :: boundary = 0
      !> Sign of its shear while it slips, 0 while it sticks or is smooth.
      integer :: slip = 0
      !> Place at the end of the step, and length that it stands for, length units.
      real(wp) :: position(2) = 0.0_wp, weight = 0.0_wp
      !> Normal traction, tension positive, and shear along the face, stress units.
      real(wp) :: traction(2) = 0.0_wp
   end type station_report_type

   !> A contact between two bodies.
   type :: surface_report_type
      !> Force of the second body on the first one, force per thickness.
      real(wp) :: force(2) = 0.0_wp
      !> Sums of the pressing parts of all stations and of their shear, whatever its direction,
      !> force units.
      real(wp) :: pressing = 0.0_wp, rubbing = 0.0_wp
      !> Length along which they press, and how deep they overlap at most, length units.
      real(wp) :: length = 0.0_wp, penetration = 0.0_wp
      !> Share of that length along which they slip.
      real(wp) :: slipping = 0.0_wp
   end type surface_report_type

end module coulter_model_contact_report
