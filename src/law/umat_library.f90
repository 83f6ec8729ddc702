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
   public :: umat_call_type, load_umat, call_umat, start_umat, n_plane_umat, n_solid_umat

   !> Stress components of a user material in plane strain and axisymmetry, 11, 22, 33, 12, and in
   !> three dimensions, 13 and 23 as well.
   integer, parameter :: n_plane_umat = 4, n_solid_umat = 6
   !> Symbols under which compilers put Fortran procedures `umat` and `sdvini` into a library.
   character(len=*), parameter :: symbols(*) = [character(len=5) :: "umat_", "umat", "UMAT"]
   character(len=*), parameter :: start_symbols(*) = [character(len=7) :: "sdvini_", "sdvini", &
                                                      "SDVINI"]
   !> What `jstep` says beside the number of the step: static, large displacements, no perturbation.
   integer, parameter :: procedure_keys(3) = [1, 1, 0]
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

      !> Abaqus User Subroutines Reference Guide, "SDVINI".
      subroutine sdvini_interface(statev, coords, nstatv, ncrds, noel, npt, layer, kspt)
         import :: wp
         implicit none (type, external)
         integer, intent(in) :: nstatv, ncrds, noel, npt, layer, kspt
         real(wp), intent(inout) :: statev(nstatv)
         real(wp), intent(in) :: coords(ncrds)
      end subroutine sdvini_interface
   end interface

   !> What a user material is told beside its state, and what it says beside its stress.
   type :: umat_call_type
      !> The user material.
      procedure(umat_interface), pointer, nopass :: umat => null()
      !> What sets its state at the start; not associated when the library has none.
      procedure(sdvini_interface), pointer, nopass :: sdvini => null()
      !> Number of its stress components, 4 or 6: shear 13 and 23 come last.
      integer :: n_components = n_plane_umat
      !> Name of the material.
      character(len=80) :: material = ""
      !> Cauchy stress 11, 22, 33, 12, 13, 23: at the start of the increment, rotated to its end; on
      !> return at its end. Tension positive.
      real(wp) :: stress(n_solid_umat) = 0.0_wp
      !> Jacobian, d stress(i) / d strain_increment(j), a column of n_components after the other.
      real(wp) :: jacobian(n_solid_umat**2) = 0.0_wp
      !> Logarithmic strain at the start of the increment, rotated to its end, and its increment;
      !> engineering shear.
      real(wp) :: strain(n_solid_umat) = 0.0_wp, strain_increment(n_solid_umat) = 0.0_wp
      !> Time at the start of the increment, of the step and of the run, and its length.
      real(wp) :: time(2) = 0.0_wp, time_increment = 0.0_wp
      !> Position of the point at the start of the increment, and a length of its domain, length
      !> units.
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
   subroutine load_umat(path, material, error)
      !> Path of the library; one without a slash is looked for as the system does.
      character(len=*), intent(in) :: path
      !> Gets the user material and what sets its state.
      type(umat_call_type), intent(inout) :: material
      !> Set when there is no such library or no `umat` in it.
      type(error_type), allocatable, intent(out) :: error
      type(c_ptr) :: handle
      type(c_funptr) :: address

      handle = dlopen(path//c_null_char, resolve_now)
      if (.not. c_associated(handle)) then
         call fatal_error(error, "cannot be loaded: "//text_at(dlerror()))
         return
      end if
      address = address_of(handle, symbols)
      if (c_associated(address)) then
         call c_f_procpointer(address, material%umat)
      else
         call fatal_error(error, "holds no subroutine `umat`")
      end if
      address = address_of(handle, start_symbols)
      if (c_associated(address)) call c_f_procpointer(address, material%sdvini)
   end subroutine load_umat

   !> First of several symbols that a library has; not associated if it has none.
   function address_of(handle, names) result(address)
      type(c_ptr), intent(in) :: handle
      character(len=*), intent(in) :: names(:)
      type(c_funptr) :: address
      integer :: i

      do i = 1, size(names)
         address = dlsym(handle, trim(names(i))//c_null_char)
         if (c_associated(address)) return
      end do
   end function address_of

   !> Let the library set the state of a point before the first increment.
   subroutine start_umat(arguments, message)
      !> Position of the point; its state is set.
      type(umat_call_type), target, intent(inout) :: arguments
      !> Why there is no state; unallocated when there is one.
      character(len=:), allocatable, intent(out) :: message
      type(c_funptr) :: work

      if (.not. associated(arguments%sdvini)) return
      work = c_funloc(start_plainly)
      call host_call(work, c_loc(arguments), message)
   end subroutine start_umat

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
      ! what a user material must not change, and yet may
      type(umat_call_type) :: told
      real(wp) :: unused(5), by_temperature(n_solid_umat), by_strain(n_solid_umat)
      real(wp) :: temperature(2), field(1), field_change(1)

      call c_f_pointer(data, a)
      told = a
      unused = 0.0_wp
      by_temperature = 0.0_wp
      by_strain = 0.0_wp
      temperature = 0.0_wp
      field = 0.0_wp
      field_change = 0.0_wp
      call a%umat(a%stress, a%state, a%jacobian, unused(1), unused(2), unused(3), unused(4), &
                  by_temperature, by_strain, unused(5), told%strain, told%strain_increment, &
                  told%time, told%time_increment, temperature(1), temperature(2), field, &
                  field_change, told%material, 3, told%n_components - 3, told%n_components, &
                  size(a%state), a%constants, size(a%constants), told%position, told%rotation, &
                  a%time_ratio, told%length, told%old_gradient, told%new_gradient, told%point, &
                  1, 1, 1, [told%step, procedure_keys], told%increment)
   end subroutine call_plainly

   !> Likewise for the state at the start.
   subroutine start_plainly(data) bind(C)
      type(c_ptr), value :: data
      type(umat_call_type), pointer :: a

      call c_f_pointer(data, a)
      call a%sdvini(a%state, a%position, size(a%state), size(a%position), a%point, 1, 1, 1)
   end subroutine start_plainly

end module coulter_law_umat_library
