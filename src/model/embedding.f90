!> Bodies leave out the place of tools that are embedded in them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_embedding
   use coulter_base_faults, only: fault_list_type
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: flatten
   use coulter_model, only: model_type
   use coulter_points_cutting, only: cut_out
   implicit none(type, external)
   private
   public :: embed_tools

   !> Arcs are taken as chords that pass this near, over the spacing: corners of bodies on chords
   !> are so deep in the tool.
   real(wp), parameter :: flatness = 0.02_wp

contains

   !> Cut embedded tools out of all regions.
   subroutine embed_tools(model, faults)
      !> Scene without points.
      type(model_type), intent(inout) :: model
      !> Faults found: bodies of which nothing is left.
      type(fault_list_type), intent(inout) :: faults
      integer :: b, t

      do t = 1, size(model%boundaries)
         associate (tool => model%boundaries(t))
            if (.not. (tool%is_embedded .and. tool%is_solid)) cycle
            do b = 1, size(model%bodies)
               if (size(model%bodies(b)%regions) == 0) cycle
               call cut_out(model%bodies(b)%regions, &
                            place_of(tool, flatness*model%grid%smallest_spacing()), model%grid)
               if (size(model%bodies(b)%regions) > 0) cycle
               call faults%add("body", b, "", "is nothing but tool "//tool%name &
                               //", which is embedded in it")
            end do
         end associate
      end do
   end subroutine embed_tools

   !> Corners of a solid tool, counter-clockwise.
   pure function place_of(tool, sagitta) result(corner)
      type(boundary_type), intent(in) :: tool
      !> Distance between arcs and chords, length units.
      real(wp), intent(in) :: sagitta
      real(wp), allocatable :: corner(:, :)
      integer :: s

      call flatten(tool%vertices, [(tool%bulge(s), s=1, size(tool%vertices, 2) - 1)], sagitta, &
                   corner)
      ! closed, with the material on the left
      corner = corner(:, size(corner, 2):2:-1)
   end function place_of

end module coulter_model_embedding
