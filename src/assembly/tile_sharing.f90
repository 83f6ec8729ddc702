!> How tiles of a patch share their volume change: stress, moduli, and what couples them.
!>
!> Mean dilatation as in `assembly/patches.f90`, whose symbols are used here.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly_tile_sharing
   use coulter_assembly_mean_volume, only: average_moduli, unit
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_system, only: system_type
   use coulter_system_point_kernel, only: respond
   implicit none(type, external)
   private
   public :: share_volume_changes

contains

   !> Find what the tiles of all patches answer at the current increments.
   subroutine share_volume_changes(system, model, failed_tile)
      !> System of the step; gets the answers of `tile_patches` and `volume_scale`.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Tile that is turned inside out or whose law failed, else 0.
      integer, intent(out) :: failed_tile
      integer :: e

      failed_tile = 0
      do e = 1, system%tile_patches%n
         associate (first => system%tile_patches%tile_start(e), &
                    last => system%tile_patches%tile_start(e + 1) - 1)
            call share_in_patch(system, model, e, system%tile_patches%tile(first:last), &
                                failed_tile)
         end associate
         if (failed_tile > 0) return
      end do
   end subroutine share_volume_changes

   !> The same for the tiles of one patch.
   subroutine share_in_patch(system, model, e, tile, failed_tile)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      integer, intent(in) :: e, tile(:)
      integer, intent(out) :: failed_tile
      real(wp) :: before(size(tile)), after(size(tile)), pressure_force
      integer :: k
      logical :: has_failed

      before = system%map%area(tile)
      do k = 1, size(tile)
         after(k) = moved_area(system, model, tile(k))
      end do
      k = minloc(after/before, dim=1)
      failed_tile = tile(k)
      if (.not. after(k) > 0.0_wp) return
      system%volume_scale(tile) = sum(after)/sum(before)*before/after
      pressure_force = 0.0_wp
      do k = 1, size(tile)
         call respond_to_mean(system, model, tile(k), has_failed)
         failed_tile = tile(k)
         if (has_failed) return
         pressure_force = pressure_force + model%points%reference_volume(tile(k)) &
            *0.5_wp*sum(system%tile_patches%response(tile(k))%stress(:2))
      end do
      failed_tile = 0
      call share_pressure(system, model, e, tile, after/sum(after), pressure_force)
   end subroutine share_in_patch

   !> Area of a tile at the end of the step: half the product of its diagonals.
   pure function moved_area(system, model, tile) result(area)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      integer, intent(in) :: tile
      real(wp) :: area
      real(wp) :: first(2), second(2)

      associate (x => model%tiling%position, u => system%map%increment, &
                 c => model%tiling%corner(:, tile))
         first = (x(:, c(3)) - x(:, c(1))) + (u(:, c(3)) - u(:, c(1)))
         second = (x(:, c(4)) - x(:, c(2))) + (u(:, c(4)) - u(:, c(2)))
      end associate
      area = 0.5_wp*(first(1)*second(2) - first(2)*second(1))
   end function moved_area

   !> Stress and moduli of a tile that sees the volume change of its patch.
   subroutine respond_to_mean(system, model, tile, has_failed)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      integer, intent(in) :: tile
      logical, intent(out) :: has_failed
      real(wp) :: stretch, from_first(2, 4)

      stretch = sqrt(system%volume_scale(tile))
      associate (corner => model%tiling%corner(:, tile), x => model%tiling%position, &
                 response => system%tile_patches%response(tile), &
                 item => model%laws(model%bodies(model%points%body(tile))%law))
         from_first = x(:, corner) - spread(x(:, corner(1)), 2, 4)
         call respond(item%law, system%visit(tile), system%map%gradient(:, :, tile), &
                      stretch*system%map%increment(:, corner) + (stretch - 1.0_wp)*from_first, &
                      model%points%converged%elastic_finger(:, tile), &
                      model%points%converged%law_state(:, tile), response)
         has_failed = response%has_failed
         ! gradients are those of the deformation itself
         response%inverse = stretch*response%inverse
         response%gradient = stretch*response%gradient
      end associate
   end subroutine respond_to_mean

   !> Replace stress and moduli by those that the shared volume change makes of them, and find what
   !> couples the corners of the patch.
   pure subroutine share_pressure(system, model, e, tile, weight, pressure_force)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      integer, intent(in) :: e, tile(:)
      real(wp), intent(in) :: weight(:), pressure_force
      real(wp) :: row(4), bulk, total
      integer :: first, last, p, k

      associate (patches => system%tile_patches, volume => model%points%reference_volume)
         first = patches%corner_start(e)
         last = patches%corner_start(e + 1) - 1
         patches%slope(:, :, first:last) = 0.0_wp
         patches%force(:, :, first:last) = 0.0_wp
         total = -pressure_force
         do k = 1, size(tile)
            p = tile(k)
            patches%by_pressure(p) = weight(k)/volume(p)
            call average_moduli(patches%response(p), pressure_force*patches%by_pressure(p), &
                                patches%by_volume(:, p), row, bulk)
            total = total + volume(p)*bulk
            associate (place => patches%place(:, p), gradient => patches%response(p)%gradient)
               call add_slopes(place, gradient, weight(k)*unit, patches%slope(:, 1, :))
               call add_slopes(place, gradient, volume(p)*row, patches%slope(:, 2, :))
               call add_slopes(place, gradient, volume(p)*patches%by_volume(:, p), &
                               patches%force(:, 1, :))
            end associate
         end do
         patches%slope(:, 2, first:last) = patches%slope(:, 2, first:last) &
            + total*patches%slope(:, 1, first:last)
         patches%force(:, 2, first:last) = patches%slope(:, 1, first:last)
      end associate
   end subroutine share_pressure

   !> Contract a tensor with the gradients at the end of the step, vertex by vertex.
   pure subroutine add_slopes(place, gradient, tensor, at_corners)
      integer, intent(in) :: place(4)
      real(wp), intent(in) :: gradient(2, 4), tensor(2, 2)
      real(wp), intent(inout) :: at_corners(:, :)
      integer :: v

      do v = 1, 4
         at_corners(:, place(v)) = at_corners(:, place(v)) + matmul(tensor, gradient(:, v))
      end do
   end subroutine add_slopes

end module coulter_assembly_tile_sharing
