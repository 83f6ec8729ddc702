!> Stations on the corners of tiles: where a body meets walls and tools, and what they remember.
!>
!> The traction of the material itself makes the constraint consistent, so that any penalty passes
!> the patch test (Nitsche; theory, section 4).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact
   use coulter_base_kinds, only: wp
   use coulter_boundary_face, only: face_type
   use coulter_boundary_motion, only: motion_type, moved_by
   use coulter_contact_cut, only: open_tip_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: untouched, broken
   public :: contact_type, contacts_type, append_contact, recall_contacts, lag_after, end_slack

   !> What stands for the opening of stations that have never touched, and of those that hold no
   !> tension any more.
   real(wp), parameter :: untouched = -1.0_wp, broken = huge(1.0_wp)

   !> One end of an outer edge against one face.
   type :: contact_type
      !> Number of the boundary and of its segment.
      integer :: boundary = 0, segment = 0
      !> Tile that owns the edge, and which of its vertices the station is.
      integer :: tile = 0, vertex = 0
      !> Corner of the tiling at that vertex, and corner at the other end of the edge.
      integer :: corner = 0, other_corner = 0
      !> Vertex at the other end of the edge; corner of the tool that presses between the ends, 0 if
      !> the station is a corner of the tile; place of that on the edge at the start.
      integer :: other_vertex = 0, tip = 0
      real(wp) :: share = 0.0_wp
      !> Number of the outer edge, and which of its ends the station is: its identity from step to
      !> step.
      integer :: edge = 0, end_of_edge = 0
      !> Length of face that the station stands for.
      real(wp) :: weight = 0.0_wp
      !> Near open ends of the face: how far the corner may get behind it before it is held, length
      !> units, and what the face adds to the pressure of the material until then, over that.
      real(wp) :: give = 0.0_wp, hold = 0.0_wp
      !> Does the face recede there, so that the corner may stay behind, and is pressed less?
      logical :: recedes = .false.
      !> Beside corners of tools that cut in: does it press at most as the other end of the edge
      !> does, but for `hold`?
      logical :: leans = .false.
      !> The face at the end of the step.
      type(face_type) :: face
      !> Corners of the edge at the start of the step, from the first end of the face, length units.
      real(wp) :: offset(2) = 0.0_wp, other_offset(2) = 0.0_wp
      !> Unit vector that the stress of the tile acts on: against the edge's outward normal, or the
      !> normal of the face where that is the same.
      real(wp) :: inward(2) = 0.0_wp
      !> Way from the place where the corner sticks to the face to the corner, if that stays where
      !> it is and the face moves, and the same after the step, length units.
      real(wp) :: lag(2) = 0.0_wp, new_lag(2) = 0.0_wp
      !> Traction (normal, tangential) that earlier rounds and steps left, for augmented
      !> formulations, and that of the current iteration, stress units.
      real(wp) :: memory(2) = 0.0_wp, traction(2) = 0.0_wp
      !> How far the corner got behind its face in earlier rounds of the step, not positive: the
      !> face presses as if it stood before itself by that, length units.
      real(wp) :: shift = 0.0_wp
      !> Where the boundary holds tension: largest opening so far, before and after the step, length
      !> units; `untouched` before they first meet, `broken` once nothing holds any more.
      real(wp) :: opening = untouched, new_opening = untouched
      !> Is it settled for the step that the face reaches the corner? So it is beside sharp corners
      !> of tools, around which corners of bodies would come and go.
      logical :: is_settled = .false.
      !> Does the face reach it at the present unknowns, and how often has that changed in the step?
      logical :: is_reached = .false.
      integer :: n_changes = 0
      !> Is the corner held in both directions and also against being pulled off, and does it rub?
      logical :: is_bilateral = .false., is_fixed = .false., rubs = .false.
      !> Does the face act on it, and did it in the last step? Has a free tool just landed on it, so
      !> that it must act whatever its traction?
      logical :: is_acting = .false., was_acting = .false., has_landed = .false.
      !> Sign of its shear while it slips, 0 while it sticks; and in the last step.
      integer :: slip = 0, last_slip = 0
   end type contact_type

   !> All stations of a step, ordered by tile.
   type :: contacts_type
      !> Number of stations.
      integer :: n = 0
      !> The stations; only the first `n` are meaningful.
      type(contact_type), allocatable :: item(:)
      !> Corners of tools beside which faces end openly in the step; unallocated where none do.
      type(open_tip_type), allocatable :: open_tips(:)
   end type contacts_type

   !> A face reaches this far beyond its ends, over the spacing: a corner that sits at an end must
   !> not come and go with round-off.
   real(wp), parameter :: end_slack = 0.05_wp

contains

   !> Add a station at the end of the list.
   pure subroutine append_contact(contacts, contact)
      !> The list.
      type(contacts_type), intent(inout) :: contacts
      !> The station.
      type(contact_type), intent(in) :: contact
      type(contact_type), allocatable :: grown(:)

      if (contacts%n == size(contacts%item)) then
         allocate (grown(2*contacts%n))
         grown(:contacts%n) = contacts%item
         call move_alloc(grown, contacts%item)
      end if
      contacts%n = contacts%n + 1
      contacts%item(contacts%n) = contact
   end subroutine append_contact

   !> Give stations what the last step left at the same place.
   pure subroutine recall_contacts(contacts, last, motion, tiling)
      !> Stations to equip, ordered by edge.
      type(contacts_type), intent(inout) :: contacts
      !> Stations of the last accepted step, ordered by edge.
      type(contacts_type), intent(in) :: last
      !> How every boundary moves in the step, shape (n_boundaries).
      type(motion_type), intent(in) :: motion(:)
      !> Tiles at the start of the step.
      type(tiling_type), intent(in) :: tiling
      integer :: i, j, first

      first = 1
      do i = 1, contacts%n
         associate (new => contacts%item(i))
            do while (first <= last%n)
               if (last%item(first)%edge >= new%edge) exit
               first = first + 1
            end do
            do j = first, last%n
               if (last%item(j)%edge > new%edge) exit
               if (last%item(j)%end_of_edge /= new%end_of_edge) cycle
               if (last%item(j)%boundary /= new%boundary) cycle
               if (last%item(j)%segment /= new%segment .or. last%item(j)%tip /= new%tip) cycle
               new%memory = last%item(j)%traction
               new%was_acting = last%item(j)%is_acting
               new%last_slip = last%item(j)%slip
               if (new%rubs) new%lag = lag_after(motion(new%boundary), &
                                       tiling%position(:, new%corner), last%item(j)%new_lag)
            end do
         end associate
      end do
   end subroutine recall_contacts

   !> Way to a corner from the place where it sticks to a boundary, once that has moved.
   pure function lag_after(motion, corner, lag) result(way)
      !> How the boundary moves in the step.
      type(motion_type), intent(in) :: motion
      !> The corner, and its way before, length units.
      real(wp), intent(in) :: corner(2), lag(2)
      real(wp) :: way(2)

      way = corner - moved_by(motion, corner - lag)
      ! without rotation no digits may be lost
      if (.not. abs(motion%rotation) > 0.0_wp) way = lag - motion%translation
   end function lag_after

end module coulter_contact
