!> The regions of all bodies in one list, for checks that look at all of them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_regions
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid
   use coulter_model, only: model_type
   implicit none(type, external)
   private
   public :: located_region_type, list_regions

   !> A region with its place in the list of all regions, bodies in order.
   type :: located_region_type
      !> Its number, and that of its body.
      integer :: number = 0, body = 0
      !> Corners, counter-clockwise, length units, shape (2, n), and area.
      real(wp), allocatable :: vertices(:, :)
      real(wp) :: area = 0.0_wp
   end type located_region_type

contains

   !> All regions in one list.
   pure subroutine list_regions(model, regions)
      !> Scene.
      type(model_type), intent(in) :: model
      !> Its regions, bodies in order.
      type(located_region_type), allocatable, intent(out) :: regions(:)
      real(wp) :: centroid(2)
      integer :: b, r, n

      n = 0
      do b = 1, size(model%bodies)
         n = n + size(model%bodies(b)%regions)
      end do
      allocate (regions(n))
      n = 0
      do b = 1, size(model%bodies)
         do r = 1, size(model%bodies(b)%regions)
            n = n + 1
            regions(n)%number = n
            regions(n)%body = b
            regions(n)%vertices = model%bodies(b)%regions(r)%vertices
            call area_and_centroid(regions(n)%vertices, regions(n)%area, centroid)
         end do
      end do
   end subroutine list_regions

end module coulter_model_regions
