!> Frames of a results file: the points at chosen moments, as VTKHDF poly data.
!>
!> Every frame starts on a chunk of its datasets and is counted only when all of it is on its way
!> to the disk, so that a killed run leaves all frames but the last one intact (docs/results.md).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_frames
   use coulter_base_kinds, only: long, wp
   use coulter_law_abstract, only: law_variable_type
   use coulter_model, only: model_type
   use coulter_model_output, only: output_type
   use coulter_points_fields, only: cauchy_stress, elastic_strain, full_gradient, n_symmetric, &
      n_tensor, space_vector, stress_ratio
   use coulter_points_tiling, only: tile_outlines
   use coulter_results_hdf5_io, only: hdf5_file_type
   use coulter_results_hdf5_types, only: kind_integer, kind_real, kind_single
   implicit none(type, external)
   private
   public :: frames_type, add_frames, put_frame

   !> Where the next frame goes.
   type :: frames_type
      !> Frames written so far.
      integer :: n_frames = 0
      !> Time of the last frame.
      real(wp) :: last_time = 0.0_wp
      !> First row of the next frame in the point data, from 0.
      integer(long), private :: next_row = 0
      !> Rows of point data that are stored together.
      integer, private :: rows_per_chunk = 1
      !> Points that the connectivity reaches.
      integer, private :: n_connected = 0
      !> Stored format of point data: one of `kind_*`.
      integer, private :: kind = kind_real
      !> Compression of point data, 0 to 9.
      integer, private :: compression = 0
   end type frames_type

   !> Group of the point data.
   character(len=*), parameter :: point_data = "VTKHDF/PointData/"
   !> Cell types of VTK poly data; points are drawn as vertices.
   character(len=*), parameter :: topologies(4) = [character(len=8) :: &
      "Vertices", "Lines", "Polygons", "Strips"]
   !> Number of cell types.
   integer, parameter :: n_cell_types = size(topologies)
   !> Rows of small datasets that are stored together.
   integer, parameter :: small_chunk = 256

contains

   !> Make all groups and datasets of an empty series of frames.
   subroutine add_frames(frames, file, model, output)
      !> Series to start.
      type(frames_type), intent(out) :: frames
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> Model in its initial state.
      type(model_type), intent(in) :: model
      !> How frames are stored.
      type(output_type), intent(in) :: output

      if (output%is_single) frames%kind = kind_single
      frames%compression = output%compression
      frames%rows_per_chunk = chunk_rows(model%points%n_points)
      call file%add_group("VTKHDF")
      call file%set_integers("VTKHDF", "Version", [2, 0])
      call file%set_text("VTKHDF", "Type", "PolyData")
      call add_topology(file)
      call add_steps(file)
      call add_point_data(frames, file, model)
   end subroutine add_frames

   !> Append the present state of a model.
   subroutine put_frame(frames, file, model, step, load_factor)
      !> Series to continue.
      type(frames_type), intent(inout) :: frames
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> Model at the end of a step.
      type(model_type), intent(in) :: model
      !> Number of the step, 0 for the initial state.
      integer, intent(in) :: step
      !> Time over the time of the last step.
      real(wp), intent(in) :: load_factor
      integer(long) :: frame
      integer :: n_chunks

      frame = int(frames%n_frames, long)
      call put_points(frames, file, model)
      call put_connectivity(frames, file, model%points%n_points)
      call put_step(file, frame, int(model%points%n_points, long), frames%next_row, model%time)
      call file%put_integers("frames/step", frame, 1, [int(step, long)])
      call file%put_reals("frames/load_factor", frame, 1, [load_factor])
      call file%flush()

      frames%n_frames = frames%n_frames + 1
      frames%last_time = model%time
      call file%set_integers("VTKHDF/Steps", "NSteps", [frames%n_frames])
      call file%flush()
      n_chunks = (model%points%n_points + frames%rows_per_chunk - 1)/frames%rows_per_chunk
      frames%next_row = frames%next_row + int(n_chunks*frames%rows_per_chunk, long)
   end subroutine put_frame

   !> Rows of a chunk: a frame is cut into equal chunks of at most 16384 rows.
   pure function chunk_rows(n_points) result(n_rows)
      integer, intent(in) :: n_points
      integer :: n_rows
      integer, parameter :: most_rows = 16384
      integer :: n_chunks

      n_chunks = max((n_points + most_rows - 1)/most_rows, 1)
      n_rows = max((n_points + n_chunks - 1)/n_chunks, 1)
   end function chunk_rows

   !> Cells of the poly data. One connectivity 0, 1, 2, ... serves the vertices of all frames; the
   !> other cell types are empty, but VTK asks for them.
   subroutine add_topology(file)
      type(hdf5_file_type), intent(inout) :: file
      integer :: i

      do i = 1, n_cell_types
         associate (group => "VTKHDF/"//trim(topologies(i)))
            call file%add_group(group)
            call file%add_rows(group//"/NumberOfCells", kind_integer, [integer ::], small_chunk)
            call file%add_rows(group//"/NumberOfConnectivityIds", kind_integer, [integer ::], &
                               small_chunk)
            call file%add_rows(group//"/Connectivity", kind_integer, [integer ::], small_chunk)
            call file%add_rows(group//"/Offsets", kind_integer, [integer ::], small_chunk)
            call file%put_integers(group//"/Offsets", 0_long, 1, [0_long])
         end associate
      end do
   end subroutine add_topology

   !> Tables of the temporal data.
   subroutine add_steps(file)
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), parameter :: counts(3) = [character(len=13) :: &
         "PartOffsets", "NumberOfParts", "PointOffsets"]
      integer :: i

      call file%add_rows("VTKHDF/NumberOfPoints", kind_integer, [integer ::], small_chunk)
      call file%add_group("VTKHDF/Steps")
      call file%set_integers("VTKHDF/Steps", "NSteps", [0])
      call file%add_rows("VTKHDF/Steps/Values", kind_real, [integer ::], small_chunk)
      call file%describe("VTKHDF/Steps/Values", "time of the frame")
      do i = 1, size(counts)
         call file%add_rows("VTKHDF/Steps/"//trim(counts(i)), kind_integer, [integer ::], &
                            small_chunk)
      end do
      call file%add_rows("VTKHDF/Steps/CellOffsets", kind_integer, [n_cell_types], small_chunk)
      call file%add_rows("VTKHDF/Steps/ConnectivityIdOffsets", kind_integer, [n_cell_types], &
                         small_chunk)
      call file%add_group("frames")
      call file%add_rows("frames/step", kind_integer, [integer ::], small_chunk)
      call file%describe("frames/step", "number of the load step, 0 for the initial state")
      call file%add_rows("frames/load_factor", kind_real, [integer ::], small_chunk)
      call file%describe("frames/load_factor", "time over the time of the last step")
   end subroutine add_steps

   !> Datasets with a row per point and frame.
   subroutine add_point_data(frames, file, model)
      type(frames_type), intent(in) :: frames
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model

      associate (units => model%units)
         call add_field(frames, file, "VTKHDF/Points", [3], "current position", units%length)
         call file%add_group("VTKHDF/PointData")
         call add_field(frames, file, point_data//"displacement", [3], &
                        "displacement since the start", units%length)
         call add_field(frames, file, point_data//"stress", [n_symmetric], &
                        "Cauchy stress XX YY ZZ XY YZ XZ, tension positive", units%stress)
         call add_field(frames, file, point_data//"strain", [n_symmetric], &
                        "logarithmic elastic strain XX YY ZZ XY YZ XZ, tensor shear components", &
                        "1")
         call add_field(frames, file, point_data//"deformation_gradient", [n_tensor], &
                        "total deformation gradient, row by row", "1")
         call add_field(frames, file, point_data//"volume_ratio", [integer ::], &
                        "current over initial volume, J", "1")
         call add_field(frames, file, point_data//"volume", [integer ::], &
                        "current volume, per unit thickness in plane strain", square(model))
         call add_field(frames, file, point_data//"domain", [3], &
                        "edges of the box around the undeformed point domain", units%length)
         if (allocated(model%tiling)) then
            call add_field(frames, file, point_data//"tile", [8], "corners of the deformed point" &
                           //" domain, x1 y1 .. x4 y4, counter-clockwise", units%length)
         end if
         call add_state_fields(frames, file, model)
      end associate
      call file%add_rows(point_data//"body", kind_integer, [integer ::], frames%rows_per_chunk, &
                         frames%compression)
      call file%describe(point_data//"body", "number of the body, from 1")
   end subroutine add_point_data

   !> Datasets of the state variables of all laws.
   subroutine add_state_fields(frames, file, model)
      type(frames_type), intent(in) :: frames
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      type(law_variable_type), allocatable :: variables(:)
      integer :: i

      call list_variables(model, variables)
      do i = 1, size(variables)
         if (variables(i)%unit == "stress") then
            call add_field(frames, file, point_data//trim(variables(i)%name), [integer ::], &
                           trim(variables(i)%meaning), model%units%stress)
         else
            call add_field(frames, file, point_data//trim(variables(i)%name), [integer ::], &
                           trim(variables(i)%meaning), trim(variables(i)%unit))
         end if
      end do
   end subroutine add_state_fields

   !> A dataset of reals with a row per point and frame.
   subroutine add_field(frames, file, name, row_shape, description, unit)
      type(frames_type), intent(in) :: frames
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: name, description
      integer, intent(in) :: row_shape(:)
      character(len=*), intent(in), optional :: unit

      call file%add_rows(name, frames%kind, row_shape, frames%rows_per_chunk, frames%compression)
      call file%describe(name, description, unit)
   end subroutine add_field

   !> Write the rows of all points.
   subroutine put_points(frames, file, model)
      type(frames_type), intent(in) :: frames
      type(hdf5_file_type), intent(inout) :: file
      type(model_type), intent(in) :: model
      type(law_variable_type), allocatable :: variables(:)
      integer :: i, n

      n = model%points%n_points
      associate (row => frames%next_row, points => model%points, state => model%points%converged)
         call file%put_reals("VTKHDF/Points", row, 3*n, space_vector(points%position))
         call file%put_reals(point_data//"displacement", row, 3*n, &
                             space_vector(points%displacement))
         call file%put_reals(point_data//"stress", row, n_symmetric*n, &
                             cauchy_stress(state%kirchhoff_stress, stress_ratio(points)))
         call file%put_reals(point_data//"strain", row, n_symmetric*n, &
                             elastic_strain(state%elastic_finger))
         call file%put_reals(point_data//"deformation_gradient", row, n_tensor*n, &
                             full_gradient(state%deformation_gradient))
         call file%put_reals(point_data//"volume_ratio", row, n, points%volume_ratio)
         call file%put_reals(point_data//"volume", row, n, &
                             points%volume_ratio*points%reference_volume)
         call file%put_reals(point_data//"domain", row, 3*n, space_vector(points%domain_size))
         if (allocated(model%tiling)) then
            call file%put_reals(point_data//"tile", row, 8*n, tile_outlines(model%tiling))
         end if
         call list_variables(model, variables)
         do i = 1, size(variables)
            call file%put_reals(point_data//trim(variables(i)%name), row, n, &
                                values_of(model, variables(i)%name))
         end do
         call file%put_integers(point_data//"body", row, n, int(points%body, long))
      end associate
   end subroutine put_points

   !> State variables of all laws, each name once.
   pure subroutine list_variables(model, variables)
      type(model_type), intent(in) :: model
      type(law_variable_type), allocatable, intent(out) :: variables(:)
      integer :: i, k

      allocate (variables(0))
      do i = 1, size(model%laws)
         if (.not. allocated(model%laws(i)%law%variables)) cycle
         associate (own => model%laws(i)%law%variables)
            do k = 1, size(own)
               if (.not. any(variables%name == own(k)%name)) variables = [variables, own(k)]
            end do
         end associate
      end do
   end subroutine list_variables

   !> A state variable of all points; 0 where the law has none of this name.
   pure function values_of(model, name) result(values)
      type(model_type), intent(in) :: model
      character(len=*), intent(in) :: name
      real(wp) :: values(model%points%n_points)
      integer :: k, p

      values = 0.0_wp
      do p = 1, model%points%n_points
         associate (law => model%laws(model%bodies(model%points%body(p))%law)%law)
            if (.not. allocated(law%variables)) cycle
            k = findloc(law%variables%name, name, dim=1)
            if (k > 0) values(p) = model%points%converged%law_state(k, p)
         end associate
      end do
   end function values_of

   !> Lengthen the connectivity that all frames share when a frame has more points than any before.
   subroutine put_connectivity(frames, file, n_points)
      type(frames_type), intent(inout) :: frames
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: n_points
      integer(long), allocatable :: numbers(:)
      integer :: i, n_new

      n_new = n_points - frames%n_connected
      if (n_new <= 0) return
      numbers = [(int(i, long), i=frames%n_connected, n_points)]
      associate (row => int(frames%n_connected, long))
         call file%put_integers("VTKHDF/Vertices/Connectivity", row, n_new, numbers)
         call file%put_integers("VTKHDF/Vertices/Offsets", row, n_new + 1, numbers)
      end associate
      frames%n_connected = n_points
   end subroutine put_connectivity

   !> Write the row of a frame into the tables of the temporal data.
   subroutine put_step(file, frame, n_points, first_row, time)
      type(hdf5_file_type), intent(inout) :: file
      integer(long), intent(in) :: frame, n_points, first_row
      real(wp), intent(in) :: time
      integer(long), parameter :: zeros(n_cell_types) = 0
      integer :: i
      integer(long) :: n_cells

      call file%put_integers("VTKHDF/NumberOfPoints", frame, 1, [n_points])
      call file%put_reals("VTKHDF/Steps/Values", frame, 1, [time])
      call file%put_integers("VTKHDF/Steps/PartOffsets", frame, 1, [frame])
      call file%put_integers("VTKHDF/Steps/NumberOfParts", frame, 1, [1_long])
      call file%put_integers("VTKHDF/Steps/PointOffsets", frame, 1, [first_row])
      call file%put_integers("VTKHDF/Steps/CellOffsets", frame, n_cell_types, zeros)
      call file%put_integers("VTKHDF/Steps/ConnectivityIdOffsets", frame, n_cell_types, zeros)
      do i = 1, n_cell_types
         n_cells = merge(n_points, 0_long, i == 1)
         associate (group => "VTKHDF/"//trim(topologies(i)))
            call file%put_integers(group//"/NumberOfCells", frame, 1, [n_cells])
            call file%put_integers(group//"/NumberOfConnectivityIds", frame, 1, [n_cells])
         end associate
      end do
   end subroutine put_step

   !> Unit of volumes per unit thickness; empty where that of lengths is not known.
   pure function square(model) result(unit)
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: unit

      unit = ""
      if (.not. allocated(model%units%length)) return
      if (model%units%length /= "") unit = model%units%length//"^2"
   end function square

end module coulter_results_frames
