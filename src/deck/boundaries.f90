!> Reads boundaries: what holds, rubs and moves the bodies.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_boundaries
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: augmented_band_ratio, boundary_type, formulation_augmented, &
      formulation_implicit, formulation_nitsche, implicit_band_ratio, kind_fixed, kind_roller, &
      nitsche_band_ratio
   use coulter_deck_document, only: blame, deck_type, find_groups
   use coulter_deck_outline, only: new_polyline
   use coulter_deck_references, only: check_unique_names, get_reference
   use coulter_deck_schedule, only: n_equal_steps, read_acting_phases
   use coulter_deck_values, only: get_choice, get_list, get_value, is_given, refuse
   use coulter_model_control, only: domains_tiles, schedule_type
   implicit none(type, external)
   private
   public :: read_boundaries, read_friction, read_motion

   !> Widest band over the spacing at which the coupling term K2 is safe: at 0.1 Newton converges,
   !> to stresses that are wrong by a third (theory, section 3).
   real(wp), parameter :: widest_coupled_band = 1.0e-2_wp
   !> Variables of shear and tension on boundaries.
   character(len=*), parameter :: friction_variables(*) = [character(len=15) :: &
      "friction", "adhesion", "shear_limit", "rough", "tension_limit", "tension_opening"]

contains

   !> All implicit boundaries.
   subroutine read_boundaries(deck, schedule, domains, boundaries)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Load steps and phases.
      type(schedule_type), intent(in) :: schedule
      !> What a point stands for: one of `domains_*`.
      integer, intent(in) :: domains
      !> Boundaries in the order of the deck.
      type(boundary_type), allocatable, intent(out) :: boundaries(:)
      integer, allocatable :: groups(:)
      integer :: i, choice

      call check_unique_names(deck, "boundary")
      call find_groups(deck, "boundary", groups)
      allocate (boundaries(size(groups)))
      do i = 1, size(groups)
         call read_boundary(deck, groups(i), boundaries(i), choice)
         call read_formulation(deck, groups(i), domains, boundaries(i))
         call read_vertices(deck, groups(i), boundaries(i)%vertices)
         call read_motion(deck, groups(i), choice, schedule, boundaries(i))
      end do
   end subroutine read_boundaries

   !> How one boundary holds the material.
   subroutine read_boundary(deck, group, boundary, kind)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(boundary_type), intent(out) :: boundary
      !> Number of its kind among the choices of the deck; 0 if at fault.
      integer, intent(out) :: kind
      integer, parameter :: kinds(0:3) = [kind_roller, kind_roller, kind_fixed, kind_fixed]

      boundary%name = ""
      call get_value(deck, group, "name", boundary%name)
      kind = 0
      call get_choice(deck, group, "kind", kind)
      boundary%kind = kinds(kind)
      call get_value(deck, group, "may_start_apart", boundary%may_start_apart)
   end subroutine read_boundary

   !> Which equations hold the material: Nitsche's for tiles, the paper's for points.
   subroutine read_formulation(deck, group, domains, boundary)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group, domains
      type(boundary_type), intent(inout) :: boundary
      integer :: choice

      choice = 3
      if (domains == domains_tiles) choice = 1
      call get_choice(deck, group, "formulation", choice)
      if (choice <= 2 .neqv. domains == domains_tiles) then
         call blame(deck, group, "formulation", "must be 'nitsche' or 'augmented' for domains =" &
                    //" 'cpdi2', and 'implicit' or 'penalty' for the others")
      else if (choice <= 2) then
         boundary%formulation = merge(formulation_nitsche, formulation_augmented, choice == 1)
         boundary%band_ratio = merge(nitsche_band_ratio, augmented_band_ratio, choice == 1)
         call read_contact(deck, group, boundary)
      else
         boundary%formulation = formulation_implicit
         boundary%band_ratio = implicit_band_ratio
         boundary%has_coupling_term = choice == 3
         call read_implicit(deck, group, boundary)
      end if
   end subroutine read_formulation

   !> Settings of boundaries that act on the corners of tiles.
   subroutine read_contact(deck, group, boundary)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(boundary_type), intent(inout) :: boundary

      boundary%is_bilateral = boundary%kind == kind_fixed
      call get_value(deck, group, "band_ratio", boundary%band_ratio)
      call get_value(deck, group, "bilateral", boundary%is_bilateral)
      if (boundary%kind == kind_fixed .and. .not. boundary%is_bilateral) then
         call blame(deck, group, "bilateral", "must be .true. unless kind = 'roller'")
      end if
      call read_friction(deck, group, boundary)
      call refuse(deck, group, "gauss_points", "belongs to 'implicit' and 'penalty'")
      call refuse(deck, group, "memory", "belongs to 'implicit' and 'penalty'; tiles need none")
   end subroutine read_contact

   !> Shear and tension on rollers.
   subroutine read_friction(deck, group, boundary)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Boundary or tool whose shear is read.
      type(boundary_type), intent(inout) :: boundary
      integer :: i

      if (boundary%kind /= kind_roller .or. boundary%formulation /= formulation_nitsche) then
         do i = 1, size(friction_variables)
            call refuse(deck, group, trim(friction_variables(i)), &
                        "belongs to kind = 'roller' with formulation = 'nitsche'")
         end do
         return
      end if
      call get_value(deck, group, "friction", boundary%friction)
      call get_value(deck, group, "adhesion", boundary%adhesion)
      call get_value(deck, group, "shear_limit", boundary%shear_limit)
      call get_value(deck, group, "rough", boundary%is_rough)
      call get_value(deck, group, "tension_limit", boundary%tension_limit)
      call get_value(deck, group, "tension_opening", boundary%tension_opening)
      if (boundary%is_bilateral) then
         call refuse(deck, group, "tension_limit", "stands beside `bilateral`, which holds any" &
                     //" tension")
      else if (boundary%tension_opening > 0.0_wp .and. .not. boundary%tension_limit > 0.0_wp) then
         call blame(deck, group, "tension_opening", "needs `tension_limit`")
      end if
      if (boundary%has_friction() .or. .not. is_given(deck, group, "shear_limit")) return
      call blame(deck, group, "shear_limit", "limits no shear: give `friction`, `adhesion` or" &
                 //" `rough`")
   end subroutine read_friction

   !> Settings of boundaries that act on segments.
   subroutine read_implicit(deck, group, boundary)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(boundary_type), intent(inout) :: boundary
      integer :: i

      boundary%formulation = formulation_implicit
      call get_value(deck, group, "band_ratio", boundary%band_ratio)
      if (boundary%has_coupling_term .and. boundary%band_ratio > widest_coupled_band) then
         call blame(deck, group, "band_ratio", "must be <= 0.01 with formulation 'implicit'," &
                    //" whose K2 makes wide bands indefinite; 'penalty' allows more")
      end if
      call get_value(deck, group, "gauss_points", boundary%n_gauss)
      call get_value(deck, group, "memory", boundary%has_memory)
      call refuse(deck, group, "bilateral", "belongs to domains = 'cpdi2'")
      do i = 1, size(friction_variables)
         call refuse(deck, group, trim(friction_variables(i)), "belongs to domains = 'cpdi2'")
      end do
   end subroutine read_implicit

   !> Corners of a boundary with the material on their left.
   subroutine read_vertices(deck, group, vertices)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      real(wp), allocatable, intent(out) :: vertices(:, :)
      character(len=:), allocatable :: message
      real(wp), allocatable :: list(:)
      integer :: side

      side = 1
      call get_choice(deck, group, "material_side", side)
      call get_list(deck, group, "vertices", list)
      if (.not. allocated(list)) return
      call new_polyline(list, vertices, message)
      if (message /= "") call blame(deck, group, "vertices", message)
      if (side == 2) vertices = vertices(:, size(vertices, 2):1:-1)
   end subroutine read_vertices

   !> Phases, displacement and its table.
   subroutine read_motion(deck, group, kind, schedule, boundary)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Number of the kind among the choices of the deck; 0 if there is none.
      integer, intent(in) :: kind
      !> Load steps and phases.
      type(schedule_type), intent(in) :: schedule
      !> Boundary or tool whose motion is read.
      type(boundary_type), intent(inout) :: boundary
      real(wp) :: per_step(2)
      integer :: n_equal

      call read_acting_phases(deck, group, boundary%first_phase, boundary%last_phase)
      boundary%ramp_phase = boundary%first_phase
      call get_reference(deck, group, "ramp_phase", boundary%ramp_phase, "phase")
      n_equal = n_equal_steps(deck, schedule, boundary%ramp_phase)
      call check_motion(deck, group, kind, n_equal > 0)
      call get_value(deck, group, "displacement", boundary%displacement)
      call get_reference(deck, group, "table", boundary%table)
      if (.not. is_given(deck, group, "displacement_per_step")) return
      per_step = 0.0_wp
      call get_value(deck, group, "displacement_per_step", per_step)
      boundary%displacement = real(n_equal, wp)*per_step
   end subroutine read_motion

   !> Note variables of the motion that do not go together.
   subroutine check_motion(deck, group, kind, has_equal_steps)
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Number of the kind among the choices of the deck; 0 if there is none.
      integer, intent(in) :: kind
      !> Are the steps equal over which it moves?
      logical, intent(in) :: has_equal_steps
      logical :: has_total, has_per_step, has_table

      has_total = is_given(deck, group, "displacement")
      has_per_step = is_given(deck, group, "displacement_per_step")
      has_table = is_given(deck, group, "table")
      if (kind == 2 .and. (has_total .or. has_per_step)) then
        call blame(deck, group, "kind", "stays in place, but a displacement is given; a moving " &
                    //"boundary is 'prescribed'")
      end if
      if (has_total .and. has_per_step) then
         call blame(deck, group, "displacement_per_step", &
                    "stands beside `displacement`; give one of them")
      else if (has_per_step .and. (has_table .or. .not. has_equal_steps)) then
         call blame(deck, group, "displacement_per_step", &
                    "needs equal steps (`count` in &steps) and no table; give `displacement`")
      else if (has_table .and. is_given(deck, group, "ramp_phase")) then
         call blame(deck, group, "ramp_phase", "stands beside `table`, which says it")
      end if
      if (has_total .or. has_per_step .or. deck%groups(group)%is_broken) return
      if (kind == 3) call blame(deck, group, "kind", "needs `displacement` or " &
                                //"`displacement_per_step`")
      if (has_table) call blame(deck, group, "table", "has no displacement to schedule")
   end subroutine check_motion

end module coulter_deck_boundaries
