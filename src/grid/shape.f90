!> Shape functions of the 4-node cell.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_grid_shape
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: shape_values_2d, shape_gradients_2d

contains

   !> Bilinear shape functions of the nodes, counter-clockwise from the lower left one.
   pure function shape_values_2d(local) result(value)
      !> Position in the cell over its edge lengths: 0 to 1 inside, extrapolated beyond.
      real(wp), intent(in) :: local(2)
      real(wp) :: value(4)

      value(1) = (1.0_wp - local(1))*(1.0_wp - local(2))
      value(2) = local(1)*(1.0_wp - local(2))
      value(3) = local(1)*local(2)
      value(4) = (1.0_wp - local(1))*local(2)
   end function shape_values_2d

   !> Gradients of the shape functions, shape (2, 4), per length.
   pure function shape_gradients_2d(local, spacing) result(gradient)
      !> Position in the cell over its edge lengths.
      real(wp), intent(in) :: local(2)
      !> Edge lengths of the cell.
      real(wp), intent(in) :: spacing(2)
      real(wp) :: gradient(2, 4)

      gradient(1, 2) = (1.0_wp - local(2))/spacing(1)
      gradient(1, 3) = local(2)/spacing(1)
      gradient(1, 1) = -gradient(1, 2)
      gradient(1, 4) = -gradient(1, 3)
      gradient(2, 3) = local(1)/spacing(2)
      gradient(2, 4) = (1.0_wp - local(1))/spacing(2)
      gradient(2, 1) = -gradient(2, 4)
      gradient(2, 2) = -gradient(2, 3)
   end function shape_gradients_2d

end module coulter_grid_shape
