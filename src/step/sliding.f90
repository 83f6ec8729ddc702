!> Do rough faces carry all the shear of the soil that flows on them, or does that slide along?
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_sliding
   use coulter_base_kinds, only: wp
   use coulter_base_tensor, only: equivalent_stress
   use coulter_contact, only: contacts_type
   use coulter_model, only: model_type
   implicit none(type, external)
   private
   public :: note_sliding

   !> What carries less than this share of the shear strength slides. With Tresca's law the
   !> equivalent stress is up to 2/sqrt(3) times what it is in plane strain.
   real(wp), parameter :: least_held = 0.85_wp

contains

   !> Compare the limits of rough boundaries with the shear strength of the tiles that flow on them,
   !> as these stresses tell it, by the mean over the stations that act; where nothing flows, what
   !> was known stays.
   pure subroutine note_sliding(model, contacts)
      !> Scene at the end of a step.
      type(model_type), intent(inout) :: model
      !> Stations of the step.
      type(contacts_type), intent(in) :: contacts
      real(wp) :: strength
      integer :: b, k, n

      if (.not. allocated(model%points%has_flowed)) return
      do b = 1, size(model%boundaries)
         associate (boundary => model%boundaries(b))
            if (.not. boundary%is_rough .or. boundary%shear_limit >= huge(1.0_wp)) cycle
            n = 0
            strength = 0.0_wp
            do k = 1, contacts%n
               associate (station => contacts%item(k))
                  if (station%boundary /= b .or. .not. station%is_acting) cycle
                  if (.not. model%points%has_flowed(station%tile)) cycle
                  n = n + 1
                  strength = strength + equivalent_stress( &
                             model%points%converged%kirchhoff_stress(:, station%tile))/sqrt(3.0_wp)
               end associate
            end do
            if (n > 0) boundary%slides = boundary%shear_limit < least_held*strength/real(n, wp)
         end associate
      end do
   end subroutine note_sliding

end module coulter_step_sliding
