!> Setting up the system of a step for points as quadrature points: cells, stations, unknowns.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_setup_points
   use coulter_algebra_ordering, only: dissection_order
   use coulter_algebra_sparse, only: element_dofs_type, joined
   use coulter_base_kinds, only: wp
   use coulter_boundary_stations, only: build_stations, reach_type, recall_tractions
   use coulter_grid_cells, only: locate_boxes, locate_points, number_nodes
   use coulter_grid_shape, only: shape_values_2d
   use coulter_model, only: model_type, point_moduli
   use coulter_model_control, only: domains_boxes, small_cells_aggregate, small_cells_drop, &
      small_cells_keep
   use coulter_points_boxes, only: current_boxes
   use coulter_system, only: make_room, renew_pattern, system_type
   use coulter_system_dofs, only: couple_cells, nodes_of_filled_cells, number_dofs
   use coulter_system_patches, only: build_patches, couple_patches, functions_in_patch, &
      patch_functions_type
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

      call locate(system, model, first_outside)
      if (first_outside > 0) return
      call measure_fill(system, model)
      reach%is_filled = is_filled(system, model)
      reach%is_filled_only = model%control%small_cells == small_cells_drop
      reach%has_empty_cells = model%control%small_cells == small_cells_aggregate
      system%takes_part = reach%is_filled .or. .not. reach%is_filled_only
      call build_stations(system%stations, model%boundaries, model%grid, system%cells, reach)
      call equip_stations(system, model)
      call number_nodes(system%cells)
      if (.not. allocated(system%patches)) return
      call build_patches(system%patches, model%grid, system%cells, model%points%position)
   end subroutine find_participants

   !> Cells that hold points or reach their boxes. Patches exist only where they are needed.
   subroutine locate(system, model, first_outside)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      integer, intent(out) :: first_outside

      if (allocated(system%patches)) deallocate (system%patches)
      if (model%control%has_mean_volume .or. model%control%domains == domains_boxes) then
         allocate (system%patches)
      end if
      if (model%control%has_mean_volume) then
         system%volume_scale = spread(1.0_wp, 1, model%points%n_points)
      end if
      if (model%control%domains == domains_boxes) then
         system%patches%box = current_boxes(model%points)
         call locate_boxes(system%cells, model%grid, model%points%position, system%patches%box, &
                           first_outside)
      else
         call locate_points(system%cells, model%grid, model%points%position, first_outside)
      end if
   end subroutine locate

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
      if (allocated(system%patches)) call couple_patches(system%patches, system%dofs)
      call gather_mass(system, model)
      call make_room(system, size(model%boundaries))
      system%loaded_length = system%stations%loaded_length
      system%lost_length = system%stations%lost_length
      if (.not. allocated(system%patches)) then
         call renew_pattern(system, elements, has_failed, &
                            dissection_order(system%dofs%dof, system%cells%node_index))
      else
         ! boxes reach across the separators of one line that dissection makes
         call renew_pattern(system, joined(elements, system%patches%coupling%elements), has_failed)
      end if
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
            system%fill(c) = system%fill(c) + share_in_cell(system, model, c, p) &
               *model%points%reference_volume(p)*model%points%volume_ratio(p)
         end do
      end do
      system%fill = system%fill/model%grid%cell_volume()
   end subroutine measure_fill

   !> Share of a point that lies in a cell: all of it, or the part of its box.
   pure function share_in_cell(system, model, c, p) result(share)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      integer, intent(in) :: c, p
      real(wp) :: share
      real(wp) :: middle(2), half(2)

      share = 1.0_wp
      if (model%control%domains /= domains_boxes) return
      middle = system%cells%local_position(model%grid, c, model%points%position(:, p))
      half = 0.5_wp*system%patches%box(:, p)/model%grid%spacing
      share = product(max(min(middle + half, 1.0_wp) - max(middle - half, 0.0_wp), 0.0_wp) &
                      /(2.0_wp*half))
   end function share_in_cell

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
      if (model%control%domains == domains_boxes) then
         call gather_mass_of_boxes(system, model)
         return
      end if
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

   !> Mass of points whose boxes reach beyond their cell.
   pure subroutine gather_mass_of_boxes(system, model)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      type(patch_functions_type) :: functions
      integer :: node, e, k, p, a
      real(wp) :: mass

      do e = 1, system%patches%n
         if (.not. system%takes_part(system%patches%cell(e))) cycle
         do k = system%patches%point_start(e), system%patches%point_start(e + 1) - 1
            p = system%patches%point(k)
            mass = model%bodies(model%points%body(p))%density*model%points%reference_volume(p)
            call functions_in_patch(system%patches, model%grid, e, model%points%position(:, p), p, &
                                    functions)
            do a = 1, functions%n
               node = system%patches%node(functions%place(a), e)
               system%nodal_mass(node) = system%nodal_mass(node) + mass*functions%value(a)
            end do
         end do
      end do
   end subroutine gather_mass_of_boxes

end module coulter_setup_points
