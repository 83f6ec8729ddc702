!> Tangent of tiles in terms of their corners.
!>
!> A corner and those that it shares tiles with are a star: a column of the tangent of the corners.
!> Tiles add their matrices to stars; `coulter_system_star_groups` then brings stars to the
!> unknowns.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_tile_stars
   use coulter_base_kinds, only: long, wp
   use coulter_points_tiling, only: list_tiles
   implicit none(type, external)
   private
   public :: tile_stars_type, build_stars, clear_stars, add_matrix, add_moduli, stars_memory

   !> Stars of all corners.
   type :: tile_stars_type
      !> First and last corner of every star in `corner`, shape (n_corners).
      integer, allocatable :: first(:), last(:)
      !> Corners in the order of their stars, shape (n_corners).
      integer, allocatable :: order(:)
      !> Corners of all stars, the corner itself first, star by star as tiles meet them, so that
      !> what a tile adds to is near in memory, shape (n_entries).
      integer, allocatable :: corner(:)
      !> Where the matrix of a tile goes: entry of its row vertex in the star of its column vertex,
      !> shape (4, 4, n_tiles).
      integer, allocatable, private :: entry(:, :, :)
      !> Corners of the tiles that the stars belong to, shape (4, n_tiles).
      integer, allocatable, private :: tile_corner(:, :)
      !> Tangent in terms of the corners, shape (component, component of the star, n_entries).
      real(wp), allocatable :: block(:, :, :)
   end type tile_stars_type

contains

   !> Find who shares tiles with whom, unless the tiles are those of the last step.
   subroutine build_stars(stars, corner, n_corners)
      !> Stars to make.
      type(tile_stars_type), intent(inout) :: stars
      !> Corners of every tile, shape (4, n_tiles).
      integer, intent(in) :: corner(:, :)
      !> Number of corners, each of which belongs to a tile.
      integer, intent(in) :: n_corners
      integer :: tile_start(n_corners + 1), tile(size(corner)), at(n_corners)
      integer :: list(16*size(corner, 2)), c, p, v, n, n_stars

      if (are_known(stars, corner)) return
      stars = tile_stars_type()
      stars%tile_corner = corner
      allocate (stars%first(n_corners), stars%last(n_corners), source=0)
      allocate (stars%order(n_corners), stars%entry(4, 4, size(corner, 2)))
      call list_tiles(corner, tile_start, tile)
      at = 0
      n = 0
      n_stars = 0
      do p = 1, size(corner, 2)
         do v = 1, 4
            c = corner(v, p)
            if (stars%first(c) > 0) cycle
            n_stars = n_stars + 1
            stars%order(n_stars) = c
            call add_star(stars, c, tile(tile_start(c):tile_start(c + 1) - 1), at, list, n)
         end do
      end do
      stars%corner = list(:n)
      allocate (stars%block(2, 2, n))
   end subroutine build_stars

   !> Make the star of a corner, of all tiles around it.
   subroutine add_star(stars, corner, tile, at, list, n)
      type(tile_stars_type), intent(inout) :: stars
      !> The corner, and the tiles around it.
      integer, intent(in) :: corner, tile(:)
      !> Last entry of every corner in any star, 0 for none.
      integer, intent(inout) :: at(:)
      !> Corners of the stars so far, and how many.
      integer, intent(inout) :: list(:), n
      integer :: k, w

      stars%first(corner) = n + 1
      call meet(corner)
      do k = 1, size(tile)
         associate (around => stars%tile_corner(:, tile(k)))
            do w = 1, 4
               call meet(around(w))
            end do
            do w = 1, 4
               if (around(w) == corner) stars%entry(:, w, tile(k)) = at(around)
            end do
         end associate
      end do
      stars%last(corner) = n

   contains

      !> Add a corner to the star, once.
      subroutine meet(other)
         integer, intent(in) :: other

         if (at(other) >= stars%first(corner)) return
         n = n + 1
         list(n) = other
         at(other) = n
      end subroutine meet

   end subroutine add_star

   !> Do the stars belong to these tiles?
   pure function are_known(stars, corner) result(answer)
      type(tile_stars_type), intent(in) :: stars
      integer, intent(in) :: corner(:, :)
      logical :: answer

      answer = allocated(stars%tile_corner)
      if (answer) answer = size(stars%tile_corner) == size(corner)
      if (answer) answer = all(stars%tile_corner == corner)
   end function are_known

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

   !> Bytes that the stars occupy.
   pure function stars_memory(stars) result(bytes)
      !> Stars.
      type(tile_stars_type), intent(in) :: stars
      integer(long) :: bytes

      bytes = 4_long*int(3*size(stars%order) + size(stars%corner) + size(stars%entry) &
                         + size(stars%tile_corner), long) + 8_long*int(size(stars%block), long)
   end function stars_memory

end module coulter_system_tile_stars
