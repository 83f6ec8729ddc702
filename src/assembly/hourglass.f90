!> Stiffness against the mode of a tile that its one point does not see.
!>
!> Elastic tiles have it in total form, from the undeformed tile. Where material flows that would
!> grow without bound and add to limit loads: there it is incremental, with a memory that is capped
!> (theory, sections 4 and 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly_hourglass
   use coulter_base_kinds, only: wp
   use coulter_base_tensor, only: equivalent_stress
   use coulter_model, only: model_type, point_moduli
   use coulter_points_tiling, only: corner_gradients, current_hourglass, values_at
   use coulter_system_tile_map, only: tile_map_type
   implicit none(type, external)
   private
   public :: find_pull, hourglass_stiffness, limit_pulls, remember_hourglass

contains

   !> At the end of a step, before corners move: keep what tiles of flowing laws pull with, turned
   !> with the tile, and cap those that flowed by their stress.
   pure subroutine remember_hourglass(model, map)
      !> Scene whose trial state is the one at the end of the step.
      type(model_type), intent(inout) :: model
      !> Map of the step with the increments of the corners.
      type(tile_map_type), intent(in) :: map
      real(wp) :: vector(4), pull(2), slope(2, 2), deformation(2, 2), angle
      integer :: p

      if (.not. allocated(model%tiling%pull)) return
      do p = 1, model%points%n_points
         if (model%laws(model%bodies(model%points%body(p))%law)%law%is_elastic) cycle
         call find_pull(model, map, p, hourglass_stiffness(model, p), vector, pull, slope)
         deformation = matmul(map%increment(:, model%tiling%corner(:, p)), &
                              transpose(map%gradient(:, :, p)))
         angle = atan2(deformation(2, 1) - deformation(1, 2), &
                       2.0_wp + deformation(1, 1) + deformation(2, 2))
         model%tiling%pull(:, p) = cos(angle)*pull + sin(angle)*[-pull(2), pull(1)]
         model%tiling%largest_pull(p) = huge(1.0_wp)
         if (model%points%has_flowed(p)) model%tiling%largest_pull(p) = &
            pull_in_flow(model, model%points%trial%kirchhoff_stress(:, p), map%area(p))
      end do
   end subroutine remember_hourglass

   !> New tiles of what flowed pull no harder than the old ones.
   pure subroutine limit_pulls(model)
      !> Scene with new tiles.
      type(model_type), intent(inout) :: model
      real(wp) :: gradient(2, 4), area
      integer :: p

      if (.not. allocated(model%tiling%pull)) return
      do p = 1, model%points%n_points
         if (.not. model%points%has_flowed(p)) cycle
         call corner_gradients(values_at(model%tiling%corner(:, p), model%tiling%position), &
                               gradient, area)
         model%tiling%largest_pull(p) = &
            pull_in_flow(model, model%points%converged%kirchhoff_stress(:, p), area)
      end do
   end subroutine limit_pulls

   !> Largest force of a tile that flows, from its stress and area.
   pure function pull_in_flow(model, stress, area) result(pull)
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: stress(4), area
      real(wp) :: pull

      pull = model%control%hourglass_limit*equivalent_stress(stress)*sqrt(area)
   end function pull_in_flow

   !> Force that stands on the vertices with the shares of a vector, and its derivative by the
   !> amplitude of the mode in the increments; nothing for affine increments: k Gamma.x with the
   !> vector of the undeformed tile, or what is remembered plus k Gamma.du with that of the tile at
   !> the start of the step.
   pure subroutine find_pull(model, map, tile, stiffness, vector, pull, slope)
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Map of the step with the increments of the corners.
      type(tile_map_type), intent(in) :: map
      !> Number of the tile.
      integer, intent(in) :: tile
      !> Its stiffness against the mode, see `hourglass_stiffness`.
      real(wp), intent(in) :: stiffness
      !> Shares of the vertices.
      real(wp), intent(out) :: vector(4)
      !> Force and its derivative: forces on vertex v are vector(v)*pull, their derivatives by the
      !> displacement of w vector(v)*vector(w)*slope.
      real(wp), intent(out) :: pull(2), slope(2, 2)
      real(wp) :: moved(2, 4), position(2, 4), size_of
      integer :: j

      slope = stiffness*reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
      associate (law => model%laws(model%bodies(model%points%body(tile))%law)%law, &
                 tiling => model%tiling, corner => model%tiling%corner(:, tile))
         moved = values_at(corner, map%increment)
         position = values_at(corner, tiling%position)
         if (law%is_elastic) then
            vector = tiling%hourglass(:, tile)
            pull = stiffness*amplitude(position + moved, vector)
            return
         end if
         vector = current_hourglass(position, map%gradient(:, :, tile))
         pull = tiling%pull(:, tile) + stiffness*amplitude(moved, vector)
         size_of = norm2(pull)
         if (size_of <= tiling%largest_pull(tile)) return
         pull = pull/size_of
         do j = 1, 2
            slope(:, j) = (slope(:, j) - stiffness*pull*pull(j))*tiling%largest_pull(tile)/size_of
         end do
         pull = tiling%largest_pull(tile)*pull
      end associate
   end subroutine find_pull

   !> Amplitude of the mode: relative to the first vertex, so that far from the origin no digits are
   !> lost.
   pure function amplitude(position, vector)
      real(wp), intent(in) :: position(2, 4), vector(4)
      real(wp) :: amplitude(2)
      integer :: v

      amplitude = 0.0_wp
      do v = 2, 4
         amplitude = amplitude + vector(v)*(position(:, v) - position(:, 1))
      end do
   end function amplitude

   !> k_hg = e (8/3) G/(1 - nu) with nu = lambda/(2 (lambda + G)).
   pure function hourglass_stiffness(model, tile) result(stiffness)
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Number of the tile.
      integer, intent(in) :: tile
      real(wp) :: stiffness
      real(wp) :: lame_lambda, shear_modulus

      call point_moduli(model, tile, lame_lambda, shear_modulus)
      stiffness = model%control%hourglass_ratio*16.0_wp/3.0_wp*shear_modulus &
         *(lame_lambda + shear_modulus)/(lame_lambda + 2.0_wp*shear_modulus)
   end function hourglass_stiffness

end module coulter_assembly_hourglass
