!> The scene in a results file: title, units, grid, and the boundaries wherever they are in a frame.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_scene
   use coulter_base_kinds, only: long, wp
   use coulter_boundary, only: boundary_type, formulation_augmented, formulation_implicit, &
      formulation_nitsche, kind_roller
   use coulter_grid, only: grid_type
   use coulter_model, only: model_type, units_type
   use coulter_model_control, only: phase_type
   use coulter_results_hdf5_io, only: hdf5_file_type
   use coulter_results_hdf5_types, only: kind_integer, kind_real
   implicit none(type, external)
   private
   public :: put_scene, put_shapes

   !> Most characters of a name that is kept.
   integer, parameter :: name_length = 64

contains

   !> Write all that stays the same in every frame.
   subroutine put_scene(file, model)
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> Model in its initial state.
      type(model_type), intent(in) :: model

      call put_optional_text(file, "/", "title", model%title)
      call put_units(file, model%units)
      call put_grid(file, model%grid)
      call file%describe("grid/origin", "position of the lower corner", model%units%length)
      call file%describe("grid/spacing", "edge lengths of a cell", model%units%length)
      call put_body_names(file, model)
      if (allocated(model%schedule%phases)) call put_phases(file, model%schedule%phases)
      call put_boundaries(file, model%boundaries)
      call file%describe("boundaries/vertices", "corners of all boundaries in every frame", &
                         model%units%length)
   end subroutine put_scene

   !> Append where the boundaries are in a frame.
   subroutine put_shapes(file, boundaries, frame)
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> Boundaries of the model; the number of their corners never changes.
      type(boundary_type), intent(in) :: boundaries(:)
      !> Number of the frame, from 0.
      integer, intent(in) :: frame
      real(wp), allocatable :: corners(:)
      integer :: i

      allocate (corners(0))
      do i = 1, size(boundaries)
         corners = [corners, reshape(boundaries(i)%vertices, [size(boundaries(i)%vertices)])]
      end do
      call file%put_reals("boundaries/vertices", int(frame, long), size(corners), corners)
   end subroutine put_shapes

   !> Write the labels of the units.
   subroutine put_units(file, units)
      type(hdf5_file_type), intent(inout) :: file
      type(units_type), intent(in) :: units

      call file%add_group("units")
      call put_optional_text(file, "units", "length", units%length)
      call put_optional_text(file, "units", "stress", units%stress)
      call put_optional_text(file, "units", "force", units%force)
   end subroutine put_units

   !> Write the background grid.
   subroutine put_grid(file, grid)
      type(hdf5_file_type), intent(inout) :: file
      type(grid_type), intent(in) :: grid
      integer :: n

      n = grid%n_dim
      call file%add_group("grid")
      call file%add_rows("grid/origin", kind_real, [integer ::], n)
      call file%put_reals("grid/origin", 0_long, n, grid%origin)
      call file%add_rows("grid/spacing", kind_real, [integer ::], n)
      call file%put_reals("grid/spacing", 0_long, n, grid%spacing)
      call file%add_rows("grid/cells", kind_integer, [integer ::], n)
      call file%put_integers("grid/cells", 0_long, n, int(grid%n_cells, long))
      call file%describe("grid/cells", "number of cells per direction")
   end subroutine put_grid

   !> Write the names of the bodies, to which the point data `body` refer.
   subroutine put_body_names(file, model)
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      character(len=name_length), allocatable :: names(:)
      integer :: i

      allocate (names(size(model%bodies)))
      do i = 1, size(names)
         names(i) = model%bodies(i)%name
      end do
      call file%add_group("bodies")
      call file%put_texts("bodies/name", names)
   end subroutine put_body_names

   !> Write names and last steps of the phases.
   subroutine put_phases(file, phases)
      type(hdf5_file_type), intent(inout) :: file
      type(phase_type), intent(in) :: phases(:)
      character(len=name_length) :: names(size(phases))
      integer :: i

      do i = 1, size(phases)
         names(i) = phases(i)%name
      end do
      call file%add_group("phases")
      call file%put_texts("phases/name", names)
      call file%add_rows("phases/last_step", kind_integer, [integer ::], size(phases))
      call file%put_integers("phases/last_step", 0_long, size(phases), &
                             int(phases%last_step, long))
      call file%describe("phases/last_step", "number of the last step of every phase")
   end subroutine put_phases

   !> Write names and kinds of the boundaries and make room for their corners.
   subroutine put_boundaries(file, boundaries)
      type(hdf5_file_type), intent(inout) :: file
      type(boundary_type), intent(in) :: boundaries(:)
      character(len=name_length) :: names(size(boundaries))
      character(len=6) :: kinds(size(boundaries))
      character(len=9) :: formulations(size(boundaries))
      integer(long) :: is_bilateral(size(boundaries))
      integer(long) :: ends(size(boundaries) + 1)
      integer :: i

      ends(1) = 0
      do i = 1, size(boundaries)
         names(i) = boundaries(i)%name
         kinds(i) = merge("roller", "fixed ", boundaries(i)%kind == kind_roller)
         formulations(i) = formulation_name(boundaries(i))
         is_bilateral(i) = merge(0_long, 1_long, is_wall(boundaries(i)))
         ends(i + 1) = ends(i) + size(boundaries(i)%vertices, 2, kind=long)
      end do
      call file%add_group("boundaries")
      call file%put_texts("boundaries/name", names)
      call file%put_texts("boundaries/kind", kinds)
      call file%put_texts("boundaries/formulation", formulations)
      call file%add_rows("boundaries/is_bilateral", kind_integer, [integer ::], &
                         max(size(boundaries), 1))
      call file%put_integers("boundaries/is_bilateral", 0_long, size(boundaries), is_bilateral)
      call file%describe("boundaries/is_bilateral", "1 where material cannot come off, else 0")
      call file%add_rows("boundaries/offsets", kind_integer, [integer ::], size(ends))
      call file%put_integers("boundaries/offsets", 0_long, size(ends), ends)
      call file%describe("boundaries/offsets", "first corner of every boundary; total at the end")
      call put_shape_kinds(file, boundaries, int(ends(size(ends))))
      call file%add_rows("boundaries/vertices", kind_real, [2, int(ends(size(ends)))], 1)
   end subroutine put_boundaries

   !> Write which boundaries are tools, and how their faces are bent: a bulge per corner, for the
   !> face that begins there.
   subroutine put_shape_kinds(file, boundaries, n_corners)
      type(hdf5_file_type), intent(inout) :: file
      type(boundary_type), intent(in) :: boundaries(:)
      integer, intent(in) :: n_corners
      real(wp) :: bulges(n_corners)
      integer :: b, s, n

      bulges = 0.0_wp
      n = 0
      do b = 1, size(boundaries)
         do s = 1, size(boundaries(b)%vertices, 2) - 1
            bulges(n + s) = boundaries(b)%bulge(s)
         end do
         n = n + size(boundaries(b)%vertices, 2)
      end do
      call file%add_rows("boundaries/bulges", kind_real, [integer ::], max(n_corners, 1))
      call file%put_reals("boundaries/bulges", 0_long, n_corners, bulges)
      call file%describe("boundaries/bulges", "tangent of a quarter of the angle of the arc that" &
                         //" begins at a corner, positive counter-clockwise; 0 if straight", "1")
      call file%add_rows("boundaries/is_tool", kind_integer, [integer ::], &
                         max(size(boundaries), 1))
      call file%put_integers("boundaries/is_tool", 0_long, size(boundaries), &
                             merge(1_long, 0_long, boundaries%is_tool))
      call file%describe("boundaries/is_tool", "1 for rigid tools, 0 for walls")
   end subroutine put_shape_kinds

   !> Word of the deck for the formulation of a boundary.
   pure function formulation_name(boundary) result(name)
      type(boundary_type), intent(in) :: boundary
      character(len=9) :: name

      if (boundary%formulation == formulation_nitsche) then
         name = "nitsche"
      else if (boundary%formulation == formulation_augmented) then
         name = "augmented"
      else if (boundary%has_coupling_term) then
         name = "implicit"
      else
         name = "penalty"
      end if
   end function formulation_name

   !> Does a boundary push only?
   pure function is_wall(boundary) result(answer)
      type(boundary_type), intent(in) :: boundary
      logical :: answer

      answer = boundary%formulation /= formulation_implicit &
         .and. .not. boundary%is_bilateral
   end function is_wall

   !> Set a text attribute, empty where the text is unallocated.
   subroutine put_optional_text(file, object, name, text)
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: object, name
      character(len=*), intent(in), optional :: text

      if (present(text)) then
         call file%set_text(object, name, text)
      else
         call file%set_text(object, name, "")
      end if
   end subroutine put_optional_text

end module coulter_results_scene
