C     Hencky elasticity from the total deformation gradient: Kirchhoff stress linear in 1/2 ln(F FT).
C     It needs DFGRD1 and principal directions, and no memory.
C     PROPS: Young's modulus, Poisson's ratio.
C     SPDX-License-Identifier: BSD-3-Clause
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,
     1 RPL,DDSDDT,DRPLDE,DRPLDT,
     2 STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,CMNAME,
     3 NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     4 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
      INCLUDE 'ABA_PARAM.INC'
      CHARACTER*80 CMNAME
      DIMENSION STRESS(NTENS),STATEV(NSTATV),
     1 DDSDDE(NTENS,NTENS),DDSDDT(NTENS),DRPLDE(NTENS),
     2 STRAN(NTENS),DSTRAN(NTENS),TIME(2),PREDEF(1),DPRED(1),
     3 PROPS(NPROPS),COORDS(3),DROT(3,3),DFGRD0(3,3),DFGRD1(3,3),
     4 JSTEP(4)
      DIMENSION B(3,3),BV(6),PS(3),AN(3,3),TAU(3)
      G=PROPS(1)/(2.0D0*(1.0D0+PROPS(2)))
      ELAM=2.0D0*G*PROPS(2)/(1.0D0-2.0D0*PROPS(2))
      B=MATMUL(DFGRD1,TRANSPOSE(DFGRD1))
      BV=0.0D0
      DO 10 I=1,3
 10   BV(I)=B(I,I)
      BV(4)=B(1,2)
      CALL SPRIND(BV,PS,AN,1,NDI,NSHR)
      PS=0.5D0*LOG(PS)
      DET=EXP(SUM(PS))
      TAU=ELAM*SUM(PS)+2.0D0*G*PS
      DO 20 I=1,3
 20   STRESS(I)=SUM(TAU*AN(:,I)**2)/DET
      STRESS(4)=SUM(TAU*AN(:,1)*AN(:,2))/DET
C     the tangent holds for steps that are coaxial with what was before
      DDSDDE=0.0D0
      DDSDDE(1:3,1:3)=ELAM/DET
      DO 30 I=1,3
 30   DDSDDE(I,I)=DDSDDE(I,I)+2.0D0*G/DET
      DDSDDE(4,4)=G/DET
      DO 40 J=1,3
 40   DDSDDE(:,J)=DDSDDE(:,J)-STRESS
      RETURN
      END
