!> Bodies that come apart or grow together when they are tiled anew.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_parting
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_model, only: model_type
   use coulter_model_observer, only: add_warning, step_report_type
   use coulter_points_parts, only: find_parts, part_type
   use coulter_system, only: system_type
   implicit none(type, external)
   private
   public :: report_parting

contains

   !> Name bodies that now have more or fewer parts than before.
   pure subroutine report_parting(report, model, system, old)
      !> Report of the step.
      type(step_report_type), intent(inout) :: report
      !> Scene with new tiles.
      type(model_type), intent(in) :: model
      !> Its system; remembers that a body has come apart.
      type(system_type), intent(inout) :: system
      !> Parts of all bodies before.
      type(part_type), intent(in) :: old(:)
      type(part_type), allocatable :: parts(:)
      integer :: part(model%points%n_points), b, k, n

      call find_parts(parts, model%tiling, model%points%body, size(model%bodies), part)
      do b = 1, size(model%bodies)
         n = count(parts%body == b)
         if (n == count(old%body == b)) cycle
         if (n > count(old%body == b)) system%has_come_apart = .true.
         k = minloc(parts%area, dim=1, mask=parts%body == b)
         if (n < count(old%body == b)) then
            call add_warning(report%warnings, "body "//model%bodies(b)%name//" has grown together" &
                             //" or lost specks: it has "//to_text(n)//" parts, not " &
                             //to_text(count(old%body == b)))
         else
            call add_warning(report%warnings, "body "//model%bodies(b)%name//" has come apart: it" &
                             //" has "//to_text(n)//" parts, the smallest, of area " &
                             //to_text(parts(k)%area, 3)//", near (" &
                             //to_text(parts(k)%centroid)//")")
         end if
      end do
   end subroutine report_parting

end module coulter_retile_parting
