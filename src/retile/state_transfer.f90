!> From distorted tiles to new ones: shape of the outline, and what the points carry.
!>
!> Integrals over the shared areas are kept, of values that vary linearly in the old tiles (theory,
!> section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_state_transfer
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: area_and_centroid
   use coulter_base_tensor, only: finger_of_log_strain_plane, log_strain_plane
   use coulter_points, only: allocate_points, points_type
   use coulter_points_tiling, only: tiling_type
   use coulter_retile_overlaps, only: find_overlaps, lookup_type, overlaps_type, sort_tiles
   use coulter_retile_slopes, only: field_type, fit_slopes
   implicit none(type, external)
   private
   public :: restore_area, transfer_points

   !> New tiles flow on where a larger share than this of what they are made of flowed.
   real(wp), parameter :: most_at_rest = 0.5_wp
   !> Fields that are carried: density over the first one times elastic strain (so that the integral
   !> of the Cauchy stress is kept), that density, displacement; from the next one on what may not
   !> leave its bounds: shared ratio and the variables of laws.
   integer, parameter :: load_field = 1, density_field = 2, displacement_field = 3, n_fields = 3

contains

   !> Shift the free corners of the outline along their normals until the tiles have a given area.
   pure subroutine restore_area(tiling, share, area, limit)
      !> Tiles to change; only their positions do.
      type(tiling_type), intent(inout) :: tiling
      !> Shift of a corner over the largest one, 0 for those that may not move, shape (n_corners).
      real(wp), intent(in) :: share(:)
      !> Area that they shall have together.
      real(wp), intent(in) :: area
      !> Largest shift, length units.
      real(wp), intent(in) :: limit
      real(wp) :: normal(2, tiling%n_corners), edge(2), shift, step, slope, total
      integer :: e, k, pass

      shift = 0.0_wp
      do pass = 1, 8
         normal = 0.0_wp
         total = 0.0_wp
         do e = 1, size(tiling%outer_edge, 2)
            associate (a => tiling%outer_edge(1, e), b => tiling%outer_edge(2, e))
               edge = tiling%position(:, b) - tiling%position(:, a)
               normal(:, a) = normal(:, a) + 0.5_wp*[edge(2), -edge(1)]
               normal(:, b) = normal(:, b) + 0.5_wp*[edge(2), -edge(1)]
               ! relative to one corner, so that far from the origin no digits are lost
               total = total + 0.5_wp*wedge(tiling%position(:, a) - tiling%position(:, 1), edge)
            end associate
         end do
         slope = 0.0_wp
         do k = 1, tiling%n_corners
            slope = slope + share(k)*norm2(normal(:, k))
         end do
         if (.not. slope > 0.0_wp) return
         step = min(max(shift + (area - total)/slope, -limit), limit) - shift
         shift = shift + step
         do k = 1, tiling%n_corners
            if (.not. (share(k) > 0.0_wp .and. norm2(normal(:, k)) > 0.0_wp)) cycle
            tiling%position(:, k) = tiling%position(:, k) &
               + share(k)*step*normal(:, k)/norm2(normal(:, k))
         end do
      end do

   contains

      pure function wedge(first, second) result(value)
         real(wp), intent(in) :: first(2), second(2)
         real(wp) :: value

         value = first(1)*second(2) - first(2)*second(1)
      end function wedge

   end subroutine restore_area

   !> Points for new tiles with what the points of the old ones carry: 1/J and elastic strain over J
   !> as means over the shared areas, law state, displacement and shared ratio as means over the
   !> shared masses. Their reference volumes add up to what they were; the rotation in the
   !> deformation gradient is lost.
   pure subroutine transfer_points(points, tiling, owner, old_points, old_tiling, spacing)
      !> Points to make; their stress is left for the laws to find.
      type(points_type), intent(out) :: points
      !> Their tiles.
      type(tiling_type), intent(in) :: tiling
      !> Body of every new tile.
      integer, intent(in) :: owner(:)
      !> Points of the old tiles.
      type(points_type), intent(in) :: old_points
      !> Old tiles.
      type(tiling_type), intent(in) :: old_tiling
      !> Size of the cells that sort the tiles, length units.
      real(wp), intent(in) :: spacing
      type(field_type) :: fields(n_fields + 1 + old_points%n_state)
      type(lookup_type) :: lookup
      type(overlaps_type) :: overlaps
      real(wp) :: area
      integer :: p, n

      call allocate_points(points, size(owner), old_points%n_state)
      points%body = owner
      if (allocated(old_points%shared_ratio)) allocate (points%shared_ratio(size(owner)))
      if (allocated(old_points%has_flowed)) allocate (points%has_flowed(size(owner)))
      call list_fields(fields, n, old_points)
      call fit_slopes(fields(:n), old_tiling, old_points%body, old_points%position)
      call sort_tiles(lookup, old_tiling, spacing)
      do p = 1, points%n_points
         associate (corner => tiling%position(:, tiling%corner(:, p)))
            call area_and_centroid(corner, area, points%position(:, p))
            points%domain_size(:, p) = maxval(corner, dim=2) - minval(corner, dim=2)
            call find_overlaps(overlaps, lookup, old_tiling, old_points%body, &
                               old_points%position, corner, owner(p))
            call average(points, p, area, old_points, fields(:n), overlaps)
         end associate
      end do
      call keep_mass(points, old_points)
   end subroutine transfer_points

   !> Fields with their values in the old tiles.
   pure subroutine list_fields(fields, n, old)
      type(field_type), intent(inout) :: fields(:)
      !> How many there are.
      integer, intent(out) :: n
      type(points_type), intent(in) :: old
      real(wp) :: strain(4)
      integer :: k, p

      allocate (fields(load_field)%value(4, old%n_points))
      do p = 1, old%n_points
         call log_strain_plane(old%converged%elastic_finger(:, p), strain)
         fields(load_field)%value(:, p) = strain/old%volume_ratio(p)
      end do
      ! the shear strain is twice the component of the tensor, which stands for two
      fields(load_field)%weight = [1.0_wp, 1.0_wp, 1.0_wp, 0.5_wp]
      call list_bounded(fields(density_field), 1.0_wp/old%volume_ratio)
      fields(displacement_field)%value = old%displacement
      fields(displacement_field)%weight = [1.0_wp, 1.0_wp]
      n = n_fields
      do k = 1, old%n_state
         n = n + 1
         call list_bounded(fields(n), old%converged%law_state(k, :))
      end do
      if (.not. allocated(old%shared_ratio)) return
      n = n + 1
      call list_bounded(fields(n), old%shared_ratio)
   end subroutine list_fields

   !> A field of one component that keeps its bounds.
   pure subroutine list_bounded(field, value)
      type(field_type), intent(inout) :: field
      real(wp), intent(in) :: value(:)

      field%value = reshape(value, [1, size(value)])
      field%weight = [1.0_wp]
      field%is_bounded = .true.
   end subroutine list_bounded

   !> State of one point from the fields of the old tiles that it shares area with.
   pure subroutine average(points, p, area, old, fields, overlaps)
      type(points_type), intent(inout) :: points
      integer, intent(in) :: p
      real(wp), intent(in) :: area
      type(points_type), intent(in) :: old
      type(field_type), intent(in) :: fields(:)
      type(overlaps_type), intent(in) :: overlaps
      real(wp) :: share(overlaps%n), density(1), value(1), strain(4)
      integer :: k

      share = overlaps%area(:overlaps%n)/sum(overlaps%area(:overlaps%n))
      density = mean(fields(density_field), overlaps, share)
      strain = mean(fields(load_field), overlaps, share)/density(1)
      call finger_of_log_strain_plane(strain, points%converged%elastic_finger(:, p))
      points%volume_ratio(p) = 1.0_wp/density(1)
      points%reference_volume(p) = area*density(1)
      share = share/old%volume_ratio(overlaps%tile(:overlaps%n))
      share = share/sum(share)
      points%displacement(:, p) = mean(fields(displacement_field), overlaps, share)
      do k = 1, old%n_state
         value = mean(fields(n_fields + k), overlaps, share)
         points%converged%law_state(k, p) = value(1)
      end do
      if (allocated(old%shared_ratio)) then
         value = mean(fields(size(fields)), overlaps, share)
         points%shared_ratio(p) = value(1)
      end if
      if (allocated(old%has_flowed)) then
         points%has_flowed(p) = sum(share, mask=old%has_flowed(overlaps%tile(:overlaps%n))) &
            > most_at_rest
      end if
   end subroutine average

   !> Mean of a field over pieces of tiles.
   pure function mean(field, pieces, share)
      type(field_type), intent(in) :: field
      type(overlaps_type), intent(in) :: pieces
      !> Share of every piece.
      real(wp), intent(in) :: share(:)
      real(wp) :: mean(size(field%weight))
      integer :: k

      mean = 0.0_wp
      do k = 1, pieces%n
         associate (tile => pieces%tile(k))
            mean = mean + share(k)*(field%value(:, tile) &
                                    + matmul(pieces%way(:, k), field%slope(:, :, tile)))
         end associate
      end do
   end function mean

   !> Scale the volumes of every body so that it has its old mass; J follows.
   pure subroutine keep_mass(points, old)
      type(points_type), intent(inout) :: points
      type(points_type), intent(in) :: old
      real(wp) :: factor, volume
      integer :: body, p

      do body = 1, maxval(points%body)
         volume = sum(points%reference_volume, mask=points%body == body)
         if (.not. volume > 0.0_wp) cycle
         factor = sum(old%reference_volume, mask=old%body == body)/volume
         do p = 1, points%n_points
            if (points%body(p) /= body) cycle
            points%reference_volume(p) = factor*points%reference_volume(p)
            points%volume_ratio(p) = points%volume_ratio(p)/factor
            ! plane strain: the out-of-plane component stays 1
            points%converged%deformation_gradient([1, 4], p) = sqrt(points%volume_ratio(p))
         end do
      end do
   end subroutine keep_mass

end module coulter_retile_state_transfer
