!> The way of the stars of corners to the unknowns that corners hang on.
!>
!> Corners give way to their unknowns star by star, after all tiles have added to the stars.
!> Neighbouring tiles share this work, which would else be done for every tile. Corners that hang on
!> the same unknowns, as those in one cell do, are a group and share the places in the tangent: its
!> columns are theirs.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_star_groups
   use coulter_algebra_sparse, only: add_blocks, element_dofs_type, pattern_type
   use coulter_base_kinds, only: long, wp
   use coulter_base_sorting, only: sort_by_number
   use coulter_system_dofs, only: dofs_type
   use coulter_system_tile_map, only: tile_map_type
   use coulter_system_tile_stars, only: tile_stars_type
   use coulter_system_unknowns, only: coupling_type, couple_vertices, max_pairs_of_vertex, &
      new_coupling
   implicit none(type, external)
   private
   public :: star_groups_type, couple_stars, scatter_stars, groups_memory

   !> Groups of corners that hang on the same unknowns.
   type :: star_groups_type
      !> Unknowns of every group: columns are those of its corners, rows those of all their stars.
      type(element_dofs_type) :: elements
      !> First member of every group, and the corners of all groups, shapes (n_groups + 1) and
      !> (n_corners).
      integer, allocatable, private :: start(:), member(:)
      !> Shares of the pairs of unknowns that every corner hangs on, shape (n_pairs), and its first
      !> one, shape (n_corners + 1).
      real(wp), allocatable, private :: share(:)
      integer, allocatable, private :: first_pair(:)
      !> Where the pairs of all corners of all stars stand among the rows of the group, star by star
      !> in the order of `member`, shape (n_places).
      integer, allocatable, private :: place(:)
   end type star_groups_type

contains

   !> Find the groups of a step and their unknowns.
   subroutine couple_stars(groups, stars, map, dofs)
      !> Groups to make.
      type(star_groups_type), intent(out) :: groups
      !> Stars of all corners.
      type(tile_stars_type), intent(in) :: stars
      !> Where the corners sit in the grid.
      type(tile_map_type), intent(in) :: map
      !> Numbering.
      type(dofs_type), intent(in) :: dofs
      type(coupling_type) :: corners
      integer :: c, n

      n = size(map%node, 2)
      call new_coupling(corners, n, 1)
      do c = 1, n
         call couple_vertices(corners, dofs, map%node(:, c:c), map%shape(:, c:c))
      end do
      groups%first_pair = (corners%elements%start + 1)/2
      groups%share = corners%share(1, :groups%first_pair(n + 1) - 1)
      call group_corners(groups, stars%order, map)
      call list_unknowns(groups, stars, corners%elements%dof, dofs%n_dofs)
   end subroutine couple_stars

   !> Find the corners that hang on the same nodes.
   pure subroutine group_corners(groups, order, map)
      type(star_groups_type), intent(inout) :: groups
      !> Corners in the order of their stars.
      integer, intent(in) :: order(:)
      type(tile_map_type), intent(in) :: map
      integer :: group(size(order)), group_at(size(map%fill), 0:15), c, i, nodes, n

      group_at = 0
      n = 0
      do i = 1, size(order)
         c = order(i)
         ! corners on grid lines hang on some of the nodes of their cell
         nodes = sum([1, 2, 4, 8], mask=abs(map%shape(:, c)) > 0.0_wp)
         associate (here => group_at(map%cell(c), nodes))
            if (here == 0) then
               n = n + 1
               here = n
            end if
            group(c) = here
         end associate
      end do
      allocate (groups%start(n + 1), groups%member(size(order)))
      call sort_by_number(group, groups%start, groups%member)
   end subroutine group_corners

   !> Pairs of unknowns of every group, its own ones first, each once, and where those of all
   !> corners of its stars stand among them.
   subroutine list_unknowns(groups, stars, own, n_dofs)
      type(star_groups_type), intent(inout) :: groups
      type(tile_stars_type), intent(in) :: stars
      !> Pairs of all corners, and the number of unknowns.
      integer, intent(in) :: own(:), n_dofs
      integer :: at(n_dofs, 2), g, i, n, n_places, first
      integer, allocatable :: list(:)

      call make_room(groups, stars%corner)
      allocate (list(2*size(groups%place)))
      at = 0
      n = 0
      n_places = 0
      do g = 1, groups%elements%n_elements
         first = n + 1
         groups%elements%start(g) = 2*n + 1
         do i = groups%start(g), groups%start(g + 1) - 1
            call place_star(groups%member(i))
         end do
         i = groups%member(groups%start(g))
         groups%elements%n_columns(g) = 2*(groups%first_pair(i + 1) - groups%first_pair(i))
      end do
      groups%elements%start(groups%elements%n_elements + 1) = 2*n + 1
      groups%elements%dof = list(:2*n)

   contains

      !> Find the places of the pairs of all corners of a star in the group from `first` on.
      subroutine place_star(corner)
         integer, intent(in) :: corner
         integer :: k, b

         do k = stars%first(corner), stars%last(corner)
            do b = groups%first_pair(stars%corner(k)), groups%first_pair(stars%corner(k) + 1) - 1
               call place_pair(own(2*b - 1), own(2*b))
            end do
         end do
      end subroutine place_star

      !> Find the place of a pair. Pairs with the same y differ if one has no x.
      subroutine place_pair(x, y)
         integer, intent(in) :: x, y
         integer :: key, kind

         key = max(x, y)
         kind = merge(2, 1, min(x, y) == 0)
         if (at(key, kind) < first) then
            n = n + 1
            list(2*n - 1) = x
            list(2*n) = y
            at(key, kind) = n
         end if
         n_places = n_places + 1
         groups%place(n_places) = at(key, kind) - first + 1
      end subroutine place_pair

   end subroutine list_unknowns

   !> Room for the places of all pairs of unknowns of all corners of all stars.
   pure subroutine make_room(groups, corner)
      type(star_groups_type), intent(inout) :: groups
      !> Corners of all stars.
      integer, intent(in) :: corner(:)

      allocate (groups%place(sum(groups%first_pair(corner + 1) - groups%first_pair(corner))))
      groups%elements%n_elements = size(groups%start) - 1
      allocate (groups%elements%start(size(groups%start)))
      allocate (groups%elements%n_columns(groups%elements%n_elements))
   end subroutine make_room

   !> Add all stars to the tangent, group by group.
   pure subroutine scatter_stars(groups, stars, pattern, values)
      !> Groups of the corners.
      type(star_groups_type), intent(in) :: groups
      !> Stars with the sums over the tiles.
      type(tile_stars_type), intent(in) :: stars
      !> Pattern of the tangent; groups are its first elements.
      type(pattern_type), intent(in) :: pattern
      !> Values of the tangent, shape (n_entries).
      real(wp), intent(inout), contiguous :: values(:)
      real(wp), allocatable :: block(:)
      integer :: g, n, m, at

      associate (elements => groups%elements)
         allocate (block(2*max_pairs_of_vertex &
                         *maxval(elements%start(2:) - elements%start(:elements%n_elements))))
         at = 1
         do g = 1, elements%n_elements
            n = (elements%start(g + 1) - elements%start(g))/2
            m = elements%n_columns(g)/2
            call sum_group(groups, stars, g, n, m, at, block)
            if (m > 0) call add_blocks(pattern, g, n, m, block, values)
         end do
      end associate
   end subroutine scatter_stars

   !> Matrix of a group in terms of its unknowns.
   pure subroutine sum_group(groups, stars, g, n, m, at, block)
      type(star_groups_type), intent(in) :: groups
      type(tile_stars_type), intent(in) :: stars
      !> Number of the group, pairs of its rows and of its columns.
      integer, intent(in) :: g, n, m
      !> Place of the next pair of a star; moves on.
      integer, intent(inout) :: at
      real(wp), intent(out) :: block(4*n, m)
      real(wp) :: rows(4*n)
      integer :: i, k, b, first, length

      block = 0.0_wp
      do i = groups%start(g), groups%start(g + 1) - 1
         rows = 0.0_wp
         associate (c => groups%member(i))
            do k = stars%first(c), stars%last(c)
               first = groups%first_pair(stars%corner(k))
               length = groups%first_pair(stars%corner(k) + 1) - first
               call add_shares(length, groups%place(at:), groups%share(first:), &
                               stars%block(:, :, k), n, rows)
               at = at + length
            end do
            do b = 1, m
               block(:, b) = block(:, b) + groups%share(groups%first_pair(c) + b - 1)*rows
            end do
         end associate
      end do
   end subroutine sum_group

   !> Share out the forces on a corner to its pairs of unknowns.
   pure subroutine add_shares(m, place, share, block, n, rows)
      !> Number of pairs, their places and shares.
      integer, intent(in) :: m, place(m)
      real(wp), intent(in) :: share(m), block(4)
      integer, intent(in) :: n
      real(wp), intent(inout) :: rows(4, n)
      integer :: b

      do b = 1, m
         rows(:, place(b)) = rows(:, place(b)) + share(b)*block
      end do
   end subroutine add_shares

   !> Bytes that the groups occupy.
   pure function groups_memory(groups) result(bytes)
      !> Groups.
      type(star_groups_type), intent(in) :: groups
      integer(long) :: bytes

      bytes = 4_long*int(size(groups%start) + size(groups%member) + size(groups%first_pair) &
                         + size(groups%place) + size(groups%elements%dof) &
                         + size(groups%elements%start) + size(groups%elements%n_columns), long) &
         + 8_long*int(size(groups%share), long)
   end function groups_memory

end module coulter_system_star_groups
