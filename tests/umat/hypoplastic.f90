! Hypoplastic sand after von Wolffersdorff, P.-A. (1996), Mech. Cohesive-Frict. Mater. 1, 251-271:
! dT/dt = fb fe/tr(t t) [F^2 D + a^2 t (t:D) + fd a F (t + t*) |D|], t = T/tr T, t* = t - 1/3.
!
! The rate is integrated by Bogacki and Shampine's method of order 3(2) with error control; DDSDDE
! comes from central differences over the same substeps (Fellin and Ostermann, Int. J. Numer. Anal.
! Meth. Geomech. 26 (2002) 1213-1233). Where that takes too many of them, a smaller step is asked
! for (PNEWDT).
! props: friction angle phi_c (degrees), h_s, n, e_d0, e_c0, e_i0, alpha, beta, p_t: a pressure that
! is added to that of the grains, so that there is stiffness without stress.
! statev: void ratio, number of substeps.
! SPDX-License-Identifier: BSD-3-Clause
module hypoplastic_sand
   implicit none
   private
   public :: wp, sand_type, new_sand, integrate, linear_moduli, most_steps
   integer, parameter :: wp = kind(1.0d0), most_steps = 1000
   ! Error of a substep, over the stress.
   real(wp), parameter :: accuracy = 1.0e-7_wp

   type :: sand_type
      real(wp) :: a, hs, n, ed, ec, ei, alpha, beta, shift, factor
   end type sand_type

contains

   pure function new_sand(props) result(sand)
      real(wp), intent(in) :: props(9)
      type(sand_type) :: sand
      real(wp) :: sine

      sine = sin(props(1)*acos(-1.0_wp)/180.0_wp)
      sand = sand_type(sqrt(3.0_wp)*(3.0_wp - sine)/(2.0_wp*sqrt(2.0_wp)*sine), props(2), props(3), &
                       props(4), props(5), props(6), props(7), props(8), props(9), 0.0_wp)
      sand%factor = sand%hs/sand%n*(sand%ei/sand%ec)**sand%beta &
         /(3.0_wp + sand%a**2 - sqrt(3.0_wp)*sand%a &
         *((sand%ei - sand%ed)/(sand%ec - sand%ed))**sand%alpha)
   end function new_sand

   ! Rate of stress (list without engineering factors) and void ratio y for a strain rate d (tensor
   ! components); with `is_linear` the part that is linear in it.
   pure subroutine find_rate(sand, y, d, rate, is_linear, is_bad)
      type(sand_type), intent(in) :: sand
      real(wp), intent(in) :: y(:), d(:)
      real(wp), intent(out) :: rate(:)
      logical, intent(in) :: is_linear
      logical, intent(out) :: is_bad
      real(wp) :: t(size(d)), s(size(d)), twice(size(d)), trace, density, f, fs, fd, e

      rate = 0.0_wp
      twice = 2.0_wp
      twice(:3) = 1.0_wp
      t = y(:size(d))
      t(:3) = t(:3) - sand%shift
      trace = sum(t(:3))
      e = y(size(y))
      is_bad = .not. (trace < -1.0e-3_wp*sand%shift .and. e > 0.0_wp)
      if (is_bad) return
      t = t/trace
      s = t
      s(:3) = s(:3) - 1.0_wp/3.0_wp
      f = shape_of(s, norm2(sqrt(twice)*s))
      density = exp(-(-trace/sand%hs)**sand%n)
      fd = max((e - sand%ed*density)/((sand%ec - sand%ed)*density), 0.0_wp)**sand%alpha
      fs = sand%factor*(1.0_wp + 1.0_wp/(sand%ei*density)) &
         *(-trace/sand%hs)**(1.0_wp - sand%n)*(sand%ec*density/e)**sand%beta/sum(twice*t**2)
      rate(:size(d)) = f**2*d + sand%a**2*t*sum(twice*t*d)
      if (.not. is_linear) rate(:size(d)) = rate(:size(d)) &
         + fd*sand%a*f*(t + s)*norm2(sqrt(twice)*d)
      rate = fs*rate
      rate(size(y)) = (1.0_wp + e)*sum(d(:3))
   end subroutine find_rate

   ! F of Matsuoka and Nakai's cone.
   pure function shape_of(s, norm) result(f)
      real(wp), intent(in) :: s(:), norm
      real(wp) :: f, tangent, cosine, m(3, 3)

      tangent = sqrt(3.0_wp)*norm
      cosine = 1.0_wp
      if (norm > 1.0e-9_wp) then
         m = 0.0_wp
         m(1, 1) = s(1)
         m(2, 2) = s(2)
         m(3, 3) = s(3)
         m(1, 2) = s(4)
         if (size(s) > 4) m(1:2, 3) = s(5:6)
         m(2, 1) = m(1, 2)
         m(3, 1:2) = m(1:2, 3)
         cosine = -sqrt(6.0_wp)*sum(m*matmul(m, m))/norm**3
      end if
      f = sqrt(tangent**2/8.0_wp + (2.0_wp - tangent**2) &
               /(2.0_wp + sqrt(2.0_wp)*tangent*cosine)) - tangent/(2.0_wp*sqrt(2.0_wp))
   end function shape_of

   ! From y by the strains d. With n_steps = 0 substeps are chosen and noted, else those given are
   ! taken.
   pure subroutine integrate(sand, y, d, steps, n_steps, is_bad)
      type(sand_type), intent(in) :: sand
      real(wp), intent(inout) :: y(:), steps(most_steps)
      real(wp), intent(in) :: d(:)
      integer, intent(inout) :: n_steps
      logical, intent(out) :: is_bad
      real(wp) :: k(size(y), 4), new(size(y)), h, done, error
      logical :: is_free, bad(4)
      integer :: i, n_tries

      is_free = n_steps == 0
      done = 0.0_wp
      h = 1.0_wp
      i = 0
      do n_tries = 1, 3*most_steps
         if (.not. is_free) then
            if (i == n_steps) return
            h = steps(i + 1)
         end if
         call find_rate(sand, y, d, k(:, 1), .false., bad(1))
         call find_rate(sand, y + 0.5_wp*h*k(:, 1), d, k(:, 2), .false., bad(2))
         call find_rate(sand, y + 0.75_wp*h*k(:, 2), d, k(:, 3), .false., bad(3))
         new = y + h*(2.0_wp*k(:, 1) + 3.0_wp*k(:, 2) + 4.0_wp*k(:, 3))/9.0_wp
         call find_rate(sand, new, d, k(:, 4), .false., bad(4))
         is_bad = any(bad)
         if (is_bad .and. .not. is_free) return
         error = 10.0_wp
         if (.not. is_bad) error = norm2(h*matmul(k, [-5.0_wp, 6.0_wp, 8.0_wp, -9.0_wp]/72.0_wp)) &
            /(accuracy*norm2([new(:3) - sand%shift, new(4:)]))
         if (.not. is_free .or. error <= 1.0_wp) then
            i = i + 1
            steps(i) = h
            y = new
            done = done + h
         end if
         if (is_free) then
            n_steps = i
            if (done >= 1.0_wp - 1.0e-12_wp) return
            if (i == most_steps) exit
            h = min(h*min(5.0_wp, max(0.2_wp, 0.9_wp/max(error, 1.0e-9_wp)**(1.0_wp/3.0_wp))), &
                    1.0_wp - done)
         end if
      end do
      is_bad = .true.
   end subroutine integrate

   ! The part of d rate/d strain that is linear, by columns of tensor components.
   pure subroutine linear_moduli(sand, y, moduli)
      type(sand_type), intent(in) :: sand
      real(wp), intent(in) :: y(:)
      real(wp), intent(out) :: moduli(:, :)
      real(wp) :: rate(size(y)), d(size(moduli, 1))
      logical :: is_bad
      integer :: k

      do k = 1, size(d)
         d = 0.0_wp
         d(k) = merge(1.0_wp, 0.5_wp, k <= 3)
         call find_rate(sand, y, d, rate, .true., is_bad)
         moduli(:, k) = rate(:size(d))
      end do
   end subroutine linear_moduli

end module hypoplastic_sand

subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, &
                stran, dstran, time, dtime, temp, dtemp, predef, dpred, cmname, &
                ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, &
                celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, jstep, kinc)
   use hypoplastic_sand, only: integrate, linear_moduli, most_steps, new_sand, sand_type, wp
   include 'ABA_PARAM.INC'
   character(len=80) :: cmname
   character(len=8) :: words(1)
   dimension stress(ntens), statev(nstatv), ddsdde(ntens, ntens), ddsddt(ntens), drplde(ntens), &
      stran(ntens), dstran(ntens), time(2), predef(1), dpred(1), props(nprops), coords(3), &
      drot(3, 3), dfgrd0(3, 3), dfgrd1(3, 3), jstep(4)
   type(sand_type) :: sand
   real(wp) :: first(ntens + 1), y(ntens + 1), side(ntens + 1, 2), d(ntens), shifted(ntens)
   real(wp) :: steps(most_steps), shift
   logical :: is_bad

   if (nprops /= 9 .or. nstatv /= 2) call stdb_abqerr(-3, &
      'hypoplastic sand needs 9 constants and 2 state variables, not %I and %I', &
      [nprops, nstatv], [0.0d0], words)
   sand = new_sand(props)
   first(:ntens) = stress
   first(ntens + 1) = statev(1)
   d = dstran
   d(4:) = 0.5_wp*d(4:)
   shift = norm2(d)
   if (.not. shift > 0.0_wp) then
      call linear_moduli(sand, first, ddsdde)
      return
   end if
   y = first
   n_steps = 0
   call integrate(sand, y, d, steps, n_steps, is_bad)
   if (is_bad) then
      pnewdt = 0.5d0
      return
   end if
   shift = 1.0e-5_wp*shift + 1.0e-12_wp
   do k = 1, ntens
      do i = 1, 2
         shifted = d
         shifted(k) = shifted(k) + merge(-0.5_wp, 0.5_wp, i == 1)*shift*merge(2.0_wp, 1.0_wp, k <= 3)
         side(:, i) = first
         call integrate(sand, side(:, i), shifted, steps, n_steps, is_bad)
      end do
      ddsdde(:, k) = (side(:ntens, 2) - side(:ntens, 1))/(2.0_wp*shift)
   end do
   stress = y(:ntens)
   statev(1) = y(ntens + 1)
   statev(2) = n_steps
end subroutine umat
