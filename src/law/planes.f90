!> Return of a trial stress to the planes that bound the elastic range, edges and apex included.
!>
!> With linear elasticity and planes in principal stress space the return is exact: for every set of
!> planes that may be active together one small system is solved, and the set whose multipliers are
!> not negative and that violates no other plane is the answer (Koiter, W. T. (1953), Quart. Appl.
!> Math. 11, 350-354; Clausen, J. et al. (2007), Comput. Struct. 85, 1795-1807). There is no
!> iteration that could fail.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_planes
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: planes_type, return_type, return_to_planes

   !> Largest number of planes and of stress components.
   integer, parameter :: max_planes = 6, max_active = 3

   !> Pulls below this share of the trial stress come from round-off, as do pivots below this share
   !> of their diagonal.
   real(wp), parameter :: round_off = 1.0e-14_wp, least_pivot = 1.0e-10_wp

   !> Planes normal . stress = offset with flow directions, and how these change with a hardening
   !> variable h. Used are the first components.
   type :: planes_type
      !> How many there are.
      integer :: n = 0
      !> Normals into the forbidden side, shape (stress component, plane).
      real(wp) :: normal(max_active, max_planes) = 0.0_wp
      !> Directions of plastic strain, shape as `normal`.
      real(wp) :: flow(max_active, max_planes) = 0.0_wp
      !> Offsets, stress units.
      real(wp) :: offset(max_planes) = 0.0_wp
      !> Derivatives of these by h.
      real(wp) :: normal_slope(max_active, max_planes) = 0.0_wp
      real(wp) :: flow_slope(max_active, max_planes) = 0.0_wp
      real(wp) :: offset_slope(max_planes) = 0.0_wp
   end type planes_type

   !> The stress that the planes allow.
   type :: return_type
      !> Stress, and its derivative by h; shape (n).
      real(wp) :: stress(max_active), slope(max_active)
      !> d stress / d trial strain, shape (n, n).
      real(wp) :: tangent(max_active, max_active)
      !> Plastic strain of the step, shape (n).
      real(wp) :: plastic(max_active)
      !> Largest stress by which a plane is violated, or by which an active one would have to pull.
      real(wp) :: violation
   end type return_type

contains

   !> Try sets of planes and keep the one that fits.
   pure subroutine return_to_planes(n, stiffness, trial, planes, sets, found)
      !> Number of stress components.
      integer, intent(in) :: n
      !> Elastic stiffness.
      real(wp), intent(in) :: stiffness(n, n)
      !> Trial stress.
      real(wp), intent(in) :: trial(n)
      !> Planes.
      type(planes_type), intent(in) :: planes
      !> Sets of planes to try, most likely first, filled with zeros, shape (max_active, n_sets).
      integer, intent(in) :: sets(:, :)
      !> The answer; `violation` is round-off unless no set fits.
      type(return_type), intent(out) :: found
      type(return_type) :: candidate
      integer :: k
      logical :: is_solved

      found%violation = huge(1.0_wp)
      do k = 1, size(sets, 2)
         call activate(n, stiffness, trial, planes, sets(:count(sets(:, k) > 0), k), candidate, &
                       is_solved)
         if (.not. is_solved) cycle
         if (candidate%violation < found%violation) found = candidate
         if (found%violation <= 0.0_wp) return
      end do
   end subroutine return_to_planes

   !> Stress on a set of planes: s = trial - D B l with A s = k, where the columns of A' and B are
   !> normals and flow directions; differentiated, also the tangent and the slope by h.
   pure subroutine activate(n, stiffness, trial, planes, set, found, is_solved)
      integer, intent(in) :: n, set(:)
      real(wp), intent(in) :: stiffness(n, n), trial(n)
      type(planes_type), intent(in) :: planes
      type(return_type), intent(out) :: found
      logical, intent(out) :: is_solved
      real(wp) :: normal(n, size(set)), flow(n, size(set)), inverse(size(set), size(set))
      real(wp) :: multiplier(size(set)), stress(n), slope(size(set)), back(n, size(set))
      real(wp) :: pull
      integer :: i, pass

      normal = planes%normal(:n, set)
      flow = planes%flow(:n, set)
      back = matmul(stiffness, flow)
      call invert(matmul(transpose(normal), back), inverse, is_solved)
      if (.not. is_solved) return
      multiplier = 0.0_wp
      stress = trial
      do pass = 1, 2
         ! the second pass takes out the round-off of the first, large for far trial stresses
         slope = matmul(inverse, matmul(transpose(normal), stress) - planes%offset(set))
         multiplier = multiplier + slope
         stress = stress - matmul(back, slope)
      end do
      associate (flow_slope => matmul(planes%flow_slope(:n, set), multiplier))
         slope = matmul(inverse, matmul(transpose(planes%normal_slope(:n, set)), stress) &
                        - planes%offset_slope(set) &
                        - matmul(transpose(normal), matmul(stiffness, flow_slope)))
         found%slope(:n) = -matmul(back, slope) - matmul(stiffness, flow_slope)
      end associate
      found%stress(:n) = stress
      found%plastic(:n) = matmul(flow, multiplier)
      found%tangent(:n, :n) = stiffness &
         - matmul(back, matmul(inverse, matmul(transpose(normal), stiffness)))
      found%violation = 0.0_wp
      do i = 1, size(set)
         pull = -multiplier(i)*dot_product(normal(:, i), back(:, i))
         if (pull > round_off*maxval(abs(trial))) found%violation = max(found%violation, pull)
      end do
      do i = 1, planes%n
         if (any(set == i)) cycle
         found%violation = max(found%violation, &
                               dot_product(planes%normal(:n, i), stress) - planes%offset(i))
      end do
   end subroutine activate

   !> Inverse of a small matrix by Gauss-Jordan elimination without exchange of rows: the pivots of
   !> positive definite matrices, and of those near them, are large enough.
   pure subroutine invert(matrix, inverse, is_solved)
      real(wp), intent(in) :: matrix(:, :)
      real(wp), intent(out) :: inverse(:, :)
      logical, intent(out) :: is_solved
      real(wp) :: pivot
      integer :: i, j

      inverse = matrix
      is_solved = .true.
      do i = 1, size(matrix, 1)
         pivot = inverse(i, i)
         is_solved = abs(pivot) > least_pivot*abs(matrix(i, i))
         if (.not. is_solved) return
         inverse(i, i) = 1.0_wp
         inverse(i, :) = inverse(i, :)/pivot
         do j = 1, size(matrix, 1)
            if (j == i) cycle
            pivot = inverse(j, i)
            inverse(j, i) = 0.0_wp
            inverse(j, :) = inverse(j, :) - pivot*inverse(i, :)
         end do
      end do
   end subroutine invert

end module coulter_law_planes
