!> What surfaces of bodies in contact remember, carried to the edges of new tiles.
!>
!> As with walls and tools, the shear that a station carries lasts, not the way that it has crept
!> (theory, section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_surface_transfer
   use coulter_assembly_contact_forces, only: band_penalties
   use coulter_base_bins, only: bins_type, new_bins
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: distance_to_segment
   use coulter_contact_surface_pairs, only: find_surface_pairs, surface_pair_type
   use coulter_model, only: model_type
   use coulter_points_tiling, only: tiling_type
   use coulter_system, only: system_type
   implicit none(type, external)
   private
   public :: carry_surfaces, is_on_other_piece

   !> Stations farther from all old ones than this have none to ask, over the spacing.
   real(wp), parameter :: farthest = 0.5_wp

contains

   !> Give the pairs of new tiles state and tractions of the nearest old ones.
   pure subroutine carry_surfaces(system, model)
      !> System between two steps; the pairs of its last step are replaced.
      type(system_type), intent(inout) :: system
      !> Scene with the new tiles.
      type(model_type), intent(in) :: model
      type(surface_pair_type), allocatable :: pairs(:)
      type(surface_pair_type), allocatable :: last(:)
      type(bins_type) :: bins
      integer :: k

      call find_surface_pairs(pairs, model%body_contacts, model%tiling, model%points%body, &
                              model%grid%smallest_spacing())
      last = pack(system%surfaces%last, system%surfaces%last%is_acting)
      call new_bins(bins, reshape([(last(k)%place, k=1, size(last))], [2, size(last)]), &
                    farthest*model%grid%smallest_spacing())
      do k = 1, size(pairs)
         call ask(pairs(k), last, bins, model)
      end do
      call move_alloc(pairs, system%surfaces%last)
   end subroutine carry_surfaces

   !> State at the place of a new pair: the middle of its half edge.
   pure subroutine ask(new, last, bins, model)
      type(surface_pair_type), intent(inout) :: new
      !> Old ones that acted, and their places.
      type(surface_pair_type), intent(in) :: last(:)
      type(bins_type), intent(in) :: bins
      type(model_type), intent(in) :: model
      real(wp) :: place(2), along(2), shear, distance, nearest
      integer, allocatable :: near(:)
      integer :: j, k, found

      associate (ends => model%tiling%position(:, new%corner([new%vertex, 5, 6])))
         along = ends(:, 2) - ends(:, 1)
         place = ends(:, 1) + (0.5_wp*real(new%half, wp) - 0.25_wp)*along
      end associate
      found = 0
      nearest = farthest*model%grid%smallest_spacing()
      near = bins%near(place)
      do j = 1, size(near)
         k = near(j)
         if (last(k)%contact /= new%contact) cycle
         distance = norm2(last(k)%place - place)
         if (distance >= nearest) cycle
         nearest = distance
         found = k
      end do
      if (found == 0) return
      new%is_acting = .true.
      new%slip = last(found)%slip
      new%traction = last(found)%traction
      new%weight = last(found)%weight
      new%place = place
      if (.not. model%body_contacts(new%contact)%rubs()) return
      associate (stress => model%points%converged%kirchhoff_stress([1, 4, 4, 2], new%tile))
         shear = dot_product(along/norm2(along), matmul(reshape(stress, [2, 2]), new%inward)) &
            /model%points%volume_ratio(new%tile)
      end associate
      associate (penalty => band_penalties(model, new%tile, &
                                           model%body_contacts(new%contact)%band_ratio))
         new%new_lag = (new%traction(2) - shear)/penalty(2)
      end associate
   end subroutine ask

   !> Does a place lie on the surface of something else that presses and rubs there: a body of
   !> another displacement field, or another piece of the body?
   pure function is_on_other_piece(model, is_mine, place, distance) result(answer)
      !> Scene with tiles.
      type(model_type), intent(in) :: model
      !> Is a tile in the piece of the place, shape (n_tiles)?
      logical, intent(in) :: is_mine(:)
      !> The place, and how far it may be away, length units.
      real(wp), intent(in) :: place(2), distance
      logical :: answer
      integer :: body, e

      answer = .true.
      body = model%points%body(findloc(is_mine, .true., dim=1))
      do e = 1, size(model%tiling%outer_edge, 2)
         associate (edge => model%tiling%outer_edge(:, e))
            associate (other => model%points%body(edge(3)))
               if (is_mine(edge(3))) cycle
               if (other /= body .and. model%bodies(other)%field == model%bodies(body)%field) cycle
            end associate
            if (distance_to_segment(place, model%tiling%position(:, edge(1)), &
                                    model%tiling%position(:, edge(2))) <= distance) return
         end associate
      end do
      answer = .false.
   end function is_on_other_piece

end module coulter_retile_surface_transfer
