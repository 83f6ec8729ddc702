!> How much of a Newton correction is taken.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_newton_line_search
   use coulter_algebra_sparse, only: multiply
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_newton_iterate, only: balance, evaluate, newton_type
   use coulter_system, only: system_type
   implicit none(type, external)
   private
   public :: advance

   !> Corrections are halved at most to this share to keep every point the right side out.
   real(wp), parameter :: smallest_share = 1.0e-3_wp
   !> Evaluations that a line search may take; the share of |G| that is small enough, and the one
   !> that is asked for once the zero has been passed where material may flow.
   integer, parameter :: most_searches = 6
   real(wp), parameter :: good_share = 0.8_wp, fine_share = 0.3_wp

   !> Where the zero of G is looked for.
   type :: bracket_type
      !> Shares on this side of the zero and beyond it, and G there.
      real(wp) :: low, high, g_low, g_high
   end type bracket_type

contains

   !> Apply the correction, shortened as far as it takes to keep every point the right side out and,
   !> where contacts may open and close, to come nearer to equilibrium. Where material may flow, one
   !> that is larger than all motion so far comes from a tangent that is too soft, and is shortened
   !> to that.
   subroutine advance(newton, system, model)
      !> The iteration, with a correction.
      type(newton_type), intent(inout) :: newton
      !> System of the step; gets forces and tangent at the new unknowns.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      real(wp) :: share
      logical :: is_searching

      share = 1.0_wp
      associate (motion => maxval(abs(newton%unknowns)), way => maxval(abs(newton%correction)))
         if (newton%may_flow .and. motion > 0.0_wp .and. way > motion) share = motion/way
      end associate
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

   !> Look for the zero of G(a) = correction . residual(a), roughly: a step is good enough when |G|
   !> has fallen by a fifth, or when it has not passed the zero (theory, section 4).
   subroutine search_line(newton, system, model, share)
      type(newton_type), intent(inout) :: newton
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: share
      type(bracket_type) :: bracket
      real(wp) :: start, now, enough
      integer :: k

      start = dot_product(newton%correction, newton%unbalanced)
      if (start >= 0.0_wp) return
      bracket = bracket_type(0.0_wp, huge(1.0_wp), start, huge(1.0_wp))
      enough = good_share
      do k = 1, most_searches
         call balance(newton, system)
         now = dot_product(newton%correction, newton%unbalanced)
         if (abs(now) <= enough*abs(start)) return
         if (now < 0.0_wp .and. .not. enough < good_share) return
         if (newton%may_flow) enough = fine_share
         call narrow(bracket, share, now)
         share = next_share(bracket, share, now, slope_along(newton, system))
         call evaluate(newton, system, model, newton%unknowns + share*newton%correction)
         if (allocated(newton%failure)) return
      end do
   end subroutine search_line

   !> Take in what G is at a share.
   pure subroutine narrow(bracket, share, now)
      type(bracket_type), intent(inout) :: bracket
      real(wp), intent(in) :: share, now

      if (now > 0.0_wp) then
         bracket%high = share
         bracket%g_high = now
      else
         bracket%low = share
         bracket%g_low = now
      end if
   end subroutine narrow

   !> Newton's method for G from beyond the zero, where contacts have closed and points unload:
   !> there G is steep, and its tangent finds the kink that a secant creeps up to. Else regula
   !> falsi.
   pure function next_share(bracket, share, now, slope) result(next)
      type(bracket_type), intent(in) :: bracket
      real(wp), intent(in) :: share, now, slope
      real(wp) :: next

      associate (width => bracket%high - bracket%low)
         next = bracket%low + width*min(0.9_wp, max(0.1_wp, -bracket%g_low &
                                                    /(bracket%g_high - bracket%g_low)))
      end associate
      if (.not. (now > 0.0_wp .and. slope > 0.0_wp)) return
      if (share - now/slope > bracket%low) next = share - now/slope
   end function next_share

   !> Slope of G where material may flow; 0 where it is not known, without tangent or with free
   !> tools.
   function slope_along(newton, system) result(slope)
      type(newton_type), intent(in) :: newton
      type(system_type), intent(in) :: system
      real(wp) :: slope
      real(wp) :: product(system%dofs%n_dofs)

      slope = 0.0_wp
      if (system%border%n > 0 .or. .not. (system%needs_tangent .and. newton%may_flow)) return
      associate (along => newton%correction(:system%dofs%n_dofs))
         call multiply(system%pattern, system%values, along, product)
         slope = dot_product(along, product)
      end associate
   end function slope_along

end module coulter_newton_line_search
