!> Softening that no point could follow, found when a law is made.
!>
!> A point that is strained further unloads elastically while its strength falls. If the strength
!> falls faster, the point alone has no equilibrium: it snaps back. For von Mises that is so from a
!> fall of the yield stress by 3 G per plastic strain on, for Tresca of the shear strength by 3/2 G,
!> at the edges (Maier, G. and Hueckel, T. (1979), Int. J. Rock Mech. Min. Sci. 16, 77-92).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_softening
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_law_plastic, only: plastic_law_type
   implicit none(type, external)
   private
   public :: check_softening

   !> Directions that are tried from one kind of edge to the other, every 5 degrees, and how far
   !> beyond the strength.
   integer, parameter :: n_directions = 12
   real(wp), parameter :: sixth = acos(-1.0_wp)/3.0_wp, far = 1.0e2_wp

contains

   !> Does the strength at the datum fall too fast anywhere in its table? Looked at is flow in
   !> shear, not at the apex; nor friction that softens, whose part depends on the pressure.
   pure subroutine check_softening(law, error)
      !> The law, complete.
      class(plastic_law_type), intent(in) :: law
      !> Set when it does.
      type(error_type), allocatable, intent(out) :: error
      real(wp) :: slope, width
      integer :: i

      associate (strain => law%strength%strain, factor => law%strength%strength_factor)
         do i = 1, size(strain) - 1
            if (factor(i + 1) >= factor(i)) cycle
            width = strain(i + 1) - strain(i)
            slope = steepest_growth(law, strain(i) + 0.5_wp*width)
            if (slope < 1.0_wp) cycle
            call fatal_error(error, "law "//law%name//": strength_factor falls from " &
                             //to_text(factor(i))//" to "//to_text(factor(i + 1)) &
                             //" faster than the material unloads; plastic_strain must grow by" &
                             //" more than "//to_text(slope*width, 3)//" there, not by " &
                             //to_text(width, 3))
            return
         end do
      end associate
   end subroutine check_softening

   !> Largest slope of the growth of the plastic strain in all directions in which a point may flow.
   pure function steepest_growth(law, h) result(slope)
      class(plastic_law_type), intent(in) :: law
      !> Plastic strain.
      real(wp), intent(in) :: h
      real(wp) :: slope
      real(wp) :: pressure, shear, deviator(3)
      integer :: i

      pressure = far*law%strength%reference
      shear = far*(law%strength%reference + pressure*law%friction)
      slope = 0.0_wp
      do i = 0, n_directions
         deviator = cos(sixth*(real(i, wp)/real(n_directions, wp) + [0.0_wp, -2.0_wp, 2.0_wp]))
         associate (g => law%elastic%shear_modulus, bulk => law%elastic%lame_lambda &
                    + 2.0_wp/3.0_wp*law%elastic%shear_modulus)
            slope = max(slope, law%growth_slope(shear*deviator/(2.0_wp*g) &
                                                - pressure/(3.0_wp*bulk), h))
         end associate
      end do
   end function steepest_growth

end module coulter_law_softening
