!> Forces and tangent of the whole system, cell by cell.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly
   use coulter_algebra_sparse, only: add_element_matrix
   use coulter_assembly_body_field, only: add_body_field
   use coulter_assembly_edge_loads, only: add_pressures, add_tractions
   use coulter_assembly_patches, only: add_patches
   use coulter_assembly_tiles, only: add_tiles, sum_tangent
   use coulter_base_kinds, only: wp
   use coulter_boundary_ibm, only: station_kernel_2d, station_response_type
   use coulter_boundary_motion, only: motion_type
   use coulter_grid_shape, only: shape_gradients_2d
   use coulter_model, only: body_force_factor, boundary_motion, model_type
   use coulter_system, only: system_type
   use coulter_system_point_kernel, only: add_force, add_stiffness, point_response_type, respond
   implicit none(type, external)
   private
   public :: assemble, apply_dead_loads

contains

   !> Internal force, boundary force and, if needed, tangent at the current displacement increments.
   subroutine assemble(system, model, failed_point)
      !> System of the step; gets `internal`, `boundary` and `values`.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> A point that is turned inside out or whose law failed, else 0.
      integer, intent(out) :: failed_point

      system%internal = 0.0_wp
      system%boundary = 0.0_wp
      system%boundary_reaction = 0.0_wp
      system%external = system%dead_load
      if (allocated(model%tiling)) then
         call add_tiles(system, model, failed_point)
         if (failed_point == 0) call add_pressures(system, model)
         if (failed_point == 0 .and. system%needs_tangent) call sum_tangent(system)
      else
         if (system%needs_tangent) system%values = 0.0_wp
         if (allocated(system%patches)) then
            call add_patches(system, model, failed_point)
         else
            call add_points(system, model, failed_point)
         end if
         if (failed_point == 0) call add_stations(system, model)
      end if
   end subroutine assemble

   !> External nodal forces at the end of the step that do not depend on displacements.
   pure subroutine apply_dead_loads(system, model)
      !> System of the step; gets `dead_load`.
      type(system_type), intent(inout) :: system
      !> Scene.
      type(model_type), intent(in) :: model
      integer :: i

      system%external = 0.0_wp
      if (allocated(system%nodal_mass)) then
         do i = 1, 2
            system%external(i, :) = system%nodal_mass*model%body_force%acceleration(i) &
               *body_force_factor(model, system%end_time)
         end do
      end if
      if (allocated(model%body_force%field)) call add_body_field(system, model)
      if (allocated(model%tiling)) call add_tractions(system, model)
      system%dead_load = system%external
   end subroutine apply_dead_loads

   !> Sum up the points of every cell, then scatter the cell once.
   subroutine add_points(system, model, failed_point)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      integer, intent(out) :: failed_point
      real(wp) :: force(2, 4), stiffness(64)
      integer :: c

      failed_point = 0
      do c = 1, system%cells%n_with_points
         if (.not. system%takes_part(c)) cycle
         associate (node => system%cells%node(:, c))
            call sum_points(system, model, c, system%increment(:, node), force, stiffness, &
                            failed_point)
            if (failed_point > 0) return
            system%internal(:, node) = system%internal(:, node) + force
         end associate
         call scatter(system, c, stiffness)
      end do
   end subroutine add_points

   !> Internal force and tangent of one cell.
   subroutine sum_points(system, model, c, increment, force, stiffness, failed_point)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      integer, intent(in) :: c
      real(wp), intent(in) :: increment(2, 4)
      real(wp), intent(out) :: force(2, 4), stiffness(2, 4, 2, 4)
      integer, intent(out) :: failed_point
      real(wp) :: gradient(2, 4), spacing(2)
      type(point_response_type) :: response
      integer :: k, p

      force = 0.0_wp
      stiffness = 0.0_wp
      spacing = model%grid%spacing
      do k = system%cells%point_start(c), system%cells%point_start(c + 1) - 1
         p = system%cells%point(k)
         gradient = shape_gradients_2d(system%cells%local_position(model%grid, c, &
                                          model%points%position(:, p)), spacing)
         associate (item => model%laws(model%bodies(model%points%body(p))%law))
            call respond(item%law, system%visit(p), gradient, increment, &
                         model%points%converged%elastic_finger(:, p), &
                         model%points%converged%law_state(:, p), response)
         end associate
         failed_point = p
         if (response%has_failed) return
         associate (volume => model%points%reference_volume(p))
            call add_force(response%gradient, response%stress, volume, force)
            call add_stiffness(response%gradient, response%moduli, volume, stiffness)
         end associate
      end do
      failed_point = 0
   end subroutine sum_points

   !> Forces and tangents of all stations.
   subroutine add_stations(system, model)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      real(wp) :: prescribed(2, size(model%boundaries))
      type(station_response_type) :: response
      type(motion_type) :: motion
      integer :: b, k

      do b = 1, size(model%boundaries)
         motion = boundary_motion(model, b, system%start_time, system%end_time)
         prescribed(:, b) = motion%translation
      end do
      do k = 1, system%stations%n
         associate (station => system%stations%item(k))
            call station_kernel_2d(station%law, station%shape, station%gradient, &
                                   system%increment(:, system%cells%node(:, station%cell)), &
                                   prescribed(:, station%boundary), station%memory, response)
            station%traction = response%traction
            response%force = station%weight*response%force
            associate (node => system%cells%node(:, station%cell))
               system%boundary(:, node) = system%boundary(:, node) + response%force
            end associate
            associate (reaction => system%boundary_reaction(:, station%boundary))
               reaction = reaction - sum(response%force, dim=2)
            end associate
            call scatter(system, station%cell, station%weight*reshape(response%tangent, [64]))
         end associate
      end do
   end subroutine add_stations

   !> Add the matrix of a cell to the tangent, if that is needed; transformed to masters if the cell
   !> has outer nodes.
   subroutine scatter(system, c, matrix)
      type(system_type), intent(inout) :: system
      integer, intent(in) :: c
      real(wp), intent(in) :: matrix(64)
      integer :: first, last

      if (.not. system%needs_tangent) return
      first = system%transform_start(c)
      last = system%transform_start(c + 1) - 1
      if (last < first) then
         call add_element_matrix(system%pattern, c, matrix, system%values)
      else
         associate (transform => system%transform(:, first:last))
            call add_element_matrix(system%pattern, c, transformed(matrix, transform), &
                                    system%values)
         end associate
      end if
   end subroutine scatter

   !> Matrix in terms of the masters, T^T K T, columns first.
   pure function transformed(matrix, transform) result(product)
      real(wp), intent(in) :: matrix(64), transform(:, :)
      real(wp) :: product(size(transform, 2)**2)

      product = reshape(matmul(transpose(transform), &
                               matmul(reshape(matrix, [8, 8]), transform)), shape(product))
   end function transformed

end module coulter_assembly
