!> Setting up the system of a step for points as quadrature points: cells, stations, unknowns.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_point_setup
   use coulter_algebra_ordering, only: dissection_order
   use coulter_algebra_sparse, only: element_dofs_type
   use coulter_base_kinds, only: wp
   use coulter_boundary_stations, only: build_stations, reach_type, recall_tractions
   use coulter_grid_cells, only: locate_points, number_nodes
   use coulter_grid_shape, only: shape_values_2d
   use coulter_model, only: model_type, point_moduli
   use coulter_model_control, only: small_cells_aggregate, small_cells_drop, small_cells_keep
   use coulter_step_dofs, only: couple_cells, nodes_of_filled_cells, number_dofs
   use coulter_step_system, only: make_room, renew_pattern, system_type
   implicit none(type, external)
   private
   public :: find_participants, number_system

contains

   !> Find who takes part in a step: cells with points, boundary stations, nodes.
   subroutine find_participants(system, model, first_outside)
      !> System of the step.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> First point outside the grid, else 0.
      integer, intent(out) :: first_outside
      type(reach_type) :: reach

      call locate_points(system%cells, model%grid, model%points%position, first_outside)
      if (first_outside > 0) return
      call measure_fill(system, model)
      reach%is_filled = is_filled(system, model)
      reach%is_filled_only = model%control%small_cells == small_cells_drop
      reach%has_empty_cells = model%control%small_cells == small_cells_aggregate
      system%takes_part = reach%is_filled .or. .not. reach%is_filled_only
      call build_stations(system%stations, model%boundaries, model%grid, system%cells, reach)
      call equip_stations(system, model)
      call number_nodes(system%cells)
   end subroutine find_participants

   !> Number the unknowns; make pattern, scatter map and symbolic factorisation unless those of the
   !> last step still hold.
   subroutine number_system(system, model, has_failed)
      !> System of the step.
      type(system_type), intent(inout) :: system
      !> Scene.
      type(model_type), intent(in) :: model
      !> Could the pattern not be analysed?
      logical, intent(out) :: has_failed
      type(element_dofs_type) :: elements
      logical :: filled(system%cells%n_with_points)

      filled = is_filled(system, model)
      call number_dofs(system%dofs, model%grid, system%cells, &
                       nodes_of_filled_cells(system%cells, filled), filled, system%fill, &
                       model%fixities)
      call couple_cells(system%dofs, system%cells, elements, system%transform_start, &
                        system%transform)
      call gather_mass(system, model)
      call make_room(system, size(model%boundaries))
      system%loaded_length = system%stations%loaded_length
      system%lost_length = system%stations%lost_length
      call renew_pattern(system, elements, has_failed, &
                         dissection_order(system%dofs%dof, system%cells%node_index))
   end subroutine number_system

   !> Current volume of the points of every cell over the volume of the cell.
   pure subroutine measure_fill(system, model)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      integer :: c, k, p

      if (allocated(system%fill)) deallocate (system%fill)
      allocate (system%fill(system%cells%n_with_points), source=0.0_wp)
      do c = 1, system%cells%n_with_points
         do k = system%cells%point_start(c), system%cells%point_start(c + 1) - 1
            p = system%cells%point(k)
            system%fill(c) = system%fill(c) &
               + model%points%reference_volume(p)*model%points%volume_ratio(p)
         end do
      end do
      system%fill = system%fill/model%grid%cell_volume()
   end subroutine measure_fill

   !> Does a cell hold enough material? If none does, all count as filled.
   pure function is_filled(system, model) result(answer)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      logical :: answer(system%cells%n_with_points)

      answer = .true.
      if (model%control%small_cells == small_cells_keep) return
      answer = system%fill >= model%control%fill_tolerance
      if (.not. any(answer)) answer = .true.
   end function is_filled

   !> Give the stations the moduli of the material that they hold, and their memories.
   pure subroutine equip_stations(system, model)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      integer :: k, point

      do k = 1, system%stations%n
         associate (station => system%stations%item(k))
            point = system%cells%point(system%cells%point_start(station%material_cell))
            call point_moduli(model, point, station%law%lame_lambda, station%law%shear_modulus)
         end associate
      end do
      if (.not. any(model%boundaries%has_memory)) return
      call recall_tractions(system%stations, system%last_stations, model%boundaries, &
                            model%grid%smallest_spacing())
   end subroutine equip_stations

   !> Share out the mass of the points to the nodes; only when there is a body force.
   pure subroutine gather_mass(system, model)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      integer :: c, k, p
      real(wp) :: mass, local(2)

      if (allocated(system%nodal_mass)) deallocate (system%nodal_mass)
      if (.not. any(abs(model%body_force%acceleration) > 0.0_wp)) return
      allocate (system%nodal_mass(system%cells%n_nodes), source=0.0_wp)
      do c = 1, system%cells%n_with_points
         if (.not. system%takes_part(c)) cycle
         do k = system%cells%point_start(c), system%cells%point_start(c + 1) - 1
            p = system%cells%point(k)
            mass = model%bodies(model%points%body(p))%density*model%points%reference_volume(p)
            local = system%cells%local_position(model%grid, c, model%points%position(:, p))
            associate (node => system%cells%node(:, c))
               system%nodal_mass(node) = system%nodal_mass(node) + mass*shape_values_2d(local)
            end associate
         end do
      end do
   end subroutine gather_mass

end module coulter_step_point_setup
