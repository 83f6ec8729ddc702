!> The few HDF5 operations that results need; nothing else calls the HDF5 library.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_hdf5_io
   use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: long, wp
   use coulter_results_hdf5_types, only: kind_text, new_stored_type, new_text_type, null_padded, &
      set_compression, text_width, unlocked_access
   use hdf5, only: h5aclose_f, h5acreate_f, h5aexists_f, h5aopen_by_name_f, h5aopen_f, h5aread_f, &
      h5awrite_f, h5dclose_f, h5dcreate_f, h5dget_space_f, h5dont_atexit_f, h5dopen_f, &
      h5dset_extent_f, h5dwrite_f, h5eset_auto_f, h5fclose_f, h5fcreate_f, h5fflush_f, h5fopen_f, &
      h5gclose_f, h5gcreate_f, h5kind_to_type, h5oclose_f, h5oopen_f, h5open_f, h5pclose_f, &
      h5pcreate_f, h5pset_chunk_f, h5pset_istore_k_f, h5sclose_f, h5screate_f, h5screate_simple_f, &
      h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, h5sselect_hyperslab_f, h5tclose_f
   use hdf5, only: h5_integer_kind, h5_real_kind, h5f_acc_rdonly_f, h5f_acc_rdwr_f, &
      h5f_acc_trunc_f, h5f_scope_global_f, h5p_dataset_create_f, h5p_file_create_f, h5s_scalar_f, &
      h5s_select_set_f, h5t_native_integer, hid_t, hsize_t
   implicit none(type, external)
   private
   public :: hdf5_file_type, forgo_cleanup

   !> Attribute of the root that tells runs apart.
   character(len=*), parameter :: key_name = "run_key"
   !> Most dimensions of a dataset.
   integer, parameter :: max_rank = 3

   !> A file with groups, attributes and datasets that grow by rows. After a failure all calls do
   !> nothing, so that a caller may write much and ask once, in `close`.
   type :: hdf5_file_type
      !> Path of the file.
      character(len=:), allocatable :: path
      !> Did any operation fail?
      logical :: has_failed = .false.
      !> HDF5 handle.
      integer(hid_t), private :: id = -1
      !> What the file says of the run that made it.
      integer, private :: run_key = 0
   contains
      procedure :: create => create_file
      procedure :: open => open_file
      procedure :: flush => flush_file
      procedure :: close => close_file
      procedure :: add_group
      procedure :: add_rows
      procedure :: describe
      procedure :: put_integers
      procedure :: put_reals
      procedure :: put_text
      procedure :: put_texts
      procedure :: set_integers
      procedure :: set_text
      procedure, private :: note
      procedure, private :: put_rows
      procedure, private :: look_for_key
      procedure, private :: set_attribute
   end type hdf5_file_type

   !> Half the number of chunks in a node of the index of a dataset. A node that is full is split,
   !> and a process that is killed in that very moment leaves older rows unreadable: with nodes of
   !> this size that can happen from the 1024th frame on only.
   integer, parameter :: half_index_size = 512

contains

   !> For a program that opens no other HDF5 files, before the first: let HDF5 not tidy up at the
   !> end of the process, where it crashes if a full disk has kept a file from being closed.
   subroutine forgo_cleanup()
      integer :: code

      call h5dont_atexit_f(code)
   end subroutine forgo_cleanup

   !> Make an empty file in place of whatever has its path.
   subroutine create_file(self)
      class(hdf5_file_type), intent(inout) :: self
      integer(hid_t) :: access_list, creation_list
      integer(long) :: ticks
      integer :: codes(7), unit, status
      logical :: is_there

      inquire (file=self%path, exist=is_there)
      ! a run that still has the old file open must not write into the new one
      open (newunit=unit, file=self%path, status="old", iostat=status)
      if (status == 0) close (unit, status="delete", iostat=status)
      self%has_failed = status > 0 .and. is_there
      call h5open_f(codes(1))
      call h5eset_auto_f(0, codes(2))
      access_list = unlocked_access()
      call h5pcreate_f(h5p_file_create_f, creation_list, codes(3))
      call h5pset_istore_k_f(creation_list, half_index_size, codes(4))
      call h5fcreate_f(self%path, h5f_acc_trunc_f, self%id, codes(5), creation_list, access_list)
      call h5pclose_f(access_list, codes(6))
      call h5pclose_f(creation_list, codes(7))
      call self%note(codes)
      call system_clock(ticks)
      self%run_key = int(modulo(ticks, int(huge(self%run_key), long)))
      call self%set_integers("/", key_name, [self%run_key])
   end subroutine create_file

   !> Open a file that this run has made.
   subroutine open_file(self)
      class(hdf5_file_type), intent(inout) :: self
      integer(hid_t) :: access_list
      integer :: codes(4)

      if (self%has_failed) return
      codes = 0
      access_list = unlocked_access()
      ! first to read: closing a file that another run writes would cut it
      call h5fopen_f(self%path, h5f_acc_rdonly_f, self%id, codes(1), access_prp=access_list)
      call self%note(codes)
      call self%look_for_key()
      if (self%id >= 0) call h5fclose_f(self%id, codes(2))
      self%id = -1
      if (.not. self%has_failed) then
         call h5fopen_f(self%path, h5f_acc_rdwr_f, self%id, codes(3), access_prp=access_list)
      end if
      call h5pclose_f(access_list, codes(4))
      call self%note(codes)
   end subroutine open_file

   !> A second run with the same output replaces the file: then leave it alone.
   subroutine look_for_key(self)
      class(hdf5_file_type), intent(inout) :: self
      integer(hid_t) :: attribute
      type(c_ptr) :: buffer
      integer, target :: key
      integer :: codes(3)

      if (self%has_failed) return
      key = 0
      buffer = c_loc(key)
      call h5aopen_by_name_f(self%id, "/", key_name, attribute, codes(1))
      call h5aread_f(attribute, h5t_native_integer, buffer, codes(2))
      call h5aclose_f(attribute, codes(3))
      self%has_failed = any(codes < 0) .or. key /= self%run_key
   end subroutine look_for_key

   !> Hand all data to the operating system, so that they survive the end of the process.
   subroutine flush_file(self)
      class(hdf5_file_type), intent(inout) :: self
      integer :: code

      if (self%has_failed) return
      call h5fflush_f(self%id, h5f_scope_global_f, code)
      call self%note([code])
   end subroutine flush_file

   !> Close the file, if it is open, and report whether everything since the last call has worked.
   !> HDF5 must not see the handle again, not even where closing failed because the disk is full.
   subroutine close_file(self, error)
      class(hdf5_file_type), intent(inout) :: self
      !> Set when something could not be written.
      type(error_type), allocatable, intent(out) :: error
      integer :: code

      if (self%id >= 0) then
         call h5fclose_f(self%id, code)
         call self%note([code])
         self%id = -1
      end if
      if (self%has_failed) then
         call fatal_error(error, "results: cannot write "//self%path &
                          //": the disk is full, or another run has replaced the file")
      end if
   end subroutine close_file

   !> Make a group; its parent exists.
   subroutine add_group(self, name)
      class(hdf5_file_type), intent(inout) :: self
      !> Path of the group in the file.
      character(len=*), intent(in) :: name
      integer(hid_t) :: group
      integer :: codes(2)

      if (self%has_failed) return
      call h5gcreate_f(self%id, name, group, codes(1))
      call h5gclose_f(group, codes(2))
      call self%note(codes)
   end subroutine add_group

   !> Make a dataset without rows.
   subroutine add_rows(self, name, kind, row_shape, rows_per_chunk, compression)
      class(hdf5_file_type), intent(inout) :: self
      !> Path of the dataset in the file; its group exists.
      character(len=*), intent(in) :: name
      !> Stored format: one of `kind_*`.
      integer, intent(in) :: kind
      !> Shape of a row, at most two dimensions.
      integer, intent(in) :: row_shape(:)
      !> Rows that are stored together.
      integer, intent(in) :: rows_per_chunk
      !> 0 (none) to 9. Only rows that start on a chunk are safe with it.
      integer, intent(in), optional :: compression
      integer(hid_t) :: space, list, dataset, type_id
      integer :: rank, codes(10)

      if (self%has_failed) return
      codes = 0
      rank = size(row_shape) + 1
      call h5screate_simple_f(rank, int([row_shape, 0], hsize_t), space, codes(1), &
                              growth_limits(row_shape))
      call h5pcreate_f(h5p_dataset_create_f, list, codes(2))
      call h5pset_chunk_f(list, rank, int([max(row_shape, 1), rows_per_chunk], hsize_t), codes(3))
      if (present(compression)) call set_compression(list, compression, codes(4))
      call new_stored_type(type_id, kind, codes(9))
      call h5dcreate_f(self%id, name, type_id, space, dataset, codes(5), list)
      call h5dclose_f(dataset, codes(6))
      call h5pclose_f(list, codes(7))
      call h5sclose_f(space, codes(8))
      call h5tclose_f(type_id, codes(10))
      call self%note(codes)
   end subroutine add_rows

   !> Say what a dataset holds.
   subroutine describe(self, name, description, unit)
      class(hdf5_file_type), intent(inout) :: self
      !> Path of the dataset.
      character(len=*), intent(in) :: name
      !> What the numbers mean.
      character(len=*), intent(in) :: description
      !> Unit label; absent: none or unknown.
      character(len=*), intent(in), optional :: unit

      call self%set_text(name, "description", description)
      if (present(unit)) then
         call self%set_text(name, "unit", unit)
      else
         call self%set_text(name, "unit", "")
      end if
   end subroutine describe

   !> Write rows of reals; the dataset grows as needed.
   subroutine put_reals(self, name, first_row, n_values, values)
      class(hdf5_file_type), intent(inout) :: self
      !> Path of the dataset.
      character(len=*), intent(in) :: name
      !> First row to write, from 0.
      integer(long), intent(in) :: first_row
      !> Number of values: rows times values of a row.
      integer, intent(in) :: n_values
      !> Values, row after row.
      real(wp), intent(in), target :: values(n_values)

      call self%put_rows(name, first_row, n_values, h5kind_to_type(wp, h5_real_kind), &
                         c_loc(values))
   end subroutine put_reals

   !> Write rows of integers; the dataset grows as needed.
   subroutine put_integers(self, name, first_row, n_values, values)
      class(hdf5_file_type), intent(inout) :: self
      !> Path of the dataset.
      character(len=*), intent(in) :: name
      !> First row to write, from 0.
      integer(long), intent(in) :: first_row
      !> Number of values: rows times values of a row.
      integer, intent(in) :: n_values
      !> Values, row after row.
      integer(long), intent(in), target :: values(n_values)

      call self%put_rows(name, first_row, n_values, h5kind_to_type(long, h5_integer_kind), &
                         c_loc(values))
   end subroutine put_integers

   !> Write a row that is a text; the dataset grows as needed.
   subroutine put_text(self, name, row, text)
      class(hdf5_file_type), intent(inout) :: self
      !> Path of the dataset, made with `kind_text`.
      character(len=*), intent(in) :: name
      !> Row to write, from 0.
      integer(long), intent(in) :: row
      !> Text; what does not fit is cut.
      character(len=*), intent(in) :: text
      character(len=text_width), target :: buffer
      integer(hid_t) :: type_id
      integer :: code

      if (self%has_failed) return
      buffer = null_padded(text, text_width)
      call new_stored_type(type_id, kind_text, code)
      call self%put_rows(name, row, 1, type_id, c_loc(buffer))
      call h5tclose_f(type_id, code)
      call self%note([code])
   end subroutine put_text

   !> Write a list of texts as a dataset of its own.
   subroutine put_texts(self, name, texts)
      class(hdf5_file_type), intent(inout) :: self
      !> Path of the dataset.
      character(len=*), intent(in) :: name
      !> The texts; trailing blanks are dropped.
      character(len=*), intent(in) :: texts(:)
      character(len=len(texts)), target :: padded(size(texts))
      integer(hid_t) :: space, text_type, dataset
      integer :: codes(6), i

      if (self%has_failed) return
      do i = 1, size(texts)
         padded(i) = null_padded(texts(i), len(texts))
      end do
      call new_text_type(text_type, len(texts), codes(1))
      call h5screate_simple_f(1, int([size(texts)], hsize_t), space, codes(2))
      call h5dcreate_f(self%id, name, text_type, space, dataset, codes(3))
      codes(4) = 0
      if (size(texts) > 0) call h5dwrite_f(dataset, text_type, c_loc(padded), codes(4))
      call h5dclose_f(dataset, codes(5))
      call h5tclose_f(text_type, codes(6))
      call self%note(codes)
      call h5sclose_f(space, codes(1))
   end subroutine put_texts

   !> Set an integer attribute: a scalar for one value, else a vector.
   subroutine set_integers(self, object, name, values)
      class(hdf5_file_type), intent(inout) :: self
      !> Path of the group or dataset.
      character(len=*), intent(in) :: object
      !> Name of the attribute.
      character(len=*), intent(in) :: name
      !> Values; their number stays the same when they are set again.
      integer, intent(in), target :: values(:)
      integer, target :: buffer(size(values))

      buffer = values
      call self%set_attribute(object, name, h5t_native_integer, size(values), c_loc(buffer))
   end subroutine set_integers

   !> Set a text attribute.
   subroutine set_text(self, object, name, text, width)
      class(hdf5_file_type), intent(inout) :: self
      !> Path of the group or dataset.
      character(len=*), intent(in) :: object
      !> Name of the attribute.
      character(len=*), intent(in) :: name
      !> Text; what does not fit `width` is cut.
      character(len=*), intent(in) :: text
      !> Bytes to reserve for texts that are set again, always the same; the length by default.
      integer, intent(in), optional :: width
      character(len=:), allocatable, target :: buffer
      integer(hid_t) :: text_type
      integer :: code, n_bytes

      if (self%has_failed) return
      n_bytes = max(len(text), 1)
      if (present(width)) n_bytes = width
      buffer = null_padded(text, n_bytes)
      call new_text_type(text_type, n_bytes, code)
      call self%set_attribute(object, name, text_type, 1, c_loc(buffer))
      call h5tclose_f(text_type, code)
   end subroutine set_text

   !> Remember failures.
   pure subroutine note(self, codes)
      class(hdf5_file_type), intent(inout) :: self
      !> Return codes of HDF5: negative after a failure.
      integer, intent(in) :: codes(:)

      if (any(codes < 0)) self%has_failed = .true.
   end subroutine note

   !> Write rows from memory.
   subroutine put_rows(self, name, first_row, n_values, memory_type, buffer)
      class(hdf5_file_type), intent(inout) :: self
      !> Path of the dataset.
      character(len=*), intent(in) :: name
      !> First row to write, from 0.
      integer(long), intent(in) :: first_row
      !> Number of values.
      integer, intent(in) :: n_values
      !> HDF5 type of the values in memory.
      integer(hid_t), intent(in) :: memory_type
      !> Address of the values.
      type(c_ptr), intent(in) :: buffer
      integer(hid_t) :: dataset, file_space, memory_space
      integer(hsize_t) :: extent(max_rank), limits(max_rank), block(max_rank), start(max_rank)
      integer :: rank, codes(8)

      if (self%has_failed) return
      codes = 0
      call h5dopen_f(self%id, name, dataset, codes(1))
      call h5dget_space_f(dataset, file_space, codes(2))
      call h5sget_simple_extent_ndims_f(file_space, rank, codes(3))
      call h5sget_simple_extent_dims_f(file_space, extent, limits, codes(4))
      call self%note(codes)
      if (self%has_failed) return
      block = extent
      block(rank) = n_rows_of(n_values, extent(:rank - 1))
      start = 0
      start(rank) = first_row
      extent(rank) = max(extent(rank), start(rank) + block(rank))
      call h5dset_extent_f(dataset, extent, codes(1))
      call h5sclose_f(file_space, codes(2))
      if (n_values > 0) then
         call h5dget_space_f(dataset, file_space, codes(3))
         call h5sselect_hyperslab_f(file_space, h5s_select_set_f, start, block, codes(4))
         call h5screate_simple_f(rank, block, memory_space, codes(5))
         call h5dwrite_f(dataset, memory_type, buffer, codes(6), memory_space, file_space)
         call h5sclose_f(memory_space, codes(7))
         call h5sclose_f(file_space, codes(8))
      end if
      call self%note(codes)
      call h5dclose_f(dataset, codes(1))
   end subroutine put_rows

   !> Make an attribute, or set the one that is there.
   subroutine set_attribute(self, object, name, memory_type, n_values, buffer)
      class(hdf5_file_type), intent(inout) :: self
      !> Path of the group or dataset.
      character(len=*), intent(in) :: object
      !> Name of the attribute.
      character(len=*), intent(in) :: name
      !> HDF5 type of the values, in memory and in the file.
      integer(hid_t), intent(in) :: memory_type
      !> Number of values.
      integer, intent(in) :: n_values
      !> Address of the values.
      type(c_ptr), intent(in) :: buffer
      integer(hid_t) :: owner, attribute, space
      integer :: codes(8)
      logical :: is_there

      if (self%has_failed) return
      codes = 0
      call h5oopen_f(self%id, object, owner, codes(1))
      call h5aexists_f(owner, name, is_there, codes(2))
      if (is_there) then
         call h5aopen_f(owner, name, attribute, codes(3))
      else
         if (n_values == 1) call h5screate_f(h5s_scalar_f, space, codes(3))
         if (n_values /= 1) call h5screate_simple_f(1, [int(n_values, hsize_t)], space, codes(3))
         call h5acreate_f(owner, name, memory_type, space, attribute, codes(4))
         call h5sclose_f(space, codes(5))
      end if
      call h5awrite_f(attribute, memory_type, buffer, codes(6))
      call h5aclose_f(attribute, codes(7))
      call h5oclose_f(owner, codes(8))
      call self%note(codes)
   end subroutine set_attribute

   !> Largest extents of a dataset that grows by rows; HDF5 does not allow empty chunks.
   pure function growth_limits(row_shape) result(limits)
      integer, intent(in) :: row_shape(:)
      integer(hsize_t) :: limits(size(row_shape) + 1)

      limits = [int(max(row_shape, 1), hsize_t), -1_hsize_t]
   end function growth_limits

   !> Number of rows that values make; one row when rows are empty.
   pure function n_rows_of(n_values, row_shape) result(n_rows)
      integer, intent(in) :: n_values
      integer(hsize_t), intent(in) :: row_shape(:)
      integer(hsize_t) :: n_rows

      n_rows = 1
      if (all(row_shape > 0)) n_rows = int(n_values, hsize_t)/product(row_shape)
   end function n_rows_of

end module coulter_results_hdf5_io
