!> Surfaces of bodies that meet in a step: those that have come within a cell of each other move as
!> one, since the grid carries both along; those that would overlap end the step.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_meetings
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_boundary, only: boundary_type
   use coulter_boundary_face, only: face_type, new_face, place_on, place_type
   use coulter_boundary_motion, only: motion_type, moved_by
   use coulter_model, only: model_type
   use coulter_model_observer, only: add_warning, step_report_type
   use coulter_points_folds, only: find_folds, fold_type
   use coulter_points_outline, only: edges_of, encloses, outline_type, &
      trace_outline
   use coulter_retile_outline_union, only: bridge_gaps, unite_loops
   use coulter_system, only: system_type
   use coulter_system_contact_state, only: whole_motion
   implicit none(type, external)
   private
   public :: find_meetings, report_meetings, join_surfaces, report_joints, do_overlap

   !> Surfaces nearer than this meet, over the spacing.
   real(wp), parameter :: reach = 1.0_wp
   !> Overlaps deeper than these, over the spacing, end a step and ask for new tiles.
   real(wp), parameter :: deepest = 0.25_wp, tolerated = 0.05_wp
   !> Surfaces nearer than this touch and are joined by new tiles; bulges that bridge the gap go
   !> this far beyond its middle, over the spacing.
   real(wp), parameter :: touching = 0.2_wp, bridging = 0.02_wp
   !> Lengths that meet are named anew when they have grown by this factor.
   real(wp), parameter :: growth = 2.0_wp

contains

   !> Find surfaces that meet at the end of a step; refuse one in which they overlap.
   pure subroutine find_meetings(system, model, failure)
      !> System in equilibrium; gets `folds`.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Which bodies would overlap; unallocated when none would.
      character(len=:), allocatable, intent(inout) :: failure
      type(fold_type), allocatable :: folds(:)
      integer :: b, k

      associate (h => model%grid%smallest_spacing())
         call find_folds(folds, model%tiling%position + system%map%increment, &
                         model%tiling%outer_edge, reach*h)
         do b = 1, size(model%boundaries)
            call drop_separated(folds, model%boundaries(b), whole_motion(system, model, b))
         end do
         do k = 1, size(folds)
            associate (body => model%points%body(model%tiling%outer_edge(3, folds(k)%edge)))
               folds(k)%body = [minval(body), maxval(body)]
            end associate
         end do
         if (size(model%body_contacts) > 0) call drop_contacts(folds, model, deepest*h)
         k = minloc(folds%gap, dim=1)
         call move_alloc(folds, system%folds)
         if (k == 0) return
         if (system%folds(k)%gap > -deepest*h) return
         failure = names_of(model, system%folds(k))//" would overlap near (" &
            //to_text(system%folds(k)%place)//"), by "//to_text(-system%folds(k)%gap, 2)
      end associate
   end subroutine find_meetings

   !> Leave out surfaces of bodies that press against each other, unless they overlap too far.
   pure subroutine drop_contacts(folds, model, depth)
      type(fold_type), allocatable, intent(inout) :: folds(:)
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: depth
      integer :: k

      folds = pack(folds, [(.not. are_apart(model, folds(k)%body) .or. folds(k)%gap <= -depth, &
                            k=1, size(folds))])
   end subroutine drop_contacts

   !> Do surfaces of two bodies, or of one, press against each other?
   pure function are_apart(model, body) result(answer)
      type(model_type), intent(in) :: model
      integer, intent(in) :: body(2)
      logical :: answer

      answer = model%bodies(body(1))%field /= model%bodies(body(2))%field
      if (body(1) == body(2)) answer = model%bodies(body(1))%meets_itself
   end function are_apart

   !> Leave out surfaces with a face of a tool between them.
   pure subroutine drop_separated(folds, boundary, motion)
      type(fold_type), allocatable, intent(inout) :: folds(:)
      type(boundary_type), intent(in) :: boundary
      type(motion_type), intent(in) :: motion
      integer :: k

      if (size(folds) == 0 .or. .not. (boundary%is_tool .and. boundary%is_active)) return
      folds = pack(folds, [(.not. lies_between(boundary, motion, folds(k)), k=1, size(folds))])
   end subroutine drop_separated

   !> Make one of the parts of an outline that touch or overlap.
   pure subroutine join_surfaces(outline, model, least_area)
      !> Outline of a body.
      type(outline_type), intent(inout) :: outline
      !> Scene with its tools.
      type(model_type), intent(in) :: model
      !> Smallest area of a loop that is kept.
      real(wp), intent(in) :: least_area
      type(fold_type), allocatable :: folds(:)
      integer :: b

      associate (h => model%grid%smallest_spacing())
         call find_folds(folds, outline%corner, edges_of(outline), touching*h)
         do b = 1, size(model%boundaries)
            call drop_separated(folds, model%boundaries(b), motion_type())
         end do
         if (size(folds) == 0) return
         call bridge_gaps(outline, folds, bridging*h)
         call unite_loops(outline, least_area, touching*h)
      end associate
   end subroutine join_surfaces

   !> Is a face of a tool between two surfaces?
   pure function lies_between(tool, motion, fold) result(answer)
      type(boundary_type), intent(in) :: tool
      type(motion_type), intent(in) :: motion
      type(fold_type), intent(in) :: fold
      logical :: answer
      type(face_type) :: face
      type(place_type) :: place(2)
      integer :: k, s

      answer = .false.
      do s = 1, size(tool%vertices, 2) - 1
         call new_face(face, moved_by(motion, tool%vertices(:, s)), &
                       moved_by(motion, tool%vertices(:, s + 1)), tool%bulge(s))
         do k = 1, 2
            place(k) = place_on(face, fold%ends(:, k) - face%first, [0.0_wp, 0.0_wp])
         end do
         answer = maxval(place%gap) > -0.5_wp*fold%gap .and. minval(place%gap) < -0.5_wp*fold%gap &
            .and. minval(place%distance) >= 0.0_wp .and. maxval(place%distance) <= face%length
         if (answer) return
      end do
   end function lies_between

   !> Body, or both bodies, whose surfaces meet.
   pure function names_of(model, fold) result(names)
      type(model_type), intent(in) :: model
      type(fold_type), intent(in) :: fold
      character(len=:), allocatable :: names

      associate (first => model%bodies(fold%body(1))%name, last => model%bodies(fold%body(2))%name)
         if (fold%body(1) == fold%body(2)) then
            names = "parts of body "//first
         else
            names = "bodies "//first//" and "//last
         end if
      end associate
   end function names_of

   !> Do surfaces overlap by more than round-off of chords?
   pure function do_overlap(system, spacing) result(answer)
      !> System at the end of a step.
      type(system_type), intent(in) :: system
      !> Grid spacing.
      real(wp), intent(in) :: spacing
      logical :: answer

      answer = any(system%folds%gap < -tolerated*spacing)
   end function do_overlap

   !> Length of surface that meets other surface, and a warning for every pair of bodies when it
   !> begins and each time that it has doubled.
   pure subroutine report_meetings(report, model, system)
      !> Report of the step; gets `met_length`.
      type(step_report_type), intent(inout) :: report
      !> Scene at the end of the step.
      type(model_type), intent(in) :: model
      !> Its system; remembers what has been named.
      type(system_type), intent(inout) :: system
      real(wp) :: length
      integer :: a, b, k

      if (.not. allocated(system%folds)) return
      if (size(system%folds) == 0) return
      if (.not. allocated(system%named_length)) then
         allocate (system%named_length(size(model%bodies), size(model%bodies)), source=0.0_wp)
      end if
      do b = 1, size(model%bodies)
         do a = 1, b
            call measure_pair(system, model, [a, b], length, k)
            report%met_length = report%met_length + length
            if (.not. length > growth*system%named_length(a, b)) cycle
            system%named_length(a, b) = length
            call add_warning(report%warnings, names_of(model, system%folds(k)) &
                             //" have met near ("//to_text(system%folds(k)%place)//"), along " &
                             //to_text(length, 3)//": within a cell of each other they stick")
         end do
      end do
   end subroutine report_meetings

   !> Length along which two bodies meet, and the fold where they are nearest.
   pure subroutine measure_pair(system, model, pair, length, nearest)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair(2)
      real(wp), intent(out) :: length
      integer, intent(out) :: nearest
      logical :: is_counted(size(model%tiling%outer_edge, 2))
      integer :: i, k

      length = 0.0_wp
      nearest = 0
      is_counted = .false.
      do k = 1, size(system%folds)
         associate (fold => system%folds(k))
            if (any(fold%body /= pair)) cycle
            if (nearest == 0) nearest = k
            if (fold%gap < system%folds(nearest)%gap) nearest = k
            do i = 1, 2
               if (is_counted(fold%edge(i))) cycle
               is_counted(fold%edge(i)) = .true.
               associate (ends => model%tiling%position(:, model%tiling%outer_edge(:2, &
                                                                                  fold%edge(i))))
                  length = length + 0.5_wp*norm2(ends(:, 2) - ends(:, 1))
               end associate
            end do
         end associate
      end do
   end subroutine measure_pair

   !> Say where new tiles fill the gap between surfaces that have met.
   pure subroutine report_joints(report, model, folds)
      !> Report of the step.
      type(step_report_type), intent(inout) :: report
      !> Scene with new tiles.
      type(model_type), intent(in) :: model
      !> Surfaces that met before.
      type(fold_type), intent(in) :: folds(:)
      type(outline_type) :: outline
      integer :: k, n, first

      if (size(folds) == 0) return
      call trace_outline(outline, model%tiling%position, model%tiling%outer_edge, 0.0_wp)
      n = 0
      first = 0
      do k = size(folds), 1, -1
         if (.not. encloses(outline, folds(k)%place)) cycle
         n = n + 1
         first = k
      end do
      if (n == 0) return
      call add_warning(report%warnings, names_of(model, folds(first))//" are joined by new tiles" &
                       //" near ("//to_text(folds(first)%place)//"), at "//to_text(n)//" of " &
                       //to_text(size(folds))//" pairs of edges that have met")
   end subroutine report_joints

end module coulter_retile_meetings
