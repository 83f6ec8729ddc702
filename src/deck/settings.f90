!> Reads the groups that stand once and describe no object: scene, grid, control and output.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_settings
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: wp
   use coulter_deck_document, only: blame, deck_type, first_group
   use coulter_deck_values, only: get_choice, get_list, get_value, is_given, refuse
   use coulter_grid, only: grid_type, new_grid
   use coulter_model, only: model_type
   use coulter_model_control, only: control_type, domains_boxes, domains_points, &
      domains_tiles, small_cells_aggregate, small_cells_drop, small_cells_keep
   use coulter_model_output, only: output_type
   implicit none(type, external)
   private
   public :: read_scene, read_grid, read_control, read_output, base_name

   !> Positions farther away than this many cells have too few digits for tractions on walls.
   real(wp), parameter :: farthest_cell = 1.0e7_wp

contains

   !> Title and labels; empty where the deck gives none.
   subroutine read_scene(deck, model)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Model whose title and units are set.
      type(model_type), intent(inout) :: model
      integer :: group

      model%title = ""
      model%units%length = ""
      model%units%stress = ""
      model%units%force = ""
      group = first_group(deck, "scene")
      if (group == 0) return
      call get_value(deck, group, "title", model%title)
      call get_value(deck, group, "length_unit", model%units%length)
      call get_value(deck, group, "stress_unit", model%units%stress)
      call get_value(deck, group, "force_unit", model%units%force)
   end subroutine read_scene

   !> The background grid; a single cell when the group is missing or at fault.
   subroutine read_grid(deck, grid)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Grid to make.
      type(grid_type), intent(out) :: grid
      type(error_type), allocatable :: error
      real(wp), allocatable :: edges(:)
      integer, allocatable :: cells(:)
      real(wp) :: origin(2), spacing(2)
      integer :: group

      origin = 0.0_wp
      spacing = 1.0_wp
      group = first_group(deck, "grid")
      if (group > 0) then
         call get_value(deck, group, "origin", origin)
         call get_list(deck, group, "spacing", edges)
         call get_list(deck, group, "cells", cells)
      end if
      if (allocated(edges)) spacing = edges([1, size(edges)])
      if (.not. allocated(cells)) cells = [1, 1]
      call new_grid(grid, origin, spacing, cells, error)
      if (allocated(error)) call blame(deck, group, "", error%message)
      if (any(abs(origin) > farthest_cell*spacing)) then
         call blame(deck, group, "origin", "must be within 1.0e7 cells of (0, 0): farther away" &
                    //" positions have too few digits")
      end if
   end subroutine read_grid

   !> How a load step is solved.
   subroutine read_control(deck, control)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Settings; those that the deck does not give keep the defaults of the type.
      type(control_type), intent(out) :: control
      integer, parameter :: treatments(*) = &
         [small_cells_keep, small_cells_drop, small_cells_aggregate]
      integer, parameter :: domains(*) = [domains_tiles, domains_boxes, domains_points]
      integer :: group, choice

      control%domains = domains_tiles
      group = first_group(deck, "control")
      if (group == 0) return
      choice = findloc(domains, control%domains, dim=1)
      call get_choice(deck, group, "domains", choice)
      control%domains = domains(choice)
      call get_value(deck, group, "hourglass", control%hourglass_ratio)
      call get_value(deck, group, "hourglass_limit", control%hourglass_limit)
      call get_value(deck, group, "ghost_penalty", control%ghost_ratio)
      call get_value(deck, group, "condition", control%has_condition)
      call get_value(deck, group, "tolerance", control%tolerance)
      call get_value(deck, group, "increment_tolerance", control%increment_tolerance)
      call get_value(deck, group, "augmentations", control%n_augmentations)
      call get_value(deck, group, "max_iterations", control%max_iterations)
      call get_value(deck, group, "max_halvings", control%max_halvings)
      call get_value(deck, group, "settle", control%may_settle)
      call get_value(deck, group, "fill_tolerance", control%fill_tolerance)
      choice = merge(2, 1, control%has_mean_volume)
      call get_choice(deck, group, "volumetric", choice)
      control%has_mean_volume = choice == 2
      choice = merge(1, 2, control%may_retile)
      call get_choice(deck, group, "retile", choice)
      control%may_retile = choice == 1
      choice = merge(2, 1, control%is_lu_only)
      call get_choice(deck, group, "solver", choice)
      control%is_lu_only = choice == 2
      choice = findloc(treatments, control%small_cells, dim=1)
      call get_choice(deck, group, "small_cells", choice)
      control%small_cells = treatments(choice)
      if (control%small_cells == small_cells_drop .and. control%domains == domains_tiles) then
         call blame(deck, group, "small_cells", "must be 'keep' or 'aggregate' for tiled domains")
      end if
      if (control%domains /= domains_tiles) then
         call refuse(deck, group, "hourglass", "belongs to domains = 'cpdi2'")
         call refuse(deck, group, "hourglass_limit", "belongs to domains = 'cpdi2'")
         call refuse(deck, group, "ghost_penalty", "belongs to domains = 'cpdi2'")
         call refuse(deck, group, "retile", "belongs to domains = 'cpdi2'")
         call refuse(deck, group, "settle", "belongs to domains = 'cpdi2'")
      end if
   end subroutine read_control

   !> When results are written, and how.
   subroutine read_output(deck, n_steps, output)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of load steps.
      integer, intent(in) :: n_steps
      !> Settings; those that the deck does not give keep the defaults of the type.
      type(output_type), intent(out) :: output
      integer :: group, choice

      output%name = base_name(deck%path)
      group = first_group(deck, "output")
      if (group == 0) return
      call get_value(deck, group, "every", output%every)
      call get_value(deck, group, "compression", output%compression)
      call get_value(deck, group, "name", output%name)
      choice = 1
      call get_choice(deck, group, "precision", choice)
      output%is_single = choice == 2
      if (scan(output%name, "/\") > 0) then
        call blame(deck, group, "name", "must be a file name without folders")
      end if
      if (is_given(deck, group, "at_steps")) call read_output_steps(deck, group, n_steps, output)
   end subroutine read_output

   !> The steps after which results are written.
   subroutine read_output_steps(deck, group, n_steps, output)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group, n_steps
      type(output_type), intent(inout) :: output

      if (is_given(deck, group, "every")) then
        call blame(deck, group, "at_steps", "stands beside `every`; give one of them")
      end if
      call get_list(deck, group, "at_steps", output%at_steps)
      if (.not. allocated(output%at_steps)) return
      associate (at => output%at_steps)
         if (any(at(2:) <= at(:size(at) - 1))) then
            call blame(deck, group, "at_steps", "must increase")
         else if (at(size(at)) > n_steps) then
            call blame(deck, group, "at_steps", "must not exceed the number of steps")
         end if
      end associate
   end subroutine read_output_steps

   !> "input/wedge.nml" -> "wedge".
   pure function base_name(path) result(name)
      !> Path of a file.
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: name
      integer :: dot

      name = path(index(path, "/", back=.true.) + 1:)
      dot = index(name, ".", back=.true.)
      if (dot > 1) name = name(:dot - 1)
   end function base_name

end module coulter_deck_settings
