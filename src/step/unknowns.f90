!> Which unknowns an element couples, when its vertices hang on several grid nodes each.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_unknowns
   use coulter_algebra_sparse, only: element_dofs_type
   use coulter_base_kinds, only: wp
   use coulter_step_dofs, only: dofs_type
   implicit none(type, external)
   private
   public :: coupling_type, new_coupling, couple_vertices, condense, max_unknowns

   !> Most unknowns of one component that an element can couple: 4 vertices on 4 nodes that follow
   !> 4 masters each.
   integer, parameter :: max_unknowns = 64

   !> Elements with their unknowns, and the shares by which their vertices hang on these.
   type :: coupling_type
      !> Unknowns of every element: first those of the x component, then those of y.
      type(element_dofs_type) :: elements
      !> Number of x unknowns of every element, shape (n_elements).
      integer, allocatable :: n_x(:)
      !> Share of every unknown in the vertices of its element, shape (n_vertices, n_entries).
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

      allocate (coupling%elements%start(n_elements + 1), coupling%n_x(n_elements))
      allocate (coupling%elements%dof(20*n_elements + 2*max_unknowns))
      allocate (coupling%share(n_vertices, 20*n_elements + 2*max_unknowns))
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
      integer :: e, first, next, component

      e = coupling%elements%n_elements + 1
      call make_room(coupling, coupling%elements%start(e) + 2*max_unknowns)
      first = coupling%elements%start(e)
      next = first
      do component = 1, 2
         call gather(coupling, dofs, component, node, share, next)
         if (component == 1) coupling%n_x(e) = next - first
      end do
      coupling%elements%start(e + 1) = next
      coupling%elements%n_elements = e
   end subroutine couple_vertices

   !> Matrix of an element in terms of its unknowns, columns first.
   pure subroutine condense(coupling, e, matrix, n, condensed)
      !> The elements.
      type(coupling_type), intent(in) :: coupling
      !> Number of the element.
      integer, intent(in) :: e
      !> Matrix in terms of its four vertices, shape (component, vertex, component, vertex).
      real(wp), intent(in) :: matrix(2, 4, 2, 4)
      !> Number of its unknowns.
      integer, intent(in) :: n
      !> Matrix in terms of its unknowns.
      real(wp), intent(out) :: condensed(n, n)
      real(wp) :: half(2, 4), half_x(4), half_y(4)
      integer :: first, i, j, n_x, v, component

      first = coupling%elements%start(e) - 1
      n_x = coupling%n_x(e)
      do j = 1, n
         component = merge(1, 2, j <= n_x)
         half = 0.0_wp
         do v = 1, 4
            half = half + coupling%share(v, first + j)*matrix(:, :, component, v)
         end do
         half_x = half(1, :)
         half_y = half(2, :)
         do i = 1, n_x
            condensed(i, j) = sum(coupling%share(:4, first + i)*half_x)
         end do
         do i = n_x + 1, n
            condensed(i, j) = sum(coupling%share(:4, first + i)*half_y)
         end do
      end do
   end subroutine condense

   !> Unknowns of one component; held nodes drop out, outer nodes are replaced by their masters.
   pure subroutine gather(coupling, dofs, component, node, share, next)
      type(coupling_type), intent(inout) :: coupling
      type(dofs_type), intent(in) :: dofs
      integer, intent(in) :: component, node(:, :)
      real(wp), intent(in) :: share(:, :)
      integer, intent(inout) :: next
      integer :: first, v, k, j, dof

      first = next
      do v = 1, size(node, 2)
         do k = 1, size(node, 1)
            if (.not. abs(share(k, v)) > 0.0_wp) cycle
            dof = dofs%dof(component, node(k, v))
            if (dof >= 0) then
               call add_share(coupling, dof, share(k, v), v, first, next)
               cycle
            end if
            do j = 1, 4
               call add_share(coupling, dofs%dof(component, dofs%master(j, -dof)), &
                              share(k, v)*dofs%share(j, -dof), v, first, next)
            end do
         end do
      end do
   end subroutine gather

   !> Let a vertex depend on an unknown, unless that is held. The unknowns of the element and
   !> component stand from `first` to `next - 1`.
   pure subroutine add_share(coupling, dof, amount, vertex, first, next)
      type(coupling_type), intent(inout) :: coupling
      integer, intent(in) :: dof, vertex, first
      real(wp), intent(in) :: amount
      integer, intent(inout) :: next
      integer :: k

      if (dof == 0) return
      do k = first, next - 1
         if (coupling%elements%dof(k) == dof) exit
      end do
      if (k == next) then
         coupling%elements%dof(k) = dof
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
         allocate (dof(2*n), share(size(coupling%share, 1), 2*n))
         dof(:old) = coupling%elements%dof
         share(:, :old) = coupling%share
      end associate
      call move_alloc(dof, coupling%elements%dof)
      call move_alloc(share, coupling%share)
   end subroutine make_room

end module coulter_step_unknowns
