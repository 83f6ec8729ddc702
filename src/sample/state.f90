!> State of a sample, and what strains make of it.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_sample_state
   use coulter_base_kinds, only: wp
   use coulter_base_tensor, only: finger_of_log_strain_plane, inverse_2d, log_strain_plane, &
      log_strain_tangent_plane
   use coulter_law_abstract, only: law_response_type, law_sites_type, law_type, law_verdict_type, &
      law_visit_type, n_plane
   use coulter_law_spatial, only: spin_of, stress_by_spin
   use coulter_sample, only: sample_type
   implicit none(type, external)
   private
   public :: sample_state_type, start_state, strain_state

   !> What a sample is like.
   type :: sample_state_type
      !> Time since the start.
      real(wp) :: time = 0.0_wp
      !> Strains since the start, see `stage_type`.
      real(wp) :: strain(4) = 0.0_wp
      !> Elastic left Cauchy-Green tensor xx, yy, zz, xy.
      real(wp) :: finger(4) = 0.0_wp
      !> Cauchy stress xx, yy, zz, xy, tension positive.
      real(wp) :: stress(4) = 0.0_wp
      !> State variables of the law.
      real(wp), allocatable :: law_state(:)
      !> Number of the stage as phase, and of the next increment in it.
      type(law_sites_type) :: sites
      !> Did the law fail on the way? Then the rest says nothing.
      logical :: has_failed = .false.
   contains
      procedure :: volume_ratio
   end type sample_state_type

contains

   !> Volume over that at the start.
   pure function volume_ratio(self) result(ratio)
      class(sample_state_type), intent(in) :: self
      real(wp) :: ratio

      ratio = exp(sum(self%strain(:3)))
   end function volume_ratio

   !> State before the test.
   subroutine start_state(state, sample, law)
      !> State to make.
      type(sample_state_type), intent(out) :: state
      !> The sample.
      type(sample_type), intent(in) :: sample
      !> Its law.
      class(law_type), intent(in) :: law
      real(wp) :: no_place(2)

      no_place = 0.0_wp
      allocate (state%law_state(law%n_state))
      call law%initial_state(sample%initial_stress, no_place, state%law_state)
      call finger_of_log_strain_plane(law%elastic_strain(sample%initial_stress, state%law_state), &
                                      state%finger)
      state%stress = sample%initial_stress
   end subroutine start_state

   !> Strain a sample.
   subroutine strain_state(law, old, change, time_step, verdict, new, jacobian)
      !> Law of the sample.
      class(law_type), intent(in) :: law
      !> State before.
      type(sample_state_type), intent(in) :: old
      !> Changes of the strains, see `stage_type`.
      real(wp), intent(in) :: change(4)
      !> Time that passes.
      real(wp), intent(in) :: time_step
      !> What a law that fails says.
      type(law_verdict_type), target, intent(out) :: verdict
      !> State after; `has_failed` is set when the law failed.
      type(sample_state_type), intent(out) :: new
      !> d stress(i) / d change(j), stress units.
      real(wp), intent(out) :: jacobian(4, 4)
      type(law_visit_type) :: visit
      type(law_sites_type), target :: sites
      type(law_response_type) :: response
      real(wp) :: finger(4), trial(n_plane)

      visit%deformation = deformation_of(old%strain(4), change)
      visit%time = old%time + time_step
      visit%time_step = time_step
      visit%point = 1
      visit%verdict => verdict
      sites = old%sites
      visit%sites => sites
      finger = pushed(visit%deformation, exp(change(3)), old%finger)
      call log_strain_plane(finger, trial)
      allocate (new%law_state, mold=old%law_state)
      call law%update(visit, trial, old%law_state, response, new%law_state)
      new%has_failed = response%has_failed
      if (new%has_failed) return
      new%sites = old%sites
      new%sites%increment = old%sites%increment + 1
      new%time = visit%time
      new%strain = old%strain + change
      new%stress = response%stress/new%volume_ratio()
      call finger_of_log_strain_plane(response%strain, new%finger)
      call differentiate(law, old%strain(4), change, finger, trial, response, jacobian)
      jacobian = jacobian/new%volume_ratio()
   end subroutine strain_state

   !> Deformation gradient of a change of the strains.
   pure function deformation_of(old_shear, change) result(deformation)
      real(wp), intent(in) :: old_shear, change(4)
      real(wp) :: deformation(2, 2)

      deformation(:, 1) = [exp(change(1)), 0.0_wp]
      deformation(2, 2) = exp(change(2))
      deformation(1, 2) = (old_shear + change(4))*deformation(2, 2) - old_shear*deformation(1, 1)
   end function deformation_of

   !> Left Cauchy-Green tensor F b F^T, with a stretch across the plane.
   pure function pushed(deformation, across, finger) result(image)
      real(wp), intent(in) :: deformation(2, 2), across, finger(4)
      real(wp) :: image(4), plane(2, 2)

      plane = matmul(deformation, matmul(reshape(finger([1, 4, 4, 2]), [2, 2]), &
                                         transpose(deformation)))
      image = [plane(1, 1), plane(2, 2), across**2*finger(3), plane(1, 2)]
   end function pushed

   !> J times the derivative of the Cauchy stress by the changes of the strains.
   pure subroutine differentiate(law, old_shear, change, finger, trial, response, jacobian)
      class(law_type), intent(in) :: law
      real(wp), intent(in) :: old_shear, change(4), finger(4), trial(n_plane)
      type(law_response_type), intent(in) :: response
      real(wp), intent(out) :: jacobian(4, 4)
      real(wp) :: f(2, 2), slope(2, 2, 4), rate(2, 2)
      integer :: k

      f = deformation_of(old_shear, change)
      slope = 0.0_wp
      slope(1, :, 1) = f(1, 1)*[1.0_wp, -old_shear]
      slope(:, 2, 2) = f(2, 2)*[old_shear + change(4), 1.0_wp]
      slope(1, 2, 4) = f(2, 2)
      do k = 1, 4
         rate = matmul(slope(:, :, k), inverse_2d(f, f(1, 1)*f(2, 2)))
         jacobian(:, k) = matmul(response%tangent, &
                                 strain_rate(finger, rate, merge(1.0_wp, 0.0_wp, k == 3)))
         if (law%is_incremental) jacobian(:, k) = jacobian(:, k) + spin_of(finger, rate) &
            *stress_by_spin(trial, response%stress, response%tangent)
         if (k < 4) jacobian(:, k) = jacobian(:, k) - response%stress
      end do
   end subroutine differentiate

   !> Rate of the logarithmic strain 1/2 ln b: of a velocity gradient in the plane and across it.
   pure function strain_rate(finger, velocity_gradient, across) result(rate)
      real(wp), intent(in) :: finger(4), velocity_gradient(2, 2), across
      real(wp) :: rate(4)
      real(wp) :: by_finger(3, 3), change(2, 2)

      call log_strain_tangent_plane(finger, by_finger)
      change = matmul(velocity_gradient, reshape(finger([1, 4, 4, 2]), [2, 2]))
      change = change + transpose(change)
      rate([1, 2, 4]) = matmul(by_finger, [change(1, 1), change(2, 2), change(1, 2)])
      rate(3) = across
   end function strain_rate

end module coulter_sample_state
