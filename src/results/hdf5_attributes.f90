!> Attributes of groups and datasets.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_hdf5_attributes
   use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
   use hdf5, only: h5aclose_f, h5acreate_f, h5aexists_f, h5aopen_by_name_f, h5aopen_f, h5aread_f, &
      h5awrite_f, h5oclose_f, h5oopen_f, h5sclose_f, h5screate_f, h5screate_simple_f
   use hdf5, only: h5s_scalar_f, h5t_native_integer, hid_t, hsize_t
   implicit none(type, external)
   private
   public :: read_integer, write_attribute

contains

   !> Read an integer attribute of the root; 0 if there is none.
   subroutine read_integer(file, name, value)
      !> Open file.
      integer(hid_t), intent(in) :: file
      !> Name of the attribute.
      character(len=*), intent(in) :: name
      !> Its value.
      integer, intent(out) :: value
      integer(hid_t) :: attribute
      type(c_ptr) :: buffer
      integer, target :: stored
      integer :: codes(3)

      buffer = c_loc(stored)
      call h5aopen_by_name_f(file, "/", name, attribute, codes(1))
      call h5aread_f(attribute, h5t_native_integer, buffer, codes(2))
      call h5aclose_f(attribute, codes(3))
      value = 0
      if (all(codes >= 0)) value = stored
   end subroutine read_integer

   !> Make an attribute, or set the one that is there.
   subroutine write_attribute(file, object, name, memory_type, n_values, buffer, has_failed)
      !> Open file.
      integer(hid_t), intent(in) :: file
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
      !> Did any operation fail?
      logical, intent(out) :: has_failed
      integer(hid_t) :: owner, attribute, space
      integer :: codes(8)
      logical :: is_there

      codes = 0
      call h5oopen_f(file, object, owner, codes(1))
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
      has_failed = any(codes < 0)
   end subroutine write_attribute

end module coulter_results_hdf5_attributes
