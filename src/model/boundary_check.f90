!> What only the whole scene can tell about its walls and tools.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_boundary_check
   use coulter_base_faults, only: fault_list_type
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: overlap_area, polyline_distance
   use coulter_base_text, only: to_text
   use coulter_boundary, only: boundary_type, formulation_implicit, kind_fixed
   use coulter_boundary_face, only: flatten
   use coulter_model, only: model_type
   use coulter_model_control, only: domains_tiles
   use coulter_model_initial_stress, only: initial_stress
   use coulter_model_regions, only: located_region_type
   implicit none(type, external)
   private
   public :: check_boundaries

   !> A tool may cover this share of a cell at the start, which is pushed out in the first step.
   real(wp), parameter :: accepted_cover = 0.5_wp
   !> Arcs are taken as chords that pass this near, over the spacing.
   real(wp), parameter :: flatness = 0.05_wp
   !> Ratio of the confined to the shear modulus above which a material is nearly incompressible.
   real(wp), parameter :: nearly_incompressible = 10.0_wp
   !> Largest band of the implicit boundary method with its K2, over the spacing and times the ratio
   !> of moduli: the stress error of a patch is a fifth of it.
   real(wp), parameter :: widest_yielding_band = 5.0e-2_wp

contains

   !> A boundary must have segments, suit the domains, and reach material unless it says otherwise.
   subroutine check_boundaries(model, regions, faults)
      !> Scene whose parts are valid by themselves.
      type(model_type), intent(in) :: model
      !> All its regions.
      type(located_region_type), intent(in) :: regions(:)
      !> Faults found.
      type(fault_list_type), intent(inout) :: faults
      integer :: b

      do b = 1, size(model%boundaries)
         call check_formulation(model, b, faults)
         call check_reach(model, b, regions, faults)
         call check_place(model, b, regions, faults)
      end do
   end subroutine check_boundaries

   !> The formulation of a boundary must suit the domains of the points and their material.
   subroutine check_formulation(model, b, faults)
      type(model_type), intent(in) :: model
      integer, intent(in) :: b
      type(fault_list_type), intent(inout) :: faults
      logical :: is_tiled, is_implicit

      is_tiled = model%control%domains == domains_tiles
      associate (boundary => model%boundaries(b))
         is_implicit = boundary%formulation == formulation_implicit
         if (is_implicit .eqv. is_tiled) then
            call blame(model, b, faults, "formulation", "does not suit the domains of the points:" &
                       //" 'nitsche' or 'augmented' for tiles, else 'implicit'")
         else if (boundary%kind == kind_fixed .and. .not. boundary%is_bilateral .and. is_tiled) then
            call blame(model, b, faults, "bilateral", "a fixed boundary must be bilateral")
         else if (is_too_soft(model, boundary)) then
            call blame(model, b, faults, "", "band_ratio = "//to_text(boundary%band_ratio) &
                       //" is too wide for material that is nearly incompressible:" &
                       //" formulation 'implicit' needs a band_ratio of at most " &
                       //to_text(widest_yielding_band/largest_stiffness_ratio(model), 3))
         end if
      end associate
   end subroutine check_formulation

   !> A boundary must have segments, and be where it acts unless it may start apart.
   subroutine check_reach(model, b, regions, faults)
      type(model_type), intent(in) :: model
      integer, intent(in) :: b
      type(located_region_type), intent(in) :: regions(:)
      type(fault_list_type), intent(inout) :: faults
      real(wp) :: distance, spacing
      integer :: r

      spacing = model%grid%smallest_spacing()
      associate (boundary => model%boundaries(b))
         if (shortest_segment(boundary%vertices) <= 1.0e-9_wp*spacing) then
            call blame(model, b, faults, "vertices", "two corners in a row coincide")
            return
         end if
         if (boundary%may_start_apart .or. boundary%first_phase > 1) return
         distance = huge(distance)
         do r = 1, size(regions)
            distance = min(distance, polyline_distance(boundary%vertices, regions(r)%vertices))
         end do
      end associate
      if (distance <= spacing) return
      call blame(model, b, faults, "", "touches no material: the nearest region is " &
                 //to_text(distance, 4)//" away, more than the grid spacing; set" &
                 //" may_start_apart if it meets material later")
   end subroutine check_reach

   !> A solid tool must not start in material: what it covers would stay in it, and no force would
   !> tell.
   subroutine check_place(model, b, regions, faults)
      type(model_type), intent(in) :: model
      integer, intent(in) :: b
      type(located_region_type), intent(in) :: regions(:)
      type(fault_list_type), intent(inout) :: faults
      real(wp), allocatable :: outline(:, :)
      real(wp) :: shared
      integer :: r, s

      associate (tool => model%boundaries(b))
         if (.not. tool%is_solid .or. tool%is_embedded .or. tool%first_phase > 1) return
         call flatten(tool%vertices, [(tool%bulge(s), s=1, size(tool%vertices, 2) - 1)], &
                      flatness*model%grid%smallest_spacing(), outline)
      end associate
      shared = 0.0_wp
      do r = 1, size(regions)
         ! tools run clockwise
         shared = shared + overlap_area(outline(:, size(outline, 2):2:-1), regions(r)%vertices)
      end do
      if (shared <= accepted_cover*model%grid%cell_volume()) return
      call blame(model, b, faults, "", "starts in the material, of which it covers an area of " &
                 //to_text(shared, 4)//": let it start outside, or say embedded = .true., which" &
                 //" cuts regions out there")
   end subroutine check_place

   !> Note a fault of a boundary, a wall or a tool; tools follow the walls.
   subroutine blame(model, b, faults, variable, message)
      type(model_type), intent(in) :: model
      integer, intent(in) :: b
      type(fault_list_type), intent(inout) :: faults
      character(len=*), intent(in) :: variable, message

      associate (is_tool => model%boundaries%is_tool)
         if (is_tool(b)) then
            call faults%add("tool", count(is_tool(:b)), variable, message)
         else
            call faults%add("boundary", count(.not. is_tool(:b)), variable, message)
         end if
      end associate
   end subroutine blame

   !> Is the band of the implicit boundary method too wide for nearly incompressible material?
   function is_too_soft(model, boundary) result(answer)
      type(model_type), intent(in) :: model
      type(boundary_type), intent(in) :: boundary
      logical :: answer
      real(wp) :: ratio

      ratio = largest_stiffness_ratio(model)
      answer = boundary%formulation == formulation_implicit .and. boundary%has_coupling_term &
         .and. ratio > nearly_incompressible .and. boundary%band_ratio*ratio > widest_yielding_band
   end function is_too_soft

   !> Largest ratio of the confined to the shear modulus among the bodies at the start.
   function largest_stiffness_ratio(model) result(ratio)
      type(model_type), intent(in) :: model
      real(wp) :: ratio
      real(wp) :: lame_lambda, shear_modulus, stress(4)
      real(wp), allocatable :: state(:)
      integer :: b, r

      ratio = 0.0_wp
      do b = 1, size(model%bodies)
         associate (body => model%bodies(b), law => model%laws(model%bodies(b)%law)%law)
            allocate (state(law%n_state))
            do r = 1, size(body%regions)
               stress = initial_stress(model, b, body%regions(r)%vertices(:, 1))
               call law%initial_state(stress, body%regions(r)%vertices(:, 1), state)
               call law%elastic_moduli(stress, state, lame_lambda, shear_modulus)
               ratio = max(ratio, lame_lambda/shear_modulus + 2.0_wp)
            end do
            deallocate (state)
         end associate
      end do
   end function largest_stiffness_ratio

   !> Length of the shortest segment of a polyline.
   pure function shortest_segment(vertices) result(length)
      real(wp), intent(in) :: vertices(:, :)
      real(wp) :: length
      integer :: s

      length = huge(length)
      do s = 1, size(vertices, 2) - 1
         length = min(length, norm2(vertices(:, s + 1) - vertices(:, s)))
      end do
   end function shortest_segment

end module coulter_model_boundary_check
