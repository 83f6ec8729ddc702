!> The equilibrium system of one step: who takes part, the equations, and their solution.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_system
   use coulter_algebra_ordering, only: dissection_order
   use coulter_algebra_solver, only: solver_type
   use coulter_algebra_sparse, only: build_pattern, element_dofs_type, pattern_type
   use coulter_base_kinds, only: long, wp
   use coulter_base_timer, only: stopwatch_type
   use coulter_boundary_stations, only: build_stations, reach_type, recall_tractions, &
      stations_type
   use coulter_grid_cells, only: cells_type, locate_points, number_nodes
   use coulter_grid_shape, only: shape_values_2d
   use coulter_model, only: model_type
   use coulter_model_control, only: small_cells_aggregate, small_cells_drop, small_cells_keep
   use coulter_step_dofs, only: couple_cells, dofs_type, number_dofs
   implicit none(type, external)
   private
   public :: system_type, find_participants, number_system, system_memory

   !> Everything that lives for one step, and what is kept from step to step because it may not
   !> have changed (pattern, symbolic factorisation).
   type :: system_type
      !> Times at the start and the end of the step.
      real(wp) :: start_time = 0.0_wp, end_time = 0.0_wp
      !> Wall time by phase.
      type(stopwatch_type) :: watch
      !> Active cells and nodes.
      type(cells_type) :: cells
      !> Stations of the boundaries.
      type(stations_type) :: stations
      !> Stations of the last accepted step, for tractions with memory.
      type(stations_type) :: last_stations
      !> Share of every cell with points that is filled, shape (n_with_points).
      real(wp), allocatable :: fill(:)
      !> Does the cell take part? Only small cells that are dropped do not.
      logical, allocatable :: takes_part(:)
      !> Numbering of the unknowns.
      type(dofs_type) :: dofs
      !> Unknowns of every cell.
      type(element_dofs_type) :: elements
      !> Where the transformation of a cell with outer nodes begins, see `couple_cells`.
      integer, allocatable :: transform_start(:)
      !> These transformations.
      real(wp), allocatable :: transform(:, :)
      !> Sparsity pattern of the tangent.
      type(pattern_type) :: pattern
      !> Values of the tangent, shape (n_entries).
      real(wp), allocatable :: values(:)
      !> Direct solver.
      type(solver_type) :: solver
      !> Has the pattern of the last step been used again?
      logical :: has_reused_pattern = .false.
      !> Displacement increments of the nodes, length units, shape (2, n_nodes).
      real(wp), allocatable :: increment(:, :)
      !> Internal, boundary and external nodal forces, shape (2, n_nodes).
      real(wp), allocatable :: internal(:, :), boundary(:, :), external(:, :)
      !> Force of every boundary on the body, shape (2, n_boundaries).
      real(wp), allocatable :: boundary_reaction(:, :)
      !> Mass that each node carries, shape (n_nodes).
      real(wp), allocatable :: nodal_mass(:)
   end type system_type

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

      has_failed = .false.
      call number_dofs(system%dofs, model%grid, system%cells, is_filled(system, model), &
                       system%fill, model%fixities)
      call couple_cells(system%dofs, system%cells, elements, system%transform_start, &
                        system%transform)
      call gather_mass(system, model)
      call make_room(system, size(model%boundaries))
      system%has_reused_pattern = are_equal(system%elements, elements)
      if (system%has_reused_pattern) return
      system%elements = elements
      call build_pattern(system%pattern, system%dofs%n_dofs, system%elements)
      if (allocated(system%values)) deallocate (system%values)
      allocate (system%values(system%pattern%n_entries))
      call system%solver%analyse(system%pattern, &
                                 dissection_order(system%dofs%dof, system%cells%node_index), &
                                 has_failed)
   end subroutine number_system

   !> Bytes that the system occupies, factors included.
   pure function system_memory(system) result(bytes)
      !> A numbered system.
      type(system_type), intent(in) :: system
      integer(long) :: bytes

      bytes = 4_long*int(size(system%cells%cell_index) + size(system%cells%node) &
                         + size(system%cells%node_index) + size(system%cells%point) &
                         + size(system%cells%cell_at) + size(system%elements%dof) &
                         + size(system%pattern%slot) + size(system%pattern%row), long) &
         + 8_long*int(size(system%values) + 4*size(system%increment) + size(system%transform) &
                      + size(system%stations%item)*storage_size(system%stations%item)/64, long) &
         + system%solver%factor_memory
   end function system_memory

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
      integer :: k, point, law

      do k = 1, system%stations%n
         associate (station => system%stations%item(k))
            point = system%cells%point(system%cells%point_start(station%material_cell))
            law = model%bodies(model%points%body(point))%law
            call model%laws(law)%law%elastic_moduli(station%law%lame_lambda, &
                                                    station%law%shear_modulus)
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

   !> Nodal arrays of the step.
   pure subroutine make_room(system, n_boundaries)
      type(system_type), intent(inout) :: system
      integer, intent(in) :: n_boundaries

      if (.not. allocated(system%boundary_reaction)) then
         allocate (system%boundary_reaction(2, n_boundaries))
      end if
      if (allocated(system%increment)) then
         if (size(system%increment, 2) == system%cells%n_nodes) return
         deallocate (system%increment, system%internal, system%boundary, system%external)
      end if
      allocate (system%increment(2, system%cells%n_nodes))
      allocate (system%internal, system%boundary, system%external, mold=system%increment)
   end subroutine make_room

   !> Do two lists couple the same unknowns in the same elements?
   pure function are_equal(first, second) result(answer)
      type(element_dofs_type), intent(in) :: first, second
      logical :: answer

      answer = first%n_elements == second%n_elements .and. allocated(first%dof)
      if (answer) answer = size(first%dof) == size(second%dof)
      if (answer) answer = all(first%start == second%start)
      if (answer) answer = all(first%dof == second%dof)
   end function are_equal

end module coulter_step_system
