!> How bodies may move as rigid ones, since neither fixities nor boundaries hold them: the null
!> vectors of what holds them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_newton_rigid_modes
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_boundary_face, only: place_type
   use coulter_model, only: model_type
   use coulter_system, only: system_type
   use coulter_system_contact_state, only: locate, motion_of
   implicit none(type, external)
   private
   public :: name_free_body

   !> Eigenvalues below this share of their sum are none.
   real(wp), parameter :: negligible = 1.0e-9_wp

   !> What holds some bodies.
   type :: hold_type
      !> Sum over all that holds them of r r^T, where r . (translation, rotation times size) is the
      !> way that it prevents.
      real(wp) :: gram(3, 3) = 0.0_wp
      !> A place in it, and its size, length units.
      real(wp) :: centre(2) = 0.0_wp, size = 1.0_wp
   end type hold_type

contains

   !> Name the first tiled body that is free to move, and how; empty if all are held.
   pure function name_free_body(system, model) result(text)
      !> System at the present unknowns.
      type(system_type), intent(in) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text
      type(hold_type) :: hold
      integer :: group(size(model%bodies)), b

      text = ""
      group = groups_of(system, model)
      do b = 1, size(group)
         if (group(b) /= b .or. .not. any(model%points%body == b)) cycle
         hold = hold_of(system, model, group == b)
         text = free_way(hold)
         if (text == "") cycle
         text = "body "//model%bodies(b)%name//" is free to "//text
         return
      end do
   end function name_free_body

   !> The first of all bodies that hang together with every body by nodes of the grid, shape
   !> (n_bodies).
   pure function groups_of(system, model) result(group)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      integer :: group(size(model%bodies))
      integer :: owner(system%cells%n_nodes), p, v, k

      group = [(k, k=1, size(group))]
      if (size(group) == 1) return
      owner = 0
      do p = 1, model%points%n_points
         do v = 1, 4
            do k = 1, 4
               associate (last => owner(system%map%node(k, model%tiling%corner(v, p))))
                  if (last > 0) call unite(group, group(last), group(model%points%body(p)))
                  last = model%points%body(p)
               end associate
            end do
         end do
      end do
   end function groups_of

   !> Make one of two groups.
   pure subroutine unite(group, first, second)
      integer, intent(inout) :: group(:)
      integer, value :: first, second

      where (group == max(first, second)) group = min(first, second)
   end subroutine unite

   !> All that holds some bodies: fixities and stations that act.
   pure function hold_of(system, model, is_in) result(hold)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      !> Which bodies, shape (n_bodies).
      logical, intent(in) :: is_in(:)
      type(hold_type) :: hold
      integer :: mine(count(is_in(model%points%body)))
      integer :: p

      mine = pack([(p, p=1, model%points%n_points)], is_in(model%points%body))
      associate (x => model%points%position(:, mine))
         hold%centre = sum(x, dim=2)/real(size(mine), wp)
         hold%size = max(maxval(maxval(x, dim=2) - minval(x, dim=2)), &
                         model%grid%smallest_spacing())
      end associate
      call add_fixities(hold, system, model, mine)
      call add_stations(hold, system, mine)
      if (allocated(system%surfaces)) call add_surfaces(hold, system, model, is_in)
   end function hold_of

   !> What fixities hold.
   pure subroutine add_fixities(hold, system, model, mine)
      type(hold_type), intent(inout) :: hold
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      !> Numbers of the tiles.
      integer, intent(in) :: mine(:)
      logical :: carries(system%cells%n_nodes)
      integer :: i, node, v

      carries = .false.
      do i = 1, size(mine)
         do v = 1, 4
            carries(system%map%node(:, model%tiling%corner(v, mine(i)))) = .true.
         end do
      end do
      do node = 1, size(carries)
         if (.not. carries(node)) cycle
         do i = 1, 2
            if (system%dofs%fixity(i, node) == 0) cycle
            call add_hold(hold, model%grid%node_position( &
                          system%cells%node_index(:, node)), &
                          real([2 - i, i - 1], wp))
         end do
      end do
   end subroutine add_fixities

   !> What walls and tools hold: along their faces as well where those stick.
   pure subroutine add_stations(hold, system, mine)
      type(hold_type), intent(inout) :: hold
      type(system_type), intent(in) :: system
      integer, intent(in) :: mine(:)
      type(place_type) :: place
      real(wp) :: position(2)
      integer :: k

      do k = 1, system%contacts%n
         associate (contact => system%contacts%item(k))
            if (.not. contact%is_acting) cycle
            if (.not. any(mine == contact%tile)) cycle
            call locate(contact, motion_of(system, contact), place, position)
            call add_hold(hold, position, place%normal)
            if (contact%is_fixed .or. (contact%rubs .and. contact%slip == 0)) then
               call add_hold(hold, position, place%tangent)
            end if
         end associate
      end do
   end subroutine add_stations

   !> What other bodies hold, as if they stood fast.
   pure subroutine add_surfaces(hold, system, model, is_in)
      type(hold_type), intent(inout) :: hold
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      logical, intent(in) :: is_in(:)
      integer :: k

      do k = 1, size(system%surfaces%pairs)
         associate (pair => system%surfaces%pairs(k))
            associate (contact => model%body_contacts(pair%contact))
               if (.not. pair%is_acting .or. count(is_in(contact%body)) /= 1) cycle
               call add_hold(hold, pair%place, pair%inward)
               if (.not. contact%rubs() .or. pair%slip /= 0) cycle
               call add_hold(hold, pair%place, [-pair%inward(2), pair%inward(1)])
            end associate
         end associate
      end do
   end subroutine add_surfaces

   !> A place is held in one direction.
   pure subroutine add_hold(hold, position, direction)
      type(hold_type), intent(inout) :: hold
      real(wp), intent(in) :: position(2), direction(2)
      real(wp) :: row(3), arm(2)
      integer :: i

      arm = (position - hold%centre)/hold%size
      row = [direction, arm(1)*direction(2) - arm(2)*direction(1)]
      do i = 1, 3
         hold%gram(:, i) = hold%gram(:, i) + row*row(i)
      end do
   end subroutine add_hold

   !> How something moves freely; empty if it does not.
   pure function free_way(hold) result(text)
      type(hold_type), intent(in) :: hold
      character(len=:), allocatable :: text
      real(wp) :: adjugate(3, 3), mode(3), trace
      integer :: i, j, k

      text = "move: nothing holds it"
      trace = hold%gram(1, 1) + hold%gram(2, 2) + hold%gram(3, 3)
      if (.not. trace > 0.0_wp) return
      do i = 1, 3
         j = modulo(i, 3) + 1
         k = modulo(j, 3) + 1
         adjugate(:, i) = cross(hold%gram(:, j), hold%gram(:, k))
      end do
      ! of rank one: in more than one way
      text = "move, for hardly anything holds it"
      if (maxval(abs(adjugate)) <= negligible*trace**2) return
      text = ""
      if (abs(dot_product(hold%gram(:, 1), adjugate(:, 1))) > negligible*trace**3) return
      mode = adjugate(:, maxloc(norm2(adjugate, dim=1), dim=1))
      mode = mode/norm2(mode)
      if (abs(mode(3)) < sqrt(negligible)) then
         text = "move along ("//to_text(1.0e-3_wp*anint(1.0e3_wp*mode(:2)))//")"
      else
         text = "turn about (" &
            //to_text(hold%centre + hold%size*[-mode(2), mode(1)]/mode(3))//")"
      end if
   end function free_way

   !> Vector product.
   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)

      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

end module coulter_newton_rigid_modes
