!> Tangent of tiles in terms of their corners, and its way to the unknowns.
!>
!> A corner and those that it shares tiles with are a star: a column of the tangent of the corners.
!> Tiles add their matrices to stars first; only then corners give way to the unknowns that they
!> hang on, star by star. Neighbouring tiles share this work, which would else be done for every
!> tile, and corners in one cell share the places in the tangent: its columns are theirs.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_tile_stars
   use coulter_algebra_sparse, only: add_blocks, element_dofs_type, pattern_type
   use coulter_base_kinds, only: long, wp
   use coulter_base_sorting, only: sort_by_number
   use coulter_step_dofs, only: dofs_type
   use coulter_step_tile_map, only: tile_map_type
   use coulter_step_unknowns, only: coupling_type, couple_vertices, max_pairs_of_vertex, &
      new_coupling
   implicit none(type, external)
   private
   public :: tile_stars_type, build_stars, couple_stars, clear_stars, add_matrix, add_moduli, &
      scatter_stars, stars_memory

   !> Stars of all corners.
   type :: tile_stars_type
      !> First and last corner of every star in `corner`, shape (n_corners).
      integer, allocatable, private :: first(:), last(:)
      !> Corners in the order of their stars, shape (n_corners).
      integer, allocatable, private :: order(:)
      !> Corners of all stars, the corner itself first, star by star as tiles meet them, so that
      !> what a tile adds to is near in memory, shape (n_entries).
      integer, allocatable, private :: corner(:)
      !> Where the matrix of a tile goes: entry of its row vertex in the star of its column vertex,
      !> shape (4, 4, n_tiles).
      integer, allocatable, private :: entry(:, :, :)
      !> Corners of the tiles that the stars belong to, shape (4, n_tiles).
      integer, allocatable, private :: tile_corner(:, :)
      !> Tangent in terms of the corners, shape (component, component of the star, n_entries).
      real(wp), allocatable :: block(:, :, :)
      !> Unknowns of groups of corners that hang on the same ones, which are the columns; the rows
      !> are those of all their stars.
      type(element_dofs_type) :: elements
      !> First member of every group, and the corners of all groups, shapes (n_groups + 1) and
      !> (n_corners).
      integer, allocatable, private :: group_start(:), member(:)
      !> Shares of the pairs of unknowns that every corner hangs on, shape (n_pairs), and its first
      !> one, shape (n_corners + 1).
      real(wp), allocatable, private :: share(:)
      integer, allocatable, private :: first_pair(:)
      !> Where the pairs of all corners of all stars stand among the rows of the group, star by star
      !> in the order of `member`, shape (n_places).
      integer, allocatable, private :: place(:)
   end type tile_stars_type

contains

   !> Find who shares tiles with whom, unless the tiles are those of the last step.
   subroutine build_stars(stars, corner, n_corners)
      !> Stars to make.
      type(tile_stars_type), intent(inout) :: stars
      !> Corners of every tile, shape (4, n_tiles).
      integer, intent(in) :: corner(:, :)
      !> Number of corners.
      integer, intent(in) :: n_corners
      integer :: tile_start(n_corners + 1), tile(size(corner)), last_star(n_corners), at(n_corners)
      integer :: list(16*size(corner, 2)), c, p, k, v, w, n, n_stars

      if (are_known(stars, corner)) return
      stars = tile_stars_type()
      stars%tile_corner = corner
      allocate (stars%first(n_corners), stars%last(n_corners), source=0)
      allocate (stars%order(n_corners))
      n_stars = 0
      allocate (stars%entry(4, 4, size(corner, 2)))
      call list_tiles(corner, tile_start, tile)
      last_star = 0
      n = 0
      do p = 1, size(corner, 2)
         do v = 1, 4
            c = corner(v, p)
            if (stars%first(c) == 0) call make_star()
         end do
      end do
      stars%corner = list(:n)
      allocate (stars%block(2, 2, n))

   contains

      !> The star of `c`: corners of all tiles around.
      subroutine make_star()
         integer :: a

         n_stars = n_stars + 1
         stars%order(n_stars) = c
         stars%first(c) = n + 1
         call meet(c)
         do k = tile_start(c), tile_start(c + 1) - 1
            do a = 1, 4
               call meet(corner(a, tile(k)))
            end do
            do w = 1, 4
               if (corner(w, tile(k)) == c) stars%entry(:, w, tile(k)) = at(corner(:, tile(k)))
            end do
         end do
         stars%last(c) = n
      end subroutine make_star

      !> Add a corner to the star of `c`, once.
      subroutine meet(other)
         integer, intent(in) :: other

         if (last_star(other) == c) return
         last_star(other) = c
         n = n + 1
         list(n) = other
         at(other) = n
      end subroutine meet

   end subroutine build_stars

   !> Do the stars belong to these tiles?
   pure function are_known(stars, corner) result(answer)
      type(tile_stars_type), intent(in) :: stars
      integer, intent(in) :: corner(:, :)
      logical :: answer

      answer = allocated(stars%tile_corner)
      if (answer) answer = size(stars%tile_corner) == size(corner)
      if (answer) answer = all(stars%tile_corner == corner)
   end function are_known

   !> Tiles around every corner, in ragged rows; one that has a corner twice is there twice.
   pure subroutine list_tiles(corner, start, tile)
      integer, intent(in) :: corner(:, :)
      integer, intent(out) :: start(:), tile(:)
      integer :: place(size(corner))

      call sort_by_number(reshape(corner, [size(corner)]), start, place)
      tile = (place + 3)/4
   end subroutine list_tiles

   !> Unknowns of all corners and stars.
   subroutine couple_stars(stars, map, dofs)
      !> Stars; get `elements`, groups, shares and places.
      type(tile_stars_type), intent(inout) :: stars
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
      stars%first_pair = (corners%elements%start + 1)/2
      stars%share = corners%share(1, :stars%first_pair(n + 1) - 1)
      call group_corners(stars, map, size(map%node_area))
      call list_unknowns(stars, corners%elements%dof, dofs%n_dofs)
   end subroutine couple_stars

   !> Find the corners that hang on the same nodes.
   pure subroutine group_corners(stars, map, n_nodes)
      type(tile_stars_type), intent(inout) :: stars
      type(tile_map_type), intent(in) :: map
      integer, intent(in) :: n_nodes
      integer :: group(size(map%node, 2)), group_at(n_nodes, 0:15), c, i, nodes, n

      group_at = 0
      n = 0
      do i = 1, size(group)
         c = stars%order(i)
         ! corners on grid lines hang on some of the nodes of their cell
         nodes = sum([1, 2, 4, 8], mask=abs(map%shape(:, c)) > 0.0_wp)
         associate (here => group_at(map%node(1, c), nodes))
            if (here == 0) then
               n = n + 1
               here = n
            end if
            group(c) = here
         end associate
      end do
      if (allocated(stars%group_start)) deallocate (stars%group_start, stars%member)
      allocate (stars%group_start(n + 1), stars%member(size(group)))
      call sort_by_number(group, stars%group_start, stars%member)
   end subroutine group_corners

   !> Pairs of unknowns of every group, its own ones first, each once, and where those of all
   !> corners of its stars stand among them.
   subroutine list_unknowns(stars, own, n_dofs)
      type(tile_stars_type), intent(inout) :: stars
      !> Pairs of all corners, and the number of unknowns.
      integer, intent(in) :: own(:), n_dofs
      integer :: last_group(n_dofs, 2), at(n_dofs, 2), g, i, k, b, n, n_places
      integer, allocatable :: list(:)

      call make_room(stars)
      allocate (list(2*size(stars%place)))
      last_group = 0
      n = 0
      n_places = 0
      associate (member => stars%member, first => stars%first_pair, elements => stars%elements)
         do g = 1, elements%n_elements
            elements%start(g) = 2*n + 1
            do i = stars%group_start(g), stars%group_start(g + 1) - 1
               do k = stars%first(member(i)), stars%last(member(i))
                  do b = first(stars%corner(k)), first(stars%corner(k) + 1) - 1
                     call place_pair(own(2*b - 1), own(2*b))
                  end do
               end do
            end do
            i = member(stars%group_start(g))
            elements%n_columns(g) = 2*(first(i + 1) - first(i))
         end do
         elements%start(elements%n_elements + 1) = 2*n + 1
         elements%dof = list(:2*n)
      end associate

   contains

      !> Find the place of a pair in group `g`. Pairs with the same y differ if one has no x.
      subroutine place_pair(x, y)
         integer, intent(in) :: x, y
         integer :: key, kind

         key = max(x, y)
         kind = merge(2, 1, min(x, y) == 0)
         if (last_group(key, kind) < g) then
            last_group(key, kind) = g
            n = n + 1
            list(2*n - 1) = x
            list(2*n) = y
            at(key, kind) = n - stars%elements%start(g)/2
         end if
         n_places = n_places + 1
         stars%place(n_places) = at(key, kind)
      end subroutine place_pair

   end subroutine list_unknowns

   !> Room for the places of all pairs of unknowns of all corners of all stars.
   pure subroutine make_room(stars)
      type(tile_stars_type), intent(inout) :: stars
      integer :: k, n

      n = 0
      do k = 1, size(stars%corner)
         n = n + stars%first_pair(stars%corner(k) + 1) - stars%first_pair(stars%corner(k))
      end do
      if (allocated(stars%place)) then
         deallocate (stars%place, stars%elements%start, stars%elements%n_columns)
      end if
      allocate (stars%place(n))
      stars%elements%n_elements = size(stars%group_start) - 1
      allocate (stars%elements%start(size(stars%group_start)))
      allocate (stars%elements%n_columns(stars%elements%n_elements))
   end subroutine make_room

   !> Begin a new sum over the tiles.
   pure subroutine clear_stars(stars)
      !> Stars; get `block`.
      type(tile_stars_type), intent(inout) :: stars

      call set_zero(size(stars%block), stars%block)

   contains

      !> In one go: the compiler would set block by block.
      pure subroutine set_zero(n, values)
         integer, intent(in) :: n
         real(wp), intent(out) :: values(n)

         values = 0.0_wp
      end subroutine set_zero

   end subroutine clear_stars

   !> Add the tangent of a tile, V g_j A_ijkl g_l, and the stiffness against its hourglass mode.
   pure subroutine add_moduli(stars, tile, gradient, moduli, vector, slope)
      !> Stars; get `block`.
      type(tile_stars_type), intent(inout) :: stars
      !> Number of the tile.
      integer, intent(in) :: tile
      !> Gradients of its corner functions, per length.
      real(wp), intent(in) :: gradient(2, 4)
      !> Spatial moduli times volume.
      real(wp), intent(in) :: moduli(2, 2, 2, 2)
      !> Vector of the mode, and derivative of the force on it by its amplitude.
      real(wp), intent(in) :: vector(4), slope(2, 2)
      real(wp) :: first(2, 2), second(2, 2), mode(2, 2)
      integer :: v, w

      do w = 1, 4
         first = moduli(:, 1, :, 1)*gradient(1, w) + moduli(:, 1, :, 2)*gradient(2, w)
         second = moduli(:, 2, :, 1)*gradient(1, w) + moduli(:, 2, :, 2)*gradient(2, w)
         mode = vector(w)*slope
         do v = 1, 4
            associate (block => stars%block(:, :, stars%entry(v, w, tile)))
               block = block + (first*gradient(1, v) + second*gradient(2, v) + mode*vector(v))
            end associate
         end do
      end do
   end subroutine add_moduli

   !> Add any matrix of a tile.
   pure subroutine add_matrix(stars, tile, matrix)
      !> Stars; get `block`.
      type(tile_stars_type), intent(inout) :: stars
      !> Number of the tile.
      integer, intent(in) :: tile
      !> Its matrix, shape (component, vertex, component, vertex).
      real(wp), intent(in) :: matrix(2, 4, 2, 4)
      integer :: v, w

      do w = 1, 4
         do v = 1, 4
            associate (block => stars%block(:, :, stars%entry(v, w, tile)))
               block = block + matrix(:, v, :, w)
            end associate
         end do
      end do
   end subroutine add_matrix

   !> Add all stars to the tangent, group by group.
   pure subroutine scatter_stars(stars, pattern, values)
      !> Stars with the sums over the tiles.
      type(tile_stars_type), intent(in) :: stars
      !> Pattern of the tangent; groups are its first elements.
      type(pattern_type), intent(in) :: pattern
      !> Values of the tangent, shape (n_entries).
      real(wp), intent(inout), contiguous :: values(:)
      real(wp), allocatable :: block(:)
      integer :: g, n, m, at

      associate (elements => stars%elements)
         allocate (block(2*max_pairs_of_vertex &
                         *maxval(elements%start(2:) - elements%start(:elements%n_elements))))
         at = 1
         do g = 1, elements%n_elements
            n = (elements%start(g + 1) - elements%start(g))/2
            m = elements%n_columns(g)/2
            call sum_group(stars, g, n, m, at, block)
            if (m > 0) call add_blocks(pattern, g, n, m, block, values)
         end do
      end associate
   end subroutine scatter_stars

   !> Matrix of a group in terms of its unknowns.
   pure subroutine sum_group(stars, g, n, m, at, block)
      type(tile_stars_type), intent(in) :: stars
      !> Number of the group, pairs of its rows and of its columns.
      integer, intent(in) :: g, n, m
      !> Place of the next pair of a star; moves on.
      integer, intent(inout) :: at
      real(wp), intent(out) :: block(4*n, m)
      real(wp) :: rows(4*n)
      integer :: i, k, b, first, length

      block = 0.0_wp
      do i = stars%group_start(g), stars%group_start(g + 1) - 1
         rows = 0.0_wp
         associate (c => stars%member(i))
            do k = stars%first(c), stars%last(c)
               first = stars%first_pair(stars%corner(k))
               length = stars%first_pair(stars%corner(k) + 1) - first
               call add_shares(length, stars%place(at:), stars%share(first:), &
                               stars%block(:, :, k), n, rows)
               at = at + length
            end do
            do b = 1, m
               block(:, b) = block(:, b) + stars%share(stars%first_pair(c) + b - 1)*rows
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

   !> Bytes that the stars occupy.
   pure function stars_memory(stars) result(bytes)
      !> Coupled stars.
      type(tile_stars_type), intent(in) :: stars
      integer(long) :: bytes

      bytes = 4_long*int(size(stars%corner) + size(stars%entry) + size(stars%tile_corner) &
                         + size(stars%place) + size(stars%elements%dof), long) &
         + 8_long*int(size(stars%block) + size(stars%share), long)
   end function stars_memory

end module coulter_step_tile_stars
