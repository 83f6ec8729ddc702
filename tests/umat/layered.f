C     Elasticity stiffer along an axis that turns with the material, in three dimensions only:
C     STRESS rate = LAMBDA tr D + 2 G D + K (A.D.A) A A. An axis out of the plane makes shear
C     stresses 13 and 23 there.
C     PROPS: LAMBDA, G, K. STATEV: the axis A.
C     SPDX-License-Identifier: BSD-3-Clause
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,
     1 RPL,DDSDDT,DRPLDE,DRPLDT,
     2 STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,CMNAME,
     3 NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     4 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
      INCLUDE 'ABA_PARAM.INC'
      CHARACTER*80 CMNAME
      DIMENSION STRESS(6),STATEV(3),
     1 DDSDDE(6,6),DDSDDT(6),DRPLDE(6),
     2 STRAN(6),DSTRAN(6),TIME(2),PREDEF(1),DPRED(1),
     3 PROPS(3),COORDS(3),DROT(3,3),DFGRD0(3,3),DFGRD1(3,3),
     4 JSTEP(4)
      DIMENSION A(3),V(6),INTV(2),REALV(1)
      CHARACTER*8 CHARV(1)
      IF (NDI.NE.3.OR.NSHR.NE.3.OR.NTENS.NE.6) THEN
         INTV(1)=NDI
         INTV(2)=NSHR
         CALL STDB_ABQERR(-3,'layered: NDI = 3, NSHR = 3, not %I, %I',
     1    INTV,REALV,CHARV)
      ENDIF
      DO 10 I=1,3
      A(I)=0.0D0
      DO 10 J=1,3
 10   A(I)=A(I)+DROT(I,J)*STATEV(J)
      DO 20 I=1,3
      STATEV(I)=A(I)
 20   V(I)=A(I)*A(I)
      V(4)=A(1)*A(2)
      V(5)=A(1)*A(3)
      V(6)=A(2)*A(3)
      DO 30 I=1,6
      DO 30 J=1,6
      DDSDDE(I,J)=PROPS(3)*V(I)*V(J)
      IF (I.LE.3.AND.J.LE.3) DDSDDE(I,J)=DDSDDE(I,J)+PROPS(1)
      IF (I.EQ.J.AND.I.LE.3) DDSDDE(I,J)=DDSDDE(I,J)+2.0D0*PROPS(2)
 30   IF (I.EQ.J.AND.I.GT.3) DDSDDE(I,J)=DDSDDE(I,J)+PROPS(2)
      DO 40 I=1,6
      DO 40 J=1,6
 40   STRESS(I)=STRESS(I)+DDSDDE(I,J)*DSTRAN(J)
      RETURN
      END
