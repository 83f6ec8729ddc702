!> Isotropic laws in principal axes: from the tensor to its eigenvalues, through the law, and back.
!>
!> Stress and elastic strain of an isotropic law share their axes with the trial strain, so that a
!> law need only map three numbers to three (Simo, J. C. (1992), Comput. Methods Appl. Mech. Engrg.
!> 99, 61-112). The axis zz is principal; the turn of the other two enters the tangent by the
!> quotient (tau_1 - tau_2)/(eps_1 - eps_2).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_principal
   use coulter_base_kinds, only: wp
   use coulter_law_abstract, only: law_response_type, law_type, law_visit_type, n_plane
   implicit none(type, external)
   private
   public :: principal_law_type, principal_response_type, split_axes, join_axes

   !> What an isotropic law answers in principal axes: the two in the plane, then zz.
   type :: principal_response_type
      !> Principal Kirchhoff stresses, tension positive.
      real(wp) :: stress(3)
      !> d stress(i) / d trial(j).
      real(wp) :: tangent(3, 3)
      !> Principal logarithmic elastic strains.
      real(wp) :: strain(3)
      !> Did the law fail?
      logical :: has_failed
   end type principal_response_type

   !> A law that is the same in all directions.
   type, abstract, extends(law_type) :: principal_law_type
   contains
      procedure :: update => update_in_axes
      procedure(principal_interface), deferred :: update_principal
   end type principal_law_type

   !> Strains whose difference is below this share of the largest count as equal: there the limit of
   !> the quotient and the quotient itself are equally accurate.
   real(wp), parameter :: equal_strains = 1.0e-8_wp

   abstract interface
      !> The law in principal axes, in any order; see `update_interface`.
      pure subroutine principal_interface(self, visit, trial, state, response, new_state)
         import :: law_visit_type, principal_law_type, principal_response_type, wp
         implicit none (type, external)
         class(principal_law_type), intent(in) :: self
         !> Where and when.
         type(law_visit_type), intent(in) :: visit
         !> Principal logarithmic elastic trial strains.
         real(wp), intent(in) :: trial(3)
         !> State variables at the start of the step.
         real(wp), intent(in) :: state(self%n_state)
         !> Stress, tangent and elastic strain.
         type(principal_response_type), intent(out) :: response
         !> State variables at the end of the step.
         real(wp), intent(out) :: new_state(self%n_state)
      end subroutine principal_interface
   end interface

contains

   !> See `update_interface`.
   pure subroutine update_in_axes(self, visit, trial_strain, state, response, new_state)
      class(principal_law_type), intent(in) :: self
      !> Where and when.
      type(law_visit_type), intent(in) :: visit
      !> Logarithmic elastic trial strain xx, yy, zz, 2 xy.
      real(wp), intent(in) :: trial_strain(n_plane)
      !> State variables at the start of the step.
      real(wp), intent(in) :: state(self%n_state)
      !> Stress, tangent and elastic strain.
      type(law_response_type), intent(out) :: response
      !> State variables at the end of the step.
      real(wp), intent(out) :: new_state(self%n_state)
      type(principal_response_type) :: principal
      real(wp) :: trial(3), axis(2)

      call split_axes([trial_strain(:3), 0.5_wp*trial_strain(4)], trial, axis)
      call self%update_principal(visit, trial, state, principal, new_state)
      response%has_failed = principal%has_failed
      if (response%has_failed) return
      response%stress = join_axes(principal%stress, axis)
      response%strain = join_axes(principal%strain, axis)
      response%strain(4) = 2.0_wp*response%strain(4)
      call turn_tangent(principal, trial, axis, response%tangent)
   end subroutine update_in_axes

   !> Eigenvalues of a symmetric tensor, and the direction of its axes.
   pure subroutine split_axes(tensor, values, axis)
      !> Components xx, yy, zz, xy.
      real(wp), intent(in) :: tensor(n_plane)
      !> Larger and smaller one in the plane, then zz.
      real(wp), intent(out) :: values(3)
      !> Cosine and sine of twice the angle from x to the first axis.
      real(wp), intent(out) :: axis(2)
      real(wp) :: half, radius

      half = 0.5_wp*(tensor(1) - tensor(2))
      radius = hypot(half, tensor(4))
      values(:2) = 0.5_wp*(tensor(1) + tensor(2)) + [radius, -radius]
      values(3) = tensor(3)
      axis = [1.0_wp, 0.0_wp]
      if (radius > 0.0_wp) axis = [half, tensor(4)]/radius
   end subroutine split_axes

   !> Tensor with given eigenvalues and axes; see `split_axes`.
   pure function join_axes(values, axis) result(tensor)
      !> Eigenvalues: the two in the plane, then zz.
      real(wp), intent(in) :: values(3)
      !> Cosine and sine of twice the angle from x to the first axis.
      real(wp), intent(in) :: axis(2)
      !> Components xx, yy, zz, xy.
      real(wp) :: tensor(n_plane)
      real(wp) :: mean, half

      mean = 0.5_wp*(values(1) + values(2))
      half = 0.5_wp*(values(1) - values(2))
      tensor = [mean + half*axis(1), mean - half*axis(1), values(3), half*axis(2)]
   end function join_axes

   !> Tangent in x and y: Q^T D Q, where the rows of Q give the strains along and between the axes.
   pure subroutine turn_tangent(principal, trial, axis, tangent)
      type(principal_response_type), intent(in) :: principal
      real(wp), intent(in) :: trial(3), axis(2)
      real(wp), intent(out) :: tangent(n_plane, n_plane)
      real(wp) :: turn(n_plane, n_plane), in_axes(n_plane, n_plane), difference

      difference = trial(1) - trial(2)
      in_axes = 0.0_wp
      in_axes(:3, :3) = principal%tangent
      if (difference > equal_strains*maxval(abs(trial))) then
         in_axes(4, 4) = 0.5_wp*(principal%stress(1) - principal%stress(2))/difference
      else
         associate (d => principal%tangent)
            in_axes(4, 4) = 0.25_wp*(d(1, 1) + d(2, 2) - d(1, 2) - d(2, 1))
         end associate
      end if
      associate (major => 0.5_wp*(1.0_wp + axis(1)), minor => 0.5_wp*(1.0_wp - axis(1)))
         turn(1, :) = [major, minor, 0.0_wp, 0.5_wp*axis(2)]
         turn(2, :) = [minor, major, 0.0_wp, -0.5_wp*axis(2)]
         turn(3, :) = [0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp]
         turn(4, :) = [-axis(2), axis(2), 0.0_wp, axis(1)]
      end associate
      tangent = matmul(transpose(turn), matmul(in_axes, turn))
   end subroutine turn_tangent

end module coulter_law_principal
