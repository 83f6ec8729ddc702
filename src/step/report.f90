!> Facts about the scene and about every step, for logs and results.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_report
   use coulter_algebra_condition, only: scaled_condition
   use coulter_assembly_loose_parts, only: name_loose_parts, name_toppling
   use coulter_base_kinds, only: long, wp
   use coulter_base_text, only: to_text
   use coulter_model, only: model_type
   use coulter_model_observer, only: add_warning, scene_report_type, step_report_type
   use coulter_newton, only: newton_type
   use coulter_newton_diagnosis, only: ghost_advice
   use coulter_points, only: points_memory
   use coulter_points_tiling, only: measure_quality
   use coulter_retile_meetings, only: report_meetings
   use coulter_step_contact_report, only: report_contacts, report_surfaces
   use coulter_step_penetration, only: measure_penetrations
   use coulter_step_thin_tools, only: report_thin_tools
   use coulter_system, only: system_memory, system_type
   use coulter_system_dofs, only: reduce
   implicit none(type, external)
   private
   public :: report_scene, report_step

   !> Boundary length that carries no load is reported from this share of the whole.
   real(wp), parameter :: notable_share = 1.0e-3_wp

   !> Residuals above this are warned of where round-off, not the tolerance, ended the iteration.
   real(wp), parameter :: notable_residual = 1.0e-5_wp

contains

   !> Facts about the scene, once the first system is numbered.
   pure subroutine report_scene(scene, model, system)
      !> Facts to collect.
      type(scene_report_type), intent(out) :: scene
      !> The scene.
      type(model_type), intent(in) :: model
      !> Its numbered system.
      type(system_type), intent(in) :: system

      scene%n_points = model%points%n_points
      scene%n_grid_cells = product(int(model%grid%n_cells, long))
      scene%n_cells = system%cells%n_cells
      scene%n_nodes = system%cells%n_nodes
      scene%n_dofs = system%dofs%n_dofs
      scene%n_entries = system%pattern%n_entries
      scene%memory = points_memory(model%points) + system_memory(system)
   end subroutine report_scene

   !> What happened in a step; the model has moved on, the system has not.
   subroutine report_step(report, model, system, newton)
      !> Facts to collect; the caller adds number, halvings and times.
      type(step_report_type), intent(out) :: report
      !> The scene at the end of the step.
      type(model_type), intent(in) :: model
      !> The system in equilibrium.
      type(system_type), intent(inout) :: system
      !> How the iteration went.
      type(newton_type), intent(in) :: newton

      report%time = model%time
      report%load_factor = model%time/model%schedule%end_time(size(model%schedule%end_time))
      report%time_increment = system%end_time - system%start_time
      report%n_iterations = newton%n_iterations
      report%residuals = newton%residuals
      if (model%control%has_condition) then
         report%condition = scaled_condition(system%pattern, system%values)
      end if
      report%n_cells = system%cells%n_cells
      report%n_nodes = system%cells%n_nodes
      report%n_dofs = system%dofs%n_dofs
      report%has_reused_pattern = system%has_reused_pattern
      report%loaded_lengths = system%loaded_length
      report%body_force = sum(system%external, dim=2)
      report%boundary_reactions = system%boundary_reaction
      call sum_fixity_reactions(report, model, system)
      report%imbalance = report%body_force + sum(report%boundary_reactions, dim=2) &
         + sum(report%fixity_reactions, dim=2)
      if (allocated(model%tiling)) then
         call measure_penetrations(report, model, system%held_edges%boundary == 0)
      else
         call measure_penetrations(report, model)
      end if
      call report_contacts(report, model, system)
      if (allocated(system%surfaces)) call report_surfaces(report, model, system)
      if (allocated(model%tiling)) then
         call measure_quality(model%tiling, report%worst_corner, report%worst_aspect)
      end if
      call collect_warnings(report, model, system)
      if (allocated(model%tiling)) then
         call report_meetings(report, model, system)
         call report_thin_tools(report, model, system)
         call name_loose_parts(report, model, system)
         call name_toppling(report, model, system)
      end if
      call doubt(report, newton, model)
   end subroutine report_step

   !> Force of every fixity on the body: what the held components lack in balance.
   subroutine sum_fixity_reactions(report, model, system)
      type(step_report_type), intent(inout) :: report
      type(model_type), intent(in) :: model
      type(system_type), intent(in) :: system
      real(wp), allocatable :: unbalanced(:, :)
      real(wp) :: reduced(system%dofs%n_dofs)
      integer :: node, i, f

      allocate (report%fixity_reactions(2, size(model%fixities)), source=0.0_wp)
      if (size(model%fixities) == 0) return
      unbalanced = system%internal + system%boundary - system%external
      call reduce(system%dofs, unbalanced, reduced)
      do node = 1, size(unbalanced, 2)
         do i = 1, 2
            f = system%dofs%fixity(i, node)
            if (f == 0) cycle
            report%fixity_reactions(i, f) = report%fixity_reactions(i, f) + unbalanced(i, node)
         end do
      end do
   end subroutine sum_fixity_reactions

   !> What the user should know although the step succeeded.
   pure subroutine collect_warnings(report, model, system)
      type(step_report_type), intent(inout) :: report
      type(model_type), intent(in) :: model
      type(system_type), intent(in) :: system
      integer :: b

      report%warnings = ""
      do b = 1, size(model%boundaries)
         if (.not. model%boundaries(b)%is_active) cycle
         associate (loaded => system%loaded_length(b), &
                    lost => system%lost_length(b), boundary => model%boundaries(b))
            if (lost > notable_share*(loaded + lost)) then
               call add_warning(report%warnings, "boundary "//boundary%name//": " &
                                //to_text(lost, 3)//" of its length reach material but carry no" &
                                //" load, since the cells there are empty or left out")
            else if (.not. (loaded > 0.0_wp .or. boundary%may_start_apart)) then
               call add_warning(report%warnings, "boundary "//boundary%name &
                                //" holds no material")
            end if
         end associate
      end do
   end subroutine collect_warnings

   !> Warn of answers that are not determined well.
   pure subroutine doubt(report, newton, model)
      type(step_report_type), intent(inout) :: report
      type(newton_type), intent(in) :: newton
      type(model_type), intent(in) :: model
      real(wp) :: residual

      if (newton%is_nearly_singular) then
         call add_warning(report%warnings, "the tangent is nearly singular: a body may be free to" &
                          //" move, since no boundary or fixity holds it, and its place" &
                          //" arbitrary"//ghost_advice(model))
      end if
      residual = newton%residuals(size(newton%residuals))
      if (newton%is_limited_by_round_off .and. residual > notable_residual) then
         call add_warning(report%warnings, "the strains of this step are hardly more than" &
                          //" round-off: forces balance to "//to_text(residual, 2) &
                          //" of their size only")
      end if
   end subroutine doubt

end module coulter_step_report
