!> Forces and tangent of bodies whose domains tile them, and of the contacts on their outer edges.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_step_tile_assembly
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_boundary_contact, only: contact_type
   use coulter_boundary_ibm, only: band_stiffness_factor
   use coulter_law, only: law_type
   use coulter_model, only: model_type
   use coulter_step_ghost, only: add_ghost_forces
   use coulter_step_point_kernel, only: add_force, add_stiffness, point_response_type, respond
   use coulter_step_system, only: system_type
   use coulter_step_tile_map, only: interpolate, spread_to_nodes
   use coulter_step_tile_scatter, only: add_at_corners, scatter_tile
   implicit none(type, external)
   private
   public :: add_tiles

   !> Gaps below this share of the spacing count as closed: round-off of a body that starts on a
   !> wall.
   real(wp), parameter :: touching = 1.0e-10_wp
   !> A face reaches this far beyond its ends, over the spacing: a corner that sits at an end must
   !> not come and go with round-off.
   real(wp), parameter :: end_slack = 0.05_wp

contains

   !> Add tiles, ghost penalty and contacts to forces and tangent.
   subroutine add_tiles(system, model, failed_tile)
      !> System of the step.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Tile that is turned inside out or whose law failed, else 0.
      integer, intent(out) :: failed_tile
      real(wp) :: at_corners(2, model%tiling%n_corners)

      call interpolate(system%map, system%increment)
      at_corners = 0.0_wp
      call add_interiors(system, model, at_corners, failed_tile)
      if (failed_tile > 0) return
      call spread_to_nodes(system%map, at_corners, system%internal)
      call add_ghost_forces(system%ghost, system%ghost_stiffness, system%increment, &
                            system%internal)
      at_corners = 0.0_wp
      system%loaded_length = 0.0_wp
      call add_contacts(system, model, at_corners)
      call spread_to_nodes(system%map, at_corners, system%boundary)
   end subroutine add_tiles

   !> Internal force and tangent of all tiles.
   subroutine add_interiors(system, model, at_corners, failed_tile)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: at_corners(:, :)
      integer, intent(out) :: failed_tile
      type(point_response_type) :: response
      real(wp) :: force(2, 4), stiffness(2, 4, 2, 4)
      integer :: p
      logical :: has_failed

      do p = 1, model%points%n_points
         associate (law => model%laws(model%bodies(model%points%body(p))%law)%law, &
                    corner => model%tiling%corner(:, p), &
                    volume => model%points%reference_volume(p))
            call respond_tile(system, model, law, p, response, has_failed)
            failed_tile = p
            if (has_failed) return
            force = 0.0_wp
            stiffness = 0.0_wp
            call add_force(response%gradient, response%stress, volume, force)
            call add_stiffness(response%gradient, response%moduli, volume, stiffness)
            call add_hourglass(hourglass_stiffness(law, model%control%hourglass_ratio), &
                               model%tiling%hourglass(:, p), model%tiling%position(:, corner) &
                               + system%map%increment(:, corner), force, stiffness)
            call add_at_corners(corner, force, at_corners)
         end associate
         call scatter_tile(system, p, stiffness)
      end do
      failed_tile = 0
   end subroutine add_interiors

   !> Stress and moduli of a tile.
   subroutine respond_tile(system, model, law, p, response, has_failed)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      class(law_type), intent(in) :: law
      integer, intent(in) :: p
      type(point_response_type), intent(out) :: response
      logical, intent(out) :: has_failed

      call respond(law, system%map%gradient(:, :, p), &
                   system%map%increment(:, model%tiling%corner(:, p)), &
                   model%points%converged%elastic_finger(:, p), &
                   model%points%converged%law_state(:, p), response, has_failed)
   end subroutine respond_tile

   !> k_hg = e (8/3) G/(1 - nu) with nu = lambda/(2 (lambda + G)).
   pure function hourglass_stiffness(law, ratio) result(stiffness)
      class(law_type), intent(in) :: law
      real(wp), intent(in) :: ratio
      real(wp) :: stiffness
      real(wp) :: lame_lambda, shear_modulus

      call law%elastic_moduli(lame_lambda, shear_modulus)
      stiffness = ratio*16.0_wp/3.0_wp*shear_modulus*(lame_lambda + shear_modulus) &
         /(lame_lambda + 2.0_wp*shear_modulus)
   end function hourglass_stiffness

   !> Hourglass control in total form: force k Gamma_a (sum_b Gamma_b x_b), zero for affine maps.
   pure subroutine add_hourglass(hourglass, vector, position, force, stiffness)
      real(wp), intent(in) :: hourglass, vector(4), position(2, 4)
      real(wp), intent(inout) :: force(2, 4), stiffness(2, 4, 2, 4)
      real(wp) :: amplitude(2)
      integer :: b

      amplitude = matmul(position, vector)
      do b = 1, 4
         force(:, b) = force(:, b) + hourglass*vector(b)*amplitude
         stiffness(1, :, 1, b) = stiffness(1, :, 1, b) + hourglass*vector(b)*vector
         stiffness(2, :, 2, b) = stiffness(2, :, 2, b) + hourglass*vector(b)*vector
      end do
   end subroutine add_hourglass

   !> Traction of all contacts. Successive stations of one tile share its response and are
   !> scattered together.
   subroutine add_contacts(system, model, at_corners)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: at_corners(:, :)
      type(point_response_type) :: response
      real(wp) :: force(2, 4), stiffness(2, 4, 2, 4), reaction(2)
      integer :: k, tile
      logical :: has_failed, is_acting

      tile = 0
      do k = 1, system%contacts%n
         associate (contact => system%contacts%item(k))
            if (contact%tile /= tile) then
               tile = contact%tile
               force = 0.0_wp
               stiffness = 0.0_wp
               associate (law => model%laws(model%bodies(model%points%body(tile))%law)%law)
                  call respond_tile(system, model, law, tile, response, has_failed)
               end associate
            end if
            call add_contact(system, model, contact, response, force, stiffness, reaction, &
                             is_acting)
            associate (total => system%boundary_reaction(:, contact%boundary), &
                       length => system%loaded_length(contact%boundary))
               total = total + reaction
               if (is_acting) length = length + contact%weight
            end associate
         end associate
         if (k < system%contacts%n) then
            if (system%contacts%item(k + 1)%tile == tile) cycle
         end if
         call add_at_corners(model%tiling%corner(:, tile), force, at_corners)
         call scatter_tile(system, tile, stiffness)
      end do
   end subroutine add_contacts

   !> One station, if it acts: traction s + k g along the normal, and for fixed kinds along the
   !> tangent.
   subroutine add_contact(system, model, contact, response, force, stiffness, reaction, is_acting)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      type(contact_type), intent(in) :: contact
      type(point_response_type), intent(in) :: response
      real(wp), intent(inout) :: force(2, 4), stiffness(2, 4, 2, 4)
      real(wp), intent(out) :: reaction(2)
      logical, intent(out) :: is_acting
      real(wp) :: traction, by_vertices(2, 4), penalty, share, moved(2), lame_lambda, shear_modulus

      reaction = 0.0_wp
      moved = system%map%increment(:, contact%corner)
      share = model%points%reference_volume(contact%tile)/system%map%area(contact%tile)
      call model%laws(model%bodies(model%points%body(contact%tile))%law)%law &
         %elastic_moduli(lame_lambda, shear_modulus)
      penalty = band_stiffness_factor*(lame_lambda + 2.0_wp*shear_modulus) &
         /(model%boundaries(contact%boundary)%band_ratio*model%grid%smallest_spacing())
      call nominal_traction(response, share, contact%normal, contact%normal, traction, by_vertices)
      traction = traction + penalty*(contact%gap + dot_product(contact%normal, moved))
      is_acting = acts(contact, traction/penalty, dot_product(contact%tangent, moved), &
                       model%grid%smallest_spacing())
      if (.not. is_acting) return
      call push(contact%normal, penalty)
      if (.not. contact%is_fixed) return
      penalty = penalty*shear_modulus/(lame_lambda + 2.0_wp*shear_modulus)
      call nominal_traction(response, share, contact%tangent, contact%normal, traction, by_vertices)
      traction = traction + penalty*(contact%slide + dot_product(contact%tangent, moved))
      call push(contact%tangent, penalty)

   contains

      !> Add the traction along a direction to force and stiffness.
      subroutine push(direction, penalty)
         real(wp), intent(in) :: direction(2), penalty
         integer :: k, b

         by_vertices(:, contact%vertex) = by_vertices(:, contact%vertex) + penalty*direction
         force(:, contact%vertex) = force(:, contact%vertex) + contact%weight*traction*direction
         reaction = reaction - contact%weight*traction*direction
         do b = 1, 4
            do k = 1, 2
               stiffness(:, contact%vertex, k, b) = stiffness(:, contact%vertex, k, b) &
                  + contact%weight*by_vertices(k, b)*direction
            end do
         end do
      end subroutine push

   end subroutine add_contact

   !> Does the face act on the corner: held for good, or pressed while it slides along the face?
   pure function acts(contact, overlap, slide, spacing) result(answer)
      type(contact_type), intent(in) :: contact
      real(wp), intent(in) :: overlap, slide, spacing
      logical :: answer
      real(wp) :: distance

      distance = contact%distance + slide
      answer = contact%is_bilateral .or. (overlap < touching*spacing &
                                          .and. distance >= -end_slack*spacing &
                                          .and. distance <= contact%length + end_slack*spacing)
   end function acts

   !> Component of the nominal traction P N, P = tau dF^-T V0/A, and its derivative by the vertices
   !> of the tile.
   pure subroutine nominal_traction(response, share, direction, normal, traction, by_vertices)
      type(point_response_type), intent(in) :: response
      real(wp), intent(in) :: share, direction(2), normal(2)
      real(wp), intent(out) :: traction, by_vertices(2, 4)
      real(wp) :: pulled(2), stress(2, 2), slope(2, 2)
      integer :: k, l

      pulled = share*matmul(normal, response%inverse)
      stress = reshape(response%stress([1, 4, 4, 2]), [2, 2])
      traction = dot_product(direction, matmul(stress, pulled))
      do l = 1, 2
         do k = 1, 2
            slope(k, l) = dot_product(direction, matmul(response%moduli(:, :, k, l), pulled))
         end do
      end do
      by_vertices = matmul(slope, response%gradient)
   end subroutine nominal_traction

end module coulter_step_tile_assembly
