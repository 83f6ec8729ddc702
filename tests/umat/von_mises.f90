! Von Mises plasticity with linear isotropic hardening: radial return with the consistent tangent of
! Simo & Taylor (1985), in free form.
! props: Young's modulus, Poisson's ratio, yield stress, hardening modulus.
! statev: equivalent plastic strain, then the elastic strain 11, 22, 33, 12.
! SPDX-License-Identifier: BSD-3-Clause
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, &
                stran, dstran, time, dtime, temp, dtemp, predef, dpred, cmname, &
                ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, &
                celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, jstep, kinc)
   include 'aba_param.inc'
   character(len=80) :: cmname
   dimension stress(ntens), statev(nstatv), ddsdde(ntens, ntens), ddsddt(ntens), drplde(ntens), &
      stran(ntens), dstran(ntens), time(2), predef(1), dpred(1), props(nprops), coords(3), &
      drot(3, 3), dfgrd0(3, 3), dfgrd1(3, 3), jstep(4)
   double precision :: flow(6), elastic(6), unit(6)
   double precision :: g, bulk, mises, plastic, mean, lambda, yield, ratio, slope

   g = 0.5d0*props(1)/(1.0d0 + props(2))
   bulk = props(1)/(3.0d0*(1.0d0 - 2.0d0*props(2)))
   lambda = bulk - 2.0d0*g/3.0d0
   unit = [1.0d0, 1.0d0, 1.0d0, 0.0d0, 0.0d0, 0.0d0]
   call rotsig(statev(2), drot, elastic, 2, ndi, nshr)
   elastic(1:ntens) = elastic(1:ntens) + dstran

   stress(1:ndi) = stress(1:ndi) + lambda*sum(dstran(1:ndi)) + 2.0d0*g*dstran(1:ndi)
   stress(ndi + 1:ntens) = stress(ndi + 1:ntens) + g*dstran(ndi + 1:ntens)
   call sinv(stress, mean, mises, ndi, nshr)

   ddsdde = 0.0d0
   ddsdde(1:ndi, 1:ndi) = lambda
   do k = 1, ndi
      ddsdde(k, k) = lambda + 2.0d0*g
   end do
   do k = ndi + 1, ntens
      ddsdde(k, k) = g
   end do
   yield = props(3) + props(4)*statev(1)
   if (mises > yield) then
      plastic = (mises - yield)/(3.0d0*g + props(4))
      flow(1:ntens) = 1.5d0*(stress - mean*unit(1:ntens))/mises
      stress = stress - 2.0d0*g*plastic*flow(1:ntens)
      statev(1) = statev(1) + plastic
      elastic(1:ndi) = elastic(1:ndi) - plastic*flow(1:ndi)
      elastic(ndi + 1:ntens) = elastic(ndi + 1:ntens) - 2.0d0*plastic*flow(ndi + 1:ntens)
      ratio = 3.0d0*g*plastic/mises
      slope = 4.0d0*g**2*(1.0d0/(3.0d0*g + props(4)) - plastic/mises)
      ddsdde = ddsdde*(1.0d0 - ratio)
      ddsdde(1:ndi, 1:ndi) = ddsdde(1:ndi, 1:ndi) + bulk*ratio
      do k = 1, ntens
         ddsdde(:, k) = ddsdde(:, k) - slope*flow(1:ntens)*flow(k)
      end do
   end if
   statev(2:ntens + 1) = elastic(1:ntens)
end subroutine umat
