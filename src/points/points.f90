!> Material points: a structure of arrays, components first, points last.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points
   use coulter_base_kinds, only: long, wp
   implicit none(type, external)
   private
   public :: points_type, point_state_type, allocate_points, points_memory
   public :: n_plane_gradient

   !> Components of the deformation gradient in plane strain and axisymmetry: 11, 21, 12, 22, 33.
   integer, parameter :: n_plane_gradient = 5

   !> What a step changes at the points beside their position.
   type :: point_state_type
      !> Total deformation gradient 11, 21, 12, 22, 33, shape (5, n_points).
      real(wp), allocatable :: deformation_gradient(:, :)
      !> Elastic left Cauchy-Green tensor xx, yy, zz, xy, shape (4, n_points).
      real(wp), allocatable :: elastic_finger(:, :)
      !> Kirchhoff stress xx, yy, zz, xy, tension positive, stress units, shape (4, n_points).
      real(wp), allocatable :: kirchhoff_stress(:, :)
      !> State variables of the laws, shape (n_state, n_points).
      real(wp), allocatable :: law_state(:, :)
   end type point_state_type

   !> All points of a model.
   type :: points_type
      !> Number of points.
      integer :: n_points = 0
      !> Most state variables that a law of the model has.
      integer :: n_state = 0
      !> Current position, length units, shape (n_dim, n_points).
      real(wp), allocatable :: position(:, :)
      !> Displacement since the start, length units, shape (n_dim, n_points).
      real(wp), allocatable :: displacement(:, :)
      !> Volume of the undeformed domain (per unit thickness in plane strain), shape (n_points).
      real(wp), allocatable :: reference_volume(:)
      !> Volume ratio J, determinant of the total deformation gradient, shape (n_points).
      real(wp), allocatable :: volume_ratio(:)
      !> Volume ratio that the law has seen over J, where points share their volume changes, shape
      !> (n_points); else unallocated.
      real(wp), allocatable :: shared_ratio(:)
      !> Edges of the box around the undeformed domain, length units, shape (n_dim, n_points).
      real(wp), allocatable :: domain_size(:, :)
      !> Number of the body that owns the point, shape (n_points).
      integer, allocatable :: body(:)
      !> Did the point flow plastically in the last step? Shape (n_points); unallocated where all
      !> laws are elastic.
      logical, allocatable :: has_flowed(:)
      !> State at the last accepted step.
      type(point_state_type) :: converged
      !> State of the current iteration.
      type(point_state_type) :: trial
   end type points_type

contains

   !> Make room for undeformed, stress-free points in the plane.
   pure subroutine allocate_points(points, n_points, n_state)
      !> Points to make.
      type(points_type), intent(out) :: points
      !> Number of points.
      integer, intent(in) :: n_points
      !> State variables per point.
      integer, intent(in) :: n_state

      points%n_points = n_points
      points%n_state = n_state
      allocate (points%position(2, n_points), source=0.0_wp)
      allocate (points%displacement(2, n_points), source=0.0_wp)
      allocate (points%reference_volume(n_points), source=0.0_wp)
      allocate (points%volume_ratio(n_points), source=1.0_wp)
      allocate (points%domain_size(2, n_points), source=0.0_wp)
      allocate (points%body(n_points), source=1)
      call allocate_state(points%converged, n_points, n_state)
      call allocate_state(points%trial, n_points, n_state)
   end subroutine allocate_points

   !> Make room for the undeformed state.
   pure subroutine allocate_state(state, n_points, n_state)
      type(point_state_type), intent(out) :: state
      integer, intent(in) :: n_points, n_state
      real(wp), parameter :: identity_gradient(n_plane_gradient) = &
         [1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp]
      real(wp), parameter :: identity(4) = [1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp]

      allocate (state%deformation_gradient(n_plane_gradient, n_points), &
                source=spread(identity_gradient, 2, n_points))
      allocate (state%elastic_finger(4, n_points), source=spread(identity, 2, n_points))
      allocate (state%kirchhoff_stress(4, n_points), source=0.0_wp)
      allocate (state%law_state(n_state, n_points), source=0.0_wp)
   end subroutine allocate_state

   !> Bytes that the points occupy.
   pure function points_memory(points) result(bytes)
      !> The points.
      type(points_type), intent(in) :: points
      integer(long) :: bytes
      integer, parameter :: n_per_point = 2 + 2 + 1 + 1 + 2, n_per_state = n_plane_gradient + 4 + 4

      bytes = int(points%n_points, long) &
         *int(4 + 8*(n_per_point + 2*(n_per_state + points%n_state)), long)
   end function points_memory

end module coulter_points
