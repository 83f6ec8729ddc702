!> Parts of tiled bodies: tiles that hang together by shared corners.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_parts
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid
   use coulter_base_sets, only: join_sets, root_of
   use coulter_points_tiling, only: tiling_type, values_at
   implicit none(type, external)
   private
   public :: part_type, find_parts

   !> A part of a body.
   type :: part_type
      !> Its body.
      integer :: body = 0
      !> Its area.
      real(wp) :: area = 0.0_wp
      !> Its centroid, length units.
      real(wp) :: centroid(2) = 0.0_wp
   end type part_type

contains

   !> All parts of all bodies, those of one body one after the other.
   pure subroutine find_parts(parts, tiling, body, n_bodies, part)
      !> Parts, shape (n_parts).
      type(part_type), allocatable, intent(out) :: parts(:)
      !> Tiles.
      type(tiling_type), intent(in) :: tiling
      !> Body of every tile, shape (n_tiles), and number of bodies.
      integer, intent(in) :: body(:), n_bodies
      !> Part of every tile, shape (n_tiles).
      integer, intent(out) :: part(:)
      integer :: parent(tiling%n_corners), b, p, v

      allocate (parts(0))
      do b = 1, n_bodies
         parent = [(v, v=1, tiling%n_corners)]
         do p = 1, size(body)
            if (body(p) /= b) cycle
            do v = 2, 4
               call join_sets(parent, tiling%corner(1, p), tiling%corner(v, p))
            end do
         end do
         call add_parts(parts, tiling, body, b, parent, part)
      end do
   end subroutine find_parts

   !> Append the parts of one body.
   pure subroutine add_parts(parts, tiling, body, b, parent, part)
      type(part_type), allocatable, intent(inout) :: parts(:)
      type(tiling_type), intent(in) :: tiling
      integer, intent(in) :: body(:), b
      integer, intent(in) :: parent(:)
      integer, intent(inout) :: part(:)
      integer :: number(size(parent)), p, root
      real(wp) :: area, centroid(2)

      number = 0
      do p = 1, size(body)
         if (body(p) /= b) cycle
         root = root_of(parent, tiling%corner(1, p))
         if (number(root) == 0) then
            parts = [parts, part_type(body=b)]
            number(root) = size(parts)
         end if
         call area_and_centroid(values_at(tiling%corner(:, p), tiling%position), area, centroid)
         part(p) = number(root)
         associate (whole => parts(part(p)))
            whole%area = whole%area + area
            whole%centroid = whole%centroid + (centroid - whole%centroid)*(area/whole%area)
         end associate
      end do
   end subroutine add_parts

end module coulter_points_parts
