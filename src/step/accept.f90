!> End of a successful step: points and boundaries move, the trial state becomes the converged one.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_accept
   use coulter_assembly_hourglass, only: remember_hourglass
   use coulter_assembly_patches, only: displacement_gradient, unit_gradient
   use coulter_base_kinds, only: wp
   use coulter_base_tensor, only: finger_of_log_strain_plane, log_strain_plane
   use coulter_base_text, only: to_text
   use coulter_boundary_motion, only: motion_type, moved_by, turn_matrix
   use coulter_grid_shape, only: shape_gradients_2d, shape_values_2d
   use coulter_law_abstract, only: law_response_type, law_visit_type, n_plane
   use coulter_model, only: model_type, point_moduli
   use coulter_points, only: point_state_type
   use coulter_points_tiling, only: tile_centroid, values_at
   use coulter_setup_bonds, only: remember_bonds
   use coulter_step_sliding, only: note_sliding
   use coulter_system, only: system_type
   use coulter_system_contact_state, only: whole_motion
   use coulter_system_patches, only: functions_in_patch, most_patch_nodes, patch_functions_type
   use coulter_system_point_kernel, only: deform_point
   implicit none(type, external)
   private
   public :: accept_step

   !> Plastic strains of a step above this are flow.
   real(wp), parameter :: least_flow = 1.0e-12_wp
   !> Shear stiffness over the elastic one below which an incremental law counts as flowing.
   real(wp), parameter :: soft_share = 0.5_wp

contains

   !> Update everything that a step changes. When a point cannot follow (it turns inside out in a
   !> cell that was left out, or leaves the grid), nothing is changed.
   subroutine accept_step(model, system, failure)
      !> Scene to move on.
      type(model_type), intent(inout) :: model
      !> System in equilibrium.
      type(system_type), intent(inout) :: system
      !> Why the step cannot be accepted; unallocated when it was.
      character(len=:), allocatable, intent(out) :: failure
      real(wp), allocatable :: moved(:, :)
      integer :: failed_point

      call system%forget_verdict()
      allocate (moved, mold=model%points%position)
      if (allocated(model%tiling)) then
         call update_tiles(model, system, moved, failed_point)
      else if (allocated(system%patches)) then
         call update_patches(model, system, moved, failed_point)
      else
         call update_points(model, system, moved, failed_point)
      end if
      if (failed_point > 0) then
         failure = fate_of(model, system, failed_point)//system%verdict_text()
         return
      end if
      model%points%displacement = model%points%displacement + moved
      model%points%position = model%points%position + moved
      if (allocated(model%tiling)) then
         call remember_hourglass(model, system%map)
         model%tiling%position = model%tiling%position + system%map%increment
      end if
      call swap_states(model%points%converged, model%points%trial)
      if (allocated(model%points%shared_ratio)) then
         model%points%shared_ratio = model%points%shared_ratio*system%volume_scale
      end if
      call measure_volumes(model)
      call move_boundaries(model, system)
      call note_sliding(model, system%contacts)
      model%time = system%end_time
      system%is_set_up = .false.
      system%last_stations = system%stations
      system%last_contacts = system%contacts
      if (allocated(system%surfaces)) system%surfaces%last = system%surfaces%pairs
      if (allocated(system%bonds)) call remember_bonds(system%contacts, system%bonds)
   end subroutine accept_step

   !> What became of a point that cannot follow.
   pure function fate_of(model, system, p) result(fate)
      type(model_type), intent(in) :: model
      type(system_type), intent(in) :: system
      integer, intent(in) :: p
      character(len=:), allocatable :: fate
      real(wp) :: corner(2, 4)
      integer :: v

      fate = "material point "//to_text(p)//" of body "//model%bodies(model%points%body(p))%name &
         //" near ("//to_text(model%points%position(:, p))//") is turned inside out"
      if (.not. allocated(model%tiling)) then
         fate = fate//" or leaves the grid"
         return
      end if
      corner = values_at(model%tiling%corner(:, p), model%tiling%position + system%map%increment)
      do v = 1, 4
         if (model%grid%contains_position(corner(:, v))) cycle
         fate = "body "//model%bodies(model%points%body(p))%name//" leaves the grid at (" &
            //to_text(corner(:, v))//"): give it more cells there, or hold that side"
         return
      end do
   end function fate_of

   !> Trial state and motion of all points, those of left-out cells included.
   subroutine update_points(model, system, moved, failed_point)
      type(model_type), intent(inout) :: model
      type(system_type), intent(in) :: system
      real(wp), intent(out) :: moved(:, :)
      integer, intent(out) :: failed_point
      real(wp) :: increment(2, 4), local(2)
      integer :: c, k, p
      logical :: has_failed

      do c = 1, system%cells%n_with_points
         increment = system%increment(:, system%cells%node(:, c))
         do k = system%cells%point_start(c), system%cells%point_start(c + 1) - 1
            p = system%cells%point(k)
            local = system%cells%local_position(model%grid, c, model%points%position(:, p))
            moved(:, p) = matmul(increment, shape_values_2d(local))
            call update_point(model, system, p, shape_gradients_2d(local, model%grid%spacing), &
                              increment, has_failed)
            failed_point = p
            if (has_failed) return
            has_failed = .not. model%grid%contains_position(model%points%position(:, p) &
                                                            + moved(:, p))
            if (has_failed) return
         end do
      end do
      failed_point = 0
   end subroutine update_points

   !> Trial state and motion of all points of patches.
   subroutine update_patches(model, system, moved, failed_point)
      type(model_type), intent(inout) :: model
      type(system_type), intent(in) :: system
      real(wp), intent(out) :: moved(:, :)
      integer, intent(out) :: failed_point
      type(patch_functions_type) :: functions
      real(wp) :: increment(2, most_patch_nodes)
      integer :: e, k, p
      logical :: has_failed

      associate (patches => system%patches)
         do e = 1, patches%n
            increment(:, :patches%n_nodes(e)) = &
               system%increment(:, patches%node(:patches%n_nodes(e), e))
            do k = patches%point_start(e), patches%point_start(e + 1) - 1
               p = patches%point(k)
               failed_point = p
               call functions_in_patch(patches, model%grid, e, model%points%position(:, p), p, &
                                       functions)
               moved(:, p) = matmul(increment(:, functions%place(:functions%n)), &
                                    functions%value(:functions%n))
               has_failed = .not. model%grid%contains_position(model%points%position(:, p) &
                                                               + moved(:, p))
               if (has_failed) return
               call update_point(model, system, p, unit_gradient, &
                                 displacement_gradient(functions, increment), has_failed)
               if (has_failed) return
            end do
         end do
      end associate
      failed_point = 0
   end subroutine update_patches

   !> Trial state and motion of all tiles.
   subroutine update_tiles(model, system, moved, failed_point)
      type(model_type), intent(inout) :: model
      type(system_type), intent(in) :: system
      real(wp), intent(out) :: moved(:, :)
      integer, intent(out) :: failed_point
      real(wp) :: increment(2, 4)
      integer :: p
      logical :: has_failed

      do p = 1, model%points%n_points
         associate (corner => model%tiling%corner(:, p))
            increment = values_at(corner, system%map%increment)
            call update_point(model, system, p, system%map%gradient(:, :, p), increment, has_failed)
            increment = increment + values_at(corner, model%tiling%position)
         end associate
         failed_point = p
         if (has_failed) return
         associate (x => increment(1, :), y => increment(2, :))
            if (.not. model%grid%contains_position([minval(x), minval(y)])) return
            if (.not. model%grid%contains_position([maxval(x), maxval(y)])) return
         end associate
         moved(:, p) = tile_centroid(increment) - model%points%position(:, p)
      end do
      failed_point = 0
   end subroutine update_tiles

   !> Trial state of one point.
   subroutine update_point(model, system, p, gradient, increment, has_failed)
      type(model_type), intent(inout) :: model
      type(system_type), intent(in) :: system
      integer, intent(in) :: p
      real(wp), intent(in) :: gradient(2, 4), increment(2, 4)
      logical, intent(out) :: has_failed
      real(wp) :: deformation(2, 2), volume_ratio, finger(4), strain(n_plane)
      type(law_visit_type) :: visit
      type(law_response_type) :: response

      associate (old => model%points%converged, new => model%points%trial, &
                 item => model%laws(model%bodies(model%points%body(p))%law))
         call deform_point(gradient, increment, old%elastic_finger(:, p), deformation, &
                           volume_ratio, finger)
         has_failed = .not. volume_ratio > 0.0_wp
         if (has_failed) return
         visit = system%visit(p)
         visit%deformation = deformation
         if (allocated(system%volume_scale)) then
            call share_volume_change(system%volume_scale(p), finger, visit%deformation)
         end if
         call log_strain_plane(finger, strain)
         call item%law%update(visit, strain, old%law_state(:item%law%n_state, p), &
                              response, new%law_state(:item%law%n_state, p))
         has_failed = response%has_failed
         if (has_failed) return
         new%kirchhoff_stress(:, p) = response%stress
         if (.not. item%law%is_elastic) then
            call finger_of_log_strain_plane(response%strain, finger)
            model%points%has_flowed(p) = any(abs(response%strain - strain) > least_flow)
            if (item%law%is_incremental) model%points%has_flowed(p) = is_soft(model, p, strain)
         end if
         new%elastic_finger(:, p) = finger
         new%deformation_gradient(1:2, p) = deformation(:, 1)*old%deformation_gradient(1, p) &
            + deformation(:, 2)*old%deformation_gradient(2, p)
         new%deformation_gradient(3:4, p) = deformation(:, 1)*old%deformation_gradient(3, p) &
            + deformation(:, 2)*old%deformation_gradient(4, p)
         new%deformation_gradient(5, p) = old%deformation_gradient(5, p)
      end associate
   end subroutine update_point

   !> Is a point of a law that does not tell plastic strains flowing? Its shear stress, new less
   !> old, is then well below what its elastic moduli say; where a point turns in the step, the
   !> answer is no rather than yes.
   pure function is_soft(model, p, strain) result(answer)
      type(model_type), intent(in) :: model
      integer, intent(in) :: p
      !> Logarithmic strain of the step.
      real(wp), intent(in) :: strain(n_plane)
      logical :: answer
      real(wp) :: lame_lambda, shear_modulus, change(n_plane), expected(n_plane)

      call point_moduli(model, p, lame_lambda, shear_modulus)
      change = model%points%trial%kirchhoff_stress(:, p) &
         - model%points%converged%kirchhoff_stress(:, p)
      change(:3) = change(:3) - sum(change(:3))/3.0_wp
      expected = shear_modulus*strain
      expected(:3) = 2.0_wp*(expected(:3) - sum(expected(:3))/3.0_wp)
      answer = any(abs(strain) > least_flow) .and. norm2(change) < soft_share*norm2(expected)
   end function is_soft

   !> Let a point see the mean volume change of its patch.
   pure subroutine share_volume_change(scale, finger, deformation)
      real(wp), intent(in) :: scale
      real(wp), intent(inout) :: finger(4), deformation(2, 2)

      finger([1, 2, 4]) = scale*finger([1, 2, 4])
      deformation = sqrt(scale)*deformation
   end subroutine share_volume_change

   !> Exchange two states without copying.
   pure subroutine swap_states(first, second)
      type(point_state_type), intent(inout) :: first, second

      call swap(first%deformation_gradient, second%deformation_gradient)
      call swap(first%elastic_finger, second%elastic_finger)
      call swap(first%kirchhoff_stress, second%kirchhoff_stress)
      call swap(first%law_state, second%law_state)

   contains

      pure subroutine swap(a, b)
         real(wp), allocatable, intent(inout) :: a(:, :), b(:, :)
         real(wp), allocatable :: kept(:, :)

         call move_alloc(a, kept)
         call move_alloc(b, a)
         call move_alloc(kept, b)
      end subroutine swap

   end subroutine swap_states

   !> Volume ratio J = det F of all points.
   pure subroutine measure_volumes(model)
      type(model_type), intent(inout) :: model

      associate (f => model%points%converged%deformation_gradient)
         model%points%volume_ratio = (f(1, :)*f(4, :) - f(2, :)*f(3, :))*f(5, :)
      end associate
   end subroutine measure_volumes

   !> Boundaries move as prescribed, tools also freely.
   pure subroutine move_boundaries(model, system)
      type(model_type), intent(inout) :: model
      type(system_type), intent(in) :: system
      type(motion_type) :: motion
      integer :: b, i

      do b = 1, size(model%boundaries)
         motion = whole_motion(system, model, b)
         associate (boundary => model%boundaries(b))
            do i = 1, size(boundary%vertices, 2)
               boundary%vertices(:, i) = moved_by(motion, boundary%vertices(:, i))
            end do
            boundary%centre = boundary%centre + motion%translation
            boundary%travel = boundary%travel + motion%translation
            if (any(abs(motion%translation) > 0.0_wp)) boundary%heading = motion%translation
            boundary%turned = boundary%turned + motion%rotation
            boundary%lever = matmul(turn_matrix(motion%rotation), boundary%lever)
         end associate
      end do
   end subroutine move_boundaries

end module coulter_step_accept
