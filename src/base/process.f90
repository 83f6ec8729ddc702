!> Settings of the running process that a program, never a library, may change: threads of the
!> BLAS and how memory goes back to the system. Both only matter for speed.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_process
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_procpointer, c_funptr, c_int, &
      c_null_char, c_null_ptr, c_ptr
   implicit none(type, external)
   private
   public :: tune_process, blas_name

   !> Names of malloc's parameters (malloc.h of the GNU C library).
   integer(c_int), parameter :: trim_threshold = -1_c_int, top_pad = -2_c_int, &
      mmap_threshold = -3_c_int
   !> Values of these, bytes.
   integer(c_int), parameter :: never = huge(0_c_int), generous = 2_c_int**25

   abstract interface
      subroutine set_threads_interface(n) bind(C)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: n
      end subroutine set_threads_interface
   end interface

   interface
      function mallopt(parameter, value) result(status) bind(C, name="mallopt")
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: parameter, value
         integer(c_int) :: status
      end function mallopt

      function dlsym(handle, symbol) result(address) bind(C, name="dlsym")
         import :: c_char, c_funptr, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: handle
         character(kind=c_char), intent(in) :: symbol(*)
         type(c_funptr) :: address
      end function dlsym
   end interface

contains

   !> Fronts of a sparse factorisation are small: threads inside the BLAS only spin. And the
   !> factors come and go in every iteration: giving their memory back to the system each time
   !> costs as much as computing them. Threads set in the environment are respected.
   subroutine tune_process()
      procedure(set_threads_interface), pointer :: set_threads
      type(c_funptr) :: address
      integer(c_int) :: status
      integer :: length

      status = mallopt(mmap_threshold, generous)
      status = mallopt(trim_threshold, never)
      status = mallopt(top_pad, generous)
      call get_environment_variable("OPENBLAS_NUM_THREADS", length=length)
      if (length > 0) return
      address = find_symbol("openblas_set_num_threads")
      if (.not. c_associated(address)) return
      call c_f_procpointer(address, set_threads)
      call set_threads(1_c_int)
   end subroutine tune_process

   !> Which BLAS is loaded, as far as it can be told apart.
   function blas_name() result(name)
      character(len=:), allocatable :: name

      name = "reference or unknown BLAS"
      if (c_associated(find_symbol("openblas_set_num_threads"))) name = "OpenBLAS"
      if (c_associated(find_symbol("MKL_Get_Version"))) name = "MKL"
   end function blas_name

   !> Address of a procedure in the loaded libraries, null if there is none.
   function find_symbol(symbol) result(address)
      character(len=*), intent(in) :: symbol
      type(c_funptr) :: address
      character(kind=c_char) :: c_symbol(len(symbol) + 1)
      integer :: i

      do i = 1, len(symbol)
         c_symbol(i) = symbol(i:i)
      end do
      c_symbol(len(symbol) + 1) = c_null_char
      address = dlsym(c_null_ptr, c_symbol)
   end function find_symbol

end module coulter_base_process
