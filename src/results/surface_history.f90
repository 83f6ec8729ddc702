!> What bodies in contact feel of each other: columns of the history, only where there are contacts.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_surface_history
   use coulter_model, only: model_type, units_type
   use coulter_model_contact_report, only: surface_report_type
   use coulter_results_columns, only: put_reals
   use coulter_results_hdf5_io, only: hdf5_file_type
   implicit none(type, external)
   private
   public :: put_surface_names, put_surfaces, surface_name

contains

   !> Names of the contacts, if there are any.
   subroutine put_surface_names(file, model)
      !> New file with a group `history`.
      type(hdf5_file_type), intent(inout) :: file
      !> Scene.
      type(model_type), intent(in) :: model
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
   end subroutine put_surface_names

   !> Columns on the contacts; see `coulter_results_columns`.
   subroutine put_surfaces(file, row, surfaces, units)
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> Number of the row, from 0, or `heading`.
      integer, intent(in) :: row
      !> What the bodies feel.
      type(surface_report_type), intent(in) :: surfaces(:)
      !> Labels.
      type(units_type), intent(in) :: units
      integer :: k, n

      n = size(surfaces)
      call put_reals(file, row, "surface_forces", [2, n], [(surfaces(k)%force, k=1, n)], &
                     "force of the second body of every contact on the first", units%force)
      call put_reals(file, row, "surface_pressing_forces", [n], surfaces%pressing, &
                     "sum of all forces along the normals", units%force)
      call put_reals(file, row, "surface_rubbing_forces", [n], surfaces%rubbing, &
                     "sum of all shear forces, without their signs", units%force)
      call put_reals(file, row, "surface_lengths", [n], surfaces%length, &
                     "length along which they press", units%length)
      call put_reals(file, row, "surface_slipping", [n], surfaces%slipping, &
                     "share of that length along which they slip", "1")
      call put_reals(file, row, "surface_penetrations", [n], surfaces%penetration, &
                     "deepest overlap of both", units%length)
   end subroutine put_surfaces

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
