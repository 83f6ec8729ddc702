!> From the description of a scene to a model that can run: check it as a whole, seed its points.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_prepare
   use coulter_base_faults, only: fault_list_type
   use coulter_base_kinds, only: wp
   use coulter_base_tensor, only: finger_of_log_strain_plane, log_strain_plane
   use coulter_base_text, only: to_text
   use coulter_law_abstract, only: law_response_type, law_visit_type
   use coulter_model, only: model_type, point_moduli
   use coulter_model_control, only: domains_tiles
   use coulter_model_embedding, only: embed_tools
   use coulter_model_initial_stress, only: initial_stress
   use coulter_model_phases, only: activate
   use coulter_model_scene_check, only: check_edge_loads, check_scene
   use coulter_model_separation, only: find_softer_sides, separate_bodies
   use coulter_points_seeding, only: seed_points, seed_tiles
   use coulter_points_tile_groups, only: group_tiles
   use coulter_points_tiling, only: remember_pulls
   implicit none(type, external)
   private
   public :: prepare_model

   !> Relative error of the stress with which a law may answer the initial stress, and plastic
   !> strain that it may add.
   real(wp), parameter :: accepted_start_error = 1.0e-6_wp

contains

   !> Check what only the whole scene can tell, and fill the bodies with points. All faults are
   !> collected; the model can run when there are none.
   subroutine prepare_model(model, faults)
      !> Scene whose parts are valid by themselves; gets its points. What it does without need not
      !> be allocated.
      type(model_type), intent(inout) :: model
      !> Faults found; regions are counted over all bodies in order.
      type(fault_list_type), intent(inout) :: faults
      integer :: known_faults

      known_faults = faults%n_faults
      call allocate_missing(model)
      call check_scene(model, faults)
      call separate_bodies(model, faults)
      if (faults%n_faults > known_faults) return
      call embed_tools(model, faults)
      if (faults%n_faults > known_faults) return
      call activate(model, 1)
      call seed_model(model)
      call find_softer_sides(model)
      call check_initial_stress(model, faults)
      if (model%points%n_points == 0) call faults%add("region", 0, "", "no region holds material")
      if (allocated(model%tiling)) then
         call check_edge_loads(model, faults)
      else if (allocated(model%body_force%field)) then
         call faults%add("body_force", 0, "", "a field of acceleration needs tiled domains")
      end if
   end subroutine prepare_model

   !> Empty lists of what the scene does without.
   pure subroutine allocate_missing(model)
      type(model_type), intent(inout) :: model

      if (.not. allocated(model%fixities)) allocate (model%fixities(0))
      if (.not. allocated(model%boundaries)) allocate (model%boundaries(0))
      if (.not. allocated(model%body_contacts)) allocate (model%body_contacts(0))
      if (.not. allocated(model%edge_loads)) allocate (model%edge_loads(0))
      if (.not. allocated(model%tables)) allocate (model%tables(0))
   end subroutine allocate_missing

   !> Points of all bodies with their initial stress.
   subroutine seed_model(model)
      type(model_type), intent(inout) :: model
      integer :: i, n_state, p

      n_state = 0
      do i = 1, size(model%laws)
         n_state = max(n_state, model%laws(i)%law%n_state)
      end do
      if (model%control%domains == domains_tiles) then
         allocate (model%tiling)
         call seed_tiles(model%points, model%tiling, model%grid, model%bodies, n_state)
         if (model%control%has_mean_volume) then
            call group_tiles(model%tiling, model%points, model%grid, model%bodies)
         end if
      else
         call seed_points(model%points, model%grid, model%bodies, n_state)
      end if
      if (model%control%has_mean_volume) then
         allocate (model%points%shared_ratio(model%points%n_points), source=1.0_wp)
      end if
      if (.not. all_are_elastic(model)) then
         allocate (model%points%has_flowed(model%points%n_points), source=.false.)
         if (allocated(model%tiling)) call remember_pulls(model%tiling)
      end if
      do p = 1, model%points%n_points
         call start_point(model, p, initial_stress(model, model%points%body(p), &
                                                   model%points%position(:, p)))
      end do
   end subroutine seed_model

   !> Does no law flow?
   pure function all_are_elastic(model) result(answer)
      type(model_type), intent(in) :: model
      logical :: answer
      integer :: i

      answer = .true.
      do i = 1, size(model%laws)
         answer = answer .and. model%laws(i)%law%is_elastic
      end do
   end function all_are_elastic

   !> The law of every point must return the stress with which it starts.
   subroutine check_initial_stress(model, faults)
      type(model_type), intent(inout) :: model
      type(fault_list_type), intent(inout) :: faults
      type(law_response_type) :: response
      real(wp) :: strain(4), modulus(2)
      real(wp), allocatable :: state(:)
      integer :: p, last

      last = 0
      do p = 1, model%points%n_points
         associate (body => model%points%body(p), start => model%points%converged, &
                    law => model%laws(model%bodies(model%points%body(p))%law)%law)
            if (law%is_incremental .or. body == last) cycle
            state = start%law_state(:law%n_state, p)
            call log_strain_plane(start%elastic_finger(:, p), strain)
            call law%update(law_visit_type(point=p), strain, start%law_state(:law%n_state, p), &
                            response, state)
            call point_moduli(model, p, modulus(1), modulus(2))
            if (.not. response%has_failed) then
               if (norm2(response%strain - strain) <= accepted_start_error .and. &
                   norm2(response%stress - start%kirchhoff_stress(:, p)) <= accepted_start_error &
                   *(norm2(start%kirchhoff_stress(:, p)) + accepted_start_error*modulus(2))) cycle
            end if
            last = body
            call faults%add("body", body, "initial_stress", "law "//law%name//" cannot carry ("// &
                            to_text(start%kirchhoff_stress(:, p))//") at (" &
                            //to_text(model%points%position(:, p))//")")
         end associate
      end do
   end subroutine check_initial_stress

   !> Initial state of a point that carries a stress.
   subroutine start_point(model, p, stress)
      type(model_type), intent(inout) :: model
      integer, intent(in) :: p
      real(wp), intent(in) :: stress(4)

      associate (law => model%laws(model%bodies(model%points%body(p))%law)%law, &
                 start => model%points%converged)
         associate (state => start%law_state(:law%n_state, p))
            call law%initial_state(stress, model%points%position(:, p), state)
            call finger_of_log_strain_plane(law%elastic_strain(stress, state), &
                                            start%elastic_finger(:, p))
            ! Cauchy stress as well, since J = 1
            start%kirchhoff_stress(:, p) = stress
         end associate
      end associate
   end subroutine start_point

end module coulter_model_prepare
