!> Directories, through POSIX: Fortran can neither make nor test them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_directory
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use coulter_base_error, only: error_type, fatal_error
   implicit none(type, external)
   private
   public :: make_directory, check_directory

   !> Permissions of new directories, before the user's mask: rwxrwxrwx.
   integer(c_int), parameter :: all_permissions = int(o"777", c_int)
   !> Questions to `access` of POSIX: is it there, can files be made in it.
   integer(c_int), parameter :: exists = 0, write_and_search = 3

   interface
      !> mkdir of POSIX.
      function c_mkdir(path, mode) bind(c, name="mkdir") result(status)
         import :: c_char, c_int
         implicit none(type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
         integer(c_int) :: status
      end function c_mkdir

      !> access of POSIX: 0 for yes.
      function c_access(path, question) bind(c, name="access") result(status)
         import :: c_char, c_int
         implicit none(type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: question
         integer(c_int) :: status
      end function c_access
   end interface

contains

   !> Find out whether files can be written in a directory that exists or can be made. Nothing is
   !> changed.
   subroutine check_directory(path, error)
      !> Path of the directory.
      character(len=*), intent(in) :: path
      !> Set when files cannot be written there.
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: ancestor

      ancestor = trim(path)
      do while (.not. answers(ancestor, exists))
         ancestor = parent_of(ancestor)
      end do
      if (.not. answers(ancestor//"/.", write_and_search)) call refuse(path, ancestor, error)
   end subroutine check_directory

   !> Make a directory and the ones above it, where they are missing.
   subroutine make_directory(path, error)
      !> Path of the directory.
      character(len=*), intent(in) :: path
      !> Set when it cannot be made or written.
      type(error_type), allocatable, intent(out) :: error
      integer(c_int) :: status
      integer :: i

      call check_directory(path, error)
      if (allocated(error)) return
      do i = 2, len_trim(path)
         if (path(i:i) == "/") status = c_mkdir(path(:i - 1)//c_null_char, all_permissions)
      end do
      status = c_mkdir(trim(path)//c_null_char, all_permissions)
      if (.not. answers(trim(path)//"/.", write_and_search)) call refuse(path, path, error)
   end subroutine make_directory

   !> Path of the directory above; "." or "/" at the end of the way.
   pure function parent_of(path) result(parent)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: parent
      integer :: last

      last = index(path, "/", back=.true.)
      select case (last)
      case (0)
         parent = "."
      case (1)
         parent = "/"
      case default
         parent = path(:last - 1)
      end select
   end function parent_of

   !> Ask POSIX about a path.
   function answers(path, question) result(is_so)
      character(len=*), intent(in) :: path
      integer(c_int), intent(in) :: question
      logical :: is_so

      is_so = c_access(path//c_null_char, question) == 0
   end function answers

   !> Say why files cannot be written.
   pure subroutine refuse(path, obstacle, error)
      character(len=*), intent(in) :: path, obstacle
      type(error_type), allocatable, intent(out) :: error

      if (obstacle == path) then
         call fatal_error(error, "cannot write into the directory "//trim(path))
      else
         call fatal_error(error, "cannot make the directory "//trim(path)//": "//trim(obstacle) &
                          //" is not a writable directory")
      end if
   end subroutine refuse

end module coulter_base_directory
