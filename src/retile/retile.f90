!> New tiles for bodies whose tiles are distorted, between two steps.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile
   use coulter_assembly_hourglass, only: limit_pulls
   use coulter_base_kinds, only: wp
   use coulter_base_tensor, only: finger_of_log_strain_plane, log_strain_plane
   use coulter_base_text, only: to_text
   use coulter_boundary_edge_load, only: carry_loaded_edges, loaded_edge_type
   use coulter_boundary_held_edge, only: carry_held_edges, held_edge_type
   use coulter_boundary_motion, only: largest_shift
   use coulter_law_abstract, only: law_response_type, law_visit_type, n_plane
   use coulter_model, only: model_type
   use coulter_model_observer, only: add_warning, step_report_type
   use coulter_newton_guess, only: carry_motion
   use coulter_points, only: points_type
   use coulter_points_folds, only: fold_type
   use coulter_points_parts, only: find_parts, part_type
   use coulter_points_tile_groups, only: group_tiles
   use coulter_points_tile_quality, only: is_distorted, is_worn
   use coulter_points_tiling, only: remember_pulls, tiling_type
   use coulter_retile_contact_transfer, only: carry_contacts
   use coulter_retile_kept_tiles, only: bring_back, keep_tiles
   use coulter_retile_leads, only: are_cuts_due, look_ahead, next_time, note_roots
   use coulter_retile_meetings, only: do_overlap, report_joints
   use coulter_retile_new_tiles, only: make_tiles
   use coulter_retile_parting, only: report_parting
   use coulter_retile_state_transfer, only: transfer_points
   use coulter_retile_surface_transfer, only: carry_surfaces
   use coulter_setup_bonds, only: carry_bonds
   use coulter_system, only: system_type
   use coulter_system_contact_state, only: depth_given, whole_motion
   use coulter_system_kept_tiles, only: kept_tiles_type
   implicit none(type, external)
   private
   public :: retile_if_distorted, retile_model, cut_ahead

   !> Way of tools after which flowing bodies are tiled anew, over the spacing.
   real(wp), parameter :: longest_way = 0.4_wp
   !> Depth from which on corners that give are put back onto their face by new tiles, over the
   !> spacing.
   real(wp), parameter :: most_given = 0.01_wp

contains

   !> Tile all bodies anew if the report of a step finds their tiles distorted, and say so; where
   !> material flows, also each time that tools have gone some way and tiles are no longer good.
   subroutine retile_if_distorted(model, system, report)
      !> Scene at the end of the step.
      type(model_type), intent(inout) :: model
      !> Its system.
      type(system_type), intent(inout) :: system
      !> What happened in the step.
      type(step_report_type), intent(inout) :: report
      real(wp) :: way
      type(part_type), allocatable :: parts(:)
      type(fold_type), allocatable :: folds(:)
      logical :: are_distorted, are_due, do_lie_over, has_failed
      integer :: part(model%points%n_points)

      if (allocated(system%kept_tiles)) deallocate (system%kept_tiles)
      way = way_of_tools(model, system)/model%grid%smallest_spacing()
      system%way_since_tiling = system%way_since_tiling + way
      are_distorted = is_distorted(report%worst_corner, report%worst_aspect)
      are_due = is_flowing(model) .and. system%way_since_tiling >= longest_way &
         .and. is_worn(report%worst_corner, report%worst_aspect)
      call look_ahead(system, model, next_time(model, system%end_time - system%start_time))
      are_due = are_due .or. (model%control%may_retile .and. (are_cuts_due(system, model) &
                                                              .or. have_given(system, model)))
      do_lie_over = do_overlap(system, model%grid%smallest_spacing())
      if (.not. (are_distorted .or. are_due .or. do_lie_over)) then
         call note_roots(system, model)
         return
      end if
      call find_parts(parts, model%tiling, model%points%body, size(model%bodies), part)
      folds = system%folds
      has_failed = .true.
      if (model%control%may_retile) call retile_model(model, system, has_failed)
      call note_roots(system, model)
      report%has_retiled = .not. has_failed
      if (report%has_retiled) then
         call report_joints(report, model, folds)
         call report_parting(report, model, system, parts)
      end if
      if (are_due .and. way > longest_way) then
         call add_warning(report%warnings, "a boundary moves by "//to_text(way, 2) &
                          //" cells in this step while material flows: forces are worth less" &
                          //" than with steps of a fifth of a cell")
      end if
      if (are_due .and. .not. (report%has_retiled .or. are_distorted) &
          .and. model%control%may_retile) then
         call add_warning(report%warnings, "new tiles are due where material flows: " &
                          //outcome_of(model, .false.))
      end if
      if (.not. are_distorted) return
      call add_warning(report%warnings, "tiles were distorted (worst corner " &
                       //to_text(report%worst_corner, 2)//", worst aspect " &
                       //to_text(report%worst_aspect, 2)//", both 1 at first): " &
                       //outcome_of(model, report%has_retiled))
   end subroutine retile_if_distorted

   !> Tile all bodies anew before a step if that needs cuts ahead of corners of tools: where tiles
   !> are new already, from those before, as if there had been no others.
   subroutine cut_ahead(model, system, end_time)
      !> Scene at the start of the step.
      type(model_type), intent(inout) :: model
      !> Its system, set up.
      type(system_type), intent(inout) :: system
      !> When the step will end.
      real(wp), intent(in) :: end_time
      type(kept_tiles_type), allocatable :: latest
      logical :: has_failed, has_roots

      if (.not. (allocated(model%tiling) .and. model%control%may_retile)) return
      has_roots = .false.
      if (allocated(system%cuts)) then
         has_roots = any(system%cuts%corner > 0)
         ! nobody has seen what soil did where no root was
         if (system%must_recut) where (system%cuts%corner == 0) system%cuts%way = 0.0_wp
      end if
      call look_ahead(system, model, end_time)
      ! roots may also be too far ahead for a step that has been halved
      if (has_roots .or. are_cuts_due(system, model)) then
         if (allocated(system%kept_tiles)) then
            allocate (latest)
            call keep_tiles(latest, model, system)
            call bring_back(system%kept_tiles, model, system)
         end if
         call retile_model(model, system, has_failed)
         if (has_failed .and. allocated(latest)) then
            call bring_back(latest, model, system)
            call retile_model(model, system, has_failed)
         end if
         system%is_set_up = .false.
      end if
      call note_roots(system, model)
   end subroutine cut_ahead

   !> Are corners that give near open ends of faces so deep behind these that new tiles are to put
   !> them back, before they get deeper in the next step?
   pure function have_given(system, model) result(answer)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      logical :: answer
      integer :: k

      answer = .false.
      do k = 1, system%contacts%n
         answer = depth_given(system, system%contacts%item(k)) &
            > most_given*model%grid%smallest_spacing()
         if (answer) return
      end do
   end function have_given

   !> How far the fastest boundary has moved in the step.
   pure function way_of_tools(model, system) result(way)
      type(model_type), intent(in) :: model
      type(system_type), intent(in) :: system
      real(wp) :: way
      integer :: b

      way = 0.0_wp
      do b = 1, size(model%boundaries)
         if (.not. model%boundaries(b)%is_active) cycle
         way = max(way, largest_shift(whole_motion(system, model, b), model%boundaries(b)%vertices))
      end do
   end function way_of_tools

   !> Has any point flowed plastically in the step?
   pure function is_flowing(model) result(answer)
      type(model_type), intent(in) :: model
      logical :: answer

      answer = allocated(model%points%has_flowed)
      if (answer) answer = any(model%points%has_flowed)
   end function is_flowing

   !> Tile all bodies anew. Nothing changes when that cannot be done: two bodies that share corners
   !> would do so no more, or a new tile has no area or a state that its law refuses.
   subroutine retile_model(model, system, has_failed)
      !> Scene between two steps.
      type(model_type), intent(inout) :: model
      !> Its system; what hangs on outer edges moves to the new ones.
      type(system_type), intent(inout) :: system
      !> Is everything as it was?
      logical, intent(out) :: has_failed
      type(tiling_type) :: tiling, old_tiling
      type(points_type) :: points
      type(held_edge_type), allocatable :: held(:)
      type(loaded_edge_type), allocatable :: loaded(:)
      integer, allocatable :: owner(:), old_body(:)

      call make_tiles(model, tiling, owner, has_failed, system%cuts)
      if (has_failed) return
      call transfer_points(points, tiling, owner, model%points, model%tiling, &
                           model%grid%smallest_spacing())
      if (allocated(model%tiling%patch)) call group_tiles(tiling, points, model%grid, model%bodies)
      if (allocated(points%has_flowed)) call remember_pulls(tiling)
      call find_stresses(model, points, has_failed)
      if (has_failed) return
      if (allocated(system%cuts) .and. .not. allocated(system%kept_tiles)) then
         if (.not. any(system%cuts%goes_in)) then
            allocate (system%kept_tiles)
            call keep_tiles(system%kept_tiles, model, system)
         end if
      end if
      call carry_held_edges(held, tiling, system%held_edges, model%tiling)
      call carry_loaded_edges(loaded, tiling, system%loaded_edges, model%tiling)
      if (allocated(system%bonds)) call carry_bonds(system%bonds, tiling, model%tiling)
      call move_alloc(held, system%held_edges)
      call move_alloc(loaded, system%loaded_edges)
      old_tiling = model%tiling
      old_body = model%points%body
      model%tiling = tiling
      model%points = points
      call note_roots(system, model)
      call limit_pulls(model)
      ! what else hangs on flow begins anew: sand that drops its contacts finds no balance otherwise
      if (allocated(model%points%has_flowed)) model%points%has_flowed = .false.
      call carry_contacts(system, model, old_tiling)
      if (allocated(system%surfaces)) then
         call carry_surfaces(system, model)
         call carry_motion(system, model, old_tiling, old_body)
      end if
      system%way_since_tiling = 0.0_wp
   end subroutine retile_model

   !> Two bodies whose tiles share a corner; zeros if there are none.
   pure function sharing_bodies(model) result(pair)
      type(model_type), intent(in) :: model
      integer :: pair(2)
      integer :: body(model%tiling%n_corners), p, v

      body = 0
      pair = 0
      do p = 1, model%points%n_points
         do v = 1, 4
            associate (owner => body(model%tiling%corner(v, p)))
               if (owner /= 0 .and. owner /= model%points%body(p)) then
                  pair = [owner, model%points%body(p)]
                  return
               end if
               owner = model%points%body(p)
            end associate
         end do
      end do
   end function sharing_bodies

   !> What became of distorted tiles, in words.
   pure function outcome_of(model, has_retiled) result(outcome)
      type(model_type), intent(in) :: model
      logical, intent(in) :: has_retiled
      character(len=:), allocatable :: outcome
      integer :: pair(2)

      outcome = "the bodies have been tiled anew"
      if (has_retiled) return
      outcome = "forces cannot be trusted"
      if (.not. model%control%may_retile) return
      pair = sharing_bodies(model)
      if (pair(1) == 0) then
         outcome = "no new tiles fit the bodies, "//outcome
      else
         outcome = "bodies "//model%bodies(pair(1))%name//" and "//model%bodies(pair(2))%name &
            //" share corners and cannot be tiled anew, "//outcome
      end if
   end function outcome_of

   !> Stress of points whose elastic strain is known.
   subroutine find_stresses(model, points, has_failed)
      type(model_type), intent(in) :: model
      type(points_type), intent(inout) :: points
      logical, intent(out) :: has_failed
      type(law_response_type) :: response
      real(wp) :: strain(n_plane), state(points%n_state)
      integer :: p

      has_failed = .false.
      associate (new => points%converged)
         do p = 1, points%n_points
            associate (item => model%laws(model%bodies(points%body(p))%law))
               call log_strain_plane(new%elastic_finger(:, p), strain)
               state = new%law_state(:, p)
               ! no time passes
               call item%law%update(law_visit_type(time=model%time, point=p), strain, &
                                    state(:item%law%n_state), response, &
                                    new%law_state(:item%law%n_state, p))
               has_failed = response%has_failed
               if (has_failed) return
               new%kirchhoff_stress(:, p) = response%stress
               if (item%law%is_elastic) cycle
               call finger_of_log_strain_plane(response%strain, new%elastic_finger(:, p))
            end associate
         end do
      end associate
   end subroutine find_stresses

end module coulter_retile
