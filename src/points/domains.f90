!> Polygons that become the tiles of bodies: joined at their corners first, cut afterwards.
!>
!> Which corners are one is decided for all polygons together, before any is cut, so that no tile
!> loses a corner that its neighbour keeps.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_domains
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid
   use coulter_points_splitting, only: split_polygon
   use coulter_points_welding, only: weld
   implicit none(type, external)
   private
   public :: domain_list_type, add_domain, weld_domains, cut_domains

   !> Polygons in ragged rows that grow.
   type :: domain_list_type
      !> Number of polygons, and of their corners together.
      integer :: n = 0, n_corners = 0
      !> First corner of every polygon and one past the last, shape (> n).
      integer, allocatable :: start(:)
      !> Corners, counter-clockwise, length units, shape (2, >= n_corners).
      real(wp), allocatable :: corner(:, :)
      !> Body of every polygon, shape (>= n).
      integer, allocatable :: body(:)
   end type domain_list_type

contains

   !> Append a polygon.
   pure subroutine add_domain(domains, corner, body)
      !> List.
      type(domain_list_type), intent(inout) :: domains
      !> Corners, counter-clockwise, shape (2, n).
      real(wp), intent(in) :: corner(:, :)
      !> Its body.
      integer, intent(in) :: body
      integer :: last

      last = domains%n_corners + size(corner, 2)
      call make_room(domains, domains%n + 1, last)
      domains%corner(:, domains%n_corners + 1:last) = corner
      domains%n_corners = last
      domains%n = domains%n + 1
      domains%body(domains%n) = body
      domains%start(domains%n + 1) = last + 1
   end subroutine add_domain

   !> Let corners that nearly coincide, in one polygon or in several, coincide exactly.
   pure subroutine weld_domains(domains, tolerance, n_distinct)
      !> List.
      type(domain_list_type), intent(inout) :: domains
      !> Gap per component that is closed, length units.
      real(wp), intent(in) :: tolerance
      !> Number of distinct corners.
      integer, intent(out) :: n_distinct
      integer, allocatable :: number(:)
      real(wp), allocatable :: place(:, :)
      integer :: i

      n_distinct = 0
      if (domains%n == 0) return
      allocate (number(domains%n_corners), place(2, domains%n_corners))
      call weld(domains%corner(:, :domains%n_corners), tolerance, number, n_distinct)
      do i = domains%n_corners, 1, -1
         place(:, number(i)) = domains%corner(:, i)
      end do
      do i = 1, domains%n_corners
         domains%corner(:, i) = place(:, number(i))
      end do
   end subroutine weld_domains

   !> Cut welded polygons into quadrilaterals and triangles.
   pure subroutine cut_domains(domains, smallest_area, vertices, owner)
      !> List; only corners that coincide exactly are one.
      type(domain_list_type), intent(in) :: domains
      !> Tiles of every body that are smaller than this are left out, shape (n_bodies).
      real(wp), intent(in) :: smallest_area(:)
      !> Corners of the tiles, counter-clockwise; a triangle repeats its last one, shape
      !> (2, 4, n_tiles).
      real(wp), allocatable, intent(out) :: vertices(:, :, :)
      !> Body of every tile, shape (n_tiles).
      integer, allocatable, intent(out) :: owner(:)
      real(wp), allocatable :: tile(:, :, :)
      real(wp) :: area, centroid(2)
      integer :: d, k, n, n_tiles

      ! a polygon of m corners makes at most m - 2 tiles
      allocate (vertices(2, 4, domains%n_corners), owner(domains%n_corners))
      n = 0
      do d = 1, domains%n
         call split_polygon(domains%corner(:, domains%start(d):domains%start(d + 1) - 1), 0.0_wp, &
                            tile, n_tiles)
         do k = 1, n_tiles
            call area_and_centroid(tile(:, :, k), area, centroid)
            if (area <= smallest_area(domains%body(d))) cycle
            n = n + 1
            vertices(:, :, n) = tile(:, :, k)
            owner(n) = domains%body(d)
         end do
      end do
      vertices = vertices(:, :, :n)
      owner = owner(:n)
   end subroutine cut_domains

   !> Let the list hold some polygons and corners, keeping those it has.
   pure subroutine make_room(domains, n, n_corners)
      type(domain_list_type), intent(inout) :: domains
      integer, intent(in) :: n, n_corners
      integer, allocatable :: start(:), body(:)
      real(wp), allocatable :: corner(:, :)

      if (.not. allocated(domains%start)) then
         allocate (domains%start(65), domains%body(64), domains%corner(2, 256))
         domains%start(1) = 1
      end if
      if (n > size(domains%body)) then
         allocate (start(2*n + 1), body(2*n))
         start(:domains%n + 1) = domains%start(:domains%n + 1)
         body(:domains%n) = domains%body(:domains%n)
         call move_alloc(start, domains%start)
         call move_alloc(body, domains%body)
      end if
      if (n_corners > size(domains%corner, 2)) then
         allocate (corner(2, 2*n_corners))
         corner(:, :domains%n_corners) = domains%corner(:, :domains%n_corners)
         call move_alloc(corner, domains%corner)
      end if
   end subroutine make_room

end module coulter_points_domains
