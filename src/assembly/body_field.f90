!> External forces of an acceleration that varies over tiled bodies.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly_body_field
   use coulter_assembly_tile_scatter, only: add_at_corners
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_points_tiling, only: corner_weights
   use coulter_system, only: system_type
   use coulter_system_tile_map, only: spread_to_nodes
   implicit none(type, external)
   private
   public :: add_body_field

contains

   !> Add the force on every tile, taken where its centroid started; it acts at the centroid.
   pure subroutine add_body_field(system, model)
      !> System of the step; gets `external`.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step, with a body field.
      type(model_type), intent(in) :: model
      real(wp) :: at_corners(2, model%tiling%n_corners), force(2), share(4)
      integer :: p

      at_corners = 0.0_wp
      do p = 1, model%points%n_points
         force = model%bodies(model%points%body(p))%density*model%points%reference_volume(p) &
            *model%body_force%field%acceleration(model%points%position(:, p) &
                                                 - model%points%displacement(:, p), system%end_time)
         share = corner_weights(model%tiling%position(:, model%tiling%corner(:, p)))
         call add_at_corners(model%tiling%corner(:, p), &
                             spread(force, 2, 4)*spread(share, 1, 2), at_corners)
      end do
      call spread_to_nodes(system%map, at_corners, system%external)
   end subroutine add_body_field

end module coulter_assembly_body_field
