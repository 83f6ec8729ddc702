!> Forces per unit mass: one acceleration for all, and a field that callers of the library may add.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_body_force
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: body_force_type, body_field_type

   !> An acceleration that varies over a body and in time: the source of a manufactured solution,
   !> or a centrifuge. Decks know none; tiled domains only.
   type, abstract :: body_field_type
   contains
      procedure(acceleration_interface), deferred :: acceleration
   end type body_field_type

   !> A force per unit mass.
   type :: body_force_type
      !> Acceleration everywhere at a table value of 1, length per time squared, shape (2).
      real(wp) :: acceleration(2) = 0.0_wp
      !> Number of the table that schedules it; 0: it grows evenly over `ramp_phase`.
      integer :: table = 0
      !> Phase over which it grows without a table; 0: it acts in full from the start.
      integer :: ramp_phase = 1
      !> Last phase in which it acts in full; it is taken off evenly over the next.
      integer :: last_phase = huge(1)
      !> Added to it; unallocated in scenes without.
      class(body_field_type), allocatable :: field
   end type body_force_type

   abstract interface
      !> Acceleration of the material that was at a place at the start.
      pure function acceleration_interface(self, place, time) result(acceleration)
         import :: body_field_type, wp
         implicit none (type, external)
         class(body_field_type), intent(in) :: self
         !> Place in the undeformed body, or where displacements were reset last, length units.
         real(wp), intent(in) :: place(2)
         !> Time at which forces shall balance.
         real(wp), intent(in) :: time
         !> Force per unit mass, length per time squared.
         real(wp) :: acceleration(2)
      end function acceleration_interface
   end interface

end module coulter_model_body_force
