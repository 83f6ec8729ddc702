!> Parts of bodies that have come apart and are held by nothing: a drag keeps the system regular.
!>
!> A part that no fixity and no boundary holds for good has no place of its own in equilibrium. Its
!> tiles resist motion in a step, not place: without weight by so little that tools do not feel it,
!> with weight so that it sinks by half a cell a step until something carries it; then the drag is
!> gone (theory, section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly_loose_parts
   use coulter_assembly_tile_scatter, only: add_at_corners, scatter_tile
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_model, only: model_type, point_moduli
   use coulter_model_observer, only: add_warning, step_report_type
   use coulter_points_parts, only: find_parts, part_type
   use coulter_points_tiling, only: values_at
   use coulter_system, only: system_type
   implicit none(type, external)
   private
   public :: find_loose_parts, add_drag, name_loose_parts, name_toppling, text_of_parts
   public :: settling_drag_of

   !> Drag per area and motion over the shear modulus and the square of the spacing.
   real(wp), parameter :: softest = 1.0e-6_wp
   !> Way in a step of a part that sinks, over the spacing.
   real(wp), parameter :: sinking = 0.5_wp

contains

   !> Find the tiles of loose parts, once a body has come apart. The largest part of a body is not
   !> slowed down by its weight: walls that only push may carry it.
   subroutine find_loose_parts(system, model)
      !> Numbered system; gets `drag`.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      type(part_type), allocatable :: parts(:)
      integer :: part(model%points%n_points), b, k, p
      logical, allocatable :: is_held(:)
      real(wp) :: drag(model%points%n_points)

      if (allocated(system%drag)) deallocate (system%drag)
      if (.not. system%has_come_apart) return
      call find_parts(parts, model%tiling, model%points%body, size(model%bodies), part)
      allocate (is_held(size(parts)))
      call find_held(system, model, part, is_held)
      drag = 0.0_wp
      do k = 1, size(parts)
         b = parts(k)%body
         if (is_held(k) .or. count(parts%body == b) == 1) cycle
         do p = 1, size(drag)
            if (part(p) == k) drag(p) = drag_of(model, p, parts(k)%area < maxval(parts%area, &
                                                                      mask=parts%body == b))
         end do
      end do
      if (any(drag > 0.0_wp)) system%drag = drag
   end subroutine find_loose_parts

   !> Which parts do fixities or bilateral boundaries hold?
   pure subroutine find_held(system, model, part, is_held)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      !> Part of every tile, shape (n_tiles).
      integer, intent(in) :: part(:)
      logical, intent(out) :: is_held(:)
      integer :: b, e, p, v

      is_held = .false.
      do p = 1, size(part)
         do v = 1, 4
            associate (node => system%map%node(:, model%tiling%corner(v, p)))
               if (any(system%dofs%fixity(:, node) > 0)) is_held(part(p)) = .true.
            end associate
         end do
      end do
      do e = 1, size(system%held_edges)
         b = system%held_edges(e)%boundary
         if (b == 0) cycle
         if (model%boundaries(b)%is_active) is_held(part(model%tiling%outer_edge(3, e))) = .true.
      end do
   end subroutine find_held

   !> Drag on a tile per area and motion, stress over squared length.
   pure function drag_of(model, p, sinks) result(drag)
      type(model_type), intent(in) :: model
      integer, intent(in) :: p
      !> Does it depend on the weight?
      logical, intent(in) :: sinks
      real(wp) :: drag
      real(wp) :: lame_lambda, shear_modulus

      call point_moduli(model, p, lame_lambda, shear_modulus)
      associate (h => model%grid%smallest_spacing(), &
                 density => model%bodies(model%points%body(p))%density/model%points%volume_ratio(p))
         drag = softest*shear_modulus/h**2
         if (sinks) drag = drag + density*norm2(model%body_force%acceleration)/(sinking*h)
      end associate
   end function drag_of

   !> Forces and tangent of the drag, shared evenly by the vertices of every tile.
   pure subroutine add_drag(system, model, at_corners)
      !> System at the present unknowns; gets `stars`.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Forces on the corners, shape (2, n_corners).
      real(wp), intent(inout) :: at_corners(:, :)
      real(wp) :: stiffness(2, 4, 2, 4), share
      integer :: i, p, v

      do p = 1, model%points%n_points
         share = 0.0_wp
         if (allocated(system%drag)) share = system%drag(p)
         if (system%settling_drag > 0.0_wp) share = share + settling_drag_of(system, model, p)
         if (.not. share > 0.0_wp) cycle
         share = 0.25_wp*share*system%map%area(p)
         associate (corner => model%tiling%corner(:, p))
            call add_at_corners(corner, share*values_at(corner, system%map%increment), at_corners)
         end associate
         stiffness = 0.0_wp
         do v = 1, 4
            do i = 1, 2
               stiffness(i, v, i, v) = share
            end do
         end do
         call scatter_tile(system, p, stiffness)
      end do
   end subroutine add_drag

   !> Drag on a tile of a body that settles, per area and motion, stress over squared length.
   pure function settling_drag_of(system, model, p) result(drag)
      !> System while bodies settle.
      type(system_type), intent(in) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> The tile.
      integer, intent(in) :: p
      real(wp) :: drag
      real(wp) :: lame_lambda, shear_modulus

      call point_moduli(model, p, lame_lambda, shear_modulus)
      drag = system%settling_drag*shear_modulus/model%grid%smallest_spacing()**2
   end function settling_drag_of

   !> Say how many tiles of which bodies are loose, when that has changed.
   pure subroutine name_loose_parts(report, model, system)
      !> Report of the step.
      type(step_report_type), intent(inout) :: report
      !> Scene, still with the tiles of the step.
      type(model_type), intent(in) :: model
      !> Its system; remembers what has been named.
      type(system_type), intent(inout) :: system
      integer :: b, n
      real(wp) :: area

      n = 0
      if (allocated(system%drag)) n = count(system%drag > 0.0_wp)
      if (n == 0 .eqv. .not. system%has_named_loose) return
      system%has_named_loose = n > 0
      if (n == 0) call add_warning(report%warnings, "all parts are held again")
      do b = 1, size(model%bodies)
         if (n == 0) exit
         area = sum(system%map%area, mask=system%drag > 0.0_wp .and. model%points%body == b)
         if (.not. area > 0.0_wp) cycle
         call add_warning(report%warnings, "parts of body "//model%bodies(b)%name//" of area " &
                          //to_text(area, 3)//" are held by no fixity and no bilateral boundary:" &
                          //" a drag keeps their place")
      end do
   end subroutine name_loose_parts

   !> Say which body topples or slips, and where it moves most, when it begins to settle after it
   !> has come apart.
   pure subroutine name_toppling(report, model, system)
      !> Report of the step.
      type(step_report_type), intent(inout) :: report
      !> Scene, still with the tiles of the step.
      type(model_type), intent(in) :: model
      !> Its system; remembers what has been named.
      type(system_type), intent(inout) :: system
      integer :: c, p

      if (.not. system%has_come_apart) return
      if (system%has_named_toppling .eqv. system%n_settling > 0) return
      system%has_named_toppling = system%n_settling > 0
      if (.not. system%has_named_toppling) return
      c = maxloc(norm2(system%map%increment, dim=1), dim=1)
      p = findloc(any(model%tiling%corner == c, dim=1), .true., dim=1)
      call add_warning(report%warnings, "a part of body "//model%bodies(model%points%body(p))%name &
                       //" near ("//to_text(model%points%position(:, p))//") topples or slips: it" &
                       //" settles against a drag until it is at rest")
   end subroutine name_toppling

   !> What a message about a step that failed says of loose parts: the largest one; nothing if there
   !> are none.
   pure function text_of_parts(model, system) result(text)
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Its system.
      type(system_type), intent(in) :: system
      character(len=:), allocatable :: text
      type(part_type), allocatable :: parts(:)
      integer :: part(model%points%n_points), k

      text = ""
      if (.not. allocated(system%drag)) return
      if (size(system%drag) /= size(part)) return
      call find_parts(parts, model%tiling, model%points%body, size(model%bodies), part)
      k = maxloc(parts%area, dim=1, mask=[(any(part == k .and. system%drag > 0.0_wp), &
                                           k=1, size(parts))])
      if (k == 0) return
      text = "; the part of body "//model%bodies(parts(k)%body)%name//" near (" &
         //to_text(parts(k)%centroid)//") has come apart and is held by contact alone"
   end function text_of_parts

end module coulter_assembly_loose_parts
