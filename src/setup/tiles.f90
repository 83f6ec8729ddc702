!> Setting up the system of a step for bodies whose domains tile them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_setup_tiles
   use coulter_algebra_sparse, only: element_dofs_type, joined
   use coulter_assembly_hourglass, only: hourglass_stiffness
   use coulter_assembly_loose_parts, only: find_loose_parts, settling_drag_of
   use coulter_assembly_surface_forces, only: meet_surfaces
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: formulation_augmented
   use coulter_boundary_edge_load, only: find_loaded_edges
   use coulter_boundary_face, only: face_type
   use coulter_boundary_held_edge, only: find_held_edges
   use coulter_boundary_motion, only: motion_type, turn_matrix
   use coulter_boundary_plate, only: beside_plate, find_plates, is_beside
   use coulter_contact, only: recall_contacts
   use coulter_contact_search, only: build_contacts
   use coulter_model, only: boundary_motion, load_factor, model_type
   use coulter_model_control, only: small_cells_aggregate
   use coulter_points_tiling, only: corner_weights
   use coulter_setup_bonds, only: recall_bonds
   use coulter_setup_ghost, only: couple_faces, find_stabilised_faces, set_ghost_values
   use coulter_system, only: make_room, renew_pattern, system_type
   use coulter_system_border, only: new_border, tool_load_type
   use coulter_system_dofs, only: number_dofs
   use coulter_system_star_groups, only: couple_stars
   use coulter_system_tile_map, only: map_tiles, spread_to_nodes
   use coulter_system_tile_patches, only: build_tile_patches, couple_tile_patches
   use coulter_system_tile_stars, only: build_stars
   use coulter_system_unknowns, only: coupling_type
   implicit none(type, external)
   private
   public :: find_tile_participants, find_contacts, number_tile_system, set_border

contains

   !> Find who takes part in a step: cells, nodes, edges that are held, stabilised faces.
   subroutine find_tile_participants(system, model, first_outside)
      !> System of the step.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> First corner outside the grid, else 0.
      integer, intent(out) :: first_outside
      logical, allocatable :: is_loose(:)
      integer :: p

      if (size(model%body_contacts) > 0) is_loose = model%bodies(model%points%body)%meets_itself
      call loosen_beside_plates(is_loose, model)
      call map_tiles(system%map, system%cells, model%tiling, model%grid, first_outside, is_loose)
      if (first_outside > 0) return
      if (allocated(model%tiling%patch)) then
         if (.not. allocated(system%tile_patches)) allocate (system%tile_patches)
         call build_tile_patches(system%tile_patches, model%tiling)
         system%volume_scale = spread(1.0_wp, 1, model%points%n_points)
      end if
      if (.not. allocated(system%held_edges)) then
         call find_held_edges(system%held_edges, model%boundaries, model%tiling, &
                              model%grid%smallest_spacing())
         call find_loaded_edges(system%loaded_edges, model%edge_loads, model%tiling, &
                                model%grid%smallest_spacing())
      end if
      call find_stabilised_faces(system, model)
      system%hourglass_stiffness = [(hourglass_stiffness(model, p), p=1, model%points%n_points)]
   end subroutine find_tile_participants

   !> Let what is on both sides of a plate move apart.
   pure subroutine loosen_beside_plates(is_loose, model)
      !> See `map_tiles`; allocated where there are plates.
      logical, allocatable, intent(inout) :: is_loose(:)
      type(model_type), intent(in) :: model
      type(face_type), allocatable :: sides(:)
      real(wp) :: h
      integer :: p

      h = model%grid%smallest_spacing()
      call find_plates(sides, model%boundaries, model%points%position, h)
      if (size(sides) == 0) return
      if (.not. allocated(is_loose)) allocate (is_loose(model%points%n_points), source=.false.)
      do p = 1, size(is_loose)
         is_loose(p) = is_loose(p) .or. is_beside(sides, model%points%position(:, p), &
                                                  beside_plate*h, 0.0_wp)
      end do
   end subroutine loosen_beside_plates

   !> Find the contacts of a step, which depend on the way that boundaries go in it.
   subroutine find_contacts(system, model)
      !> System of the step.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      type(motion_type) :: motion(size(model%boundaries))
      integer :: b

      do b = 1, size(model%boundaries)
         motion(b) = boundary_motion(model, b, system%start_time, system%end_time)
      end do
      call build_contacts(system%contacts, model%boundaries, motion, model%tiling, &
                          system%held_edges, model%grid%smallest_spacing(), system%cuts)
      system%has_friction = any(model%boundaries%has_friction())
      if (allocated(system%surfaces)) system%has_friction = system%has_friction &
         .or. any(model%body_contacts%rubs())
      system%has_tension = any(model%boundaries%tension_limit > 0.0_wp)
      if (system%has_friction .or. system%has_tension &
          .or. any(model%boundaries%formulation == formulation_augmented)) then
         call recall_contacts(system%contacts, system%last_contacts, motion, model%tiling)
      end if
      if (system%has_tension) then
         call recall_bonds(system%contacts, system%bonds, model%boundaries, model%tiling, &
                           model%grid%smallest_spacing())
      end if
   end subroutine find_contacts

   !> Number the unknowns; make pattern, scatter map and symbolic factorisation unless those of the
   !> last step still hold.
   subroutine number_tile_system(system, model, has_failed)
      !> System of the step.
      type(system_type), intent(inout) :: system
      !> Scene.
      type(model_type), intent(in) :: model
      !> Could the pattern not be analysed?
      logical, intent(out) :: has_failed
      logical :: is_core(system%cells%n_nodes), may_lead(system%cells%n_cells)
      type(coupling_type) :: faces
      type(element_dofs_type) :: elements

      is_core = system%map%node_area >= model%control%fill_tolerance &
         .or. model%control%small_cells /= small_cells_aggregate
      may_lead = all_are_core(system, is_core)
      ! a body smaller than a cell has nothing to follow
      is_core = is_core .or. .not. any(may_lead)
      call number_dofs(system%dofs, model%grid, system%cells, is_core, may_lead, &
                       system%map%fill, model%fixities)
      call build_stars(system%stars, model%tiling%corner, model%tiling%n_corners)
      call couple_stars(system%groups, system%stars, system%map, system%dofs)
      call couple_faces(faces, system)
      call find_loose_parts(system, model)
      call gather_mass(system, model)
      call make_room(system, size(model%boundaries))
      elements = joined(system%groups%elements, faces%elements)
      if (size(model%body_contacts) > 0) then
         call meet_surfaces(system, model)
         elements = joined(elements, system%surfaces%coupling%elements)
      end if
      if (allocated(system%tile_patches)) then
         call couple_tile_patches(system%tile_patches, system%map, system%dofs)
         elements = joined(elements, system%tile_patches%coupling%elements)
      end if
      call renew_pattern(system, elements, has_failed)
      if (.not. has_failed) call set_ghost_values(system, faces)
   end subroutine number_tile_system

   !> Free components of tools, with their pivots and the loads on them at the end of the step.
   subroutine set_border(system, model)
      !> System with numbered nodes.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      type(motion_type) :: motion
      real(wp) :: factor, drag
      integer :: j

      call new_border(system%border, model%boundaries, system%cells%n_nodes, &
                      model%tiling%n_corners)
      drag = 0.0_wp
      if (system%settling_drag > 0.0_wp .and. system%border%n > 0) drag = mean_drag(system, model)
      do j = 1, system%border%n
         associate (b => system%border%boundary(j))
            motion = boundary_motion(model, b, system%start_time, system%end_time)
            system%border%motion(b)%centre = motion%centre + motion%translation
            associate (tool => model%boundaries(b))
               system%border%drag(j) = drag*product(maxval(tool%vertices, dim=2) &
                                                    - minval(tool%vertices, dim=2))
               factor = load_factor(model, tool%load_table, system%end_time, tool%ramp_phase)
               system%border%pull(j) = tool_load_type( &
                  factor*tool%load, factor*tool%moment, &
                  matmul(turn_matrix(motion%rotation), tool%lever))
            end associate
         end associate
      end do
   end subroutine set_border

   !> Drag on bodies that settle, per area: free tools have it for theirs, too.
   pure function mean_drag(system, model) result(drag)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      real(wp) :: drag
      integer :: p

      drag = sum([(settling_drag_of(system, model, p), p=1, model%points%n_points)]) &
         /real(model%points%n_points, wp)
   end function mean_drag

   !> Are all nodes of a cell unknowns of their own?
   pure function all_are_core(system, is_core) result(answer)
      type(system_type), intent(in) :: system
      logical, intent(in) :: is_core(:)
      logical :: answer(system%cells%n_cells)
      integer :: c

      do c = 1, system%cells%n_cells
         answer(c) = all(is_core(system%cells%node(:, c)))
      end do
   end function all_are_core

   !> Share out the mass of the tiles to the nodes; only when there is a body force.
   subroutine gather_mass(system, model)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      real(wp) :: at_corners(2, model%tiling%n_corners), nodal(2, system%cells%n_nodes), mass
      integer :: p, v

      if (allocated(system%nodal_mass)) deallocate (system%nodal_mass)
      if (.not. any(abs(model%body_force%acceleration) > 0.0_wp)) return
      at_corners = 0.0_wp
      do p = 1, model%points%n_points
         mass = model%bodies(model%points%body(p))%density*model%points%reference_volume(p)
         associate (corner => model%tiling%corner(:, p), &
                    weight => corner_weights(model%tiling%position(:, model%tiling%corner(:, p))))
            do v = 1, 4
               at_corners(1, corner(v)) = at_corners(1, corner(v)) + mass*weight(v)
            end do
         end associate
      end do
      nodal = 0.0_wp
      call spread_to_nodes(system%map, at_corners, nodal)
      system%nodal_mass = nodal(1, :)
   end subroutine gather_mass

end module coulter_setup_tiles
