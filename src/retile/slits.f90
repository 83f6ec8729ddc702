!> Slits in a body whose surfaces press and rub, or with a plate in them, held open while new tiles
!> are made.
!>
!> Tiles of a lattice would join both sides of a gap that is far narrower than their spacing. Both
!> sides therefore step back a little before, and what lies on them goes back with them afterwards
!> (theory, section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_slits
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: distance_to_segment
   use coulter_boundary_face, only: face_type
   use coulter_boundary_plate, only: is_beside
   use coulter_points_folds, only: find_folds, fold_type
   use coulter_points_outline, only: edges_of, outline_type
   implicit none(type, external)
   private
   public :: open_slits, close_slits, are_facing

   !> Both sides step back by this, over the spacing, where they are nearer than twice as much.
   real(wp), parameter :: step_back = 0.06_wp
   !> Corners nearer to the other side than this are beside a slit, over the spacing.
   real(wp), parameter :: beside = 0.5_wp
   !> Corners this near to a side of a plate lie on it, over the spacing.
   real(wp), parameter :: on_plate = 0.1_wp
   !> Vertices this near to an edge of the outline lie on it, over the spacing.
   real(wp), parameter :: on_edge = 1.0e-6_wp
   !> What is left of the step, so that corners of both sides stay two.
   real(wp), parameter :: rest = 1.0e-4_wp

contains

   !> Let both sides of slits step back, also where they overlap a little.
   pure subroutine open_slits(outline, shift, spacing, plates)
      !> Outline of a body; some corners move.
      type(outline_type), intent(inout) :: outline
      !> How far every corner has moved, length units, shape (2, n).
      real(wp), allocatable, intent(out) :: shift(:, :)
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      !> Sides of plates, if slits are only where these are.
      type(face_type), intent(in), optional :: plates(:)
      logical :: is_facing(outline%n), has_plate(outline%n)
      real(wp) :: along(2)
      integer :: c

      has_plate = .false.
      if (present(plates)) has_plate = [(is_beside(plates, outline%corner(:, c), &
                                                   on_plate*spacing, on_plate*spacing), &
                                         c=1, outline%n)]
      allocate (shift(2, outline%n))
      do c = 1, outline%n
         along = unit(outline%corner(:, outline%next(c)) - outline%corner(:, c)) &
            + unit(outline%corner(:, c) - outline%corner(:, outline%previous(c)))
         shift(:, c) = step_back*spacing*unit([-along(2), along(1)])
      end do
      is_facing = are_facing(outline%corner + shift, edges_of(outline), 4.0_wp*step_back*spacing)
      if (present(plates)) is_facing = is_facing .and. has_plate
      where (spread(.not. is_facing, 1, 2)) shift = 0.0_wp
      outline%corner = outline%corner + shift
      is_facing = are_facing(outline%corner, edges_of(outline), beside*spacing)
      if (present(plates)) is_facing = has_plate
      if (any(is_facing)) outline%is_slit = is_facing
   end subroutine open_slits

   !> Bring back what lies on sides that have stepped back.
   pure subroutine close_slits(vertices, outline, shift, spacing)
      !> Corners of tiles, shape (2, 4, n_tiles).
      real(wp), intent(inout) :: vertices(:, :, :)
      !> Outline with open slits; see `open_slits`.
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: shift(:, :), spacing
      real(wp) :: share
      integer :: c, p, v

      do p = 1, size(vertices, 3)
         do v = 1, 4
            do c = 1, outline%n
               associate (a => outline%corner(:, c), next => outline%next(c), &
                          place => vertices(:, v, p))
                  associate (b => outline%corner(:, next))
                     if (.not. any(abs(shift(:, [c, next])) > 0.0_wp)) cycle
                     if (distance_to_segment(place, a, b) > on_edge*spacing) cycle
                     share = min(max(dot_product(place - a, b - a)/dot_product(b - a, b - a), &
                                     0.0_wp), 1.0_wp)
                  end associate
                  vertices(:, v, p) = place - (1.0_wp - rest) &
                     *((1.0_wp - share)*shift(:, c) + share*shift(:, next))
                  exit
               end associate
            end do
         end do
      end do
   end subroutine close_slits

   !> Corners of outer edges that face others across less than some distance.
   pure function are_facing(position, edge, distance) result(answer)
      !> Positions of all corners, and outer edges, see `find_folds`.
      real(wp), intent(in) :: position(:, :)
      integer, intent(in) :: edge(:, :)
      !> The distance, length units.
      real(wp), intent(in) :: distance
      logical :: answer(size(position, 2))
      type(fold_type), allocatable :: folds(:)
      integer :: k

      answer = .false.
      call find_folds(folds, position, edge, distance)
      do k = 1, size(folds)
         answer([edge(:2, folds(k)%edge(1)), edge(:2, folds(k)%edge(2))]) = .true.
      end do
   end function are_facing

   !> Unit vector, or none.
   pure function unit(vector)
      real(wp), intent(in) :: vector(2)
      real(wp) :: unit(2)

      unit = vector/max(norm2(vector), tiny(1.0_wp))
   end function unit

end module coulter_retile_slits
