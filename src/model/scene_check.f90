!> What only the whole scene can tell about its parts: regions, walls and tools, fixities, loads.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_scene_check
   use coulter_base_faults, only: fault_list_type
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid, overlap_area, polyline_distance
   use coulter_base_text, only: to_text
   use coulter_boundary, only: boundary_type, formulation_implicit, kind_fixed
   use coulter_boundary_edge_load, only: find_loaded_edges, loaded_edge_type
   use coulter_boundary_face, only: flatten
   use coulter_model, only: body_force_factor, model_type
   use coulter_model_control, only: domains_tiles
   use coulter_model_initial_stress, only: initial_stress, is_geostatic
   implicit none(type, external)
   private
   public :: check_scene, check_edge_loads

   !> Regions may overlap by this share of the smaller one: round-off of the deck's digits.
   real(wp), parameter :: accepted_overlap = 1.0e-6_wp
   !> Most points of a scene.
   real(wp), parameter :: most_points = 2.0e7_wp
   !> A tool may cover this share of a cell at the start, which is pushed out in the first step.
   real(wp), parameter :: accepted_cover = 0.5_wp
   !> Arcs are taken as chords that pass this near, over the spacing.
   real(wp), parameter :: flatness = 0.05_wp
   !> Ratio of the confined to the shear modulus above which a material is nearly incompressible.
   real(wp), parameter :: nearly_incompressible = 10.0_wp
   !> Largest band of the implicit boundary method with its K2, over the spacing and times the ratio
   !> of moduli: the stress error of a patch is a fifth of it.
   real(wp), parameter :: widest_yielding_band = 5.0e-2_wp

   !> A region with its place in the list of all regions, bodies in order.
   type :: located_region_type
      integer :: number = 0, body = 0
      real(wp), allocatable :: vertices(:, :)
      real(wp) :: area = 0.0_wp
   end type located_region_type

contains

   !> Check the parts of a scene against each other before it has points.
   subroutine check_scene(model, faults)
      !> Scene whose parts are valid by themselves.
      type(model_type), intent(in) :: model
      !> Faults found; regions are counted over all bodies in order.
      type(fault_list_type), intent(inout) :: faults
      type(located_region_type), allocatable :: regions(:)

      call list_regions(model, regions)
      call check_regions(model, regions, faults)
      call check_overlaps(model, regions, faults)
      call check_number(model, regions, faults)
      call check_boundaries(model, regions, faults)
      call check_fixities(model, faults)
      call check_geostatic(model, faults)
      call check_mean_volume(model, faults)
   end subroutine check_scene

   !> All regions in one list.
   pure subroutine list_regions(model, regions)
      type(model_type), intent(in) :: model
      type(located_region_type), allocatable, intent(out) :: regions(:)
      real(wp) :: centroid(2)
      integer :: b, r, n

      n = 0
      do b = 1, size(model%bodies)
         n = n + size(model%bodies(b)%regions)
      end do
      allocate (regions(n))
      n = 0
      do b = 1, size(model%bodies)
         do r = 1, size(model%bodies(b)%regions)
            n = n + 1
            regions(n)%number = n
            regions(n)%body = b
            regions(n)%vertices = model%bodies(b)%regions(r)%vertices
            call area_and_centroid(regions(n)%vertices, regions(n)%area, centroid)
         end do
      end do
   end subroutine list_regions

   !> Every region must lie in the grid.
   subroutine check_regions(model, regions, faults)
      type(model_type), intent(in) :: model
      type(located_region_type), intent(in) :: regions(:)
      type(fault_list_type), intent(inout) :: faults
      integer :: r, v

      do r = 1, size(regions)
         do v = 1, size(regions(r)%vertices, 2)
            if (model%grid%contains_position(regions(r)%vertices(:, v))) cycle
            call faults%add("region", r, "", "corner ("//to_text(regions(r)%vertices(:, v)) &
                            //") is outside the grid, which spans ("//to_text(model%grid%origin) &
                            //") to ("//to_text(model%grid%upper_corner())//")")
            exit
         end do
      end do
   end subroutine check_regions

   !> No two regions may share material.
   subroutine check_overlaps(model, regions, faults)
      type(model_type), intent(in) :: model
      type(located_region_type), intent(in) :: regions(:)
      type(fault_list_type), intent(inout) :: faults
      real(wp) :: shared
      integer :: i, j

      do i = 2, size(regions)
         do j = 1, i - 1
            shared = overlap_area(regions(j)%vertices, regions(i)%vertices)
            if (shared <= accepted_overlap*min(regions(i)%area, regions(j)%area)) cycle
            call faults%add("region", i, "", "overlaps another region of body " &
                            //model%bodies(regions(j)%body)%name//" by an area of " &
                            //to_text(shared, 4)//"; regions must not overlap")
         end do
      end do
   end subroutine check_overlaps

   !> A spacing that is wrong by its unit asks for more points than any memory holds.
   subroutine check_number(model, regions, faults)
      type(model_type), intent(in) :: model
      type(located_region_type), intent(in) :: regions(:)
      type(fault_list_type), intent(inout) :: faults
      real(wp) :: n_points
      integer :: r

      n_points = 0.0_wp
      do r = 1, size(regions)
         n_points = n_points + regions(r)%area/model%grid%cell_volume() &
            *real(model%bodies(regions(r)%body)%points_per_cell, wp)**2
      end do
      if (n_points <= most_points) return
      call faults%add("grid", 1, "spacing", "makes about "//to_text(n_points, 2) &
                      //" points of the bodies; at most "//to_text(most_points, 2)//" will do")
   end subroutine check_number

   !> A boundary must have segments, suit the domains, and reach material unless it says otherwise.
   subroutine check_boundaries(model, regions, faults)
      type(model_type), intent(in) :: model
      type(located_region_type), intent(in) :: regions(:)
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
         if (.not. tool%is_solid .or. tool%first_phase > 1) return
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
                 //to_text(shared, 4)//": let it start outside, or leave its place out of the" &
                 //" regions (two that meet beside it make a hole)")
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

   !> Every load must find an edge to act on; the bodies have their tiles.
   subroutine check_edge_loads(model, faults)
      type(model_type), intent(in) :: model
      type(fault_list_type), intent(inout) :: faults
      type(loaded_edge_type), allocatable :: edges(:)
      integer :: load

      call find_loaded_edges(edges, model%edge_loads, model%tiling, model%grid%smallest_spacing())
      do load = 1, size(model%edge_loads)
         if (any(edges%load == load)) cycle
         call faults%add("edge_load", load, "vertices", "no edge of a body lies on this polyline")
      end do
   end subroutine check_edge_loads

   !> The box of a fixity must meet the grid.
   subroutine check_fixities(model, faults)
      type(model_type), intent(in) :: model
      type(fault_list_type), intent(inout) :: faults
      integer :: f

      do f = 1, size(model%fixities)
         if (any(model%fixities(f)%lower > model%grid%upper_corner()) .or. &
             any(model%fixities(f)%upper < model%grid%origin)) then
            call faults%add("fixity", f, "", "its box lies outside the grid")
         end if
      end do
   end subroutine check_fixities

   !> Weight that makes initial stress must point down and act in full from the start.
   subroutine check_geostatic(model, faults)
      type(model_type), intent(in) :: model
      type(fault_list_type), intent(inout) :: faults
      integer :: b

      do b = 1, size(model%bodies)
         if (.not. is_geostatic(model%bodies(b))) cycle
         associate (down => model%body_force%acceleration)
            if (abs(down(1)) > 0.0_wp .or. down(2) >= 0.0_wp) then
               call faults%add("body", b, "k0", "needs a body force that points down")
            else if (abs(body_force_factor(model, 0.0_wp) - 1.0_wp) > epsilon(1.0_wp)) then
               call faults%add("body", b, "k0", "needs a body force that acts in full from the" &
                               //" start: give &body_force from_start = .true.")
            end if
         end associate
      end do
   end subroutine check_geostatic

   !> Tiles share volume changes only where a cell holds several.
   pure subroutine check_mean_volume(model, faults)
      type(model_type), intent(in) :: model
      type(fault_list_type), intent(inout) :: faults

      if (model%control%domains /= domains_tiles .or. .not. model%control%has_mean_volume) return
      if (any(model%bodies%points_per_cell > 1)) return
      call faults%add("control", 1, "volumetric", "has no use for tiled domains with one" &
                      //" point per cell, which do not lock: give a body points_per_cell = 2 or" &
                      //" more, or take 'standard'")
   end subroutine check_mean_volume

end module coulter_model_scene_check
