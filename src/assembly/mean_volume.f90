!> Stress and moduli of a point that shares its volume change with others, from those of its law.
!> Formulas: theory, section 2, and `assembly/patches.f90`.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly_mean_volume
   use coulter_base_kinds, only: wp
   use coulter_system_point_kernel, only: point_response_type
   implicit none(type, external)
   private
   public :: average_moduli, unit

   !> Second-order unit tensor as a column.
   real(wp), parameter :: unit(4) = [1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp]

contains

   !> Stress dev tau + p I and its moduli; what is left of the moduli c acts on the mean volume
   !> change: column = dev c : I/2, row = I/2 : c dev and bulk = I : c : I/4.
   pure subroutine average_moduli(response, pressure, column, row, bulk)
      !> Answer to the shared volume change; gets stress and moduli of the energy's derivative.
      type(point_response_type), intent(inout) :: response
      !> Pressure p, tension positive, stress units.
      real(wp), intent(in) :: pressure
      !> Components 11, 21, 12, 22 of what is left of the moduli, stress units.
      real(wp), intent(out) :: column(4), row(4), bulk
      real(wp) :: moduli(4, 4), geometric(4, 4)

      moduli = reshape(response%moduli, [4, 4]) + stress_moduli(response%stress)
      column = 0.5_wp*(moduli(:, 1) + moduli(:, 4))
      row = 0.5_wp*(moduli(1, :) + moduli(4, :))
      bulk = 0.5_wp*(row(1) + row(4))
      response%stress(:2) = response%stress(:2) &
         + pressure - 0.5_wp*sum(response%stress(:2))
      geometric = stress_moduli(response%stress)
      moduli = moduli - geometric - spread(unit, 2, 4)*spread(row, 1, 4) &
         + spread(unit, 1, 4)*spread((bulk + pressure)*unit - column, 2, 4)
      response%moduli = reshape(moduli, [2, 2, 2, 2])
      column = column - bulk*unit
      row = row - bulk*unit
   end subroutine average_moduli

   !> tau_il delta_jk, shape (ij, kl).
   pure function stress_moduli(stress) result(moduli)
      real(wp), intent(in) :: stress(4)
      real(wp) :: moduli(4, 4)

      moduli = 0.0_wp
      moduli([1, 2], 1) = stress([1, 4])
      moduli([3, 4], 2) = stress([1, 4])
      moduli([1, 2], 3) = stress([4, 2])
      moduli([3, 4], 4) = stress([4, 2])
   end function stress_moduli

end module coulter_assembly_mean_volume
