!> Tools so thin that the tiles at their ends are coarser than they are.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_thin_tools
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_boundary_face, only: place_on, place_type
   use coulter_boundary_plate, only: opposed
   use coulter_contact, only: contacts_type
   use coulter_model, only: model_type
   use coulter_model_observer, only: add_warning, step_report_type
   use coulter_points_tiling, only: tiling_type
   use coulter_system, only: system_type
   implicit none(type, external)
   private
   public :: report_thin_tools

   !> Tools with bodies on both sides are named below this thickness, over the spacing; they are
   !> there if corners of them are this near to its faces.
   real(wp), parameter :: thinnest = 1.2_wp, near = 0.5_wp

contains

   !> Name every tool, once, that has bodies on both sides where it is too thin.
   pure subroutine report_thin_tools(report, model, system)
      !> Report of the step.
      type(step_report_type), intent(inout) :: report
      !> Scene at the end of the step, with the tiles of the step.
      type(model_type), intent(in) :: model
      !> Its system; remembers what has been named.
      type(system_type), intent(inout) :: system
      real(wp) :: place(2), thickness
      integer :: b

      if (.not. any(model%boundaries%is_tool)) return
      if (.not. allocated(system%named_thin)) then
         allocate (system%named_thin(size(model%boundaries)), source=.false.)
      end if
      do b = 1, size(model%boundaries)
         if (system%named_thin(b) .or. .not. model%boundaries(b)%is_tool) cycle
         call find_thinnest(system%contacts, b, model%tiling, model%grid%smallest_spacing(), &
                            place, thickness)
         system%named_thin(b) = thickness < thinnest
         if (.not. system%named_thin(b)) cycle
         call add_warning(report%warnings, "tool "//model%boundaries(b)%name//" is " &
                          //to_text(thickness, 2)//" cells thick near ("//to_text(place) &
                          //"), with material on both sides, which parts roughly at its ends:" &
                          //" compare with a finer grid or a tool of "//to_text(thinnest, 2) &
                          //" cells")
      end do
   end subroutine report_thin_tools

   !> Where the faces of a tool are nearest to each other between bodies on both sides.
   pure subroutine find_thinnest(contacts, boundary, tiling, spacing, middle, thickness)
      type(contacts_type), intent(in) :: contacts
      !> Number of the tool.
      integer, intent(in) :: boundary
      type(tiling_type), intent(in) :: tiling
      real(wp), intent(in) :: spacing
      !> Place between them, length units, and their distance over the spacing, huge if there is
      !> none.
      real(wp), intent(out) :: middle(2), thickness
      type(place_type) :: place(contacts%n)
      real(wp) :: foot(2, contacts%n), between(2)
      integer :: mine(contacts%n), i, k, n

      middle = 0.0_wp
      thickness = huge(1.0_wp)
      n = 0
      do k = 1, contacts%n
         associate (contact => contacts%item(k))
            if (contact%boundary /= boundary .or. contact%tip > 0) cycle
            place(k) = place_on(contact%face, tiling%position(:, contact%corner) &
                                - contact%face%first, [0.0_wp, 0.0_wp])
            if (abs(place(k)%gap) > near*spacing .or. place(k)%distance < 0.0_wp &
                .or. place(k)%distance > contact%face%length) cycle
            foot(:, k) = tiling%position(:, contact%corner) - place(k)%gap*place(k)%normal
         end associate
         n = n + 1
         mine(n) = k
         do i = 1, n - 1
            if (dot_product(place(mine(i))%normal, place(k)%normal) > opposed) cycle
            between = foot(:, mine(i)) - foot(:, k)
            if (norm2(between) >= thickness*spacing) cycle
            thickness = norm2(between)/spacing
            middle = foot(:, k) + 0.5_wp*between
         end do
      end do
   end subroutine find_thinnest

end module coulter_step_thin_tools
