!> What a material point adds to the system in plane strain: kinematics, stress, force, tangent.
!>
!> All formulas: theory, section 1. Hot: constant sizes, no allocation, no branches beyond the law.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_point_kernel
   use coulter_base_kinds, only: wp
   use coulter_base_tensor, only: inverse_2d, log_strain_plane
   use coulter_law_abstract, only: law_response_type, law_type, law_visit_type, n_plane
   implicit none(type, external)
   private
   public :: point_response_type, deform_point, respond, add_force, add_stiffness

   !> What a point answers to displacement increments.
   type :: point_response_type
      !> Kirchhoff stress xx, yy, zz, xy, tension positive, stress units.
      real(wp) :: stress(n_plane) = 0.0_wp
      !> Moduli A_ijkl of the spatial tangent, stress units.
      real(wp) :: moduli(2, 2, 2, 2) = 0.0_wp
      !> Shape function gradients at the end of the step, per length, shape (2, 4).
      real(wp) :: gradient(2, 4) = 0.0_wp
      !> Inverse of the in-plane deformation gradient of the step.
      real(wp) :: inverse(2, 2) = 0.0_wp
      !> Is the point turned inside out, or did its law fail? Then the rest says nothing.
      logical :: has_failed = .false.
   end type point_response_type

contains

   !> Deformation gradient of the current step, and the elastic left Cauchy-Green tensor that it
   !> makes of the converged one: dF = I + sum_v du_v (x) dN_v/dX, b = dF b_n dF^T.
   pure subroutine deform_point(gradient, increment, converged_finger, deformation, volume_ratio, &
                                finger)
      !> Shape function gradients at the start of the step, per length.
      real(wp), intent(in) :: gradient(2, 4)
      !> Displacement increments of the nodes, length units.
      real(wp), intent(in) :: increment(2, 4)
      !> Converged elastic left Cauchy-Green tensor xx, yy, zz, xy.
      real(wp), intent(in) :: converged_finger(4)
      !> In-plane deformation gradient of the step.
      real(wp), intent(out) :: deformation(2, 2)
      !> Its determinant; not positive when the point is turned inside out.
      real(wp), intent(out) :: volume_ratio
      !> Elastic trial left Cauchy-Green tensor xx, yy, zz, xy.
      real(wp), intent(out) :: finger(4)
      real(wp) :: row(2, 2)
      integer :: i, j

      do j = 1, 2
         do i = 1, 2
            deformation(i, j) = sum(increment(i, :)*gradient(j, :))
         end do
         deformation(j, j) = deformation(j, j) + 1.0_wp
      end do
      volume_ratio = deformation(1, 1)*deformation(2, 2) - deformation(1, 2)*deformation(2, 1)
      row(:, 1) = deformation(:, 1)*converged_finger(1) + deformation(:, 2)*converged_finger(4)
      row(:, 2) = deformation(:, 1)*converged_finger(4) + deformation(:, 2)*converged_finger(2)
      finger(1) = row(1, 1)*deformation(1, 1) + row(1, 2)*deformation(1, 2)
      finger(2) = row(2, 1)*deformation(2, 1) + row(2, 2)*deformation(2, 2)
      finger(3) = converged_finger(3)
      finger(4) = row(1, 1)*deformation(2, 1) + row(1, 2)*deformation(2, 2)
   end subroutine deform_point

   !> Stress and spatial moduli of a point at the end of the step.
   subroutine respond(law, visit, gradient, increment, converged_finger, law_state, response)
      !> Law of the point.
      class(law_type), intent(in) :: law
      !> Where and when the law is asked.
      type(law_visit_type), intent(in) :: visit
      !> Shape function gradients at the start of the step, per length.
      real(wp), intent(in) :: gradient(2, 4)
      !> Displacement increments of the nodes or corners, length units.
      real(wp), intent(in) :: increment(2, 4)
      !> Converged elastic left Cauchy-Green tensor xx, yy, zz, xy.
      real(wp), intent(in) :: converged_finger(4)
      !> Converged state variables, shape (>= law%n_state).
      real(wp), intent(in) :: law_state(:)
      !> What the point answers.
      type(point_response_type), intent(out) :: response
      real(wp) :: deformation(2, 2), volume_ratio, finger(4), strain(n_plane)
      type(law_visit_type) :: here
      type(law_response_type) :: answer
      real(wp) :: new_state(law%n_state)

      call deform_point(gradient, increment, converged_finger, deformation, volume_ratio, finger)
      response%has_failed = .not. volume_ratio > 0.0_wp
      if (response%has_failed) return
      response%inverse = inverse_2d(deformation, volume_ratio)
      response%gradient = matmul(transpose(response%inverse), gradient)
      call log_strain_plane(finger, strain)
      here = visit
      here%deformation = deformation
      call law%update(here, strain, law_state(:law%n_state), answer, new_state)
      response%has_failed = answer%has_failed
      if (response%has_failed) return
      response%stress = answer%stress
      if (.not. visit%needs_moduli) return
      if (visit%stiffening > 0.0_wp .and. .not. law%is_elastic) then
         call stiffen(law, visit%stiffening, law_state, answer)
      end if
      call law%spatial_moduli(finger, strain, answer, response%moduli)
   end subroutine respond

   !> Mix elastic stiffness into a tangent.
   pure subroutine stiffen(law, share, law_state, answer)
      class(law_type), intent(in) :: law
      real(wp), intent(in) :: share, law_state(:)
      type(law_response_type), intent(inout) :: answer
      real(wp) :: lame_lambda, shear_modulus
      integer :: i

      call law%elastic_moduli(answer%stress, law_state(:law%n_state), lame_lambda, shear_modulus)
      answer%tangent = (1.0_wp - share)*answer%tangent
      answer%tangent(:3, :3) = answer%tangent(:3, :3) + share*lame_lambda
      do i = 1, n_plane
         answer%tangent(i, i) = answer%tangent(i, i) &
            + merge(2.0_wp, 1.0_wp, i < n_plane)*share*shear_modulus
      end do
   end subroutine stiffen

   !> Add the internal force of a point to that of its cell: f_v = tau dN_v/dx V0.
   pure subroutine add_force(gradient, stress, volume, force)
      !> Shape function gradients at the end of the step, per length.
      real(wp), intent(in) :: gradient(2, 4)
      !> Kirchhoff stress.
      real(wp), intent(in) :: stress(n_plane)
      !> Reference volume.
      real(wp), intent(in) :: volume
      !> Force on the nodes, shape (component, node).
      real(wp), intent(inout) :: force(2, 4)

      force(1, :) = force(1, :) &
         + volume*(stress(1)*gradient(1, :) + stress(4)*gradient(2, :))
      force(2, :) = force(2, :) &
         + volume*(stress(4)*gradient(1, :) + stress(2)*gradient(2, :))
   end subroutine add_force

   !> Add the tangent of a point, K_vw = V0 dN_v,j A_ijkl dN_w,l, contracted directly: twice as fast
   !> as with strain-displacement matrices.
   pure subroutine add_stiffness(gradient, moduli, volume, stiffness)
      !> Shape function gradients at the end of the step, per length.
      real(wp), intent(in) :: gradient(2, 4)
      !> Spatial moduli A_ijkl.
      real(wp), intent(in) :: moduli(2, 2, 2, 2)
      !> Reference volume.
      real(wp), intent(in) :: volume
      !> Tangent, shape (component, node, component, node).
      real(wp), intent(inout) :: stiffness(2, 4, 2, 4)
      real(wp) :: half(2, 2)
      integer :: k, b

      do b = 1, 4
         do k = 1, 2
            half = volume*(moduli(:, :, k, 1)*gradient(1, b) + moduli(:, :, k, 2)*gradient(2, b))
            stiffness(1, :, k, b) = stiffness(1, :, k, b) &
               + half(1, 1)*gradient(1, :) + half(1, 2)*gradient(2, :)
            stiffness(2, :, k, b) = stiffness(2, :, k, b) &
               + half(2, 1)*gradient(1, :) + half(2, 2)*gradient(2, :)
         end do
      end do
   end subroutine add_stiffness

end module coulter_system_point_kernel
