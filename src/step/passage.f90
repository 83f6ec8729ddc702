!> Finds corners of bodies that a step has taken through a wall or a tool, or off the face that
!> pushes them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_passage
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: turn
   use coulter_base_text, only: to_text
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type
   use coulter_boundary_motion, only: motion_type, moved_by
   use coulter_contact_cut, only: cut_type, open_tip_type
   use coulter_model, only: model_type
   use coulter_points_tiling, only: depth_in_tiles, tiling_type
   use coulter_system, only: system_type
   use coulter_system_contact_state, only: motion_of, whole_motion
   implicit none(type, external)
   private
   public :: check_passage

   !> Depth behind a face beyond which a corner has passed it, over the penalty band: overlaps of
   !> contacts are smaller. Over the spacing, it is at least what contacts bring back.
   real(wp), parameter :: passed = 0.5_wp, least_depth = 0.01_wp
   !> Corners that cross a face nearer to its ends than this, over the spacing, slide round them,
   !> unless the next face turns towards the material by an angle with more than this sine. Those
   !> less in front of a face than this, over the spacing, have been on it.
   real(wp), parameter :: near_end = 0.5_wp, pocket = 0.1_wp, on_face = 0.05_wp
   !> Corners of tools may be this deep in tiles, over the spacing; steps are not refused for it if
   !> their way is less than this share of that.
   real(wp), parameter :: cut_in = 0.02_wp, shortest = 0.2_wp

contains

   !> Refuse a step that has taken a corner of a body through a face of a wall or a tool: it was too
   !> large for a contact to see it.
   pure subroutine check_passage(model, system, failure)
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> System in equilibrium.
      type(system_type), intent(inout) :: system
      !> Which corner has passed what; unallocated when none has.
      character(len=:), allocatable, intent(inout) :: failure
      type(motion_type) :: motion
      type(face_type), allocatable :: faces(:)
      integer :: b, e

      call check_ends(model, system, failure)
      if (.not. allocated(failure)) call check_tips(model, system, failure)
      if (allocated(failure)) return
      do b = 1, size(model%boundaries)
         if (model%boundaries(b)%is_bilateral .or. .not. model%boundaries(b)%is_active) cycle
         motion = whole_motion(system, model, b)
         faces = moved_faces(model%boundaries(b), motion)
         do e = 1, size(model%tiling%outer_edge, 2)
            associate (corner => model%tiling%outer_edge(1, e))
               if (.not. has_passed(model%boundaries(b), faces, motion, &
                                    model%tiling%position(:, corner), &
                                    system%map%increment(:, corner), &
                                    model%grid%smallest_spacing())) cycle
               if (gives_way(system, corner, b)) cycle
               failure = "a corner of a body near ("//to_text(model%tiling%position(:, corner)) &
                  //") would pass through "//name_of(model%boundaries(b))
               return
            end associate
         end do
      end do
   end subroutine check_passage

   !> What a wall or a tool is called.
   pure function name_of(boundary) result(name)
      type(boundary_type), intent(in) :: boundary
      character(len=:), allocatable :: name

      name = "boundary "//boundary%name
      if (boundary%is_tool) name = "tool "//boundary%name
   end function name_of

   !> May a corner get behind faces of a boundary, near an open end of one?
   pure function gives_way(system, corner, boundary) result(answer)
      type(system_type), intent(in) :: system
      integer, intent(in) :: corner, boundary
      logical :: answer

      associate (contact => system%contacts%item(:system%contacts%n))
         answer = any(contact%corner == corner .and. contact%boundary == boundary &
                      .and. (contact%give > 0.0_wp .or. contact%leans))
      end associate
   end function gives_way

   !> Refuse a step in which a face that was settled to push a corner ends up far beside it: it has
   !> pushed on after it had gone. What gives may go.
   pure subroutine check_ends(model, system, failure)
      type(model_type), intent(in) :: model
      type(system_type), intent(in) :: system
      character(len=:), allocatable, intent(inout) :: failure
      type(place_type) :: place
      real(wp) :: moved(2, 2), slack
      integer :: k

      slack = near_end*model%grid%smallest_spacing()
      do k = 1, system%contacts%n
         associate (contact => system%contacts%item(k))
            if (.not. (contact%is_settled .and. contact%is_acting)) cycle
            if (contact%give > 0.0_wp .or. contact%leans) cycle
            moved = motion_of(system, contact)
            place = place_on(contact%face, contact%offset, moved(:, 1))
            if (place%distance >= -slack .and. place%distance <= contact%face%length + slack) cycle
            failure = name_of(model%boundaries(contact%boundary))//" would push a corner" &
               //" of a body near ("//to_text(model%tiling%position(:, contact%corner)) &
               //") that it has left"
            return
         end associate
      end do
   end subroutine check_ends

   !> Refuse a step in which a sharp corner of a tool passes the root of the cut before it and gets
   !> into a tile, since soil at the root did not come along as it did in the last step, or one that
   !> parts soil since this step, without a cut.
   pure subroutine check_tips(model, system, failure)
      type(model_type), intent(in) :: model
      type(system_type), intent(inout) :: system
      character(len=:), allocatable, intent(inout) :: failure
      type(tiling_type) :: tiling
      type(open_tip_type), allocatable :: tips(:)
      real(wp) :: tip(2), most
      integer :: i

      tips = tips_to_check(model, system)
      if (size(tips) == 0) return
      tiling = model%tiling
      tiling%position = tiling%position + system%map%increment
      most = cut_in*model%grid%smallest_spacing()
      do i = 1, size(tips)
         associate (place => model%boundaries(tips(i)%boundary)%vertices(:, tips(i)%vertex))
            tip = moved_by(whole_motion(system, model, tips(i)%boundary), place)
            if (norm2(tip - place) <= shortest*most) cycle
         end associate
         if (depth_in_tiles(tiling, tip, system%held_edges%boundary == 0) <= most) cycle
         system%must_recut = .true.
         failure = name_of(model%boundaries(tips(i)%boundary))//" would cut into a tile near (" &
            //to_text(tip)//")"
         return
      end do
   end subroutine check_tips

   !> Corners of tools before which tiles are, or can be, cut. Nothing helps where new tiles have
   !> not brought a root.
   pure function tips_to_check(model, system) result(tips)
      type(model_type), intent(in) :: model
      type(system_type), intent(in) :: system
      type(open_tip_type), allocatable :: tips(:)
      type(cut_type), allocatable :: cuts(:)
      integer :: i

      allocate (cuts(0))
      if (allocated(system%cuts)) cuts = system%cuts
      tips = pack(cuts%open_tip_type, cuts%corner > 0 .or. system%n_recuts == 0)
      if (.not. (allocated(system%contacts%open_tips) .and. model%control%may_retile)) return
      do i = 1, size(system%contacts%open_tips)
         associate (tip => system%contacts%open_tips(i))
            if (any(cuts%boundary == tip%boundary .and. cuts%vertex == tip%vertex)) cycle
            tips = [tips, tip]
         end associate
      end do
   end function tips_to_check

   !> Faces of a boundary at the end of the step.
   pure function moved_faces(boundary, motion) result(faces)
      type(boundary_type), intent(in) :: boundary
      type(motion_type), intent(in) :: motion
      type(face_type) :: faces(size(boundary%vertices, 2) - 1)
      integer :: s

      do s = 1, size(faces)
         call new_face(faces(s), moved_by(motion, boundary%vertices(:, s)), &
                       moved_by(motion, boundary%vertices(:, s + 1)), boundary%bulge(s))
      end do
   end function moved_faces

   !> Does a corner cross a face from its front and end up behind it?
   pure function has_passed(boundary, faces, motion, position, increment, spacing) result(answer)
      type(boundary_type), intent(in) :: boundary
      !> Its faces at the end of the step, and how it got there.
      type(face_type), intent(in) :: faces(:)
      type(motion_type), intent(in) :: motion
      real(wp), intent(in) :: position(2), increment(2), spacing
      logical :: answer
      type(place_type) :: before, after
      real(wp) :: depth
      integer :: s

      answer = .true.
      depth = max(passed*boundary%band_ratio, least_depth)*spacing
      do s = 1, size(faces)
         associate (face => faces(s))
            after = place_on(face, position - face%first, increment)
            if (after%gap > -depth) cycle
            before = place_on(face, moved_by(motion, position) - face%first, [0.0_wp, 0.0_wp])
            if (before%gap < -depth) cycle
            if (.not. any(slides_off(face, before, after, spacing, &
                                     [is_pocket(boundary%vertices, s - 1), &
                                      is_pocket(boundary%vertices, s)]))) return
         end associate
      end do
      answer = .false.
   end function has_passed

   !> Does a corner cross a face near its first, or its last end? One that has been on the face may
   !> come from farther away, if it leaves beyond the end. In a pocket,
   !> neither is near enough.
   pure function slides_off(face, before, after, spacing, pockets) result(answer)
      type(face_type), intent(in) :: face
      !> Place of the corner before and after the step, as seen from the face.
      type(place_type), intent(in) :: before, after
      real(wp), intent(in) :: spacing
      !> Does the face form a pocket with the one before it, and with the next one?
      logical, intent(in) :: pockets(2)
      logical :: answer(2)
      real(wp) :: crossing, from_end(3, 2)

      crossing = (max(before%gap, 0.0_wp)*after%distance &
                  - min(after%gap, 0.0_wp)*before%distance) &
         /(max(before%gap, 0.0_wp) - min(after%gap, 0.0_wp))
      from_end(:, 1) = [before%distance, crossing, after%distance]
      from_end(:, 2) = face%length - from_end(:, 1)
      answer = from_end(2, :) < near_end*spacing .or. (before%gap < on_face*spacing &
               .and. from_end(1, :) < 2.0_wp*near_end*spacing .and. from_end(3, :) < 0.0_wp)
      answer = merge(from_end(2, :) < 0.0_wp, answer, pockets)
   end function slides_off

   !> Do two faces that follow each other turn towards the material, on their left?
   pure function is_pocket(vertices, s) result(answer)
      real(wp), intent(in) :: vertices(:, :)
      !> The first of both.
      integer, intent(in) :: s
      logical :: answer

      answer = .false.
      if (s < 1 .or. s > size(vertices, 2) - 2) return
      associate (corner => vertices(:, s:s + 2))
         answer = turn(corner(:, 1), corner(:, 2), corner(:, 3)) &
            > pocket*norm2(corner(:, 2) - corner(:, 1))*norm2(corner(:, 3) - corner(:, 2))
      end associate
   end function is_pocket

end module coulter_step_passage
