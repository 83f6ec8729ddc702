!> What boundaries do in a step, as the search for contacts needs it: their motion, how far they
!> look, and the sharp corners of tools.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_approach
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type
   use coulter_boundary_motion, only: largest_shift, motion_type
   use coulter_boundary_plate, only: find_plates, find_thicknesses
   use coulter_contact, only: contacts_type, end_slack
   use coulter_contact_cut, only: cut_type, open_tip_type
   use coulter_contact_round_tip, only: add_round_tips
   use coulter_contact_tip, only: find_tips, tip_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: approach_type, look_ahead, find_roots, list_open_tips

   !> What a boundary does in the step, and how far it looks for edges.
   type :: approach_type
      !> Number of the boundary.
      integer :: number = 0
      !> How it moves, and may it turn in the step?
      type(motion_type) :: motion
      logical :: may_turn = .false.
      !> Its sharp corners, if it is a tool.
      type(tip_type), allocatable :: tips(:)
      !> A plate with bodies on both sides: how thick it is behind every face, length units; else
      !> unallocated.
      real(wp), allocatable :: thickness(:)
      !> Edges farther away than `reach` or behind a face by more than `deepest` cannot be met;
      !> faces reach `slack` beyond their ends; spacing of the grid, length units.
      real(wp) :: reach = 0.0_wp, deepest = 0.0_wp, slack = 0.0_wp, spacing = 0.0_wp
   end type approach_type

   !> Faces this far away may be met within a step, over the spacing.
   real(wp), parameter :: reach = 4.0_wp
   !> Edges deeper behind a face than this, over the spacing, and the way that the face has come in
   !> the step belong to something else.
   real(wp), parameter :: deepest = 1.0_wp
   !> A corner of a tool this near to a face of another one abuts on it, over the spacing, if the
   !> product of the normals of both faces is more than this.
   real(wp), parameter :: abutting = 1.0e-6_wp, same_way = 0.99_wp

contains

   !> What every boundary does in the step.
   pure subroutine look_ahead(approach, boundaries, motion, tiling, spacing)
      !> One for every boundary.
      type(approach_type), intent(inout) :: approach(:)
      !> Boundaries at the start of the step.
      type(boundary_type), intent(in) :: boundaries(:)
      !> How every boundary moves in the step, shape (n_boundaries).
      type(motion_type), intent(in) :: motion(:)
      !> Tiles at the start of the step.
      type(tiling_type), intent(in) :: tiling
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      real(wp) :: shift(size(boundaries))
      type(face_type), allocatable :: sides(:)
      integer :: b

      do b = 1, size(boundaries)
         shift(b) = largest_shift(motion(b), boundaries(b)%vertices)
         approach(b)%number = b
         approach(b)%motion = motion(b)
         approach(b)%may_turn = abs(motion(b)%rotation) > 0.0_wp .or. boundaries(b)%turns_freely
         call find_plates(sides, boundaries(b:b), tiling%position, spacing)
         if (size(sides) > 0) call find_thicknesses(approach(b)%thickness, sides, boundaries(b))
         call find_tips(approach(b)%tips, boundaries(b), tiling, spacing)
         call close_abutting_ends(approach(b)%tips, boundaries, b, tiling, spacing)
         call add_round_tips(approach(b)%tips, boundaries(b), tiling, spacing)
      end do
      approach%reach = reach*spacing + 2.0_wp*maxval([0.0_wp, shift])
      approach%deepest = deepest*spacing + shift
      approach%slack = end_slack*spacing
      approach%spacing = spacing
   end subroutine look_ahead

   !> Find the corners of bodies to which these are cut ahead of corners of tools.
   pure subroutine find_roots(approach, cuts)
      !> What boundaries do; their corners get roots.
      type(approach_type), intent(inout) :: approach(:)
      !> Cuts ahead of corners of tools.
      type(cut_type), intent(in) :: cuts(:)
      integer :: i

      do i = 1, size(cuts)
         associate (tips => approach(cuts(i)%boundary)%tips)
            where (tips%vertex == cuts(i)%vertex .and. .not. tips%is_round) &
               tips%root = cuts(i)%corner
         end associate
      end do
   end subroutine find_roots

   !> Note the sharp corners of tools beside which faces end openly.
   pure subroutine list_open_tips(contacts, approach)
      !> Stations that get the list.
      type(contacts_type), intent(inout) :: contacts
      !> What boundaries do.
      type(approach_type), intent(in) :: approach(:)
      type(open_tip_type), allocatable :: list(:)
      integer :: b, i

      allocate (list(0))
      do b = 1, size(approach)
         do i = 1, size(approach(b)%tips)
            associate (tip => approach(b)%tips(i))
               ! rounded corners have no tiles cut ahead
               if (tip%is_round .or. .not. any(tip%is_open)) cycle
               list = [list, open_tip_type(b, tip%vertex, tip%cuts)]
            end associate
         end do
      end do
      if (size(list) > 0) contacts%open_tips = list
   end subroutine list_open_tips

   !> Where a face of another tool carries on from the end of a face, that is not open: the body
   !> does not go on beyond it without a tool. Corners of the body at such a place need no tip.
   pure subroutine close_abutting_ends(tips, boundaries, b, tiling, spacing)
      !> Sharp corners of a tool.
      type(tip_type), allocatable, intent(inout) :: tips(:)
      type(boundary_type), intent(in) :: boundaries(:)
      !> Number of the tool.
      integer, intent(in) :: b
      type(tiling_type), intent(in) :: tiling
      real(wp), intent(in) :: spacing
      logical :: does_abut(2), is_kept(size(tips))
      real(wp) :: ends(2, 2)
      integer :: c, i

      is_kept = .true.
      do i = 1, size(tips)
         do c = 1, size(boundaries)
            if (c == b .or. .not. (boundaries(c)%is_tool .and. boundaries(c)%is_active)) cycle
            does_abut = carries_on(boundaries(c), boundaries(b)%vertices(:, tips(i)%vertex), &
                                   tips(i)%normal, abutting*spacing)
            tips(i)%is_open = tips(i)%is_open .and. .not. does_abut
            if (.not. any(does_abut)) cycle
            ends = tiling%position(:, tiling%outer_edge(:2, tips(i)%edge))
            is_kept(i) = min(tips(i)%share, 1.0_wp - tips(i)%share) &
               *norm2(ends(:, 2) - ends(:, 1)) > end_slack*spacing
         end do
      end do
      if (.not. all(is_kept)) tips = pack(tips, is_kept)
   end subroutine close_abutting_ends

   !> Does a face of a tool that looks the same way as one of two others pass through a place?
   pure function carries_on(tool, place, normal, slack) result(answer)
      type(boundary_type), intent(in) :: tool
      !> Place, normals of the other faces, and distance below which it is on the face.
      real(wp), intent(in) :: place(2), normal(2, 2), slack
      logical :: answer(2)
      type(face_type) :: face
      type(place_type) :: foot
      integer :: s

      answer = .false.
      do s = 1, size(tool%vertices, 2) - 1
         call new_face(face, tool%vertices(:, s), tool%vertices(:, s + 1), tool%bulge(s))
         foot = place_on(face, place - face%first, [0.0_wp, 0.0_wp])
         if (abs(foot%gap) > slack .or. foot%distance < -slack &
             .or. foot%distance > face%length + slack) cycle
         answer = answer .or. matmul(foot%normal, normal) > same_way
      end do
   end function carries_on

end module coulter_contact_approach
