! Linear elasticity that misbehaves in the way that its constants ask for.
! props: Young's modulus, Poisson's ratio, fault, volume strain of an increment at which it occurs.
! Faults: 1 NaN in the stress, 2 XIT, 3 an error message, 4 pnewdt = 0.25, 5 NaN in the tangent,
! 6 a tangent that is 10 % off, 7 stress that changes without strain, 8 a remark.
! SPDX-License-Identifier: BSD-3-Clause
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, &
                stran, dstran, time, dtime, temp, dtemp, predef, dpred, cmname, &
                ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, &
                celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, jstep, kinc)
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   include 'ABA_PARAM.INC'
   character(len=80) :: cmname
   character(len=8) :: words(1)
   dimension stress(ntens), statev(nstatv), ddsdde(ntens, ntens), ddsddt(ntens), drplde(ntens), &
      stran(ntens), dstran(ntens), time(2), predef(1), dpred(1), props(nprops), coords(3), &
      drot(3, 3), dfgrd0(3, 3), dfgrd1(3, 3), jstep(4)

   g = 0.5d0*props(1)/(1.0d0 + props(2))
   elam = 2.0d0*g*props(2)/(1.0d0 - 2.0d0*props(2))
   ddsdde = 0.0d0
   ddsdde(1:3, 1:3) = elam
   do k = 1, 3
      ddsdde(k, k) = elam + 2.0d0*g
   end do
   ddsdde(4:, 4:) = g
   stress = stress + matmul(ddsdde, dstran)
   if (abs(sum(dstran(1:3))) < props(4)) return
   words(1) = cmname(1:8)
   select case (nint(props(3)))
   case (1)
      stress(2) = ieee_value(stress(2), ieee_quiet_nan)
   case (2)
      call xit
   case (3)
      call stdb_abqerr(-3, 'point %I of %S: volume strain %R', [npt], [sum(dstran(1:3))], words)
   case (4)
      pnewdt = 0.25d0
   case (5)
      ddsdde(1, 4) = ieee_value(stress(2), ieee_quiet_nan)
   case (6)
      ddsdde = 1.1d0*ddsdde
   case (7)
      stress(1) = stress(1) + 1.0d0
   case (8)
      call stdb_abqerr(1, 'remark', [0], [0.0d0], words)
   end select
end subroutine umat
