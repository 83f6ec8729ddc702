!> Summary of a scene for the head of the run log.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_log_scene
   use coulter_base_kinds, only: long, wp
   use coulter_base_text, only: to_text
   use coulter_boundary, only: boundary_type, formulation_augmented, formulation_implicit, &
      kind_roller
   use coulter_model, only: model_type
   use coulter_model_control, only: small_cells_aggregate, small_cells_drop, &
      small_cells_keep
   use coulter_model_observer, only: scene_report_type
   use coulter_results_log_text, only: bytes_text, grouped, left, plural, right, &
      write_paragraph
   use coulter_results_surface_history, only: surface_name
   implicit none(type, external)
   private
   public :: write_scene, name_width

   !> Width of the labels on the left.
   integer, parameter :: label_width = 14
   !> Width of the counts behind them.
   integer, parameter :: count_width = 11
   !> Tiles whose aspect (longest edge squared over area) is above this are slivers: thinner than a
   !> hundredth of their length.
   real(wp), parameter :: sliver_aspect = 100.0_wp

contains

   !> Write the summary.
   subroutine write_scene(unit, model, scene)
      !> Unit to write to.
      integer, intent(in) :: unit
      !> Model in its initial state.
      type(model_type), intent(in) :: model
      !> Facts about the scene.
      type(scene_report_type), intent(in) :: scene

      write (unit, "(a)") ""
      if (allocated(model%title)) write (unit, "(a, /)") model%title
      call write_count("points", int(scene%n_points, long), &
                       "in "//plural(size(model%bodies), "body", "bodies"))
      call write_count("active cells", int(scene%n_cells, long), &
                       "of "//grouped(scene%n_grid_cells))
      call write_count("nodes", int(scene%n_nodes, long), "")
      call write_count("unknowns", int(scene%n_dofs, long), &
                       grouped(int(scene%n_entries, long))//" matrix entries, " &
                       //bytes_text(scene%memory))
      call write_count("steps", int(model%schedule%n_steps(), long), phases_text(model))
      call write_boundaries(unit, model)
      call write_contacts(unit, model)
      if (allocated(model%tiling)) call write_slivers(unit, model)
      call write_paragraph(unit, "  "//left("not needed", label_width), not_needed(model))

   contains

      !> Write a labelled count.
      subroutine write_count(label, number, remark)
         character(len=*), intent(in) :: label, remark
         integer(long), intent(in) :: number

         write (unit, "(2x, a)") trim(left(label, label_width) &
                                      //right(grouped(number), count_width)//"   "//remark)
      end subroutine write_count

   end subroutine write_scene

   !> Names of the phases, if there are any.
   pure function phases_text(model) result(text)
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text
      integer :: i

      text = ""
      if (model%schedule%n_steps() < size(model%schedule%end_time)) text = "of " &
         //to_text(size(model%schedule%end_time))//" "
      if (.not. allocated(model%schedule%phases)) return
      text = text//"in phases"
      do i = 1, size(model%schedule%phases)
         if (i > 1) text = text//","
         text = text//" "//model%schedule%phases(i)%name
      end do
   end function phases_text

   !> Length of the longest name of a boundary.
   pure function name_width(boundaries) result(width)
      !> Boundaries of the model.
      type(boundary_type), intent(in) :: boundaries(:)
      integer :: width
      integer :: i

      width = 0
      do i = 1, size(boundaries)
         width = max(width, len(boundaries(i)%name))
      end do
   end function name_width

   !> Write a line for every boundary.
   subroutine write_boundaries(unit, model)
      integer, intent(in) :: unit
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: label
      integer :: i, width

      width = name_width(model%boundaries)
      do i = 1, size(model%boundaries)
         label = ""
         if (i == 1) label = "boundaries"
         associate (boundary => model%boundaries(i))
            write (unit, "(2x, 4a)") left(label, label_width), left(boundary%name, width), &
               "   ", formulation(boundary)
         end associate
      end do
   end subroutine write_boundaries

   !> Write a line for every contact between bodies.
   subroutine write_contacts(unit, model)
      integer, intent(in) :: unit
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text
      integer :: k

      if (.not. allocated(model%body_contacts)) return
      do k = 1, size(model%body_contacts)
         text = left(trim(merge("contacts", "        ", k == 1)), label_width) &
            //surface_name(model, k)//"   smooth"
         associate (friction => model%body_contacts(k)%friction)
            if (model%body_contacts(k)%rubs()) text = text(:len(text) - 6)//"friction " &
               //to_text(friction%coefficient)//", adhesion "//to_text(friction%adhesion)
            if (friction%is_rough) text = text//", rough"
         end associate
         write (unit, "(2x, a)") text
      end do
   end subroutine write_contacts

   !> Name bodies with slivers among their tiles, which an outline beside a grid line makes: their
   !> stress is worth little.
   subroutine write_slivers(unit, model)
      integer, intent(in) :: unit
      type(model_type), intent(in) :: model
      logical :: is_sliver(model%points%n_points)
      integer :: b, p

      do b = 1, size(model%bodies)
         is_sliver = model%points%body == b .and. model%tiling%first_aspect > sliver_aspect
         if (.not. any(is_sliver)) cycle
         p = maxloc(model%tiling%first_aspect, dim=1, mask=is_sliver)
         call write_paragraph(unit, "  "//left("slivers", label_width), "body " &
                              //model%bodies(b)%name//" has " &
                              //plural(count(is_sliver), "tile", "tiles")//" thinner than a" &
                              //" hundredth of the length, the thinnest near (" &
                              //to_text(model%points%position(:, p))//"): let grid lines keep" &
                              //" away from its outline, or lie on it")
      end do
   end subroutine write_slivers

   !> How a boundary acts: "roller, pushes only, moves by (-36, 0)".
   pure function formulation(boundary) result(text)
      type(boundary_type), intent(in) :: boundary
      character(len=:), allocatable :: text

      text = "fixed"
      if (boundary%kind == kind_roller) text = "roller"
      if (boundary%formulation /= formulation_implicit) then
         if (boundary%formulation == formulation_augmented) text = text//", augmented"
         if (.not. boundary%is_bilateral) text = text//", pushes only"
      else
         text = text//", penalty"
         if (boundary%has_coupling_term) text = text//" + coupling"
         if (boundary%has_memory) text = text//", traction memory"
      end if
      if (any(abs(boundary%displacement) > 0.0_wp)) then
         text = text//", moves by ("//to_text(boundary%displacement)//")"
      end if
   end function formulation

   !> What the scene leaves unused and the program therefore skips.
   pure function not_needed(model) result(text)
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text

      text = ""
      if (.not. any(abs(model%body_force%acceleration) > 0.0_wp)) call append("body force")
      if (size(model%fixities) == 0) call append("grid fixities")
      if (allocated(model%tiling)) then
         if (all(model%boundaries%is_bilateral)) call append("opening contacts")
         if (.not. model%control%ghost_ratio > 0.0_wp) call append("ghost penalty")
         if (model%control%small_cells == small_cells_keep) call append("node aggregation")
      else
         call append("tiling domains")
         if (.not. any(model%boundaries%has_memory)) call append("traction memory")
         if (.not. any(model%boundaries%has_coupling_term)) call append("coupling term")
         if (model%control%small_cells /= small_cells_aggregate) call append("cell aggregation")
         if (model%control%small_cells /= small_cells_drop) call append("dropping of cells")
      end if
      if (size(model%tables) == 0) call append("load tables")
      if (text == "") text = "nothing left out"

   contains

      !> Continue the list.
      pure subroutine append(item)
         character(len=*), intent(in) :: item

         if (text /= "") text = text//", "
         text = text//item
      end subroutine append

   end function not_needed

end module coulter_results_log_scene
