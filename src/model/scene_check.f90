!> What only the whole scene can tell about its parts: regions, fixities, loads; walls
!> and tools are boundary_check's.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model_scene_check
   use coulter_base_faults, only: fault_list_type
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: overlap_area
   use coulter_base_text, only: to_text
   use coulter_boundary_edge_load, only: find_loaded_edges, loaded_edge_type
   use coulter_model, only: body_force_factor, model_type
   use coulter_model_boundary_check, only: check_boundaries
   use coulter_model_control, only: domains_tiles
   use coulter_model_initial_stress, only: is_geostatic
   use coulter_model_regions, only: list_regions, located_region_type
   implicit none(type, external)
   private
   public :: check_scene, check_edge_loads

   !> Regions may overlap by this share of the smaller one: round-off of the deck's digits.
   real(wp), parameter :: accepted_overlap = 1.0e-6_wp
   !> Most points of a scene.
   real(wp), parameter :: most_points = 2.0e7_wp

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
