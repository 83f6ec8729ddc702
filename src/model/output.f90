!> What of a run is kept in its results file.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_output
   implicit none(type, external)
   private
   public :: output_type

   !> Choice of frames and their storage.
   type :: output_type
      !> Base name of the results file.
      character(len=:), allocatable :: name
      !> A frame is kept after every so many complete steps, >= 1; always after the last.
      integer :: every = 1
      !> Steps after which a frame is kept, instead of `every`; unallocated: none given.
      integer, allocatable :: at_steps(:)
      !> Are frames kept in single precision?
      logical :: is_single = .false.
      !> Compression of frames, 0 (none) to 9.
      integer :: compression = 0
   end type output_type

end module coulter_model_output
