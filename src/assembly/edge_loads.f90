!> External forces on the edges of tiled bodies.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly_edge_loads
   use coulter_assembly_tile_scatter, only: add_at_corners, scatter_tile
   use coulter_base_kinds, only: wp
   use coulter_model, only: edge_load_factor, model_type
   use coulter_system, only: system_type
   use coulter_system_tile_map, only: spread_to_nodes
   implicit none(type, external)
   private
   public :: add_tractions, add_pressures

contains

   !> Add dead tractions to the external forces: half of each edge's force at either end.
   pure subroutine add_tractions(system, model)
      !> System of the step; gets `external`.
      type(system_type), intent(inout) :: system
      !> Scene.
      type(model_type), intent(in) :: model
      real(wp) :: at_corners(2, model%tiling%n_corners), half(2)
      integer :: e, v, corner

      if (size(system%loaded_edges) == 0) return
      at_corners = 0.0_wp
      do e = 1, size(system%loaded_edges)
         associate (edge => system%loaded_edges(e))
            half = 0.5_wp*edge%length*model%edge_loads(edge%load)%traction &
               *edge_load_factor(model, edge%load, system%end_time)
            do v = 1, 2
               corner = model%tiling%corner(edge%vertex(v), edge%tile)
               at_corners(:, corner) = at_corners(:, corner) + half
            end do
         end associate
      end do
      call spread_to_nodes(system%map, at_corners, system%external)
   end subroutine add_tractions

   !> Add follower pressures and their tangent: the force -p n L with the outward normal n and the
   !> length L of the deformed edge, half at either end.
   subroutine add_pressures(system, model)
      !> System of the step; gets `external` and `values`.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      real(wp) :: at_corners(2, model%tiling%n_corners), pressure
      real(wp) :: force(2, 4), stiffness(2, 4, 2, 4)
      integer :: e

      if (.not. any(abs(model%edge_loads%pressure) > 0.0_wp)) return
      at_corners = 0.0_wp
      do e = 1, size(system%loaded_edges)
         associate (edge => system%loaded_edges(e))
            pressure = model%edge_loads(edge%load)%pressure &
               *edge_load_factor(model, edge%load, system%end_time)
            associate (corner => model%tiling%corner(:, edge%tile))
               call press(pressure, edge%vertex, model%tiling%position(:, corner) &
                          + system%map%increment(:, corner), force, stiffness)
               call add_at_corners(corner, force, at_corners)
            end associate
            call scatter_tile(system, edge%tile, stiffness)
         end associate
      end do
      call spread_to_nodes(system%map, at_corners, system%external)
   end subroutine add_pressures

   !> Force of a pressure on an edge of a tile, and what it adds to the tangent.
   pure subroutine press(pressure, vertex, position, force, stiffness)
      real(wp), intent(in) :: pressure, position(2, 4)
      integer, intent(in) :: vertex(2)
      real(wp), intent(out) :: force(2, 4), stiffness(2, 4, 2, 4)
      real(wp) :: edge(2)
      integer :: v

      force = 0.0_wp
      stiffness = 0.0_wp
      edge = position(:, vertex(2)) - position(:, vertex(1))
      do v = 1, 2
         force(:, vertex(v)) = 0.5_wp*pressure*[-edge(2), edge(1)]
         stiffness(1, vertex(v), 2, vertex(2)) = 0.5_wp*pressure
         stiffness(1, vertex(v), 2, vertex(1)) = -0.5_wp*pressure
         stiffness(2, vertex(v), 1, vertex(2)) = -0.5_wp*pressure
         stiffness(2, vertex(v), 1, vertex(1)) = 0.5_wp*pressure
      end do
   end subroutine press

end module coulter_assembly_edge_loads
