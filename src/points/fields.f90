!> Quantities at the points as people read them: Cauchy stress, strain, vectors in space.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_fields
   use coulter_base_kinds, only: wp
   use coulter_base_tensor, only: log_strain_plane
   use coulter_points, only: n_plane_gradient, points_type
   implicit none(type, external)
   private
   public :: cauchy_stress, stress_ratio, elastic_strain, full_gradient, space_vector, &
      n_symmetric, n_tensor

   !> Components of a symmetric tensor in space: xx, yy, zz, xy, yz, xz.
   integer, parameter :: n_symmetric = 6
   !> Components of a tensor in space, row by row.
   integer, parameter :: n_tensor = 9

contains

   !> Cauchy stress from Kirchhoff stress, sigma = tau/J, shape (6, n_points).
   pure function cauchy_stress(kirchhoff_stress, volume_ratio) result(stress)
      !> Kirchhoff stress xx, yy, zz, xy, stress units, shape (4, n_points).
      real(wp), intent(in) :: kirchhoff_stress(:, :)
      !> Volume ratio J, shape (n_points).
      real(wp), intent(in) :: volume_ratio(:)
      real(wp), allocatable :: stress(:, :)
      integer :: i

      allocate (stress(n_symmetric, size(volume_ratio)), source=0.0_wp)
      do i = 1, size(volume_ratio)
         stress(:4, i) = kirchhoff_stress(:, i)/volume_ratio(i)
      end do
   end function cauchy_stress

   !> Volume ratio that turns Kirchhoff into Cauchy stress: the one that the law has seen, shape
   !> (n_points).
   pure function stress_ratio(points) result(ratio)
      !> Points.
      type(points_type), intent(in) :: points
      real(wp), allocatable :: ratio(:)

      ratio = points%volume_ratio
      if (allocated(points%shared_ratio)) ratio = points%shared_ratio*ratio
   end function stress_ratio

   !> Logarithmic elastic strain 1/2 ln(b_e) with tensor (not engineering) shear components,
   !> shape (6, n_points).
   pure function elastic_strain(elastic_finger) result(strain)
      !> Elastic left Cauchy-Green tensor b_e: xx, yy, zz, xy, shape (4, n_points).
      real(wp), intent(in) :: elastic_finger(:, :)
      real(wp), allocatable :: strain(:, :)
      integer :: i

      allocate (strain(n_symmetric, size(elastic_finger, 2)), source=0.0_wp)
      do i = 1, size(elastic_finger, 2)
         call log_strain_plane(elastic_finger(:, i), strain(:4, i))
      end do
      strain(4, :) = 0.5_wp*strain(4, :)
   end function elastic_strain

   !> Tensor in space row by row, 11 12 13 21 22 23 31 32 33, shape (9, n_points).
   pure function full_gradient(plane_gradient) result(gradient)
      !> Deformation gradient 11, 21, 12, 22, 33, shape (5, n_points).
      real(wp), intent(in) :: plane_gradient(:, :)
      real(wp), allocatable :: gradient(:, :)
      integer, parameter :: place(n_plane_gradient) = [1, 4, 2, 5, 9]

      allocate (gradient(n_tensor, size(plane_gradient, 2)), source=0.0_wp)
      gradient(place, :) = plane_gradient
   end function full_gradient

   !> Vectors with zeros for the missing directions, shape (3, n_points).
   pure function space_vector(vectors) result(spatial)
      !> Vectors, shape (n_dim, n_points).
      real(wp), intent(in) :: vectors(:, :)
      real(wp), allocatable :: spatial(:, :)

      allocate (spatial(3, size(vectors, 2)), source=0.0_wp)
      spatial(:size(vectors, 1), :) = vectors
   end function space_vector

end module coulter_points_fields
