!> How far the cut before a corner of a tool that parts material must lead, so that the corner
!> reaches its root at the end of the next step, and is in no tile then.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_leads
   use coulter_base_kinds, only: wp
   use coulter_boundary_motion, only: followed_by, motion_type, moved_by
   use coulter_model, only: boundary_motion, model_type
   use coulter_points_tiling, only: depth_in_tiles
   use coulter_system, only: system_type
   use coulter_system_contact_state, only: whole_motion
   use coulter_contact_cut, only: cut_type
   use coulter_contact_tip, only: faces_at, look_at_corner
   implicit none(type, external)
   private
   public :: look_ahead, next_time, are_cuts_due, note_roots, note_motions

   !> New tiles are due if a corner of a tool gets deeper into one than this in the next step, over
   !> the spacing.
   real(wp), parameter :: cut_in = 0.009_wp
   !> By how much roots are to be passed, over the spacing.
   real(wp), parameter :: short = 0.0075_wp
   !> Share of the way of a root behind a face that is left out.
   real(wp), parameter :: left_out = 0.25_wp
   !> Corners of bodies this near to where the root of a cut must be are the root, over the spacing.
   real(wp), parameter :: near = 0.05_wp

contains

   !> Note what the roots of cuts have done in a step, and how far the tips have gone; what is known
   !> of others stays.
   pure subroutine note_motions(system, model)
      !> System in equilibrium.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      integer :: i

      do i = 1, size(system%cuts)
         associate (cut => system%cuts(i))
            if (cut%corner == 0) cycle
            cut%way = norm2(moved_by(whole_motion(system, model, cut%boundary), cut%tip) - cut%tip)
            cut%motion = system%map%increment(:, cut%corner)
         end associate
      end do
   end subroutine note_motions

   !> Find the cuts that the next step needs: the way of every tip in it, less what the soil at the
   !> root does meanwhile, as far as the last step tells.
   pure subroutine look_ahead(system, model, end_time)
      !> System of the step that has ended, or been refused; gets `cuts`.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the next step.
      type(model_type), intent(in) :: model
      !> When that will end.
      real(wp), intent(in) :: end_time
      type(cut_type), allocatable :: last(:)
      integer :: i

      if (.not. (model%control%may_retile .and. allocated(system%contacts%open_tips))) then
         if (allocated(system%cuts)) deallocate (system%cuts)
         return
      end if
      allocate (last(0))
      if (allocated(system%cuts)) last = system%cuts
      if (allocated(system%cuts)) deallocate (system%cuts)
      allocate (system%cuts(size(system%contacts%open_tips)))
      do i = 1, size(system%cuts)
         system%cuts(i)%open_tip_type = system%contacts%open_tips(i)
         call place_cut(system%cuts(i), last, system, model, end_time)
      end do
   end subroutine look_ahead

   !> Where the root of a cut must be at the start of the next step.
   pure subroutine place_cut(cut, last, system, model, end_time)
      type(cut_type), intent(inout) :: cut
      !> Cuts of the step before.
      type(cut_type), intent(in) :: last(:)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: end_time
      real(wp) :: way(2)
      integer :: i

      cut%tip = model%boundaries(cut%boundary)%vertices(:, cut%vertex)
      way = moved_by(next_motion(system, model, cut%boundary, end_time), cut%tip) - cut%tip
      cut%place = cut%tip + way
      do i = 1, size(last)
         if (last(i)%boundary /= cut%boundary .or. last(i)%vertex /= cut%vertex) cycle
         if (.not. last(i)%way > 0.0_wp) cycle
         ! known until the next equilibrium: the next step may have none
         cut%way = last(i)%way
         cut%motion = last(i)%motion
         cut%place = cut%place - norm2(way)/cut%way*cut%motion
      end do
      call stay_in_front(cut, model)
      ! the face beside a tip that just does not reach its root would have nothing to press on
      way = cut%place - cut%tip
      if (norm2(way) > 0.0_wp) cut%place = cut%tip &
         + max(0.0_wp, 1.0_wp - short*model%grid%smallest_spacing()/norm2(way))*way
   end subroutine place_cut

   !> Roots behind the face along which a tool slides let it press on soil that it must push aside,
   !> which then moves so that the next root would be there again: a part of that motion is not
   !> believed, so that what is not soil's own dies out.
   pure subroutine stay_in_front(cut, model)
      type(cut_type), intent(inout) :: cut
      type(model_type), intent(in) :: model
      real(wp) :: normal(2, 2)
      logical :: is_sharp
      integer :: k

      associate (tool => model%boundaries(cut%boundary))
         call look_at_corner(tool, faces_at(tool, cut%vertex), is_sharp, normal)
      end associate
      do k = 1, 2
         cut%place = cut%place - left_out*min(0.0_wp, dot_product(normal(:, k), &
                                                                  cut%place - cut%tip))*normal(:, k)
      end do
   end subroutine stay_in_front

   !> How a boundary will move in the next step: free ones as in the last one.
   pure function next_motion(system, model, boundary, end_time) result(motion)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      integer, intent(in) :: boundary
      real(wp), intent(in) :: end_time
      type(motion_type) :: motion, free
      real(wp) :: ratio

      motion = boundary_motion(model, boundary, model%time, end_time)
      if (system%border%n == 0 .or. .not. system%end_time > system%start_time) return
      ratio = (end_time - model%time)/(system%end_time - system%start_time)
      free = system%border%motion(boundary)
      free%translation = ratio*free%translation
      free%rotation = ratio*free%rotation
      motion = followed_by(motion, free)
   end function next_motion

   !> When the next step will end if it succeeds: the next load step, or another part of one that
   !> has been halved.
   pure function next_time(model, duration) result(time)
      !> Scene at the end of a step.
      type(model_type), intent(in) :: model
      !> Duration of the last step.
      real(wp), intent(in) :: duration
      real(wp) :: time
      integer :: k

      time = model%time
      associate (ends => model%schedule%end_time(:model%schedule%n_steps()))
         k = findloc(ends > model%time, .true., dim=1)
         if (k == 0) return
         time = ends(k)
         if (k > 1) then
            if (model%time > ends(k - 1)) time = min(time, model%time + duration)
         else if (model%time > 0.0_wp) then
            time = min(time, model%time + duration)
         end if
      end associate
   end function next_time

   !> Would a tip be in a tile at the end of the next step?
   pure function are_cuts_due(system, model) result(answer)
      !> The system, with `cuts`.
      type(system_type), intent(in) :: system
      !> Scene at the end of the last step.
      type(model_type), intent(in) :: model
      logical :: answer
      integer :: i

      answer = .false.
      if (.not. allocated(system%cuts)) return
      do i = 1, size(system%cuts)
         answer = depth_in_tiles(model%tiling, system%cuts(i)%place, &
                                 system%held_edges%boundary == 0) &
            > cut_in*model%grid%smallest_spacing()
         if (answer) return
      end do
   end function are_cuts_due

   !> Note which corners of the tiles are the roots of cuts.
   pure subroutine note_roots(system, model)
      !> The system.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the next step.
      type(model_type), intent(in) :: model
      real(wp) :: distance, nearest
      integer :: i, e

      if (.not. allocated(system%cuts)) return
      do i = 1, size(system%cuts)
         associate (cut => system%cuts(i))
            cut%corner = 0
            nearest = near*model%grid%smallest_spacing()
            do e = 1, size(model%tiling%outer_edge, 2)
               associate (c => model%tiling%outer_edge(1, e))
                  distance = norm2(model%tiling%position(:, c) - cut%place)
                  if (distance >= nearest) cycle
                  nearest = distance
                  cut%corner = c
               end associate
            end do
         end associate
      end do
   end subroutine note_roots

end module coulter_retile_leads
