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

   !> Stress components, of which there may be fewer: the others are 0, as are their stiffnesses;
   !> and the largest number of planes.
   integer, parameter, public :: n_stress = 3
   integer, parameter :: max_planes = 6

   !> Pulls below this share of the trial stress come from round-off, as do pivots below this share
   !> of their diagonal.
   real(wp), parameter :: round_off = 1.0e-14_wp, least_pivot = 1.0e-10_wp

   !> Planes normal . stress = offset with flow directions, and how these change with a hardening
   !> variable h. Used are the first components.
   type :: planes_type
      !> How many there are.
      integer :: n = 0
      !> Normals into the forbidden side, shape (stress component, plane).
      real(wp) :: normal(n_stress, max_planes) = 0.0_wp
      !> Directions of plastic strain, shape as `normal`.
      real(wp) :: flow(n_stress, max_planes) = 0.0_wp
      !> Offsets, stress units.
      real(wp) :: offset(max_planes) = 0.0_wp
      !> Derivatives of these by h.
      real(wp) :: normal_slope(n_stress, max_planes) = 0.0_wp
      real(wp) :: flow_slope(n_stress, max_planes) = 0.0_wp
      real(wp) :: offset_slope(max_planes) = 0.0_wp
   end type planes_type

   !> The stress that the planes allow.
   type :: return_type
      !> Stress, and its derivative by h; shape (n).
      real(wp) :: stress(n_stress), slope(n_stress)
      !> d stress / d trial strain, shape (n, n).
      real(wp) :: tangent(n_stress, n_stress)
      !> Plastic strain of the step, shape (n).
      real(wp) :: plastic(n_stress)
      !> Largest stress by which a plane is violated, or by which an active one would have to pull.
      real(wp) :: violation
   end type return_type

contains

   !> Try sets of planes and keep the one that fits.
   pure subroutine return_to_planes(stiffness, trial, planes, sets, found)
      !> Elastic stiffness.
      real(wp), intent(in) :: stiffness(n_stress, n_stress)
      !> Trial stress.
      real(wp), intent(in) :: trial(n_stress)
      !> Planes.
      type(planes_type), intent(in) :: planes
      !> Sets of planes to try, most likely first, filled with zeros, shape (n_stress, n_sets).
      integer, intent(in) :: sets(:, :)
      !> The answer; `violation` is round-off unless no set fits.
      type(return_type), intent(out) :: found
      type(return_type) :: candidate
      integer :: k
      logical :: is_solved

      found%violation = huge(1.0_wp)
      do k = 1, size(sets, 2)
         call activate(stiffness, trial, planes, sets(:, k), candidate, is_solved)
         if (.not. is_solved) cycle
         if (candidate%violation < found%violation) found = candidate
         if (found%violation <= 0.0_wp) return
      end do
   end subroutine return_to_planes

   !> Stress on a set of planes: s = trial - D B l with A s = k, where the columns of A' and B are
   !> normals and flow directions, 0 for planes that the set lacks; differentiated, also the tangent
   !> and the slope by h.
   pure subroutine activate(stiffness, trial, planes, set, found, is_solved)
      real(wp), intent(in) :: stiffness(n_stress, n_stress), trial(n_stress)
      type(planes_type), intent(in) :: planes
      integer, intent(in) :: set(n_stress)
      type(return_type), intent(out) :: found
      logical, intent(out) :: is_solved
      real(wp), dimension(n_stress, n_stress) :: normal, flow, back, inverse, normal_slope
      real(wp), dimension(n_stress) :: offset, offset_slope, multiplier, slope, stress, turn
      integer :: n, pass

      n = count(set > 0)
      normal = chosen(planes%normal, set)
      flow = chosen(planes%flow, set)
      back = matmul(stiffness, flow)
      call invert(n, matmul(transpose(normal), back), inverse, is_solved)
      if (.not. is_solved) return
      offset = 0.0_wp
      offset(:n) = planes%offset(set(:n))
      multiplier = 0.0_wp
      stress = trial
      do pass = 1, 2
         ! the second pass takes out the round-off of the first, large for far trial stresses
         slope = matmul(inverse, matmul(transpose(normal), stress) - offset)
         multiplier = multiplier + slope
         stress = stress - matmul(back, slope)
      end do
      offset_slope = 0.0_wp
      offset_slope(:n) = planes%offset_slope(set(:n))
      normal_slope = chosen(planes%normal_slope, set)
      turn = matmul(stiffness, matmul(chosen(planes%flow_slope, set), multiplier))
      slope = matmul(inverse, matmul(transpose(normal_slope), stress) - offset_slope &
                     - matmul(transpose(normal), turn))
      found%slope = -matmul(back, slope) - turn
      found%stress = stress
      found%plastic = matmul(flow, multiplier)
      found%tangent = stiffness &
         - matmul(back, matmul(inverse, matmul(transpose(normal), stiffness)))
      found%violation = violation_of(planes, set(:n), stress, &
                                     -multiplier*sum(normal*back, dim=1), maxval(abs(trial)))
   end subroutine activate

   !> Columns of a set of planes, 0 for those that it lacks.
   pure function chosen(columns, set)
      real(wp), intent(in) :: columns(n_stress, max_planes)
      integer, intent(in) :: set(n_stress)
      real(wp) :: chosen(n_stress, n_stress)
      integer :: i

      chosen = 0.0_wp
      do i = 1, n_stress
         if (set(i) > 0) chosen(:, i) = columns(:, set(i))
      end do
   end function chosen

   !> Largest stress by which an active plane pulls, beyond round-off, or another one is violated.
   pure function violation_of(planes, set, stress, pull, scale) result(violation)
      type(planes_type), intent(in) :: planes
      integer, intent(in) :: set(:)
      real(wp), intent(in) :: stress(n_stress), pull(n_stress), scale
      real(wp) :: violation
      integer :: i

      violation = 0.0_wp
      do i = 1, size(set)
         if (pull(i) > round_off*scale) violation = max(violation, pull(i))
      end do
      do i = 1, planes%n
         if (any(set == i)) cycle
         violation = max(violation, dot_product(planes%normal(:, i), stress) - planes%offset(i))
      end do
   end function violation_of

   !> Inverse of the first n rows and columns of a matrix by Gauss-Jordan elimination without
   !> exchange of rows: the pivots of positive definite matrices, and of those near them, are large
   !> enough.
   pure subroutine invert(n, matrix, inverse, is_solved)
      integer, intent(in) :: n
      real(wp), intent(in) :: matrix(n_stress, n_stress)
      real(wp), intent(out) :: inverse(n_stress, n_stress)
      logical, intent(out) :: is_solved
      real(wp) :: pivot
      integer :: i, j

      inverse = matrix
      is_solved = .true.
      do i = 1, n
         pivot = inverse(i, i)
         is_solved = abs(pivot) > least_pivot*abs(matrix(i, i))
         if (.not. is_solved) return
         inverse(i, i) = 1.0_wp
         inverse(i, :) = inverse(i, :)/pivot
         do j = 1, n
            if (j == i) cycle
            pivot = inverse(j, i)
            inverse(j, i) = 0.0_wp
            inverse(j, :) = inverse(j, :) - pivot*inverse(i, :)
         end do
      end do
   end subroutine invert

end module coulter_law_planes
