!> Reads the shapes of rigid tools: primitives, outlines from the deck or a file.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_tool_shapes
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: last_of_line, to_text
   use coulter_boundary, only: boundary_type
   use coulter_boundary_tool_shape, only: close_circle, close_outline, fluke_corners, &
      rectangle_corners, turned_to, wedge_corners
   use coulter_deck_document, only: blame, deck_type
   use coulter_deck_file, only: read_text
   use coulter_deck_outline, only: new_polygon, new_polyline
   use coulter_deck_values, only: get_choice, get_list, get_value, is_given
   implicit none(type, external)
   private
   public :: read_shape

   !> Numbers of the shapes among the choices of the deck.
   integer, parameter :: polygon = 1, polyline = 2, circle = 3, rectangle = 4, wedge = 5, fluke = 6
   !> Radians of a degree.
   real(wp), parameter :: degree = acos(-1.0_wp)/180.0_wp
   !> Variables of a shape: which of them it needs.
   character(len=*), parameter :: shape_variables(*) = [character(len=8) :: &
      "vertices", "radius", "size"]

contains

   !> Faces of a tool, and the centre of its rotation where the deck gives no pivot.
   subroutine read_shape(deck, group, tool)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Tool; gets its faces.
      type(boundary_type), intent(inout) :: tool
      real(wp) :: position(2), angle
      real(wp), allocatable :: corner(:, :)
      integer :: kind

      position = 0.0_wp
      angle = 0.0_wp
      kind = 0
      call get_choice(deck, group, "shape", kind)
      call get_value(deck, group, "position", position)
      call get_value(deck, group, "angle", angle)
      call check_variables(deck, group, kind)
      tool%centre = position
      allocate (tool%vertices(2, 0))
      if (kind == circle) then
         call read_circle(deck, group, position, tool)
         return
      end if
      call read_corners(deck, group, kind, corner)
      if (size(corner) == 0) return
      corner = turned_to(corner, degree*angle, position)
      if (kind == polyline) then
         call read_side(deck, group, corner, tool)
      else
         call read_outline(deck, group, corner, tool)
      end if
   end subroutine read_shape

   !> A shape takes its own variables only, and needs them.
   subroutine check_variables(deck, group, kind)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group, kind
      !> Which of `shape_variables` a shape needs.
      integer, parameter :: needed(0:6) = [0, 1, 1, 2, 3, 3, 3]
      integer :: i
      logical :: has

      do i = 1, size(shape_variables)
         has = is_given(deck, group, trim(shape_variables(i)))
         if (i == 1) has = has .or. is_given(deck, group, "file")
         if (kind == 0 .or. deck%groups(group)%is_broken .or. (has .eqv. needed(kind) == i)) cycle
         if (has) then
            call blame(deck, group, trim(shape_variables(i)), "does not belong to this shape")
         else
            call blame(deck, group, "shape", "needs `"//trim(shape_variables(i))//"`")
         end if
      end do
      if (is_given(deck, group, "file") .and. is_given(deck, group, "vertices")) then
         call blame(deck, group, "file", "stands beside `vertices`; give one of them")
      end if
   end subroutine check_variables

   !> A circle.
   subroutine read_circle(deck, group, position, tool)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      real(wp), intent(in) :: position(2)
      type(boundary_type), intent(inout) :: tool
      real(wp) :: radius
      logical :: is_inside

      radius = 1.0_wp
      is_inside = .false.
      call get_value(deck, group, "radius", radius)
      call get_value(deck, group, "inside", is_inside)
      tool%is_solid = .not. is_inside
      call close_circle(position, radius, is_inside, tool%vertices, tool%bulges)
   end subroutine read_circle

   !> Corners of all other shapes around their origin; none when they are at fault.
   subroutine read_corners(deck, group, kind, corner)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group, kind
      real(wp), allocatable, intent(out) :: corner(:, :)
      real(wp), allocatable :: list(:)
      character(len=:), allocatable :: message
      real(wp) :: size_of(2)

      size_of = 1.0_wp
      message = ""
      call get_value(deck, group, "size", size_of)
      call read_list(deck, group, list)
      allocate (corner(2, 0))
      select case (kind)
      case (rectangle)
         corner = rectangle_corners(size_of)
      case (wedge)
         corner = wedge_corners(size_of)
      case (fluke)
         corner = fluke_corners(size_of)
         if (size_of(1) <= size_of(2)) call blame(deck, group, "size", &
                                                  "must be longer than thick for a fluke")
      case (polygon)
         if (size(list) > 0) call new_polygon(list, corner, message)
      case (polyline)
         if (size(list) > 0) call new_polyline(list, corner, message)
      case default
         ! the shape is at fault
      end select
      if (any(size_of <= 0.0_wp)) call blame(deck, group, "size", "must be > 0")
      if (message /= "") call blame(deck, group, "vertices", message)
   end subroutine read_corners

   !> Coordinates from the deck or a file; none when they are missing or at fault.
   subroutine read_list(deck, group, list)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      real(wp), allocatable, intent(out) :: list(:)
      character(len=:), allocatable :: name, text
      type(error_type), allocatable :: error

      call get_list(deck, group, "vertices", list)
      if (.not. allocated(list)) allocate (list(0))
      name = ""
      call get_value(deck, group, "file", name)
      if (name == "") return
      call read_text(beside(deck%path, name), text, error)
      if (allocated(error)) then
         call blame(deck, group, "file", error%message)
      else
         call parse_columns(deck, group, text, list)
      end if
   end subroutine read_list

   !> Path of a file in the folder of the deck.
   pure function beside(deck_path, name) result(path)
      character(len=*), intent(in) :: deck_path, name
      character(len=:), allocatable :: path
      integer :: slash

      slash = scan(deck_path, "/", back=.true.)
      path = deck_path(:slash)//name
   end function beside

   !> Two columns of numbers, x and y, separated by commas or blanks; lines that begin with a letter
   !> or # say what they are.
   subroutine parse_columns(deck, group, text, list)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      character(len=*), intent(in) :: text
      real(wp), allocatable, intent(inout) :: list(:)
      character(len=:), allocatable :: line
      real(wp) :: row(2)
      integer :: first, last, status, number

      first = 1
      number = 0
      do while (first <= len(text))
         last = last_of_line(text, first)
         line = trim(adjustl(text(first:last)))
         first = last + 2
         number = number + 1
         if (line == "" .or. line == achar(13)) cycle
         if (scan(line(:1), "0123456789+-.") == 0) cycle
         read (line, *, iostat=status) row
         if (status == 0) then
            list = [list, row]
         else
            call blame(deck, group, "file", "line "//to_text(number) &
                       //" must hold two numbers, x and y")
            return
         end if
      end do
      if (size(list) < 4) call blame(deck, group, "file", "must hold at least two rows x, y")
   end subroutine parse_columns

   !> An open chain of faces.
   subroutine read_side(deck, group, corner, tool)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      real(wp), intent(in) :: corner(:, :)
      type(boundary_type), intent(inout) :: tool
      integer :: side

      side = 1
      call get_choice(deck, group, "material_side", side)
      tool%vertices = corner
      if (side == 2) tool%vertices = corner(:, size(corner, 2):1:-1)
   end subroutine read_side

   !> A closed chain of faces.
   subroutine read_outline(deck, group, corner, tool)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      real(wp), intent(in) :: corner(:, :)
      type(boundary_type), intent(inout) :: tool
      real(wp) :: rounding
      logical :: is_inside, fits

      rounding = 0.0_wp
      is_inside = .false.
      call get_value(deck, group, "rounding", rounding)
      call get_value(deck, group, "inside", is_inside)
      tool%is_solid = .not. is_inside
      call close_outline(corner, rounding, is_inside, tool%vertices, tool%bulges, fits)
      if (.not. fits) call blame(deck, group, "rounding", "leaves nothing of a side")
   end subroutine read_outline

end module coulter_deck_tool_shapes
