!> How results are stored in HDF5: formats of numbers and texts, compression, access without locks.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_hdf5_types
   use, intrinsic :: iso_c_binding, only: c_bool, c_int, c_int64_t, c_null_char
   use hdf5, only: h5p_file_access_f, h5pcreate_f, h5pset_deflate_f, h5pset_shuffle_f, &
      h5t_fortran_s1, h5t_ieee_f32le, h5t_ieee_f64le, h5t_std_i64le, h5t_str_nullpad_f, &
      h5tcopy_f, h5tset_size_f, h5tset_strpad_f, hid_t, size_t
   implicit none(type, external)
   private
   public :: kind_real, kind_single, kind_integer, kind_text, text_width
   public :: new_stored_type, new_text_type, null_padded, set_compression, unlocked_access

   !> Stored as 64-bit reals.
   integer, parameter :: kind_real = 1
   !> Stored as 32-bit reals.
   integer, parameter :: kind_single = 2
   !> Stored as 64-bit integers.
   integer, parameter :: kind_integer = 3
   !> Stored as texts of `text_width` bytes.
   integer, parameter :: kind_text = 4

   !> Bytes of a text in a dataset that grows by rows.
   integer, parameter :: text_width = 256

   interface
      !> H5Pset_file_locking, which the Fortran interface of HDF5 1.10 lacks. Without locks a
      !> reader that keeps the file open does not end the run.
      function c_set_file_locking(list, use_locking, ignore_disabled) &
         bind(c, name="H5Pset_file_locking") result(status)
         import :: c_bool, c_int, c_int64_t
         implicit none(type, external)
         integer(c_int64_t), value :: list
         logical(c_bool), value :: use_locking, ignore_disabled
         integer(c_int) :: status
      end function c_set_file_locking
   end interface

contains

   !> File access without locks.
   function unlocked_access() result(list)
      integer(hid_t) :: list
      integer :: code

      call h5pcreate_f(h5p_file_access_f, list, code)
      code = c_set_file_locking(list, .false._c_bool, .true._c_bool)
   end function unlocked_access

   !> HDF5 type of stored values, to be closed.
   subroutine new_stored_type(type_id, kind, code)
      integer(hid_t), intent(out) :: type_id
      integer, intent(in) :: kind
      integer, intent(out) :: code

      select case (kind)
      case (kind_real)
         call h5tcopy_f(h5t_ieee_f64le, type_id, code)
      case (kind_single)
         call h5tcopy_f(h5t_ieee_f32le, type_id, code)
      case (kind_text)
         call new_text_type(type_id, text_width, code)
      case default
         call h5tcopy_f(h5t_std_i64le, type_id, code)
      end select
   end subroutine new_stored_type

   !> Compress chunks of numbers, if asked to.
   subroutine set_compression(list, compression, code)
      integer(hid_t), intent(in) :: list
      integer, intent(in) :: compression
      integer, intent(out) :: code

      code = 0
      if (compression > 0) call h5pset_shuffle_f(list, code)
      if (compression > 0 .and. code >= 0) call h5pset_deflate_f(list, compression, code)
   end subroutine set_compression

   !> HDF5 type of texts of a fixed number of bytes, padded with null characters.
   subroutine new_text_type(type_id, n_bytes, code)
      integer(hid_t), intent(out) :: type_id
      integer, intent(in) :: n_bytes
      integer, intent(out) :: code
      integer :: codes(3)

      call h5tcopy_f(h5t_fortran_s1, type_id, codes(1))
      call h5tset_size_f(type_id, int(max(n_bytes, 1), size_t), codes(2))
      call h5tset_strpad_f(type_id, h5t_str_nullpad_f, codes(3))
      code = minval(codes)
   end subroutine new_text_type

   !> Text without trailing blanks, filled up with null characters.
   pure function null_padded(text, n_bytes) result(padded)
      character(len=*), intent(in) :: text
      integer, intent(in) :: n_bytes
      character(len=n_bytes) :: padded
      integer :: i

      padded = text
      do i = len_trim(text) + 1, n_bytes
         padded(i:i) = c_null_char
      end do
   end function null_padded

end module coulter_results_hdf5_types
