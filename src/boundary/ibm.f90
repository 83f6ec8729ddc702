!> The Implicit Boundary Method: one station to residual and tangent.
!>
!> The Dirichlet function d(phi) = 1 - (1 - phi/delta)^2 acts in a band of width delta; its band
!> integrals are taken in closed form, so that a station needs no inner quadrature (paper, Eq. 1 to
!> 6; theory, section 3).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary_ibm
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: station_law_type, station_response_type, station_kernel_2d, band_stiffness_factor

   !> Integral of (delta d')^2 over the band, divided by delta: d' is the slope of d.
   real(wp), parameter :: band_stiffness_factor = 4.0_wp/3.0_wp

   !> What a station makes of displacements: the constants of K2 and K3.
   type :: station_law_type
      !> Unit normal into the material.
      real(wp) :: normal(2) = 0.0_wp
      !> Prescribed directions: 1 (normal) or 2 (normal and tangent).
      integer :: n_held = 1
      !> Is the coupling term K2 present?
      logical :: has_coupling = .true.
      !> Width of the band delta, length units.
      real(wp) :: band = 0.0_wp
      !> First Lame parameter and shear modulus of the band, stress units.
      real(wp) :: lame_lambda = 0.0_wp, shear_modulus = 0.0_wp
   end type station_law_type

   !> What a station answers.
   type :: station_response_type
      !> Nodal force per length of boundary, to be added to the residual, shape (component, node).
      real(wp) :: force(2, 4)
      !> Its derivative by the increments, symmetric.
      real(wp) :: tangent(2, 4, 2, 4)
      !> Traction (normal, tangential) on the boundary, tension positive, stress units.
      real(wp) :: traction(2)
   end type station_response_type

contains

   !> Traction, nodal forces and tangent of a station that holds the displacement increment at a
   !> prescribed value. The increments are those of the current step.
   !>
   !> With the directions e_1 = n, e_2 = t, the rows M_i = e_i N and the half tractions
   !> q_i = (W C)_i G of K2, the traction component is t_i = k_i w_i + q_i du + memory_i, and
   !> f = sum_i M_i t_i + q_i w_i, K = sum_i k_i M_i M_i + M_i q_i + q_i M_i.
   pure subroutine station_kernel_2d(law, shape, gradient, increment, prescribed, memory, response)
      !> Constants of the station.
      type(station_law_type), intent(in) :: law
      !> Shape functions of the four nodes.
      real(wp), intent(in) :: shape(4)
      !> Their gradients at the start of the step, per length.
      real(wp), intent(in) :: gradient(2, 4)
      !> Displacement increments of the nodes, length units.
      real(wp), intent(in) :: increment(2, 4)
      !> Prescribed displacement increment of the boundary, length units.
      real(wp), intent(in) :: prescribed(2)
      !> Traction (normal, tangential) remembered from earlier steps, stress units.
      real(wp), intent(in) :: memory(2)
      !> What the station answers.
      type(station_response_type), intent(out) :: response
      real(wp) :: direction(2, 2), moved(2, 4), half(2, 4), gap, stiffness
      integer :: i, k, b

      direction(:, 1) = law%normal
      direction(:, 2) = [law%normal(2), -law%normal(1)]
      response%force = 0.0_wp
      response%tangent = 0.0_wp
      response%traction = 0.0_wp
      do i = 1, law%n_held
         moved = spread(direction(:, i), 2, 4)*spread(shape, 1, 2)
         half = half_traction(law, gradient, direction, i)
         stiffness = band_stiffness(law, i)
         gap = sum(moved*increment) - dot_product(direction(:, i), prescribed)
         response%traction(i) = stiffness*gap + sum(half*increment) + memory(i)
         response%force = response%force + moved*response%traction(i) + half*gap
         do b = 1, 4
            do k = 1, 2
               response%tangent(:, :, k, b) = response%tangent(:, :, k, b) + half*moved(k, b) &
                  + moved*(stiffness*moved(k, b) + half(k, b))
            end do
         end do
      end do
   end subroutine station_kernel_2d

   !> Stiffness of K3 in one direction, stress per length.
   pure function band_stiffness(law, direction) result(stiffness)
      type(station_law_type), intent(in) :: law
      integer, intent(in) :: direction
      real(wp) :: stiffness

      stiffness = law%shear_modulus
      if (direction == 1) stiffness = law%lame_lambda + 2.0_wp*law%shear_modulus
      stiffness = stiffness*band_stiffness_factor/law%band
   end function band_stiffness

   !> Row q_i of K2, shape (2, 4): the traction of the displacement gradient, weighted by the band
   !> integral of d d' = 1/2 in held directions and of d' = 1 in free ones.
   pure function half_traction(law, gradient, direction, i) result(row)
      type(station_law_type), intent(in) :: law
      real(wp), intent(in) :: gradient(2, 4), direction(2, 2)
      integer, intent(in) :: i
      real(wp) :: row(2, 4)
      real(wp) :: along_normal(4), along_tangent(4), free_weight
      integer :: a

      row = 0.0_wp
      if (.not. law%has_coupling) return
      along_normal = matmul(direction(:, 1), gradient)
      along_tangent = matmul(direction(:, 2), gradient)
      free_weight = 1.0_wp
      if (law%n_held == 2) free_weight = 0.5_wp
      do a = 1, 4
         if (i == 1) then
            row(:, a) = 0.5_wp*(law%lame_lambda + 2.0_wp*law%shear_modulus)*along_normal(a) &
               *direction(:, 1) + free_weight*law%lame_lambda*along_tangent(a)*direction(:, 2)
         else
            row(:, a) = 0.5_wp*law%shear_modulus &
               *(along_tangent(a)*direction(:, 1) + along_normal(a)*direction(:, 2))
         end if
      end do
   end function half_traction

end module coulter_boundary_ibm
