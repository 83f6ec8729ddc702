!> What a test on a sample gave: a table, to be written as comma-separated values.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_sample_record
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_base_tensor, only: equivalent_stress
   use coulter_law_abstract, only: law_type
   use coulter_sample, only: sample_type
   use coulter_sample_state, only: sample_state_type
   implicit none(type, external)
   private
   public :: record_type, new_record, add_row, write_record

   !> A table with named columns.
   type :: record_type
      !> Names of the columns.
      character(len=32), allocatable :: names(:)
      !> Numbers, shape (n_columns, most rows).
      real(wp), allocatable :: values(:, :)
      !> Rows that are there.
      integer :: n_rows = 0
      !> Void ratio at the start; negative: no such column.
      real(wp), private :: void_ratio = -1.0_wp
   end type record_type

   !> Columns that every table has, in front of those of the law.
   character(len=*), parameter :: common_names(*) = [character(len=32) :: "stage", "time", &
      "strain_xx", "strain_yy", "strain_zz", "strain_xy", &
      "stress_xx", "stress_yy", "stress_zz", "stress_xy", "p", "q", "volume_strain", "iterations"]

   !> Characters of a number in a table.
   integer, parameter :: width = 23

contains

   !> Make an empty table.
   pure subroutine new_record(record, sample, law, most_rows)
      !> Table to make.
      type(record_type), intent(out) :: record
      !> Sample whose table it is.
      type(sample_type), intent(in) :: sample
      !> Its law, which names its state variables.
      class(law_type), intent(in) :: law
      !> Most rows.
      integer, intent(in) :: most_rows

      record%void_ratio = sample%void_ratio
      record%names = common_names
      if (sample%void_ratio >= 0.0_wp) then
         record%names = [record%names, [character(len=32) :: "void_ratio"]]
      end if
      if (allocated(law%variables)) record%names = [record%names, law%variables%name]
      allocate (record%values(size(record%names), most_rows))
   end subroutine new_record

   !> Add a row. Pressure p is positive in compression, q is the von Mises stress.
   pure subroutine add_row(record, stage, state, n_iterations)
      !> Table.
      type(record_type), intent(inout) :: record
      !> Number of the stage; 0 before the first.
      integer, intent(in) :: stage
      !> State of the sample.
      type(sample_state_type), intent(in) :: state
      !> Newton corrections of the increment.
      integer, intent(in) :: n_iterations
      real(wp) :: void_ratio(1)
      real(wp), allocatable :: row(:)

      row = [real(stage, wp), state%time, state%strain, state%stress, &
             -sum(state%stress(:3))/3.0_wp, &
             equivalent_stress(state%stress), sum(state%strain(:3)), &
             real(n_iterations, wp)]
      void_ratio = (1.0_wp + record%void_ratio)*state%volume_ratio() - 1.0_wp
      if (record%void_ratio >= 0.0_wp) row = [row, void_ratio]
      row = [row, state%law_state]
      record%n_rows = record%n_rows + 1
      record%values(:, record%n_rows) = row(:size(record%names))
   end subroutine add_row

   !> Write a table: a line of names, then a line per row.
   subroutine write_record(record, path, error)
      !> Table.
      type(record_type), intent(in) :: record
      !> File to write.
      character(len=*), intent(in) :: path
      !> Set when it cannot be written.
      type(error_type), allocatable, intent(out) :: error
      character(len=200) :: message
      integer :: unit, status, i, k, n_bytes

      open (newunit=unit, file=path, action="write", status="replace", iostat=status, &
            iomsg=message)
      if (status == 0) write (unit, "(*(a, :, ','))", iostat=status, iomsg=message) &
         (trim(record%names(k)), k=1, size(record%names))
      do i = 1, record%n_rows
         if (status /= 0) exit
         write (unit, "(*(es23.15e3, :, ','))", iostat=status, iomsg=message) record%values(:, i)
      end do
      if (status == 0) close (unit, iostat=status, iomsg=message)
      inquire (file=path, size=n_bytes)
      if (status /= 0) then
         call fatal_error(error, path//": cannot be written: "//trim(message))
      else if (n_bytes < width*size(record%names)*record%n_rows) then
         ! Fortran's run-time library says nothing of it
         call fatal_error(error, path//": cannot be written (is the disk full?)")
      end if
   end subroutine write_record

end module coulter_sample_record
