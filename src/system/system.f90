!> The equilibrium system of one step: who takes part, the equations, and their solution.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system
   use, intrinsic :: iso_c_binding, only: c_int
   use coulter_algebra_pattern, only: build_pattern
   use coulter_algebra_solver, only: solver_type
   use coulter_algebra_sparse, only: element_dofs_type, pattern_type
   use coulter_base_kinds, only: long, wp
   use coulter_base_timer, only: stopwatch_type
   use coulter_boundary_edge_load, only: loaded_edge_type
   use coulter_boundary_held_edge, only: held_edge_type
   use coulter_boundary_stations, only: stations_type
   use coulter_contact, only: contacts_type
   use coulter_grid_cells, only: cells_type
   use coulter_law_abstract, only: law_sites_type, law_verdict_type, law_visit_type
   use coulter_model_contact_report, only: contact_report_type
   use coulter_points_folds, only: fold_type
   use coulter_system_border, only: border_type
   use coulter_contact_cut, only: cut_type
   use coulter_system_dofs, only: dofs_type
   use coulter_system_ghost, only: ghost_type
   use coulter_system_kept_tiles, only: kept_tiles_type
   use coulter_system_patches, only: patches_memory, patches_type
   use coulter_system_star_groups, only: groups_memory, star_groups_type
   use coulter_system_surfaces, only: surfaces_type
   use coulter_system_tile_map, only: tile_map_type
   use coulter_system_tile_patches, only: tile_patches_memory, tile_patches_type
   use coulter_system_tile_stars, only: stars_memory, tile_stars_type
   implicit none(type, external)
   private
   public :: system_type, motion_memory_type, renew_pattern, make_room, system_memory

   !> Motion of the nodes in a step.
   type :: motion_memory_type
      !> Grid index of every active node, shape (2, n_nodes).
      integer, allocatable :: node_index(:, :)
      !> How far it moved, length units, shape (2, n_nodes), and in what time.
      real(wp), allocatable :: increment(:, :)
      real(wp) :: duration = 0.0_wp
      !> Where several nodes may stand at one place: the nodes that every corner hung on, shape
      !> (4, n_corners), and how far it moved, length units, shape (2, n_corners).
      integer, allocatable :: corner_node(:, :)
      real(wp), allocatable :: corner_increment(:, :)
      !> Free motions of tools, length units, shape (border%n).
      real(wp), allocatable :: free(:)
      !> Relative residuals of the iteration that found it.
      real(wp), allocatable :: residuals(:)
   end type motion_memory_type

   !> Everything that lives for one step, and what is kept from step to step because it may not
   !> have changed (pattern, symbolic factorisation).
   type :: system_type
      !> Times at the start and the end of the step.
      real(wp) :: start_time = 0.0_wp, end_time = 0.0_wp
      !> Do cells, nodes, unknowns and pattern belong to the present state of the scene?
      logical :: is_set_up = .false.
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
      !> Points of cells that hang together beyond the nodes of their cells; only with boxes or
      !> shared volume changes.
      type(patches_type), allocatable :: patches
      !> For tiled bodies: where their corners sit in the grid.
      type(tile_map_type) :: map
      !> Stiffness of tiles against the mode that their points do not see, shape (n_tiles).
      real(wp), allocatable :: hourglass_stiffness(:)
      !> Contacts on their outer edges, and the edges that bilateral boundaries keep for good.
      type(contacts_type) :: contacts
      !> Contacts of the last accepted step, for tractions with memory.
      type(contacts_type) :: last_contacts
      type(held_edge_type), allocatable :: held_edges(:)
      !> Largest openings of edges against boundaries that hold tension, length units, see
      !> `coulter_setup_bonds`; unallocated where none does.
      real(wp), allocatable :: bonds(:, :, :)
      !> Surfaces of bodies with displacement fields of their own; unallocated where all share one.
      type(surfaces_type), allocatable :: surfaces
      !> Does any boundary rub, does any hold tension? Then a step begins with a prediction: what
      !> acted acts on, what stuck sticks, what slipped slips on, what had not opened does not,
      !> whatever the tractions; or, when nothing that rubs acted yet, with smooth contacts (theory,
      !> section 4).
      logical :: has_friction = .false., has_tension = .false.
      logical :: is_predicting = .false., is_smooth = .false.
      !> Does all stick that rubs and acts, for once?
      logical :: is_sticking = .false.
      !> Surfaces of bodies that meet at the end of the step, and the length of those of every pair
      !> of bodies that a warning has named last, length units, shape (n_bodies, n_bodies).
      type(fold_type), allocatable :: folds(:)
      !> Has a tool been named as too thin for what is on both sides of it? Shape (n_boundaries).
      logical, allocatable :: named_thin(:)
      real(wp), allocatable :: named_length(:, :)
      !> Has a body come apart, and has a warning named parts that are loose, or one that topples?
      logical :: has_come_apart = .false., has_named_loose = .false., has_named_toppling = .false.
      !> Drag on the tiles of loose parts per area and motion, stress over squared length, shape
      !> (n_tiles); unallocated if there are none.
      real(wp), allocatable :: drag(:)
      !> Drag on all tiles while bodies settle, over shear modulus and squared spacing, and the
      !> number of the part that is tried; 0 where they do not.
      real(wp) :: settling_drag = 0.0_wp
      integer :: n_settling = 0
      !> Forces of the boundaries before the tiles were made that have not been through a step yet,
      !> force per thickness, shape (2, n_boundaries); unallocated if all have.
      real(wp), allocatable :: forces_before_reset(:, :)
      !> Way of the fastest boundary since bodies were tiled, over the grid spacing.
      real(wp) :: way_since_tiling = 0.0_wp
      !> Cuts ahead of corners of tools that part material; unallocated where none does.
      type(cut_type), allocatable :: cuts(:)
      !> Tiles from before the last reset, until a step with the new ones is accepted; only with
      !> cuts.
      type(kept_tiles_type), allocatable :: kept_tiles
      !> Has a step been refused since a tip got into a tile, and how often has that been repeated?
      logical :: must_recut = .false.
      integer :: n_recuts = 0
      !> Edges that carry loads for good.
      type(loaded_edge_type), allocatable :: loaded_edges(:)
      !> Stabilised cell faces, their stiffness, and what they add to the tangent.
      type(ghost_type) :: ghost
      real(wp), allocatable :: ghost_stiffness(:), ghost_values(:)
      !> Tangent of all tiles in terms of their corners, and the way of corners to the unknowns.
      type(tile_stars_type) :: stars
      type(star_groups_type) :: groups
      !> Tiles that share their volume change; only where some do.
      type(tile_patches_type), allocatable :: tile_patches
      !> Shared volume change of every point over its own one, of the current iteration, shape
      !> (n_points); only where volume changes are shared.
      real(wp), allocatable :: volume_scale(:)
      !> Sparsity pattern of the tangent.
      type(pattern_type) :: pattern
      !> Values of the tangent, shape (n_entries).
      real(wp), allocatable :: values(:)
      !> Is the tangent assembled with the forces?
      logical :: needs_tangent = .true.
      !> Share of the elastic tangent that laws mix into theirs; 0 for consistent tangents.
      real(wp) :: stiffening = 0.0_wp
      !> Motion of the last step, with tiles, unless the next one begins without it.
      type(motion_memory_type), allocatable :: last_motion
      !> Direct solver.
      type(solver_type) :: solver
      !> Has the pattern of the last step been used again?
      logical :: has_reused_pattern = .false.
      !> Displacement increments of the nodes, length units, shape (2, n_nodes).
      real(wp), allocatable :: increment(:, :)
      !> Internal, boundary and external nodal forces, shape (2, n_nodes).
      real(wp), allocatable :: internal(:, :), boundary(:, :), external(:, :)
      !> The part of the external forces that does not depend on displacements, shape as these.
      real(wp), allocatable :: dead_load(:, :)
      !> Length of every boundary that acts on material, and that material reaches in vain, length
      !> units, shape (n_boundaries).
      real(wp), allocatable :: loaded_length(:), lost_length(:)
      !> Force of every boundary on the body, shape (2, n_boundaries).
      real(wp), allocatable :: boundary_reaction(:, :)
      !> Free components of tools.
      type(border_type) :: border
      !> What the boundaries felt at the end of the last step, to sum up their work; shapes
      !> (n_boundaries) and (2, n_boundaries).
      type(contact_report_type), allocatable :: last_report(:)
      real(wp), allocatable :: last_reaction(:, :)
      !> Mass that each node carries, shape (n_nodes).
      real(wp), allocatable :: nodal_mass(:)
      !> Where the points are; there if a law asks.
      type(law_sites_type), pointer :: sites => null()
      !> What a law that failed had to say; there if somebody asks.
      type(law_verdict_type), pointer :: verdict => null()
   contains
      procedure :: visit
      procedure :: forget_verdict
      procedure :: must_end_step
      procedure :: verdict_text
   end type system_type

contains

   !> What the law of a point is told about the step.
   function visit(self, point)
      class(system_type), intent(in) :: self
      !> Number of the point.
      integer, intent(in) :: point
      type(law_visit_type) :: visit

      visit%time = self%end_time
      visit%time_step = self%end_time - self%start_time
      visit%point = point
      visit%sites => self%sites
      visit%verdict => self%verdict
      visit%stiffening = self%stiffening
      visit%needs_moduli = self%needs_tangent
   end function visit

   !> Before laws are asked: none has failed.
   subroutine forget_verdict(self)
      class(system_type), intent(inout) :: self

      if (associated(self%verdict)) self%verdict = law_verdict_type()
   end subroutine forget_verdict

   !> Does a law that failed want the step to end, even if shorter corrections could be tried?
   pure function must_end_step(self) result(answer)
      class(system_type), intent(in) :: self
      logical :: answer

      answer = .false.
      if (associated(self%verdict)) answer = self%verdict%ends_step
   end function must_end_step

   !> What a law that failed says, to be added to a message; empty when it says nothing.
   pure function verdict_text(self) result(text)
      class(system_type), intent(in) :: self
      character(len=:), allocatable :: text

      text = ""
      if (.not. associated(self%verdict)) return
      if (allocated(self%verdict%message)) text = ": "//self%verdict%message
   end function verdict_text

   !> Make pattern, scatter map and symbolic factorisation, unless those of the last step hold.
   !> Other elements may have the same pattern, as when tiles have moved a little: then the
   !> factor at hand serves on, too.
   subroutine renew_pattern(system, elements, has_failed, order)
      !> System with numbered unknowns.
      type(system_type), intent(inout) :: system
      !> The unknowns that its elements couple.
      type(element_dofs_type), intent(in) :: elements
      !> Could the pattern not be analysed?
      logical, intent(out) :: has_failed
      !> Elimination order, zero-based, shape (n_dofs); the solver finds one if there is none.
      integer, intent(in), optional :: order(:)
      integer :: none(0)
      integer(c_int), allocatable :: last_start(:), last_row(:)

      has_failed = .false.
      system%has_reused_pattern = are_equal(system%elements, elements)
      if (system%has_reused_pattern) return
      system%elements = elements
      call move_alloc(system%pattern%column_start, last_start)
      call move_alloc(system%pattern%row, last_row)
      call build_pattern(system%pattern, system%dofs%n_dofs, system%elements)
      system%has_reused_pattern = has_entries(system%pattern, last_start, last_row)
      if (system%has_reused_pattern) return
      if (allocated(system%values)) deallocate (system%values)
      allocate (system%values(system%pattern%n_entries))
      if (present(order)) then
         call system%solver%analyse(system%pattern, order, has_failed)
      else
         call system%solver%analyse(system%pattern, none, has_failed)
      end if
      ! what could not be analysed must not be taken for known in the next attempt
      if (.not. has_failed) return
      system%elements%n_elements = -1
      deallocate (system%pattern%row)
   end subroutine renew_pattern

   !> Bytes that the system occupies, factors included.
   pure function system_memory(system) result(bytes)
      !> A numbered system.
      type(system_type), intent(in) :: system
      integer(long) :: bytes

      bytes = 4_long*int(size(system%cells%cell_index) + size(system%cells%node) &
                         + size(system%cells%node_index) + size(system%cells%cell_at) &
                         + size(system%elements%dof) + size(system%pattern%slot) &
                         + size(system%pattern%row), long) &
         + 8_long*int(size(system%values) + 4*size(system%increment), long) &
         + system%solver%factor_memory
      if (allocated(system%cells%point)) bytes = bytes + 4_long*int(size(system%cells%point), long)
      if (allocated(system%transform)) bytes = bytes + 8_long*int(size(system%transform), long)
      if (allocated(system%patches)) bytes = bytes + patches_memory(system%patches)
      if (allocated(system%volume_scale)) then
         bytes = bytes + 8_long*int(size(system%volume_scale), long)
      end if
      if (allocated(system%tile_patches)) then
         bytes = bytes + tile_patches_memory(system%tile_patches)
      end if
      if (allocated(system%last_motion)) then
         bytes = bytes + 12_long*int(size(system%last_motion%increment), long)
      end if
      if (allocated(system%map%area)) then
         bytes = bytes + stars_memory(system%stars) + groups_memory(system%groups) &
            + 8_long*int(10*size(system%map%area) + 8*size(system%map%shape, 2) &
                         + size(system%ghost_values), long)
      end if
   end function system_memory

   !> Nodal arrays of the step.
   pure subroutine make_room(system, n_boundaries)
      !> System with numbered nodes.
      type(system_type), intent(inout) :: system
      !> Number of boundaries.
      integer, intent(in) :: n_boundaries

      if (.not. allocated(system%boundary_reaction)) then
         allocate (system%boundary_reaction(2, n_boundaries))
         allocate (system%loaded_length(n_boundaries), source=0.0_wp)
         allocate (system%lost_length(n_boundaries), source=0.0_wp)
      end if
      if (allocated(system%increment)) then
         if (size(system%increment, 2) == system%cells%n_nodes) return
         deallocate (system%increment, system%internal, system%boundary, system%external, &
                     system%dead_load)
      end if
      allocate (system%increment(2, system%cells%n_nodes))
      allocate (system%internal, system%boundary, system%external, system%dead_load, &
                mold=system%increment)
   end subroutine make_room

   !> Has a pattern these entries? None are unallocated.
   pure function has_entries(pattern, column_start, row) result(answer)
      type(pattern_type), intent(in) :: pattern
      integer(c_int), allocatable, intent(in) :: column_start(:), row(:)
      logical :: answer

      answer = allocated(row)
      if (answer) answer = size(column_start) == size(pattern%column_start) &
         .and. size(row) == size(pattern%row)
      if (answer) answer = all(column_start == pattern%column_start)
      if (answer) answer = all(row == pattern%row)
   end function has_entries

   !> Do two lists couple the same unknowns in the same elements?
   pure function are_equal(first, second) result(answer)
      type(element_dofs_type), intent(in) :: first, second
      logical :: answer

      answer = first%n_elements == second%n_elements .and. allocated(first%dof)
      if (answer) answer = size(first%dof) == size(second%dof)
      if (answer) answer = all(first%start == second%start)
      if (answer) answer = all(first%dof == second%dof)
      if (answer .and. allocated(first%n_columns)) answer = all(first%n_columns == second%n_columns)
   end function are_equal

end module coulter_system
