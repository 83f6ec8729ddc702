!> Host of user materials: calls them, and offers the utilities that they call, under the names and
!> with the arguments that Abaqus gives them (Abaqus User Subroutines Guide, "Utility routines").
!> The program exports these.
!>
!> Components: direct 11, 22, 33, then shear 12, 13, 23; engineering shear when `lstr` is 2.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law_umat_host
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_funptr, c_int, c_ptr, c_size_t
   use, intrinsic :: iso_fortran_env, only: error_unit
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_law_umat_guard, only: call_guarded, leave_call, note, noted_text
   implicit none(type, external)
   private
   public :: host_call
   public :: sinv, sprinc, sprind, rotsig, xit, stdb_abqerr

   !> Rows and columns of the shear components.
   integer, parameter :: shear_row(3) = [1, 1, 2], shear_column(3) = [2, 3, 3]
   !> Sweeps of Jacobi's method; it converges quadratically, so that six are many.
   integer, parameter :: most_sweeps = 10
   !> Shear over direct components that is nothing: below round-off of any rotation.
   real(wp), parameter :: negligible = epsilon(1.0_wp)**2

contains

   !> Call work(data), which may leave by `xit`. Serial, since few user materials are safe to run in
   !> several threads.
   subroutine host_call(work, data, message)
      !> Procedure of C's kind with one argument, and that argument.
      type(c_funptr), intent(in) :: work
      type(c_ptr), intent(in) :: data
      !> Why it left; unallocated when it did not.
      character(len=:), allocatable, intent(out) :: message

      !$omp critical (coulter_umat)
      if (call_guarded(work, data) /= 0) then
         message = noted_text()
         if (message == "") message = "it called XIT without a message"
      end if
      !$omp end critical (coulter_umat)
   end subroutine host_call

   !> Mean stress tr/3 and von Mises stress of a tensor.
   subroutine sinv(stress, sinv1, sinv2, ndi, nshr) bind(C, name="sinv_")
      !> Number of direct and of shear components.
      integer(c_int), intent(in) :: ndi, nshr
      !> Stress, shape (ndi + nshr).
      real(c_double), intent(in) :: stress(ndi + nshr)
      !> First invariant tr/3.
      real(c_double), intent(out) :: sinv1
      !> Second invariant sqrt(3/2 s : s).
      real(c_double), intent(out) :: sinv2
      real(wp) :: deviator(3, 3)
      integer :: i

      deviator = unpacked(stress, 1_c_int, ndi, nshr)
      sinv1 = (deviator(1, 1) + deviator(2, 2) + deviator(3, 3))/3.0_wp
      do i = 1, 3
         deviator(i, i) = deviator(i, i) - sinv1
      end do
      sinv2 = sqrt(1.5_wp*sum(deviator**2))
   end subroutine sinv

   !> Principal values of a tensor, largest first.
   subroutine sprinc(s, ps, lstr, ndi, nshr) bind(C, name="sprinc_")
      !> Number of direct and of shear components.
      integer(c_int), intent(in) :: ndi, nshr
      !> Stress or strain, shape (ndi + nshr).
      real(c_double), intent(in) :: s(ndi + nshr)
      !> Principal values.
      real(c_double), intent(out) :: ps(3)
      !> 1: stress, 2: strain.
      integer(c_int), intent(in) :: lstr
      real(c_double) :: directions(3, 3)

      call sprind(s, ps, directions, lstr, ndi, nshr)
   end subroutine sprinc

   !> Principal values of a tensor, largest first, and their directions (Jacobi's method).
   subroutine sprind(s, ps, an, lstr, ndi, nshr) bind(C, name="sprind_")
      !> Number of direct and of shear components.
      integer(c_int), intent(in) :: ndi, nshr
      !> Stress or strain, shape (ndi + nshr).
      real(c_double), intent(in) :: s(ndi + nshr)
      !> Principal values.
      real(c_double), intent(out) :: ps(3)
      !> Direction cosines: row k belongs to value k.
      real(c_double), intent(out) :: an(3, 3)
      !> 1: stress, 2: strain.
      integer(c_int), intent(in) :: lstr
      real(wp) :: tensor(3, 3)
      integer :: sweep, k, order(3)

      tensor = unpacked(s, lstr, ndi, nshr)
      an = reshape([1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [3, 3])
      do sweep = 1, most_sweeps
         do k = 1, 3
            call rotate_away(tensor, an, shear_row(k), shear_column(k))
         end do
      end do
      ps = [tensor(1, 1), tensor(2, 2), tensor(3, 3)]
      order = [1, 2, 3]
      if (ps(order(1)) < ps(order(2))) order([1, 2]) = order([2, 1])
      if (ps(order(2)) < ps(order(3))) order([2, 3]) = order([3, 2])
      if (ps(order(1)) < ps(order(2))) order([1, 2]) = order([2, 1])
      ps = ps(order)
      an = an(order, :)
   end subroutine sprind

   !> Tensor in other axes: s' = r s r^T.
   subroutine rotsig(s, r, sprime, lstr, ndi, nshr) bind(C, name="rotsig_")
      !> Number of direct and of shear components.
      integer(c_int), intent(in) :: ndi, nshr
      !> Stress or strain, shape (ndi + nshr).
      real(c_double), intent(in) :: s(ndi + nshr)
      !> Rotation.
      real(c_double), intent(in) :: r(3, 3)
      !> Rotated tensor, shape (ndi + nshr).
      real(c_double), intent(out) :: sprime(ndi + nshr)
      !> 1: stress, 2: strain.
      integer(c_int), intent(in) :: lstr
      real(wp) :: rotated(3, 3)
      integer :: i

      rotated = matmul(r, matmul(unpacked(s, lstr, ndi, nshr), transpose(r)))
      do i = 1, ndi
         sprime(i) = rotated(i, i)
      end do
      do i = 1, nshr
         sprime(ndi + i) = real(lstr, wp)*rotated(shear_row(i), shear_column(i))
      end do
   end subroutine rotsig

   !> The user material gives up: its call ends at once, and the run ends with an error.
   subroutine xit() bind(C, name="xit_")
      call leave_call()
   end subroutine xit

   !> A message of the user material. Its errors become part of the program's own message, and what
   !> stops the analysis (`lop` is -3) ends like `xit`; the rest is printed.
   subroutine stdb_abqerr(lop, string, intv, realv, charv, string_length, charv_length) &
      bind(C, name="stdb_abqerr_")
      !> Hidden lengths of the texts.
      integer(c_size_t), value :: string_length, charv_length
      !> 1: remark, -1: warning, -2: error, -3: error that stops the analysis.
      integer(c_int), intent(in) :: lop
      !> Text; %I, %R and %S stand for the next value of the lists.
      character(kind=c_char), intent(in) :: string(string_length)
      !> Values to insert; those of `charv` have eight characters.
      integer(c_int), intent(in) :: intv(*)
      real(c_double), intent(in) :: realv(*)
      character(kind=c_char), intent(in) :: charv(*)
      character(len=:), allocatable :: text

      text = filled(joined(string), intv, realv, charv, int(charv_length))
      if (lop > -2) then
         write (error_unit, "(a)") "user material: "//text
      else
         call note(text)
      end if
      deallocate (text)  ! nothing is freed on the way out
      if (lop <= -3) call leave_call()
   end subroutine stdb_abqerr

   !> Text with its places filled in.
   function filled(string, intv, realv, charv, length) result(text)
      character(len=*), intent(in) :: string
      integer(c_int), intent(in) :: intv(*)
      real(c_double), intent(in) :: realv(*)
      character(kind=c_char), intent(in) :: charv(*)
      integer, intent(in) :: length
      character(len=:), allocatable :: text
      integer :: i, n(3)

      text = ""
      n = 1
      i = 1
      do while (i <= len(string))
         select case (string(i:min(i + 1, len(string))))
         case ("%I", "%i")
            text = text//to_text(intv(n(1)))
            n(1) = n(1) + 1
         case ("%R", "%r")
            text = text//to_text(realv(n(2)))
            n(2) = n(2) + 1
         case ("%S", "%s")
            text = text//trim(joined(charv(n(3):n(3) + length - 1)))
            n(3) = n(3) + length
         case default
            text = text//string(i:i)
            i = i - 1
         end select
         i = i + 2
      end do
      text = trim(text)
   end function filled

   !> Text of single characters.
   pure function joined(characters) result(text)
      character(kind=c_char), intent(in) :: characters(:)
      character(len=size(characters)) :: text
      integer :: i

      do i = 1, len(text)
         text(i:i) = characters(i)
      end do
   end function joined

   !> Tensor from its list of components.
   pure function unpacked(s, lstr, ndi, nshr) result(tensor)
      integer(c_int), intent(in) :: lstr, ndi, nshr
      real(c_double), intent(in) :: s(ndi + nshr)
      real(wp) :: tensor(3, 3)
      integer :: i

      tensor = 0.0_wp
      do i = 1, ndi
         tensor(i, i) = s(i)
      end do
      do i = 1, nshr
         tensor(shear_row(i), shear_column(i)) = s(ndi + i)/real(lstr, wp)
         tensor(shear_column(i), shear_row(i)) = s(ndi + i)/real(lstr, wp)
      end do
   end function unpacked

   !> One plane rotation that makes the component (p, q) vanish.
   pure subroutine rotate_away(tensor, directions, p, q)
      real(wp), intent(inout) :: tensor(3, 3), directions(3, 3)
      integer, intent(in) :: p, q
      real(wp) :: ratio, tangent, rotation(2, 2)

      if (abs(tensor(p, q)) <= negligible*max(abs(tensor(p, p)), abs(tensor(q, q)))) return
      ratio = 0.5_wp*(tensor(q, q) - tensor(p, p))/tensor(p, q)
      tangent = sign(1.0_wp, ratio)/(abs(ratio) + hypot(1.0_wp, ratio))
      rotation(:, 1) = [1.0_wp, -tangent]/hypot(1.0_wp, tangent)
      rotation(:, 2) = [-rotation(2, 1), rotation(1, 1)]
      tensor([p, q], :) = matmul(transpose(rotation), tensor([p, q], :))
      tensor(:, [p, q]) = matmul(tensor(:, [p, q]), rotation)
      directions([p, q], :) = matmul(transpose(rotation), directions([p, q], :))
   end subroutine rotate_away

end module coulter_law_umat_host
