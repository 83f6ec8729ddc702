!> Contact between two bodies that are carried by displacement fields of their own.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_body_contact
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: nitsche_band_ratio
   use coulter_contact_friction, only: friction_type
   implicit none(type, external)
   private
   public :: body_contact_type

   !> Two bodies that press and rub where their surfaces meet.
   type :: body_contact_type
      !> Their numbers; the same one twice for a body whose surfaces meet.
      integer :: body(2) = 0
      !> Which of both is the softer one, whose tractions both feel.
      integer :: softer = 1
      !> What their surfaces can carry.
      type(friction_type) :: friction = friction_type(limit=huge(1.0_wp))
      !> Width of the penalty band over the grid spacing.
      real(wp) :: band_ratio = nitsche_band_ratio
   contains
      procedure :: rubs
      procedure :: is_within
   end type body_contact_type

contains

   !> Is there any friction?
   elemental function rubs(self) result(answer)
      class(body_contact_type), intent(in) :: self
      logical :: answer

      answer = self%friction%coefficient > 0.0_wp .or. self%friction%adhesion > 0.0_wp &
         .or. self%friction%is_rough
   end function rubs

   !> Is it between surfaces of one body?
   elemental function is_within(self) result(answer)
      class(body_contact_type), intent(in) :: self
      logical :: answer

      answer = self%body(1) == self%body(2)
   end function is_within

end module coulter_contact_body_contact
