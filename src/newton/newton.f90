!> Equilibrium by Newton's method.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_newton
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_boundary, only: nitsche_band_ratio
   use coulter_model, only: model_type
   use coulter_model_observer, only: phase_factorise, phase_solve
   use coulter_newton_border_solve, only: solve_bordered
   use coulter_newton_diagnosis, only: contact_watch_type, explain_singular, explain_stall, &
      n_watched, watch_contacts
   use coulter_newton_guess, only: guess_motion
   use coulter_newton_iterate, only: evaluate, evaluate_again, is_tangent_good_enough, measure, &
      newton_type
   use coulter_newton_landing, only: land_free_tools
   use coulter_newton_line_search, only: advance
   use coulter_system, only: system_type
   use coulter_system_contact_state, only: augment_contacts, push_out
   implicit none(type, external)
   private
   public :: newton_type, solve_newton

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
   !> A correction of more than this many times the motion so far, or one that leads away from
   !> balance while the residual is above this, comes from a tangent that is too soft; the share of
   !> elastic stiffness that mends it.
   real(wp), parameter :: largest_growth = 10.0_wp, notable_residual = 1.0e-3_wp, &
      mending_share = 0.3_wp
   !> Rounds in which corners that are too deep behind faces are pushed out.
   integer, parameter :: most_rounds = 5
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
      type(contact_watch_type) :: watch
      logical :: is_done
      integer :: round

      call begin(newton, system, model)
      round = 0
      do while (.not. allocated(newton%failure))
         if (system%border%n > 0) call land(newton, system, model)
         call measure(newton, system)
         if (newton%n_iterations == 0) watch = contact_watch_type()
         if (newton%n_iterations >= model%control%max_iterations - n_watched) then
            call watch_contacts(watch, system%contacts)
         end if
         call judge(newton, model, is_done)
         if (allocated(newton%failure)) then
            newton%failure = newton%failure//explain_stall(newton, watch, system, model)
            call begin_again(newton, system, model)
         else if (system%is_smooth .and. (is_done .or. is_near(newton))) then
            call end_smoothness(newton, system, model)
         else if (is_done) then
            call begin_round(newton, system, model, round, is_done)
            if (is_done) exit
         else
            call iterate(newton, system, model)
         end if
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
      integer :: i

      newton%may_flow = any([(.not. model%laws(i)%law%is_elastic, i=1, size(model%laws))])
      associate (n => system%dofs%n_dofs + system%border%n)
         allocate (newton%unknowns(n), newton%correction(n), source=0.0_wp)
         allocate (newton%unbalanced(n), newton%residuals(0), newton%norms(0))
      end associate
      if (system%has_friction .or. system%has_tension) newton%has_predicted = &
         any(system%contacts%item(:system%contacts%n)%was_acting)
      if (system%has_friction .and. allocated(system%surfaces)) newton%has_predicted = &
         newton%has_predicted .or. any(system%surfaces%pairs%was_acting)
      system%is_smooth = system%has_friction .and. .not. newton%has_predicted
      newton%may_begin_again = system%has_friction
      newton%has_begun_predicted = newton%has_predicted
      system%is_predicting = newton%has_predicted
      call evaluate_first(newton, system, model)
      system%is_predicting = .false.
   end subroutine begin

   !> First forces where the motion of the last step goes on, or without motion. There points that
   !> flowed are at their yield surface up to round-off, which must not choose between two tangents:
   !> the first is the elastic one.
   subroutine evaluate_first(newton, system, model)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      logical :: has_guess

      call guess_motion(system, model, newton%unknowns, has_guess)
      if (has_guess) then
         call evaluate(newton, system, model, newton%unknowns)
         if (.not. allocated(newton%failure)) return
         deallocate (newton%failure)
         newton%unknowns = 0.0_wp
      end if
      system%stiffening = 1.0_wp
      call evaluate(newton, system, model, newton%unknowns)
      system%stiffening = 0.0_wp
   end subroutine evaluate_first

   !> Let free tools land that nothing holds; what they land on is predicted to act.
   subroutine land(newton, system, model)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      logical :: has_changed

      ! a drag holds all
      if (system%settling_drag > 0.0_wp) return
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
      newton%norms = newton%norms(:newton%n_iterations)
      call evaluate(newton, system, model, newton%unknowns)
   end subroutine end_smoothness

   !> After a failure that began with smooth contacts, or a singular tangent of predicted ones,
   !> begin anew with contacts that stick: a body may be held by them alone, such as one that
   !> slipped while a tool pushed it that has left.
   subroutine begin_again(newton, system, model)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model

      if (.not. (allocated(newton%failure) .and. newton%may_begin_again)) return
      if (newton%has_begun_predicted .and. .not. newton%is_singular) return
      newton%may_begin_again = .false.
      system%is_smooth = .false.
      deallocate (newton%failure, newton%residuals, newton%norms)
      allocate (newton%residuals(0), newton%norms(0))
      newton%unknowns = 0.0_wp
      newton%n_iterations = 0
      newton%has_predicted = newton%has_begun_predicted
      system%is_sticking = newton%has_begun_predicted
      call evaluate(newton, system, model, newton%unknowns)
      system%is_sticking = .false.
   end subroutine begin_again

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

   !> After equilibrium: the next round of the augmented Lagrangian method, unless none is left or
   !> needed, or one that pushes out what is too deep.
   subroutine begin_round(newton, system, model, round, is_last)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      integer, intent(inout) :: round
      logical, intent(out) :: is_last
      logical :: has_changed

      has_changed = .false.
      if (round < model%control%n_augmentations) call augment_contacts(system, model, has_changed)
      if (.not. has_changed .and. round < most_rounds) call push_out(system, model, has_changed)
      is_last = .not. has_changed
      if (is_last) return
      round = round + 1
      newton%correction = huge(newton%correction)
      call evaluate(newton, system, model, newton%unknowns)
   end subroutine begin_round

   !> One correction, as far as it goes.
   subroutine iterate(newton, system, model)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model

      call find_correction(newton, system, model)
      if (.not. allocated(newton%failure)) then
         call advance(newton, system, model)
         newton%n_iterations = newton%n_iterations + 1
      end if
      call begin_again(newton, system, model)
   end subroutine iterate

   !> Newton correction; from a stiffened tangent where the consistent one is too soft.
   subroutine find_correction(newton, system, model)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model

      if (.not. system%needs_tangent) then
         if (serves_again(newton, system, model)) then
            call solve_tangent(newton, system, model, is_old=.true.)
            if (.not. allocated(newton%failure)) return
            deallocate (newton%failure)
         end if
         system%needs_tangent = .true.
         call evaluate_again(newton, system, model)
         if (allocated(newton%failure)) return
      end if
      call solve_tangent(newton, system, model, is_old=.false.)
      if (.not. is_too_soft(newton)) return
      if (allocated(newton%failure)) deallocate (newton%failure)
      system%stiffening = mending_share
      call evaluate_again(newton, system, model)
      system%stiffening = 0.0_wp
      if (.not. allocated(newton%failure)) call solve_tangent(newton, system, model, is_old=.false.)
   end subroutine find_correction

   !> Is the tangent of the last correction good enough for another one?
   function serves_again(newton, system, model) result(answer)
      type(newton_type), intent(in) :: newton
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      logical :: answer

      answer = newton%n_iterations > 0 .and. system%border%n == 0 &
         .and. system%solver%is_reusable()
      if (answer) answer = is_tangent_good_enough(newton%residuals, model%control%tolerance)
   end function serves_again

   !> Is a plastic tangent too soft, or not even positive, on the way that it proposes? Where
   !> material flows all the way through a body little holds that back, and less without associated
   !> flow.
   pure function is_too_soft(newton) result(answer)
      type(newton_type), intent(in) :: newton
      logical :: answer

      answer = newton%may_flow .and. any(abs(newton%unknowns) > 0.0_wp)
      if (.not. answer .or. allocated(newton%failure)) return
      answer = maxval(abs(newton%correction)) > largest_growth*maxval(abs(newton%unknowns)) &
         .or. (dot_product(newton%correction, newton%unbalanced) >= 0.0_wp &
               .and. newton%residuals(size(newton%residuals)) > notable_residual)
   end function is_too_soft

   !> Tangent times correction = - residual.
   subroutine solve_tangent(newton, system, model, is_old)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      !> Is it the tangent that was solved with last?
      logical, intent(in) :: is_old
      logical :: has_failed

      has_failed = .false.
      call system%watch%start(phase_factorise)
      if (.not. is_old) call system%solver%refresh(system%pattern, system%values, &
                                                           change_of(newton%residuals), has_failed)
      call system%watch%start(phase_solve)
      if (.not. has_failed) call solve_bordered(system, newton%unbalanced, &
                                                forcing(newton, model%control%tolerance), &
                                                newton%correction, has_failed)
      call system%watch%stop()
      if (.not. has_failed) has_failed = maxval(abs(newton%correction)) &
         > largest_motion*maxval(model%grid%upper_corner() - model%grid%origin)
      newton%is_singular = has_failed
      newton%is_nearly_singular = system%solver%pivot_ratio < least_pivot_ratio(model)
      if (has_failed .and. system%border%unheld > 0) then
         newton%failure = "tool "//model%boundaries(system%border%unheld)%name &
            //" is free to move, and nothing holds it against its load"
      else if (has_failed) then
         newton%failure = explain_singular(system, model)
      end if
   end subroutine solve_tangent

   !> How much the tangent has changed with the last correction, relative to it: if not at all, the
   !> correction would have left no residual.
   pure function change_of(residuals) result(change)
      real(wp), intent(in) :: residuals(:)
      real(wp) :: change

      change = huge(change)
      associate (n => size(residuals))
         if (n > 1) change = residuals(n)/residuals(n - 1)
      end associate
   end function change_of

   !> Error that a correction may have: in proportion to the residual, so that the convergence stays
   !> quadratic (Eisenstat, S. C. and Walker, H. F. (1996), SIAM J. Sci. Comput. 17, 16-32), and not
   !> smaller than what ends the iteration. The first correction is the largest by far: its error
   !> can turn tiles inside out.
   pure function forcing(newton, tolerance) result(error)
      type(newton_type), intent(in) :: newton
      !> Relative residual that ends the iteration.
      real(wp), intent(in) :: tolerance
      real(wp) :: error

      error = first_forcing
      if (newton%n_iterations == 0) return
      associate (residual => newton%residuals(size(newton%residuals)))
         error = max(1.0e-3_wp*residual, 1.0e-6_wp*tolerance/residual)
      end associate
      error = min(max(error, smallest_forcing), largest_forcing)
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

end module coulter_newton
