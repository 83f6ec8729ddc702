!> Which unknowns an element couples, when its vertices hang on several grid nodes each.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_unknowns
   use coulter_algebra_sparse, only: element_dofs_type
   use coulter_base_kinds, only: wp
   use coulter_system_dofs, only: dofs_type
   implicit none(type, external)
   private
   public :: coupling_type, new_coupling, couple_vertices, max_pairs_of_vertex

   !> Most pairs of unknowns that a vertex can hang on: 4 nodes that follow 4 masters each; and most
   !> of those that an element of 4 vertices can couple.
   integer, parameter :: max_pairs_of_vertex = 16, max_pairs = 4*max_pairs_of_vertex

   !> Elements with their unknowns, and the shares by which their vertices hang on these.
   type :: coupling_type
      !> Unknowns of every element, in pairs of an x and a y component; 0: held.
      type(element_dofs_type) :: elements
      !> Share of every pair in the vertices of its element, shape (n_vertices, n_pairs); the first
      !> pair of element e is (start(e) + 1)/2.
      real(wp), allocatable :: share(:, :)
   end type coupling_type

contains

   !> Make room for elements that are then added one by one.
   pure subroutine new_coupling(coupling, n_elements, n_vertices)
      !> Coupling to make.
      type(coupling_type), intent(out) :: coupling
      !> Number of elements to come.
      integer, intent(in) :: n_elements
      !> Vertices of each.
      integer, intent(in) :: n_vertices

      allocate (coupling%elements%start(n_elements + 1))
      allocate (coupling%elements%dof(20*n_elements + 2*max_pairs))
      allocate (coupling%share(n_vertices, 10*n_elements + max_pairs))
      coupling%elements%start(1) = 1
   end subroutine new_coupling

   !> Add the next element.
   pure subroutine couple_vertices(coupling, dofs, node, share)
      !> Coupling to extend.
      type(coupling_type), intent(inout) :: coupling
      !> Numbering of the unknowns.
      type(dofs_type), intent(in) :: dofs
      !> Nodes that every vertex hangs on, shape (n_nodes_per_vertex, n_vertices).
      integer, intent(in) :: node(:, :)
      !> Their shares; zeros couple nothing, shape as `node`.
      real(wp), intent(in) :: share(:, :)
      integer :: e, first, next, v, k, j, dof(2), outer

      e = coupling%elements%n_elements + 1
      call make_room(coupling, coupling%elements%start(e) + 8*size(node))
      first = (coupling%elements%start(e) + 1)/2
      next = first
      do v = 1, size(node, 2)
         do k = 1, size(node, 1)
            if (.not. abs(share(k, v)) > 0.0_wp) cycle
            dof = dofs%dof(:, node(k, v))
            outer = -minval(dof)
            if (outer <= 0) then
               call add_share(coupling, dof, share(k, v), v, first, next)
               cycle
            end if
            do j = 1, 4
               call add_share(coupling, merge(dofs%dof(:, dofs%master(j, outer)), 0, dof < 0), &
                              share(k, v)*dofs%share(j, outer), v, first, next)
            end do
         end do
      end do
      coupling%elements%start(e + 1) = 2*next - 1
      coupling%elements%n_elements = e
   end subroutine couple_vertices

   !> Let a vertex depend on a pair of unknowns, unless both are held. The pairs of the element
   !> stand from `first` to `next - 1`.
   pure subroutine add_share(coupling, dof, amount, vertex, first, next)
      type(coupling_type), intent(inout) :: coupling
      integer, intent(in) :: dof(2), vertex, first
      real(wp), intent(in) :: amount
      integer, intent(inout) :: next
      integer :: k

      if (maxval(dof) == 0) return
      do k = first, next - 1
         if (all(coupling%elements%dof(2*k - 1:2*k) == dof)) exit
      end do
      if (k == next) then
         coupling%elements%dof(2*k - 1:2*k) = dof
         coupling%share(:, k) = 0.0_wp
         next = next + 1
      end if
      coupling%share(vertex, k) = coupling%share(vertex, k) + amount
   end subroutine add_share

   !> Let there be room for `n` entries.
   pure subroutine make_room(coupling, n)
      type(coupling_type), intent(inout) :: coupling
      integer, intent(in) :: n
      integer, allocatable :: dof(:)
      real(wp), allocatable :: share(:, :)

      associate (old => size(coupling%elements%dof))
         if (old >= n) return
         allocate (dof(2*n), share(size(coupling%share, 1), n))
         dof(:old) = coupling%elements%dof
         share(:, :size(coupling%share, 2)) = coupling%share
      end associate
      call move_alloc(dof, coupling%elements%dof)
      call move_alloc(share, coupling%share)
   end subroutine make_room

end module coulter_system_unknowns
