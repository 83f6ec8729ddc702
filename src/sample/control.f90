!> Mixed control: some strains are given, and Newton's method finds the others from their stresses.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_sample_control
   use coulter_algebra_dense, only: solve_dense
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_law_abstract, only: law_type, law_verdict_type
   use coulter_sample_state, only: sample_state_type, strain_state
   implicit none(type, external)
   private
   public :: demand_type, reach

   !> What an increment shall do.
   type :: demand_type
      !> Is a component driven by stress?
      logical :: is_stress(4) = .false.
      !> Are the strains xx and zz equal, and the sum of their stresses driven?
      logical :: is_round = .false.
      !> Changes of the strains that are given.
      real(wp) :: change(4) = 0.0_wp
      !> Stresses to reach where they are given.
      real(wp) :: stress(4) = 0.0_wp
      !> Time that passes.
      real(wp) :: time_step = 0.0_wp
   end type demand_type

   !> Largest accepted error of the stresses over their size, or over this share of the stiffness
   !> where there is no stress.
   real(wp), parameter :: tolerance = 1.0e-10_wp, least_strain = 1.0e-6_wp
   !> Strains of one increment that betray a sample that flows without more stress.
   real(wp), parameter :: largest_strain = 3.0_wp
   !> Iterations before an increment counts as failed.
   integer, parameter :: most_iterations = 30

contains

   !> Take a sample through an increment.
   subroutine reach(law, old, demand, new, n_iterations, verdict, failure)
      !> Law of the sample.
      class(law_type), intent(in) :: law
      !> State before.
      type(sample_state_type), intent(in) :: old
      !> What is asked for.
      type(demand_type), intent(in) :: demand
      !> State after.
      type(sample_state_type), intent(out) :: new
      !> Corrections made.
      integer, intent(out) :: n_iterations
      !> What a law that failed says.
      type(law_verdict_type), intent(out) :: verdict
      !> Why it was not reached; unallocated when it was.
      character(len=:), allocatable, intent(out) :: failure
      real(wp) :: change(4), jacobian(4, 4), error(4), scale
      real(wp), allocatable :: modes(:, :), correction(:)
      logical :: has_failed

      modes = free_modes(demand)
      allocate (correction(size(modes, 2)))
      change = merge(0.0_wp, demand%change, demand%is_stress)
      do n_iterations = 0, most_iterations
         call strain_state(law, old, change, demand%time_step, verdict, new, jacobian)
         if (new%has_failed) then
            failure = "the law fails"
            if (allocated(verdict%message)) failure = verdict%message
            return
         end if
         error = new%stress - demand%stress
         scale = max(norm2(new%stress), norm2(demand%stress), least_strain*maxval(abs(jacobian)))
         if (norm2(matmul(error, modes)) <= tolerance*scale) return
         call solve_dense(matmul(transpose(modes), matmul(jacobian, modes)), &
                          -matmul(error, modes), correction, has_failed)
         if (.not. has_failed) change = change + matmul(modes, correction)
         if (maxval(abs(change)) > largest_strain) has_failed = .true.
         if (has_failed) exit
      end do
      failure = "the stress cannot be reached: after "//to_text(most_iterations) &
         //" corrections it is "//to_text(norm2(matmul(error, modes))/scale, 3) &
         //" of its size away"
      if (has_failed) failure = "the stress cannot be reached: the sample has no stiffness left"
   end subroutine reach

   !> Strains that stresses drive, one in a column.
   pure function free_modes(demand) result(modes)
      type(demand_type), intent(in) :: demand
      real(wp), allocatable :: modes(:, :)
      integer :: i, n
      logical :: is_free(4)

      is_free = demand%is_stress
      if (demand%is_round) is_free(3) = .false.
      allocate (modes(4, count(is_free)), source=0.0_wp)
      n = 0
      do i = 1, 4
         if (.not. is_free(i)) cycle
         n = n + 1
         modes(i, n) = 1.0_wp
         if (i == 1 .and. demand%is_round) modes(3, n) = 1.0_wp
      end do
   end function free_modes

end module coulter_sample_control
