!> Which bodies move apart from each other: contacts between them, and displacement fields.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_separation
   use coulter_base_faults, only: fault_list_type
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type, point_moduli
   use coulter_model_control, only: domains_tiles
   implicit none(type, external)
   private
   public :: separate_bodies, find_softer_sides

contains

   !> Give bodies that have a contact displacement fields of their own. Those without must share
   !> one, so that every other body needs a contact with at least one of two that have one.
   pure subroutine separate_bodies(model, faults)
      !> Scene; its bodies get `field`.
      type(model_type), intent(inout) :: model
      !> Faults found.
      type(fault_list_type), intent(inout) :: faults
      logical :: are_apart(size(model%bodies), size(model%bodies))
      integer :: b, k, c

      if (size(model%body_contacts) == 0) return
      if (model%control%domains /= domains_tiles) then
         call faults%add("contact", 1, "", "needs domains = 'cpdi2', whose tiles have surfaces")
      else if (model%control%has_mean_volume) then
         call faults%add("contact", 1, "", "does not go with volumetric = 'fbar'")
      end if
      are_apart = .false.
      do k = 1, size(model%body_contacts)
         associate (pair => model%body_contacts(k)%body)
            if (are_apart(pair(1), pair(2)) .or. (pair(1) == pair(2) &
                                                  .and. model%bodies(pair(1))%meets_itself)) then
               call faults%add("contact", k, "against", "has a contact with this body already")
            end if
            if (pair(1) == pair(2)) then
               model%bodies(pair(1))%meets_itself = .true.
               cycle
            end if
            are_apart(pair(1), pair(2)) = .true.
            are_apart(pair(2), pair(1)) = .true.
         end associate
      end do
      do k = 1, size(model%body_contacts)
         associate (pair => model%body_contacts(k)%body)
            do c = 1, size(model%bodies)
               if (any(pair == c) .or. any(are_apart(c, pair)) .or. pair(1) == pair(2)) cycle
               call faults%add("contact", k, "", "body "//model%bodies(c)%name//" cannot be" &
                               //" bonded to both bodies of it: give that a contact with one" &
                               //" of them")
            end do
         end associate
      end do
      do b = 1, size(model%bodies)
         k = findloc(are_apart(:b, b), .false., dim=1)
         model%bodies(b)%field = maxval([0, model%bodies(:b - 1)%field]) + 1
         if (k < b) model%bodies(b)%field = model%bodies(k)%field
      end do
   end subroutine separate_bodies

   !> Find the softer body of every contact, by its stiffness at the start.
   pure subroutine find_softer_sides(model)
      !> Scene with points.
      type(model_type), intent(inout) :: model
      real(wp) :: lame_lambda, shear_modulus, stiffness(2)
      integer :: i, k, p

      do k = 1, size(model%body_contacts)
         associate (contact => model%body_contacts(k))
            do i = 1, 2
               p = findloc(model%points%body, contact%body(i), dim=1)
               stiffness(i) = 0.0_wp
               if (p == 0) cycle
               call point_moduli(model, p, lame_lambda, shear_modulus)
               stiffness(i) = lame_lambda + 2.0_wp*shear_modulus
            end do
            contact%softer = merge(2, 1, stiffness(2) < stiffness(1))
         end associate
      end do
   end subroutine find_softer_sides

end module coulter_model_separation
