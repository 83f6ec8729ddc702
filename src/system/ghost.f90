!> Ghost penalty: holds the displacement field together across the faces of badly filled cells.
!>
!> Burman, E. (2010), C. R. Acad. Sci. Paris 348, 1217-1220; Coombs, W. M. (2023), Int. J. Numer.
!> Meth. Engng 124, 4841-4875. Per face and component gamma 2 G/3 (D0^2 + D0 D1 + D1^2) with the
!> second differences D across the face on the two grid lines that bound it (theory, section 4).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_ghost
   use coulter_base_kinds, only: wp
   use coulter_grid_cells, only: cells_type
   implicit none(type, external)
   private
   public :: ghost_type, find_ghost_faces, ghost_matrix, add_ghost_forces

   !> Stabilised faces.
   type :: ghost_type
      !> Number of faces.
      integer :: n_faces = 0
      !> Nodes across the face on the first and on the second grid line, shape (3, 2, n_faces).
      integer, allocatable :: node(:, :, :)
      !> Active cell on one side, whose material sets the stiffness, shape (n_faces).
      integer, allocatable :: cell(:)
   end type ghost_type

   !> Cells filled less than this count as cut by the outline. The fill is sampled, so cells inside
   !> a deformed body may count as well.
   real(wp), parameter :: full = 0.999_wp

contains

   !> Faces between active cells of which one is cut or lies beside an inactive cell.
   pure subroutine find_ghost_faces(ghost, cells, fill)
      !> Faces to find.
      type(ghost_type), intent(out) :: ghost
      !> Active cells with numbered nodes.
      type(cells_type), intent(in) :: cells
      !> Share of every cell that is filled, shape (n_cells).
      real(wp), intent(in) :: fill(:)
      logical :: is_near(cells%n_cells)
      integer :: c, axis, beside, step(2)

      do c = 1, cells%n_cells
         is_near(c) = fill(c) < full .or. has_inactive_neighbour(cells, c)
      end do
      allocate (ghost%node(3, 2, most_faces(cells)), ghost%cell(most_faces(cells)))
      do c = 1, cells%n_cells
         do axis = 1, 2
            step = 0
            step(axis) = 1
            beside = cells%next_beside(c, step, 0)
            do while (beside > 0)
               if (is_near(c) .or. is_near(beside)) then
                  ghost%n_faces = ghost%n_faces + 1
                  ghost%cell(ghost%n_faces) = c
                  ghost%node(:, :, ghost%n_faces) = face_nodes(cells%node(:, c), &
                                                               cells%node(:, beside), axis)
               end if
               beside = cells%next_beside(c, step, beside)
            end do
         end do
      end do
   end subroutine find_ghost_faces

   !> Matrix of a face for one component and unit stiffness, in terms of unknowns.
   pure function ghost_matrix(share) result(matrix)
      !> Shares of the unknowns in the nodes of the face, these in the order of `ghost%node`, shape
      !> (6, n).
      real(wp), intent(in) :: share(:, :)
      real(wp) :: matrix(size(share, 2), size(share, 2))
      real(wp) :: first(size(share, 2)), second(size(share, 2))
      integer :: b

      ! second differences on either grid line
      first = share(1, :) - 2.0_wp*share(2, :) + share(3, :)
      second = share(4, :) - 2.0_wp*share(5, :) + share(6, :)
      do b = 1, size(share, 2)
         matrix(:, b) = (first*(2.0_wp*first(b) + second(b)) &
                         + second*(2.0_wp*second(b) + first(b)))/6.0_wp
      end do
   end function ghost_matrix

   !> Add the forces of all faces at given displacement increments.
   pure subroutine add_ghost_forces(ghost, stiffness, increment, force)
      !> The faces.
      type(ghost_type), intent(in) :: ghost
      !> Stiffness of every face, stress units, shape (>= n_faces).
      real(wp), intent(in) :: stiffness(:)
      !> Displacement increments of the nodes, length units, shape (2, n_nodes).
      real(wp), intent(in) :: increment(:, :)
      !> Nodal forces, shape (2, n_nodes).
      real(wp), intent(inout) :: force(:, :)
      real(wp) :: difference(2, 2), pull(2)
      integer :: f, line

      do f = 1, ghost%n_faces
         do line = 1, 2
            associate (node => ghost%node(:, line, f))
               difference(:, line) = increment(:, node(1)) - 2.0_wp*increment(:, node(2)) &
                  + increment(:, node(3))
            end associate
         end do
         do line = 1, 2
            pull = stiffness(f)/6.0_wp*(2.0_wp*difference(:, line) + difference(:, 3 - line))
            associate (node => ghost%node(:, line, f))
               force(:, node(1)) = force(:, node(1)) + pull
               force(:, node(2)) = force(:, node(2)) - 2.0_wp*pull
               force(:, node(3)) = force(:, node(3)) + pull
            end associate
         end do
      end do
   end subroutine add_ghost_forces

   !> Nodes on the two grid lines across the face between a cell and the next one along an axis.
   pure function face_nodes(own, beside, axis) result(node)
      integer, intent(in) :: own(4), beside(4), axis
      integer :: node(3, 2)

      if (axis == 1) then
         node(:, 1) = [own(1), own(2), beside(2)]
         node(:, 2) = [own(4), own(3), beside(3)]
      else
         node(:, 1) = [own(1), own(4), beside(4)]
         node(:, 2) = [own(2), own(3), beside(3)]
      end if
   end function face_nodes

   !> Is one of the eight cells around a cell inactive, or another sheet?
   pure function has_inactive_neighbour(cells, cell) result(answer)
      type(cells_type), intent(in) :: cells
      integer, intent(in) :: cell
      logical :: answer
      integer :: i, j

      answer = .false.
      do j = -1, 1
         do i = -1, 1
            if (i == 0 .and. j == 0) cycle
            answer = answer .or. .not. cells%has_beside(cell, [i, j])
         end do
      end do
   end function has_inactive_neighbour

   !> Room for two faces a cell, each to all sheets beside it.
   pure function most_faces(cells) result(n)
      type(cells_type), intent(in) :: cells
      integer :: n
      integer :: c, k, sheets

      n = 2*cells%n_cells
      if (.not. allocated(cells%next_sheet)) return
      do c = 1, cells%n_cells
         sheets = 1
         k = cells%next_sheet(c)
         do while (k > 0)
            sheets = sheets + 1
            k = cells%next_sheet(k)
         end do
         n = max(n, 2*sheets*cells%n_cells)
      end do
   end function most_faces

end module coulter_system_ghost
