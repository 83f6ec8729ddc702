!> Loads a user material (UMAT) from a shared library and calls it.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_umat_library
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_f_procpointer, &
      c_funloc, c_funptr, c_int, c_loc, c_null_char, c_ptr
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_kinds, only: wp
   use coulter_law_umat_guard, only: text_at
   use coulter_law_umat_host, only: host_call
   implicit none(type, external)
   private
   public :: umat_interface, umat_call_type, load_umat, call_umat, n_umat

   !> Stress components of a user material in plane strain and axisymmetry: 11, 22, 33, 12.
   integer, parameter :: n_umat = 4
   !> Symbols under which compilers put a Fortran procedure `umat` into a library.
   character(len=*), parameter :: symbols(*) = [character(len=5) :: "umat_", "umat", "UMAT"]
   !> dlopen: resolve all symbols now, so that what is missing is found when the library is loaded.
   integer(c_int), parameter :: resolve_now = 2_c_int

   abstract interface
      !> Abaqus User Subroutines Reference Guide, "UMAT".
      subroutine umat_interface(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, &
                                drpldt, stran, dstran, time, dtime, temp, dtemp, predef, dpred, &
                                cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, &
                                pnewdt, celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, kstep, kinc)
         import :: wp
         implicit none (type, external)
         integer, intent(in) :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt
         integer, intent(in) :: kstep(4), kinc
         real(wp), intent(inout) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens)
         real(wp), intent(inout) :: sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), drpldt
         real(wp), intent(in) :: stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp
         real(wp), intent(in) :: predef(1), dpred(1), props(nprops), coords(3), drot(3, 3)
         character(len=80), intent(in) :: cmname
         real(wp), intent(inout) :: pnewdt
         real(wp), intent(in) :: celent, dfgrd0(3, 3), dfgrd1(3, 3)
      end subroutine umat_interface
   end interface

   !> What a user material is told beside its state, and what it says beside its stress.
   type :: umat_call_type
      !> The user material.
      procedure(umat_interface), pointer, nopass :: umat => null()
      !> Name of the material.
      character(len=80) :: material = ""
      !> Cauchy stress 11, 22, 33, 12: at the start of the increment, rotated to its end; on return
      !> at its end. Tension positive.
      real(wp) :: stress(n_umat) = 0.0_wp
      !> Jacobian, d stress(i) / d strain_increment(j).
      real(wp) :: jacobian(n_umat, n_umat) = 0.0_wp
      !> Logarithmic strain at the start of the increment, rotated to its end, and its increment;
      !> engineering shear.
      real(wp) :: strain(n_umat) = 0.0_wp, strain_increment(n_umat) = 0.0_wp
      !> Time at the start of the increment, and its length.
      real(wp) :: time = 0.0_wp, time_increment = 0.0_wp
      !> Position of the point, and a length of its domain, length units.
      real(wp) :: position(3) = 0.0_wp, length = 1.0_wp
      !> Rotation of the increment; deformation gradients at its start and its end.
      real(wp) :: rotation(3, 3) = 0.0_wp, old_gradient(3, 3) = 0.0_wp, new_gradient(3, 3) = 0.0_wp
      !> Number of the point, of the step and of the increment.
      integer :: point = 1, step = 1, increment = 1
      !> Time increment that the user material asks for, over this one; at least 1 when content.
      real(wp) :: time_ratio = 1.0_wp
      !> Constants, shape (n_constants), and state variables, shape (n_state), of the caller.
      real(wp), pointer, contiguous :: constants(:) => null(), state(:) => null()
   end type umat_call_type

   interface
      function dlopen(path, flags) result(handle) bind(C, name="dlopen")
         import :: c_char, c_int, c_ptr
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: flags
         type(c_ptr) :: handle
      end function dlopen

      function dlsym(handle, symbol) result(address) bind(C, name="dlsym")
         import :: c_char, c_funptr, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: handle
         character(kind=c_char), intent(in) :: symbol(*)
         type(c_funptr) :: address
      end function dlsym

      function dlerror() result(text) bind(C, name="dlerror")
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr) :: text
      end function dlerror
   end interface

contains

   !> Find the user material of a shared library. The library stays loaded.
   subroutine load_umat(path, umat, error)
      !> Path of the library; one without a slash is looked for as the system does.
      character(len=*), intent(in) :: path
      !> The user material.
      procedure(umat_interface), pointer, intent(out) :: umat
      !> Set when there is no such library or no `umat` in it.
      type(error_type), allocatable, intent(out) :: error
      type(c_ptr) :: handle
      type(c_funptr) :: address
      integer :: i

      umat => null()
      handle = dlopen(path//c_null_char, resolve_now)
      if (.not. c_associated(handle)) then
         call fatal_error(error, "cannot be loaded: "//text_at(dlerror()))
         return
      end if
      do i = 1, size(symbols)
         address = dlsym(handle, trim(symbols(i))//c_null_char)
         if (.not. c_associated(address)) cycle
         call c_f_procpointer(address, umat)
         return
      end do
      call fatal_error(error, "holds no subroutine `umat`")
   end subroutine load_umat

   !> Call the user material.
   subroutine call_umat(arguments, message)
      !> What it is told; gets its answer.
      type(umat_call_type), target, intent(inout) :: arguments
      !> Why there is no answer; unallocated when there is one.
      character(len=:), allocatable, intent(out) :: message
      type(c_funptr) :: work

      ! as an argument the address would become a constant that the loader must relocate
      work = c_funloc(call_plainly)
      call host_call(work, c_loc(arguments), message)
   end subroutine call_umat

   !> The call itself; never returns when the user material calls `xit`.
   subroutine call_plainly(data) bind(C)
      type(c_ptr), value :: data
      type(umat_call_type), pointer :: a
      real(wp) :: unused(3), by_temperature(n_umat), by_strain(n_umat), heat, by_heat

      call c_f_pointer(data, a)
      unused = 0.0_wp
      by_temperature = 0.0_wp
      by_strain = 0.0_wp
      heat = 0.0_wp
      by_heat = 0.0_wp
      call a%umat(a%stress, a%state, a%jacobian, unused(1), unused(2), unused(3), heat, &
                  by_temperature, by_strain, by_heat, a%strain, a%strain_increment, &
                  [a%time, a%time], a%time_increment, 0.0_wp, 0.0_wp, [0.0_wp], [0.0_wp], &
                  a%material, 3, 1, n_umat, size(a%state), a%constants, size(a%constants), &
                  a%position, a%rotation, a%time_ratio, a%length, a%old_gradient, a%new_gradient, &
                  a%point, 1, 1, 1, [a%step, 1, 0, 0], a%increment)
   end subroutine call_plainly

end module coulter_law_umat_library
