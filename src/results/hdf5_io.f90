!> The few HDF5 operations that results need; nothing else calls the HDF5 library.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_hdf5_io
   use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: long, wp
   use coulter_results_hdf5_attributes, only: read_integer, write_attribute
   use coulter_results_hdf5_rows, only: new_rows, write_rows
   use coulter_results_hdf5_types, only: kind_text, new_stored_type, new_text_type, null_padded, &
      text_width, unlocked_access
   use hdf5, only: h5dclose_f, h5dcreate_f, h5dont_atexit_f, h5dwrite_f, h5eset_auto_f, &
      h5fclose_f, h5fcreate_f, h5fflush_f, h5fopen_f, h5gclose_f, h5gcreate_f, h5kind_to_type, &
      h5open_f, h5pclose_f, h5pcreate_f, h5pset_istore_k_f, h5sclose_f, h5screate_simple_f, &
      h5tclose_f
   use hdf5, only: h5_integer_kind, h5_real_kind, h5f_acc_rdonly_f, h5f_acc_rdwr_f, &
      h5f_acc_trunc_f, h5f_scope_global_f, h5p_file_create_f, h5t_native_integer, hid_t, hsize_t
   implicit none(type, external)
   private
   public :: hdf5_file_type, forgo_cleanup

   !> Attribute of the root that tells runs apart.
   character(len=*), parameter :: key_name = "run_key"

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

   !> Open the file that this run has made. A second run with the same output replaces it: then it
   !> is left alone. Should that happen between the two openings, nothing is written either; but
   !> what the other run writes before `close` could be cut off.
   subroutine open_file(self)
      class(hdf5_file_type), intent(inout) :: self
      integer(hid_t) :: access_list
      integer :: code

      if (self%has_failed) return
      access_list = unlocked_access()
      ! first to read: closing a file that another run writes would cut it
      call open_if_own(self, h5f_acc_rdonly_f, access_list)
      if (self%id >= 0) call h5fclose_f(self%id, code)
      self%id = -1
      if (.not. self%has_failed) call open_if_own(self, h5f_acc_rdwr_f, access_list)
      call h5pclose_f(access_list, code)
   end subroutine open_file

   !> Open the file and see whether it is that of this run.
   subroutine open_if_own(self, access, access_list)
      class(hdf5_file_type), intent(inout) :: self
      integer, intent(in) :: access
      integer(hid_t), intent(in) :: access_list
      integer :: code, key

      call h5fopen_f(self%path, access, self%id, code, access_prp=access_list)
      call self%note([code])
      if (self%has_failed) return
      call read_integer(self%id, key_name, key)
      self%has_failed = key /= self%run_key
   end subroutine open_if_own

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
      integer :: level

      if (self%has_failed) return
      level = 0
      if (present(compression)) level = compression
      call new_rows(self%id, name, kind, row_shape, rows_per_chunk, level, self%has_failed)
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

      if (self%has_failed) return
      buffer = values
      call write_attribute(self%id, object, name, h5t_native_integer, size(values), &
                           c_loc(buffer), self%has_failed)
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
      call write_attribute(self%id, object, name, text_type, 1, c_loc(buffer), self%has_failed)
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

      if (self%has_failed) return
      call write_rows(self%id, name, first_row, n_values, memory_type, buffer, self%has_failed)
   end subroutine put_rows

end module coulter_results_hdf5_io
