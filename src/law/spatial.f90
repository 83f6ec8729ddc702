!> From the tangent of a law to the moduli of the spatial tangent in plane strain.
!>
!> Formulas: theory, section 1. Hot: constant sizes, no allocation.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_spatial
   use coulter_base_kinds, only: wp
   use coulter_base_tensor, only: log_strain_tangent_plane
   implicit none(type, external)
   private
   public :: moduli_of_strain, add_spin_moduli, spin_of, stress_by_spin

contains

   !> Moduli A_ijkl = d tau_ij/d l_kl - tau_il delta_jk of the spatial tangent, where
   !> d tau = D : 1/2 d(ln b) : (l b + b l^T).
   pure subroutine moduli_of_strain(finger, stress, law_tangent, moduli)
      !> Left Cauchy-Green tensor b whose logarithm the law took: xx, yy, zz, xy.
      real(wp), intent(in) :: finger(4)
      !> Kirchhoff stress xx, yy, zz, xy.
      real(wp), intent(in) :: stress(4)
      !> Algorithmic tangent D of the law.
      real(wp), intent(in) :: law_tangent(4, 4)
      !> Moduli, stress units.
      real(wp), intent(out) :: moduli(2, 2, 2, 2)
      real(wp) :: logarithm(3, 3), by_finger(3, 3), change(3)
      integer, parameter :: in_plane(3) = [1, 2, 4]
      integer :: k, l

      call log_strain_tangent_plane(finger, logarithm)
      by_finger = matmul(law_tangent(in_plane, in_plane), logarithm)
      do l = 1, 2
         do k = 1, 2
            change = by_finger(:, k)*2.0_wp*component(finger, k, l) &
               + by_finger(:, 3)*component(finger, 3 - k, l)
            moduli(1, 1, k, l) = change(1)
            moduli(2, 2, k, l) = change(2)
            moduli(1, 2, k, l) = change(3)
            moduli(2, 1, k, l) = change(3)
            moduli(1, k, k, l) = moduli(1, k, k, l) - component(stress, 1, l)
            moduli(2, k, k, l) = moduli(2, k, k, l) - component(stress, 2, l)
         end do
      end do
   end subroutine moduli_of_strain

   !> Add what the rotation of the step does to a stress that is carried along by it.
   pure subroutine add_spin_moduli(finger, strain, stress, law_tangent, moduli)
      !> Left Cauchy-Green tensor of the step: xx, yy, zz, xy.
      real(wp), intent(in) :: finger(4)
      !> Its logarithmic strain xx, yy, zz, 2 xy.
      real(wp), intent(in) :: strain(4)
      !> Kirchhoff stress xx, yy, zz, xy.
      real(wp), intent(in) :: stress(4)
      !> Algorithmic tangent of the law.
      real(wp), intent(in) :: law_tangent(4, 4)
      !> Moduli A_ijkl, stress units.
      real(wp), intent(inout) :: moduli(2, 2, 2, 2)
      real(wp) :: by_spin(4), spin(2, 2)
      integer :: k, l

      by_spin = stress_by_spin(strain, stress, law_tangent)
      do l = 1, 2
         do k = 1, 2
            spin = 0.0_wp
            spin(k, l) = 1.0_wp
            moduli(:, :, k, l) = moduli(:, :, k, l) &
               + spin_of(finger, spin)*reshape(by_spin([1, 4, 4, 2]), [2, 2])
         end do
      end do
   end subroutine add_spin_moduli

   !> Rate of the angle of R in the polar decomposition V R of the step, where V^2 is its left
   !> Cauchy-Green tensor: in the plane dR R^T = (l V - V l^T)/tr V.
   pure function spin_of(finger, velocity_gradient) result(spin)
      !> Left Cauchy-Green tensor of the step: xx, yy, zz, xy.
      real(wp), intent(in) :: finger(4)
      !> Velocity gradient l.
      real(wp), intent(in) :: velocity_gradient(2, 2)
      real(wp) :: spin
      real(wp) :: root, stretch(3)

      ! V = (b + sqrt(det b) 1)/tr V; its trace cancels but for the square
      root = sqrt(finger(1)*finger(2) - finger(4)**2)
      stretch = [finger(1) + root, finger(2) + root, finger(4)]
      associate (l => velocity_gradient)
         spin = (l(2, 1)*stretch(1) - l(1, 2)*stretch(2) + (l(2, 2) - l(1, 1))*stretch(3)) &
            /(stretch(1) + stretch(2))
      end associate
   end function spin_of

   !> Change of the Kirchhoff stress per angle of rotation, beside what D : d(ln V) says. A stress
   !> that is a function of R and U only changes by R (D_0 : d ln U) R^T and turns with R, and
   !> R d(ln U) R^T = d(ln V) - [W, ln V] with W = dR R^T: the change is [W, tau] - D : [W, ln V].
   pure function stress_by_spin(strain, stress, law_tangent) result(change)
      !> Logarithmic strain ln V of the step: xx, yy, zz, 2 xy.
      real(wp), intent(in) :: strain(4)
      !> Kirchhoff stress xx, yy, zz, xy.
      real(wp), intent(in) :: stress(4)
      !> Algorithmic tangent of the law.
      real(wp), intent(in) :: law_tangent(4, 4)
      real(wp) :: change(4)

      change = [-2.0_wp*stress(4), 2.0_wp*stress(4), 0.0_wp, stress(1) - stress(2)] &
         - matmul(law_tangent, [-strain(4), strain(4), 0.0_wp, 2.0_wp*(strain(1) - strain(2))])
   end function stress_by_spin

   !> In-plane component of a symmetric tensor stored as xx, yy, zz, xy.
   pure function component(tensor, i, j) result(value)
      real(wp), intent(in) :: tensor(4)
      integer, intent(in) :: i, j
      real(wp) :: value

      value = tensor(merge(i, 4, i == j))
   end function component

end module coulter_law_spatial
