!> Equilibrium by Newton's method.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_newton
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_boundary, only: nitsche_band_ratio
   use coulter_model, only: model_type
   use coulter_model_observer, only: phase_assemble, phase_factorise, phase_solve
   use coulter_step_assembly, only: assemble
   use coulter_step_border, only: set_motion
   use coulter_step_border_solve, only: solve_bordered
   use coulter_step_contact_state, only: augment_contacts
   use coulter_step_dofs, only: expand, reduce
   use coulter_step_landing, only: land_free_tools
   use coulter_step_system, only: system_type
   implicit none(type, external)
   private
   public :: newton_type, solve_newton

   !> How the iteration went.
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
      !> May a failure be due to smooth contacts at first?
      logical :: may_begin_again = .false.
      !> Why there is no equilibrium; unallocated when there is.
      character(len=:), allocatable :: failure
      !> Displacement increments, their last correction, and the unbalanced force, shape (n_dofs).
      real(wp), allocatable, private :: unknowns(:), correction(:), unbalanced(:)
   end type newton_type

   !> Corrections are halved at most to this share to keep every point the right side out.
   real(wp), parameter :: smallest_share = 1.0e-3_wp
   !> Corrections beyond this many times the edges of the grid betray a singular tangent whose
   !> pivots round-off has kept from vanishing.
   real(wp), parameter :: largest_motion = 1.0e3_wp
   !> Corrections within this share of the largest coordinate of the grid are round-off of
   !> positions: a body at rest on walls would feel their gaps for ever.
   real(wp), parameter :: round_off = 16.0_wp*epsilon(1.0_wp)
   !> A tangent whose smallest pivot is less than this share of its largest is nearly singular: the
   !> share is 1e-7 or more when all bodies are held, and 1e-15 when one of them is free to move.
   real(wp), parameter :: smallest_pivot = 1.0e-12_wp
   !> Least, largest and first relative errors of corrections that are worth their price.
   real(wp), parameter :: smallest_forcing = 1.0e-8_wp, largest_forcing = 1.0e-4_wp, &
      first_forcing = 1.0e-6_wp
   !> Evaluations that a line search may take, and the fall of |G| that is enough.
   integer, parameter :: most_searches = 6
   real(wp), parameter :: good_share = 0.8_wp
   !> Residual of smooth contacts below which they begin to rub.
   real(wp), parameter :: near = 0.1_wp

contains

   !> Find the displacement increments at which all forces balance. On return the system holds
   !> them, and all forces at them.
   subroutine solve_newton(newton, system, model)
      !> How it went.
      type(newton_type), intent(out) :: newton
      !> System of the step, numbered, with external forces.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      logical :: is_done
      integer :: round

      associate (n => system%dofs%n_dofs + system%border%n)
         allocate (newton%unknowns(n), newton%correction(n), source=0.0_wp)
         allocate (newton%unbalanced(n), newton%residuals(0))
      end associate
      call begin(newton, system, model)
      round = 0
      do while (.not. allocated(newton%failure))
         if (system%border%n > 0) call land(newton, system, model)
         call measure(newton, system)
         call judge(newton, model, is_done)
         if (allocated(newton%failure)) then
            call begin_again(newton, system, model)
            cycle
         else if (system%is_smooth .and. (is_done .or. is_near(newton))) then
            call end_smoothness(newton, system, model)
            cycle
         else if (is_done) then
            if (round == model%control%n_augmentations) exit
            call augment_contacts(system, model, has_changed=is_done)
            if (.not. is_done) exit
            round = round + 1
            newton%correction = huge(newton%correction)
            call evaluate(newton, system, model, newton%unknowns)
            cycle
         end if
         call find_correction(newton, system, model)
         if (.not. allocated(newton%failure)) then
            call advance(newton, system, model)
            newton%n_iterations = newton%n_iterations + 1
         end if
         call begin_again(newton, system, model)
      end do
      system%needs_tangent = .true.
   end subroutine solve_newton

   !> First forces and tangent. With friction, contacts of the last step predict those of this one;
   !> where there are none, Newton comes near with smooth contacts first, since the signs of shear
   !> are unknown (theory, section 4).
   subroutine begin(newton, system, model)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model

      if (system%has_friction .or. system%has_tension) newton%has_predicted = &
         any(system%contacts%item(:system%contacts%n)%was_acting)
      system%is_smooth = system%has_friction .and. .not. newton%has_predicted
      newton%may_begin_again = system%is_smooth
      system%is_predicting = newton%has_predicted
      call evaluate(newton, system, model, newton%unknowns)
      system%is_predicting = .false.
   end subroutine begin

   !> Let free tools land that nothing holds; what they land on is predicted to act.
   subroutine land(newton, system, model)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      logical :: has_changed

      call land_free_tools(system, model%grid%smallest_spacing(), &
                           newton%unknowns(system%dofs%n_dofs + 1:), has_changed)
      if (.not. has_changed) return
      newton%has_predicted = .true.
      call evaluate(newton, system, model, newton%unknowns)
   end subroutine land

   !> Is equilibrium near?
   pure function is_near(newton) result(answer)
      type(newton_type), intent(in) :: newton
      logical :: answer

      answer = newton%n_iterations > 0 .and. newton%residuals(size(newton%residuals)) < near
   end function is_near

   !> Let contacts rub from now on.
   subroutine end_smoothness(newton, system, model)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model

      system%is_smooth = .false.
      newton%residuals = newton%residuals(:newton%n_iterations)
      call evaluate(newton, system, model, newton%unknowns)
   end subroutine end_smoothness

   !> After a failure that began with smooth contacts, begin anew with contacts that stick: a body
   !> may be held by them alone.
   subroutine begin_again(newton, system, model)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model

      if (.not. (allocated(newton%failure) .and. newton%may_begin_again)) return
      newton%may_begin_again = .false.
      system%is_smooth = .false.
      deallocate (newton%failure, newton%residuals)
      allocate (newton%residuals(0))
      newton%unknowns = 0.0_wp
      newton%n_iterations = 0
      call evaluate(newton, system, model, newton%unknowns)
   end subroutine begin_again

   !> Forces and tangent at given unknowns; no tangent if the iteration should end there.
   subroutine evaluate(newton, system, model, unknowns)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: unknowns(:)

      system%needs_tangent = .not. expects_end(newton, model)
      call expand(system%dofs, unknowns(:system%dofs%n_dofs), system%increment)
      call set_motion(system%border, unknowns(system%dofs%n_dofs + 1:))
      call evaluate_again(newton, system, model)
   end subroutine evaluate

   !> Forces, and tangent if needed, at the same unknowns.
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

   !> Will the next residual be small enough, if the convergence is quadratic? Then the tangent will
   !> not be needed.
   pure function expects_end(newton, model) result(answer)
      type(newton_type), intent(in) :: newton
      type(model_type), intent(in) :: model
      logical :: answer
      integer :: n

      n = size(newton%residuals)
      answer = n > 2
      if (answer) answer = newton%residuals(n)**3 &
         < model%control%tolerance*newton%residuals(n - 1)**2
   end function expects_end

   !> Residual relative to the internal or external force; 1 while both vanish. Penalty forces are
   !> left out of the reference: they would hide everything else (theory, section 1).
   subroutine measure(newton, system)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(in) :: system
      real(wp) :: reference, residual

      reference = max(norm_of(system, system%internal), norm_of(system, system%external))
      if (system%border%n > 0) reference = max(reference, norm2(system%border%load))
      call balance(newton, system)
      residual = norm2(newton%unbalanced)
      if (reference > 0.0_wp) then
         residual = residual/reference
      else if (residual > 0.0_wp) then
         residual = 1.0_wp
      end if
      newton%residuals = [newton%residuals, residual]
   end subroutine measure

   !> Force that is not in balance, reduced to the unknowns.
   subroutine balance(newton, system)
      type(newton_type), intent(inout) :: newton
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

   !> Converged by residual, or by increment, which also covers bodies that move free of stress; a
   !> correction that had to be shortened counts in full;
   !> never before one correction has been made. Out of patience or out of numbers: a failure.
   subroutine judge(newton, model, is_done)
      type(newton_type), intent(inout) :: newton
      type(model_type), intent(in) :: model
      logical, intent(out) :: is_done
      real(wp) :: residual

      residual = newton%residuals(size(newton%residuals))
      is_done = .false.
      if (newton%n_iterations > 0 .and. residual <= huge(residual)) then
         is_done = residual <= model%control%tolerance &
            .or. maxval(abs(newton%correction)) &
            <= model%control%increment_tolerance*maxval(abs(newton%unknowns))
         if (is_done) return
         newton%is_limited_by_round_off = maxval(abs(newton%correction)) &
            <= round_off*maxval(abs([model%grid%origin, model%grid%upper_corner()]))
         is_done = newton%is_limited_by_round_off
      end if
      if (is_done) return
      is_done = newton%n_iterations >= model%control%max_iterations &
         .or. .not. residual <= huge(residual)
      if (is_done) then
         newton%failure = "no equilibrium after "//to_text(newton%n_iterations) &
            //" iterations, relative residual "//to_text(residual, 3)
      end if
   end subroutine judge

   !> Newton correction: tangent times correction = - residual.
   subroutine find_correction(newton, system, model)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      logical :: has_failed

      if (.not. system%needs_tangent) then
         system%needs_tangent = .true.
         call evaluate_again(newton, system, model)
         if (allocated(newton%failure)) return
      end if
      call system%watch%start(phase_factorise)
      call system%solver%refresh(system%pattern, system%values, has_failed)
      call system%watch%start(phase_solve)
      if (.not. has_failed) call solve_bordered(system%border, system%solver, system%pattern, &
                                                system%values, system%dofs, newton%unbalanced, &
                                                newton%correction, has_failed, forcing(newton))
      call system%watch%stop()
      if (.not. has_failed) has_failed = maxval(abs(newton%correction)) &
         > largest_motion*maxval(model%grid%upper_corner() - model%grid%origin)
      newton%is_nearly_singular = system%solver%pivot_ratio < least_pivot_ratio(model)
      if (has_failed .and. system%border%unheld > 0) then
         newton%failure = "tool "//model%boundaries(system%border%unheld)%name &
            //" is free to move, and nothing holds it against its load"
      else if (has_failed) then
         newton%failure = "the tangent is singular: the material is unstable, or a body is free" &
            //" to move since no boundary or fixity holds it"
      end if
   end subroutine find_correction

   !> Error that a correction may have: in proportion to the residual, so that the convergence stays
   !> quadratic (Eisenstat, S. C. and Walker, H. F. (1996), SIAM J. Sci. Comput. 17, 16-32). The
   !> first correction is the largest by far: its error can turn tiles inside out.
   pure function forcing(newton) result(error)
      type(newton_type), intent(in) :: newton
      real(wp) :: error

      error = 1.0e-3_wp*newton%residuals(size(newton%residuals))
      error = min(max(error, smallest_forcing), largest_forcing)
      if (newton%n_iterations == 0) error = first_forcing
   end function forcing

   !> Ratio of pivots below which a tangent is nearly singular. Penalties over bands that are
   !> smaller than usual make the largest pivots larger.
   pure function least_pivot_ratio(model) result(ratio)
      type(model_type), intent(in) :: model
      real(wp) :: ratio
      integer :: b

      ratio = smallest_pivot
      do b = 1, size(model%boundaries)
         ratio = min(ratio, smallest_pivot*model%boundaries(b)%band_ratio/nitsche_band_ratio)
      end do
   end function least_pivot_ratio

   !> Apply the correction, shortened as far as it takes to keep every point the right side out and,
   !> where contacts may open and close, to come nearer to equilibrium.
   subroutine advance(newton, system, model)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      real(wp) :: share
      logical :: is_searching

      share = 1.0_wp
      do
         call evaluate(newton, system, model, newton%unknowns + share*newton%correction)
         if (.not. allocated(newton%failure)) exit
         share = 0.5_wp*share
         if (share < smallest_share .or. system%must_end_step()) return
         deallocate (newton%failure)
      end do
      ! a prediction is not compared with what it predicts
      is_searching = system%contacts%n > 0 .and. .not. newton%has_predicted
      newton%has_predicted = .false.
      if (is_searching) call search_line(newton, system, model, share)
      if (allocated(newton%failure)) return
      newton%unknowns = newton%unknowns + share*newton%correction
   end subroutine advance

   !> Look for the zero of G(a) = correction . residual(a) by regula falsi, roughly: a step is good
   !> enough when |G| has fallen by a fifth, or when it is a full one that has not passed the zero
   !> (theory, section 4).
   subroutine search_line(newton, system, model, share)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: share
      real(wp) :: start, now, low, high, slope_low, slope_high
      integer :: k

      start = dot_product(newton%correction, newton%unbalanced)
      if (start >= 0.0_wp) return
      low = 0.0_wp
      slope_low = start
      do k = 1, most_searches
         call balance(newton, system)
         now = dot_product(newton%correction, newton%unbalanced)
         if (abs(now) <= good_share*abs(start) .or. now < 0.0_wp) return
         high = share
         slope_high = now
         share = low + (high - low)*min(0.9_wp, max(0.1_wp, -slope_low/(slope_high - slope_low)))
         call evaluate(newton, system, model, newton%unknowns + share*newton%correction)
         if (allocated(newton%failure)) return
      end do
   end subroutine search_line

end module coulter_step_newton
