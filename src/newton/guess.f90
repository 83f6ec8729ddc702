!> A first guess of the motion of a step: that of the last one goes on.
!>
!> The grid stands still while material flows through it, so that the field of the last step is
!> known where it is needed, whatever has become of the tiles. In steady flow it is all but the
!> answer, and points that flow are found to flow in the first tangent.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_newton_guess
   use coulter_base_bins, only: bins_type, new_bins
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_points_tiling, only: tile_centroid, tiling_type
   use coulter_system, only: system_type
   use coulter_system_border, only: free_motions
   implicit none(type, external)
   private
   public :: guess_motion, remember_motion, forget_motion, carry_motion

   !> A field that moves on by more than this share of the spacing is no guess.
   real(wp), parameter :: farthest = 0.5_wp
   !> Old tiles are looked for as far as this, over the spacing.
   real(wp), parameter :: nearest_tile = 1.5_wp

contains

   !> Unknowns at which Newton's method begins: zero, or the last motion over the length of the
   !> step. A node that took no part then moves like its neighbours.
   pure subroutine guess_motion(system, model, unknowns, has_guess)
      !> Numbered system.
      type(system_type), intent(in) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Nodal unknowns, then free motions of tools, length units, shape (n_dofs + border%n).
      real(wp), intent(out) :: unknowns(:)
      !> Is there a motion to go on with? Else the unknowns are zero.
      logical, intent(out) :: has_guess
      real(wp) :: motion(2, system%cells%n_nodes)
      integer :: node
      real(wp) :: scale

      unknowns = 0.0_wp
      has_guess = allocated(system%last_motion)
      if (has_guess) has_guess = size(system%last_motion%free) == system%border%n
      if (.not. has_guess) return
      associate (last => system%last_motion)
         scale = (system%end_time - system%start_time)/last%duration
         if (allocated(last%corner_node)) then
            call follow_corners(system, motion)
         else
            call follow_places(system, motion)
         end if
         do node = 1, system%cells%n_nodes
            associate (value => scale*motion(:, node), dof => system%dofs%dof(:, node))
               if (dof(1) > 0) unknowns(dof(1)) = value(1)
               if (dof(2) > 0) unknowns(dof(2)) = value(2)
            end associate
         end do
         unknowns(size(unknowns) - system%border%n + 1:) = scale*last%free
      end associate
      ! what outer nodes extrapolate is no measure
      has_guess = maxval(abs(unknowns)) <= farthest*model%grid%smallest_spacing()
      if (.not. has_guess) unknowns = 0.0_wp
   end subroutine guess_motion

   !> Motions of the nodes that stood where nodes stand now.
   pure subroutine follow_places(system, motion)
      type(system_type), intent(in) :: system
      !> Last motion of what is now at every node, length units.
      real(wp), intent(out) :: motion(:, :)
      integer, allocatable :: place(:, :)
      integer :: node

      call place_nodes(system%last_motion%node_index, system%cells%node_index, place)
      do node = 1, size(motion, 2)
         motion(:, node) = motion_near(system%last_motion%increment, place, &
                                       system%cells%node_index(:, node))
      end do
   end subroutine follow_places

   !> Where several nodes may stand at one place: the motion of that on which one of the corners of
   !> a node hung there; of new nodes, the mean motion of their corners.
   pure subroutine follow_corners(system, motion)
      type(system_type), intent(in) :: system
      !> See `follow_places`.
      real(wp), intent(out) :: motion(:, :)
      real(wp) :: total(2, size(motion, 2))
      integer :: before(size(motion, 2)), n(size(motion, 2)), c, j, k

      before = 0
      n = 0
      total = 0.0_wp
      associate (last => system%last_motion, map => system%map)
         do c = 1, size(map%node, 2)
            do k = 1, 4
               if (.not. abs(map%shape(k, c)) > 0.0_wp) cycle
               associate (node => map%node(k, c))
                  n(node) = n(node) + 1
                  total(:, node) = total(:, node) + last%corner_increment(:, c)
                  do j = 1, 4
                     if (any(last%node_index(:, last%corner_node(j, c)) &
                             /= system%cells%node_index(:, node))) cycle
                     before(node) = last%corner_node(j, c)
                  end do
               end associate
            end do
         end do
         motion = total/spread(real(max(n, 1), wp), 1, 2)
         do k = 1, size(motion, 2)
            if (before(k) > 0) motion(:, k) = last%increment(:, before(k))
         end do
      end associate
   end subroutine follow_corners

   !> Where the nodes of the last step are, on a window that holds those of both steps and a margin:
   !> their numbers, or 0.
   pure subroutine place_nodes(last, now, place)
      !> Grid indices of the nodes, shape (2, n).
      integer, intent(in) :: last(:, :), now(:, :)
      integer, allocatable, intent(out) :: place(:, :)
      integer :: lower(2), upper(2), k

      lower = min(minval(last, dim=2), minval(now, dim=2)) - 1
      upper = max(maxval(last, dim=2), maxval(now, dim=2)) + 1
      allocate (place(lower(1):upper(1), lower(2):upper(2)), source=0)
      do k = 1, size(last, 2)
         place(last(1, k), last(2, k)) = k
      end do
   end subroutine place_nodes

   !> Motion of a node, or the mean of those around it.
   pure function motion_near(increment, place, index) result(motion)
      !> Motions in the last step, shape (2, n).
      real(wp), intent(in) :: increment(:, :)
      !> See `place_nodes`.
      integer, allocatable, intent(in) :: place(:, :)
      integer, intent(in) :: index(2)
      real(wp) :: motion(2)
      integer :: i, j, n

      associate (k => place(index(1), index(2)))
         if (k > 0) then
            motion = increment(:, k)
            return
         end if
      end associate
      motion = 0.0_wp
      n = 0
      do j = index(2) - 1, index(2) + 1
         do i = index(1) - 1, index(1) + 1
            if (place(i, j) == 0) cycle
            n = n + 1
            motion = motion + increment(:, place(i, j))
         end do
      end do
      if (n > 0) motion = motion/real(n, wp)
   end function motion_near

   !> Keep the motion of a step that has been accepted.
   pure subroutine remember_motion(system, residuals)
      !> System in equilibrium.
      type(system_type), intent(inout) :: system
      !> Relative residuals of the iteration.
      real(wp), intent(in) :: residuals(:)

      if (.not. allocated(system%last_motion)) allocate (system%last_motion)
      associate (last => system%last_motion)
         last%node_index = system%cells%node_index
         last%increment = system%increment
         if (allocated(system%surfaces)) then
            last%corner_node = system%map%node
            last%corner_increment = system%map%increment
         end if
         last%duration = system%end_time - system%start_time
         last%free = free_motions(system%border)
         last%residuals = residuals
      end associate
   end subroutine remember_motion

   !> Let the corners of new tiles take what is remembered of old ones: each that of the nearest
   !> corner of the tile that was nearest, so that both sides of a surface keep their own.
   pure subroutine carry_motion(system, model, old_tiling, old_body)
      !> System between two steps, with surfaces that meet.
      type(system_type), intent(inout) :: system
      !> Scene with new tiles.
      type(model_type), intent(in) :: model
      !> Old tiles and their bodies.
      type(tiling_type), intent(in) :: old_tiling
      integer, intent(in) :: old_body(:)
      type(bins_type) :: bins
      real(wp) :: centre(2, size(old_body))
      integer, allocatable :: near(:)
      integer :: from(model%tiling%n_corners), k, p, v

      if (.not. allocated(system%last_motion)) return
      do p = 1, size(old_body)
         centre(:, p) = tile_centroid(old_tiling%position(:, old_tiling%corner(:, p)))
      end do
      call new_bins(bins, centre, nearest_tile*model%grid%smallest_spacing())
      from = 0
      do p = 1, model%points%n_points
         near = bins%near(model%points%position(:, p))
         near = pack(near, old_body(near) == model%points%body(p))
         if (size(near) == 0) cycle
         k = near(nearest_of(centre(:, near), model%points%position(:, p)))
         do v = 1, 4
            associate (corner => model%tiling%corner(v, p), old => old_tiling%corner(:, k))
               from(corner) = old(nearest_of(old_tiling%position(:, old), &
                                          model%tiling%position(:, corner)))
            end associate
         end do
      end do
      ! without the motion of some corner there is no guess
      if (any(from == 0)) then
         deallocate (system%last_motion)
      else
         associate (last => system%last_motion)
            last%corner_node = last%corner_node(:, from)
            last%corner_increment = last%corner_increment(:, from)
         end associate
      end if
   end subroutine carry_motion

   !> Number of the nearest of several places.
   pure function nearest_of(places, place) result(number)
      real(wp), intent(in) :: places(:, :), place(2)
      integer :: number

      number = minloc((places(1, :) - place(1))**2 + (places(2, :) - place(2))**2, dim=1)
   end function nearest_of

   !> Begin the next step without guess: it failed with one, or what drives the body changes.
   pure subroutine forget_motion(system)
      !> The system.
      type(system_type), intent(inout) :: system

      if (allocated(system%last_motion)) deallocate (system%last_motion)
   end subroutine forget_motion

end module coulter_newton_guess
