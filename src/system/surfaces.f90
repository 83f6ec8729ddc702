!> Surfaces of bodies that press against each other: stations, their unknowns and their tangents.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_surfaces
   use coulter_algebra_sparse, only: add_element_matrix, pattern_type
   use coulter_base_kinds, only: wp
   use coulter_contact_surface_pairs, only: surface_pair_type
   use coulter_system_dofs, only: dofs_type
   use coulter_system_tile_map, only: tile_map_type
   use coulter_system_unknowns, only: coupling_type, couple_vertices, new_coupling
   implicit none(type, external)
   private
   public :: surfaces_type, couple_surfaces, scatter_surfaces

   !> All stations of a step.
   type :: surfaces_type
      !> Those of the step and of the last accepted one.
      type(surface_pair_type), allocatable :: pairs(:), last(:)
      !> Tangent of every pair by its six corners, shape (2, 6, 2, 6, n_pairs).
      real(wp), allocatable :: stiffness(:, :, :, :, :)
      !> Unknowns that the pairs couple.
      type(coupling_type) :: coupling
   end type surfaces_type

contains

   !> Unknowns of all pairs.
   pure subroutine couple_surfaces(surfaces, map, dofs)
      !> Surfaces with pairs; get `coupling` and room for tangents.
      type(surfaces_type), intent(inout) :: surfaces
      !> Where their corners sit in the grid.
      type(tile_map_type), intent(in) :: map
      !> Numbering.
      type(dofs_type), intent(in) :: dofs
      integer :: k

      call new_coupling(surfaces%coupling, size(surfaces%pairs), 6)
      do k = 1, size(surfaces%pairs)
         associate (corner => surfaces%pairs(k)%corner)
            call couple_vertices(surfaces%coupling, dofs, map%node(:, corner), map%shape(:, corner))
         end associate
      end do
      if (allocated(surfaces%stiffness)) deallocate (surfaces%stiffness)
      allocate (surfaces%stiffness(2, 6, 2, 6, size(surfaces%pairs)), source=0.0_wp)
   end subroutine couple_surfaces

   !> Add the tangents of all pairs that press to that of the system.
   pure subroutine scatter_surfaces(surfaces, pattern, n_before, values)
      !> Coupled surfaces.
      type(surfaces_type), intent(in) :: surfaces
      !> Pattern of the tangent, and its number of elements before those of the pairs.
      type(pattern_type), intent(in) :: pattern
      integer, intent(in) :: n_before
      !> Values of the tangent, shape (n_entries).
      real(wp), intent(inout) :: values(:)
      integer :: k, first, last

      do k = 1, size(surfaces%pairs)
         if (.not. surfaces%pairs(k)%is_acting) cycle
         first = (surfaces%coupling%elements%start(k) + 1)/2
         last = (surfaces%coupling%elements%start(k + 1) - 1)/2
         call add_element_matrix(pattern, n_before + k, by_unknowns( &
            surfaces%stiffness(:, :, :, :, k), surfaces%coupling%share(:, first:last)), values)
      end do
   end subroutine scatter_surfaces

   !> Tangent by pairs of unknowns, columns first, from that by corners.
   pure function by_unknowns(stiffness, share) result(matrix)
      real(wp), intent(in) :: stiffness(2, 6, 2, 6)
      !> Shares of the pairs in the corners, shape (6, n).
      real(wp), intent(in) :: share(:, :)
      real(wp) :: matrix(4*size(share, 2)**2)
      real(wp) :: whole(2, size(share, 2), 2, size(share, 2))
      integer :: i, j

      do j = 1, 2
         do i = 1, 2
            whole(i, :, j, :) = matmul(transpose(share), matmul(stiffness(i, :, j, :), share))
         end do
      end do
      matrix = reshape(whole, shape(matrix))
   end function by_unknowns

end module coulter_system_surfaces
