!> Columns of the history: one call says what a column is, and what a row of it holds.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_columns
   use coulter_base_kinds, only: long, wp
   use coulter_results_hdf5_io, only: hdf5_file_type
   use coulter_results_hdf5_types, only: kind_integer, kind_real, kind_text
   implicit none(type, external)
   private
   public :: put_real, put_reals, put_integer, put_integers, put_text

   !> Row in whose place the column is made, without rows.
   integer, parameter, public :: heading = -1
   !> Rows that are stored together.
   integer, parameter :: chunk = 64

contains

   !> A column of numbers.
   subroutine put_real(file, row, name, value, meaning, unit)
      !> Open file with a group `history`.
      type(hdf5_file_type), intent(inout) :: file
      !> Row to write, from 0, or `heading`.
      integer, intent(in) :: row
      !> Name of the column.
      character(len=*), intent(in) :: name
      !> What the row holds; of no interest for a heading.
      real(wp), intent(in) :: value
      !> What the numbers mean.
      character(len=*), intent(in) :: meaning
      !> Label of their unit; absent: none or unknown.
      character(len=*), intent(in), optional :: unit

      call put_reals(file, row, name, [integer ::], [value], meaning, unit)
   end subroutine put_real

   !> A column of arrays; see `put_real`.
   subroutine put_reals(file, row, name, row_shape, values, meaning, unit)
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: row
      character(len=*), intent(in) :: name
      !> Shape of a row, at most two dimensions.
      integer, intent(in) :: row_shape(:)
      !> What the row holds.
      real(wp), intent(in) :: values(product(row_shape))
      character(len=*), intent(in) :: meaning
      character(len=*), intent(in), optional :: unit

      if (row == heading) then
         call add_column(file, name, kind_real, row_shape, meaning, unit)
      else
         call file%put_reals("history/"//name, int(row, long), size(values), values)
      end if
   end subroutine put_reals

   !> A column of integers; see `put_real`.
   subroutine put_integer(file, row, name, value, meaning)
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: row
      character(len=*), intent(in) :: name
      integer, intent(in) :: value
      character(len=*), intent(in) :: meaning

      if (row == heading) then
         call add_column(file, name, kind_integer, [integer ::], meaning)
      else
         call file%put_integers("history/"//name, int(row, long), 1, [int(value, long)])
      end if
   end subroutine put_integer

   !> A column of vectors of integers; see `put_real`.
   subroutine put_integers(file, row, name, values, meaning)
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: row
      character(len=*), intent(in) :: name
      integer, intent(in) :: values(:)
      character(len=*), intent(in) :: meaning

      if (row == heading) then
         call add_column(file, name, kind_integer, [size(values)], meaning)
      else
         call file%put_integers("history/"//name, int(row, long), size(values), int(values, long))
      end if
   end subroutine put_integers

   !> A column of texts; see `put_real`.
   subroutine put_text(file, row, name, text, meaning)
      type(hdf5_file_type), intent(inout) :: file
      integer, intent(in) :: row
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: text
      character(len=*), intent(in) :: meaning

      if (row == heading) then
         call add_column(file, name, kind_text, [integer ::], meaning)
      else
         call file%put_text("history/"//name, int(row, long), text)
      end if
   end subroutine put_text

   !> Make a column.
   subroutine add_column(file, name, kind, row_shape, meaning, unit)
      type(hdf5_file_type), intent(inout) :: file
      character(len=*), intent(in) :: name, meaning
      integer, intent(in) :: kind, row_shape(:)
      character(len=*), intent(in), optional :: unit

      call file%add_rows("history/"//name, kind, row_shape, chunk)
      call file%describe("history/"//name, meaning, unit)
   end subroutine add_column

end module coulter_results_columns
