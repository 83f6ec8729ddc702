!> Datasets that grow by rows.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_hdf5_rows
   use, intrinsic :: iso_c_binding, only: c_ptr
   use coulter_base_kinds, only: long
   use coulter_results_hdf5_types, only: new_stored_type, set_compression
   use hdf5, only: h5dclose_f, h5dcreate_f, h5dget_space_f, h5dopen_f, h5dset_extent_f, &
      h5dwrite_f, h5pclose_f, h5pcreate_f, h5pset_chunk_f, h5sclose_f, h5screate_simple_f, &
      h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, h5sselect_hyperslab_f, h5tclose_f
   use hdf5, only: h5p_dataset_create_f, h5s_select_set_f, hid_t, hsize_t
   implicit none(type, external)
   private
   public :: new_rows, write_rows

   !> Most dimensions of a dataset.
   integer, parameter :: max_rank = 3

contains

   !> Make a dataset without rows.
   subroutine new_rows(file, name, kind, row_shape, rows_per_chunk, compression, has_failed)
      !> Open file.
      integer(hid_t), intent(in) :: file
      !> Path of the dataset in the file; its group exists.
      character(len=*), intent(in) :: name
      !> Stored format: one of `kind_*`.
      integer, intent(in) :: kind
      !> Shape of a row, at most two dimensions.
      integer, intent(in) :: row_shape(:)
      !> Rows that are stored together.
      integer, intent(in) :: rows_per_chunk
      !> 0 (none) to 9.
      integer, intent(in) :: compression
      !> Did any operation fail?
      logical, intent(out) :: has_failed
      integer(hid_t) :: space, list, dataset, type_id
      integer :: rank, codes(10)

      rank = size(row_shape) + 1
      call h5screate_simple_f(rank, int([row_shape, 0], hsize_t), space, codes(1), &
                              growth_limits(row_shape))
      call h5pcreate_f(h5p_dataset_create_f, list, codes(2))
      call h5pset_chunk_f(list, rank, int([max(row_shape, 1), rows_per_chunk], hsize_t), codes(3))
      call set_compression(list, compression, codes(4))
      call new_stored_type(type_id, kind, codes(5))
      call h5dcreate_f(file, name, type_id, space, dataset, codes(6), list)
      call h5dclose_f(dataset, codes(7))
      call h5pclose_f(list, codes(8))
      call h5sclose_f(space, codes(9))
      call h5tclose_f(type_id, codes(10))
      has_failed = any(codes < 0)
   end subroutine new_rows

   !> Write rows from memory; the dataset grows as needed.
   subroutine write_rows(file, name, first_row, n_values, memory_type, buffer, has_failed)
      !> Open file.
      integer(hid_t), intent(in) :: file
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
      !> Did any operation fail?
      logical, intent(out) :: has_failed
      integer(hid_t) :: dataset, file_space, memory_space
      integer(hsize_t) :: extent(max_rank), limits(max_rank), block(max_rank), start(max_rank)
      integer :: rank, codes(8)

      codes = 0
      call h5dopen_f(file, name, dataset, codes(1))
      call h5dget_space_f(dataset, file_space, codes(2))
      call h5sget_simple_extent_ndims_f(file_space, rank, codes(3))
      call h5sget_simple_extent_dims_f(file_space, extent, limits, codes(4))
      has_failed = any(codes < 0)
      if (has_failed) return
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
      has_failed = any(codes < 0)
      call h5dclose_f(dataset, codes(1))
   end subroutine write_rows

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

end module coulter_results_hdf5_rows
