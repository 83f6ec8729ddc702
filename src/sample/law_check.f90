!> Does a law answer as it should? Zero strain must leave the stress as it is, and the tangent must
!> be its slope.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_sample_law_check
   use coulter_base_kinds, only: wp
   use coulter_law_abstract, only: law_type, law_verdict_type
   use coulter_sample_state, only: sample_state_type, strain_state
   implicit none(type, external)
   private
   public :: law_check_type, check_law, good_tangent, good_rest

   !> What the check found.
   type :: law_check_type
      !> Change of the stress by zero strain, over the largest entry of the tangent.
      real(wp) :: stress_change = 0.0_wp
      !> Largest difference between the tangent and differences of the stress, over its largest
      !> entry: at a small strain.
      real(wp) :: tangent_error = 0.0_wp
      !> Why the law fails; unallocated when it does not.
      character(len=:), allocatable :: failure
   end type law_check_type

   !> What may be found without harm: round-off, and what Newton's method forgives.
   real(wp), parameter :: good_rest = 1.0e-12_wp, good_tangent = 1.0e-3_wp
   !> Strains of the check: layers are compressed and sheared.
   real(wp), parameter :: probe(4) = 1.0e-4_wp*[0.3_wp, -1.0_wp, 0.2_wp, 0.7_wp]
   !> Strain of the central differences.
   real(wp), parameter :: shift = 1.0e-7_wp

contains

   !> Check a law at a state.
   subroutine check_law(law, state, time_step, check)
      !> Law.
      class(law_type), intent(in) :: law
      !> State to start from.
      type(sample_state_type), intent(in) :: state
      !> Time that the strains take.
      real(wp), intent(in) :: time_step
      !> What was found.
      type(law_check_type), intent(out) :: check
      type(sample_state_type) :: new
      real(wp) :: jacobian(4, 4), slope(4, 4), change(4), side(4, 2)
      integer :: k, i

      change = 0.0_wp
      call ask(change, new%stress, jacobian)
      if (allocated(check%failure)) return
      check%stress_change = maxval(abs(new%stress - state%stress))/maxval(abs(jacobian))
      do k = 1, 4
         do i = 1, 2
            change = probe
            change(k) = change(k) + merge(-shift, shift, i == 1)
            call ask(change, side(:, i), jacobian)
            if (allocated(check%failure)) return
         end do
         slope(:, k) = (side(:, 2) - side(:, 1))/(2.0_wp*shift)
      end do
      call ask(probe, side(:, 1), jacobian)
      check%tangent_error = maxval(abs(jacobian - slope))/maxval(abs(slope))

   contains

      !> Stress and tangent of a strain.
      subroutine ask(change, stress, jacobian)
         real(wp), intent(in) :: change(4)
         real(wp), intent(out) :: stress(4), jacobian(4, 4)
         type(sample_state_type) :: answer
         type(law_verdict_type), target :: verdict

         call strain_state(law, state, change, time_step, verdict, answer, jacobian)
         stress = answer%stress
         if (.not. answer%has_failed) return
         check%failure = "the law fails"
         if (allocated(verdict%message)) check%failure = verdict%message
      end subroutine ask

   end subroutine check_law

end module coulter_sample_law_check
