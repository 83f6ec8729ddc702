! Mohr-Coulomb, perfectly plastic, not associated: return in principal stresses to plane, edge or
! apex with the consistent tangent (de Souza Neto, Peric & Owen 2008, chapter 8).
! props: Young's modulus, Poisson's ratio, cohesion, friction angle, dilation angle (degrees).
! statev: norm of the plastic strain in principal values, added up.
! SPDX-License-Identifier: BSD-3-Clause
module mohr_coulomb_return
   implicit none
   private
   public :: return_principal, wp
   integer, parameter :: wp = kind(1.0d0)

contains

   ! Principal stresses s, largest first, back to the surface; tangent d s/d (elastic strain).
   subroutine return_principal(s, d, cohesion, sin_friction, cos_friction, sin_dilation, tangent)
      real(wp), intent(inout) :: s(3), tangent(3, 3)
      real(wp), intent(in) :: d(3, 3), cohesion, sin_friction, cos_friction, sin_dilation
      real(wp) :: normal(3, 3), flow(3, 3), trial(3), size

      ! planes 13, 12, 23: f = s_i - s_j + (s_i + s_j) sin - 2 c cos
      normal = planes(sin_friction)
      flow = planes(sin_dilation)
      tangent = d
      trial = s
      size = abs(s(1)) + abs(s(3)) + cohesion
      if (excess(1) <= 1.0e-14_wp*size) return
      call project(1)
      if (s(1) >= s(2) .and. s(2) >= s(3)) return
      call project(merge(2, 3, s(3) > s(2)))  ! the edge that the return to the plane has passed
      if (.not. sin_friction > 0.0_wp) return
      if (s(1) <= cohesion*cos_friction/sin_friction) return
      s = cohesion*cos_friction/sin_friction
      tangent = 0.0_wp

   contains

      real(wp) function excess(plane)
         integer, intent(in) :: plane

         excess = dot_product(normal(:, plane), trial) - 2.0_wp*cohesion*cos_friction
      end function excess

      ! To plane 13 alone (1), or to it and plane 12 (2) or 23 (3).
      subroutine project(case)
         integer, intent(in) :: case
         real(wp) :: a(3, 2), b(3, 2), m(2, 2), g(2), determinant

         a = normal(:, [1, case])
         b = matmul(d, flow(:, [1, case]))
         if (case == 1) then
            g(1) = excess(1)/dot_product(a(:, 1), b(:, 1))
            s = trial - b(:, 1)*g(1)
            tangent = d - spread(b(:, 1), 2, 3)*spread(matmul(a(:, 1), d), 1, 3) &
               /dot_product(a(:, 1), b(:, 1))
            return
         end if
         m = matmul(transpose(a), b)
         determinant = m(1, 1)*m(2, 2) - m(1, 2)*m(2, 1)
         m = reshape([m(2, 2), -m(2, 1), -m(1, 2), m(1, 1)], [2, 2])/determinant
         g = matmul(m, [excess(1), excess(case)])
         s = trial - matmul(b, g)
         tangent = d - matmul(b, matmul(m, matmul(transpose(a), d)))
      end subroutine project

   end subroutine return_principal

   pure function planes(sine) result(n)
      real(wp), intent(in) :: sine
      real(wp) :: n(3, 3)

      n(:, 1) = [1.0_wp + sine, 0.0_wp, -1.0_wp + sine]
      n(:, 2) = [1.0_wp + sine, -1.0_wp + sine, 0.0_wp]
      n(:, 3) = [0.0_wp, 1.0_wp + sine, -1.0_wp + sine]
   end function planes

end module mohr_coulomb_return

subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, &
                stran, dstran, time, dtime, temp, dtemp, predef, dpred, cmname, &
                ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, &
                celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, jstep, kinc)
   use mohr_coulomb_return, only: return_principal, wp
   include 'ABA_PARAM.INC'
   character(len=80) :: cmname
   dimension stress(ntens), statev(nstatv), ddsdde(ntens, ntens), ddsddt(ntens), drplde(ntens), &
      stran(ntens), dstran(ntens), time(2), predef(1), dpred(1), props(nprops), coords(3), &
      drot(3, 3), dfgrd0(3, 3), dfgrd1(3, 3), jstep(4)
   real(wp) :: d(3, 3), trial(3), s(3), axes(3, 3), tangent(3, 3), list(6), along(4), degree, ratio

   g = 0.5d0*props(1)/(1.0d0 + props(2))
   elam = 2.0d0*g*props(2)/(1.0d0 - 2.0d0*props(2))
   degree = acos(-1.0_wp)/180.0_wp
   d = elam
   do i = 1, 3
      d(i, i) = elam + 2.0d0*g
   end do
   stress(1:3) = stress(1:3) + matmul(d, dstran(1:3))
   stress(4:) = stress(4:) + g*dstran(4:)
   list(1:ntens) = stress
   call sprind(list, trial, axes, 1, ndi, nshr)
   s = trial
   call return_principal(s, d, props(3), sin(props(4)*degree), cos(props(4)*degree), &
                         sin(props(5)*degree), tangent)
   statev(1) = statev(1) + norm2((trial - s)/(2.0d0*g) &
                                 - elam*sum(trial - s)/(2.0d0*g*(3.0d0*elam + 2.0d0*g)))
   stress = 0.0d0
   ddsdde = 0.0d0
   do i = 1, 3
      stress = stress + s(i)*dyad(i, i)
      do j = 1, 3
         ddsdde = ddsdde + tangent(i, j)*spread(dyad(i, i), 2, 4)*spread(dyad(j, j), 1, 4)
      end do
   end do
   do i = 1, 2
      do j = i + 1, 3
         ratio = tangent(i, i) - tangent(i, j)
         if (trial(i) - trial(j) > 1.0e-9_wp*g) ratio = 2.0d0*g*(s(i) - s(j))/(trial(i) - trial(j))
         along = sqrt(2.0_wp)*dyad(i, j)
         ddsdde = ddsdde + ratio*spread(along, 2, 4)*spread(along, 1, 4)
      end do
   end do

contains

   ! Symmetric dyad of two axes: 11, 22, 33, 12.
   function dyad(p, q)
      integer, intent(in) :: p, q
      real(wp) :: dyad(4)

      dyad(1:3) = axes(p, :)*axes(q, :)
      dyad(4) = 0.5_wp*(axes(p, 1)*axes(q, 2) + axes(p, 2)*axes(q, 1))
   end function dyad

end subroutine umat
