!> Stations in contact in a results file: where walls and tools press and rub, frame by frame.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_results_stations
   use coulter_base_kinds, only: long, wp
   use coulter_model, only: model_type
   use coulter_model_contact_report, only: station_report_type
   use coulter_results_hdf5_io, only: hdf5_file_type
   use coulter_results_hdf5_types, only: kind_integer, kind_real
   implicit none(type, external)
   private
   public :: stations_file_type, add_stations, put_stations

   !> Where the stations of the next frame go.
   type :: stations_file_type
      private
      !> Rows written so far.
      integer(long) :: n_rows = 0
   end type stations_file_type

   !> Rows that are stored together.
   integer, parameter :: chunk = 1024

contains

   !> Make the group and its datasets, without rows.
   subroutine add_stations(file, model)
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> Model in its initial state.
      type(model_type), intent(in) :: model

      call file%add_group("stations")
      call file%add_rows("stations/first_row", kind_integer, [integer ::], chunk)
      call file%describe("stations/first_row", "first row of every frame, from 0")
      call file%add_rows("stations/n_rows", kind_integer, [integer ::], chunk)
      call file%describe("stations/n_rows", "stations in contact in every frame")
      call file%add_rows("stations/boundary", kind_integer, [integer ::], chunk)
      call file%describe("stations/boundary", "number of the boundary, from 1, or minus that of" &
                         //" the contact between two bodies")
      call file%add_rows("stations/slip", kind_integer, [integer ::], chunk)
      call file%describe("stations/slip", "sign of the shear while it slips, else 0")
      call file%add_rows("stations/position", kind_real, [2], chunk)
      call file%describe("stations/position", "place", model%units%length)
      call file%add_rows("stations/length", kind_real, [integer ::], chunk)
      call file%describe("stations/length", "length that it stands for", model%units%length)
      call file%add_rows("stations/traction", kind_real, [2], chunk)
      call file%describe("stations/traction", "normal traction, tension positive, and shear", &
                         model%units%stress)
   end subroutine add_stations

   !> Append the stations of a frame.
   subroutine put_stations(rows, file, frame, stations)
      !> Where they go.
      type(stations_file_type), intent(inout) :: rows
      !> Open file.
      type(hdf5_file_type), intent(inout) :: file
      !> Number of the frame, from 0.
      integer, intent(in) :: frame
      !> The stations.
      type(station_report_type), intent(in) :: stations(:)
      real(wp) :: position(2, size(stations)), traction(2, size(stations))
      integer :: i, n

      n = size(stations)
      call file%put_integers("stations/first_row", int(frame, long), 1, [rows%n_rows])
      call file%put_integers("stations/n_rows", int(frame, long), 1, [int(n, long)])
      if (n == 0) return
      do i = 1, n
         position(:, i) = stations(i)%position
         traction(:, i) = stations(i)%traction
      end do
      call file%put_integers("stations/boundary", rows%n_rows, n, int(stations%boundary, long))
      call file%put_integers("stations/slip", rows%n_rows, n, int(stations%slip, long))
      call file%put_reals("stations/position", rows%n_rows, 2*n, position)
      call file%put_reals("stations/length", rows%n_rows, n, stations%weight)
      call file%put_reals("stations/traction", rows%n_rows, 2*n, traction)
      rows%n_rows = rows%n_rows + int(n, long)
   end subroutine put_stations

end module coulter_results_stations
