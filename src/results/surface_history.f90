!> What bodies in contact feel of each other: columns of the history, only where there are contacts.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_surface_history
   use coulter_base_kinds, only: long, wp
   use coulter_model, only: model_type
   use coulter_model_contact_report, only: surface_report_type
   use coulter_results_hdf5_io, only: hdf5_file_type
   use coulter_results_hdf5_types, only: kind_real
   implicit none(type, external)
   private
   public :: add_surface_columns, put_surface_columns, surface_name

contains

   !> Make the columns.
   subroutine add_surface_columns(file, model, chunk)
      !> New file with a group `history`.
      type(hdf5_file_type), intent(inout) :: file
      !> Scene.
      type(model_type), intent(in) :: model
      !> Rows per chunk.
      integer, intent(in) :: chunk
      character(len=256), allocatable :: names(:)
      integer :: k, n

      n = 0
      if (allocated(model%body_contacts)) n = size(model%body_contacts)
      if (n == 0) return
      allocate (names(n))
      do k = 1, n
         names(k) = surface_name(model, k)
      end do
      call file%put_texts("history/surface_names", names)
      call add_column("forces", [2, n], "force of the second body of every contact on the first", &
                      model%units%force)
      call add_column("pressing_forces", [n], "sum of all forces along the normals", &
                      model%units%force)
      call add_column("rubbing_forces", [n], "sum of all shear forces, without their signs", &
                      model%units%force)
      call add_column("lengths", [n], "length along which they press", model%units%length)
      call add_column("slipping", [n], "share of that length along which they slip", "1")
      call add_column("penetrations", [n], "deepest overlap of both", model%units%length)

   contains

      !> Make one column.
      subroutine add_column(name, row_shape, meaning, unit)
         character(len=*), intent(in) :: name, meaning
         integer, intent(in) :: row_shape(:)
         character(len=*), intent(in), optional :: unit

         call file%add_rows("history/surface_"//name, kind_real, row_shape, chunk)
         call file%describe("history/surface_"//name, meaning, unit)
      end subroutine add_column

   end subroutine add_surface_columns

   !> Append a row.
   subroutine put_surface_columns(file, row, surfaces)
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> Number of the row, from 0.
      integer(long), intent(in) :: row
      !> What the bodies feel.
      type(surface_report_type), intent(in) :: surfaces(:)
      real(wp) :: forces(2, size(surfaces))
      integer :: k, n

      n = size(surfaces)
      do k = 1, n
         forces(:, k) = surfaces(k)%force
      end do
      call file%put_reals("history/surface_forces", row, 2*n, forces)
      call file%put_reals("history/surface_pressing_forces", row, n, surfaces%pressing)
      call file%put_reals("history/surface_rubbing_forces", row, n, surfaces%rubbing)
      call file%put_reals("history/surface_lengths", row, n, surfaces%length)
      call file%put_reals("history/surface_slipping", row, n, surfaces%slipping)
      call file%put_reals("history/surface_penetrations", row, n, surfaces%penetration)
   end subroutine put_surface_columns

   !> Name of a contact in logs and results.
   pure function surface_name(model, contact) result(name)
      !> Scene.
      type(model_type), intent(in) :: model
      !> Number of the contact.
      integer, intent(in) :: contact
      character(len=:), allocatable :: name

      associate (body => model%body_contacts(contact)%body)
         name = model%bodies(body(1))%name//" on "//model%bodies(body(2))%name
      end associate
   end function surface_name

end module coulter_results_surface_history
