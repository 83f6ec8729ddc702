!> Where Newton's method stands: unknowns, forces and tangent at them, and how far from balance.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_newton_iterate
   use coulter_assembly, only: assemble
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_model, only: model_type
   use coulter_model_observer, only: phase_assemble
   use coulter_system, only: system_type
   use coulter_system_border, only: set_motion
   use coulter_system_dofs, only: expand, reduce
   implicit none(type, external)
   private
   public :: newton_type, evaluate, evaluate_again, measure, balance, is_tangent_good_enough

   !> How the iteration goes.
   type :: newton_type
      !> Linear solves.
      integer :: n_iterations = 0
      !> Relative residual before every iteration and at the end, shape (n_iterations + 1).
      real(wp), allocatable :: residuals(:)
      !> Was the last tangent nearly singular, so that something may move without any force?
      logical :: is_nearly_singular = .false.
      !> Did round-off end the iteration, with a residual above the tolerance?
      logical :: is_limited_by_round_off = .false.
      !> Are the forces at hand those of predicted contacts: those of the last step before the first
      !> iteration, or those on which free tools have landed?
      logical :: has_predicted = .false.
      !> Did the step begin with predicted contacts?
      logical :: has_begun_predicted = .false.
      !> Is any law of the scene more than elastic?
      logical :: may_flow = .false.
      !> May a failure be due to contacts that were smooth or predicted at first? Was the tangent
      !> singular?
      logical :: may_begin_again = .false., is_singular = .false.
      !> Why there is no equilibrium; unallocated when there is.
      character(len=:), allocatable :: failure
      !> Displacement increments, their last correction, and the unbalanced force, shape (n_dofs).
      real(wp), allocatable :: unknowns(:), correction(:), unbalanced(:)
      !> Norm of the unbalanced force before every iteration and at the end, shape as `residuals`.
      real(wp), allocatable :: norms(:)
   end type newton_type

   !> How many times larger than expected the residual of an old tangent may be.
   real(wp), parameter :: margin = 1.0e4_wp

contains

   !> Forces and tangent at given unknowns; no tangent if the iteration should end there.
   subroutine evaluate(newton, system, model, unknowns)
      !> The iteration; gets `failure` if there are none.
      type(newton_type), intent(inout) :: newton
      !> System of the step; gets them.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Displacement increments, length units, shape (n_dofs).
      real(wp), intent(in) :: unknowns(:)

      system%needs_tangent = .not. (expects_end(newton, model) &
                                    .or. went_well(newton, system, model))
      call expand(system%dofs, unknowns(:system%dofs%n_dofs), system%increment)
      call set_motion(system%border, unknowns(system%dofs%n_dofs + 1:))
      call evaluate_again(newton, system, model)
   end subroutine evaluate

   !> Forces, and tangent if needed, at the same unknowns; arguments: see `evaluate`.
   subroutine evaluate_again(newton, system, model)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      integer :: failed_point

      call system%watch%start(phase_assemble)
      call system%forget_verdict()
      call assemble(system, model, failed_point)
      call system%watch%stop()
      if (failed_point == 0) return
      newton%failure = "a material point is turned inside out or its law fails near (" &
         //to_text(model%points%position(:, failed_point))//")"//system%verdict_text()
   end subroutine evaluate_again

   !> Will the next residual be small enough, if the convergence is as before or quadratic? Then the
   !> tangent will not be needed.
   pure function expects_end(newton, model) result(answer)
      type(newton_type), intent(in) :: newton
      type(model_type), intent(in) :: model
      logical :: answer
      integer :: n

      n = size(newton%residuals)
      answer = is_tangent_good_enough(newton%residuals, model%control%tolerance)
      if (n > 2 .and. .not. answer) answer = newton%residuals(n)**3 &
         < model%control%tolerance*newton%residuals(n - 1)**2
   end function expects_end

   !> Will the tangent at hand do for the correction after the next one, too? It would have in the
   !> last step.
   pure function went_well(newton, system, model) result(answer)
      type(newton_type), intent(in) :: newton
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      logical :: answer
      integer :: n

      n = size(newton%residuals) + 1
      answer = n > 1 .and. allocated(system%last_motion) .and. system%border%n == 0
      if (answer) answer = n <= size(system%last_motion%residuals) &
         .and. system%solver%is_reusable()
      if (answer) answer = is_tangent_good_enough(system%last_motion%residuals(:n), &
                                                  model%control%tolerance)
   end function went_well

   !> Would a correction from the tangent before the last residual end the iteration? Its residuals
   !> fall at least as fast as the last one did, and a margin is kept. A first residual above 1 is
   !> that of penalties and tells nothing.
   pure function is_tangent_good_enough(residuals, tolerance) result(answer)
      !> Relative residuals so far.
      real(wp), intent(in) :: residuals(:)
      !> Relative residual that ends the iteration.
      real(wp), intent(in) :: tolerance
      logical :: answer
      integer :: n

      n = size(residuals)
      answer = n > 1
      if (answer) answer = margin*residuals(n)**2 <= tolerance*min(residuals(n - 1), 1.0_wp)
   end function is_tangent_good_enough

   !> Residuals relative to the internal or external force as it is now; 1 while both vanish.
   !> Penalty forces are left out of the reference: they would hide everything else (theory, section
   !> 1). So are forces before the first correction, which may be mere round-off.
   subroutine measure(newton, system)
      !> The iteration; gets `residuals`.
      type(newton_type), intent(inout) :: newton
      !> System with forces.
      type(system_type), intent(in) :: system
      real(wp) :: reference

      reference = max(norm_of(system, system%internal), norm_of(system, system%external))
      if (system%border%n > 0) reference = max(reference, norm2(system%border%load))
      call balance(newton, system)
      newton%norms = [newton%norms, norm2(newton%unbalanced)]
      if (reference > 0.0_wp) then
         newton%residuals = newton%norms/reference
      else
         newton%residuals = merge(1.0_wp, newton%norms, newton%norms > 0.0_wp)
      end if
   end subroutine measure

   !> Force that is not in balance, reduced to the unknowns.
   subroutine balance(newton, system)
      !> The iteration; gets `unbalanced`.
      type(newton_type), intent(inout) :: newton
      !> System with forces.
      type(system_type), intent(in) :: system

      associate (n => system%dofs%n_dofs)
         call reduce_copy(system, system%internal + system%boundary - system%external, &
                          newton%unbalanced(:n))
         if (system%border%n > 0) newton%unbalanced(n + 1:) = system%border%unbalanced
      end associate
   end subroutine balance

   !> Norm of nodal forces, reduced to the unknowns.
   function norm_of(system, nodal) result(norm)
      type(system_type), intent(in) :: system
      real(wp), intent(in) :: nodal(:, :)
      real(wp) :: norm
      real(wp) :: reduced(system%dofs%n_dofs)

      call reduce_copy(system, nodal, reduced)
      norm = norm2(reduced)
   end function norm_of

   !> `reduce` on a copy.
   subroutine reduce_copy(system, nodal, reduced)
      type(system_type), intent(in) :: system
      real(wp), intent(in) :: nodal(:, :)
      real(wp), intent(out) :: reduced(:)
      real(wp) :: copy(size(nodal, 1), size(nodal, 2))

      copy = nodal
      call reduce(system%dofs, copy, reduced)
   end subroutine reduce_copy

end module coulter_newton_iterate
