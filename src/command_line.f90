!> What the user asks for on the command line.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_command_line
   use coulter_base_error, only: error_type, fatal_error
   implicit none(type, external)
   private
   public :: command_type, read_command, write_usage
   public :: task_run, task_check, task_help, task_version, task_deck_reference, task_point

   !> What to do.
   integer, parameter :: task_run = 1, task_check = 2, task_help = 3, task_version = 4, &
      task_deck_reference = 5, task_point = 6

   !> A parsed command line.
   type :: command_type
      !> What to do: one of `task_*`.
      integer :: task = task_run
      !> Path of the deck.
      character(len=:), allocatable :: deck_path
      !> Directory of the results.
      character(len=:), allocatable :: directory
      !> Steps after which a run ends if there are more.
      integer :: most_steps = huge(1)
      !> Is nothing but errors printed?
      logical :: is_quiet = .false.
   end type command_type

contains

   !> Parse the command line of the process.
   subroutine read_command(command, error)
      !> What the user asks for.
      type(command_type), intent(out) :: command
      !> Set when the command line makes no sense.
      type(error_type), allocatable, intent(out) :: error
      integer :: k

      command%deck_path = ""
      command%directory = "."
      if (command_argument_count() == 0) command%task = task_help
      k = 1
      do while (k <= command_argument_count())
         call read_argument(command, k, error)
         if (allocated(error)) return
         k = k + 1
      end do
      if (command%deck_path == "" &
          .and. any(command%task == [task_run, task_check, task_point])) then
         call fatal_error(error, "no deck given; see coulter --help")
      end if
   end subroutine read_command

   !> Parse the k-th argument, and its value if it has one.
   subroutine read_argument(command, k, error)
      type(command_type), intent(inout) :: command
      integer, intent(inout) :: k
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: text

      text = argument(k)
      select case (text)
      case ("--help", "-h")
         command%task = task_help
      case ("--version")
         command%task = task_version
      case ("--deck-reference")
         command%task = task_deck_reference
      case ("--check")
         command%task = task_check
      case ("point")
         if (k == 1) then
            command%task = task_point
         else
            command%deck_path = text
         end if
      case ("--quiet", "-q")
         command%is_quiet = .true.
      case ("--output", "-o")
         k = k + 1
         command%directory = argument(k)
         if (command%directory == "") call fatal_error(error, text//" needs a directory")
      case ("--steps")
         k = k + 1
         call read_most_steps(command, argument(k), error)
      case default
         if (index(text, "-") == 1) then
            call fatal_error(error, "unknown option "//text//"; see coulter --help")
         else if (command%deck_path /= "") then
            call fatal_error(error, "one deck at a time: "//command%deck_path//" or "//text//"?")
         else
            command%deck_path = text
         end if
      end select
   end subroutine read_argument

   !> Parse the number of steps after which a run ends.
   subroutine read_most_steps(command, text, error)
      type(command_type), intent(inout) :: command
      character(len=*), intent(in) :: text
      type(error_type), allocatable, intent(out) :: error
      integer :: status

      status = 1
      if (text /= "" .and. verify(text, "0123456789") == 0) then
         read (text, *, iostat=status) command%most_steps
      end if
      if (status == 0 .and. command%most_steps > 0) return
      call fatal_error(error, "--steps needs a whole number above 0, not """//text//"""")
   end subroutine read_most_steps

   !> The k-th argument; empty when there is none.
   function argument(k) result(text)
      integer, intent(in) :: k
      character(len=:), allocatable :: text
      integer :: length

      length = 0
      if (k <= command_argument_count()) call get_command_argument(k, length=length)
      allocate (character(len=length) :: text)
      if (length > 0) call get_command_argument(k, text)
   end function argument

   !> Explain the program.
   subroutine write_usage(unit)
      !> Unit to write to.
      integer, intent(in) :: unit

      write (unit, "(a)") "Usage: coulter [options] deck.nml", &
         "       coulter point [options] deck.nml", "", &
         "Computes how tools move through soil: implicit material point method with implicit", &
         "boundaries. Reads a namelist deck and writes NAME.vtkhdf, which ParaView opens.", &
         "`point` runs the laboratory tests on samples that the deck holds instead, and writes", &
         "NAME_SAMPLE.csv.", "", &
         "  -o, --output DIR   where the results go (default: the current directory)", &
         "      --check        read and check the deck, report the scene, run nothing", &
         "      --steps N      end the run after N steps", &
         "  -q, --quiet        print nothing but errors", &
         "      --deck-reference  print all groups and variables of a deck", &
         "      --version      print version and build", &
         "  -h, --help         print this", "", &
         "Exit status: 0 done, 1 the run failed, 2 the deck or the command is wrong."
   end subroutine write_usage

end module coulter_command_line
