!> Forces and tangent of bodies that press and rub against each other.
!>
!> A station carries t = s + k g over what one edge covers of half an edge of the softer body: the
!> nominal traction s of that body's tile, and the penalty k on the gap g at the end of the step.
!> Both bodies feel it at the same place, so that forces are in balance. Theory, section 8.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly_surface_forces
   use coulter_assembly_contact_forces, only: band_penalties, nominal_traction
   use coulter_assembly_tile_scatter, only: respond_tile
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_contact_body_contact, only: body_contact_type
   use coulter_contact_edge_pair, only: compare_edges, edge_pair_type, most_slopes
   use coulter_contact_friction, only: shear_capacity
   use coulter_contact_surface_pairs, only: find_surface_pairs, reach_along, recall_surface_pairs, &
      surface_pair_type
   use coulter_model, only: model_type
   use coulter_system, only: system_type
   use coulter_system_contact_state, only: touching
   use coulter_system_point_kernel, only: point_response_type
   use coulter_system_surfaces, only: couple_surfaces
   implicit none(type, external)
   private
   public :: meet_surfaces, add_surfaces, check_sliding

   !> Coordinates of the corners of a station.
   integer, parameter :: n_slopes = 12

   !> A traction component and its derivatives by the coordinates of the six corners.
   type :: slope_type
      real(wp) :: value = 0.0_wp, slope(n_slopes) = 0.0_wp
   end type slope_type

contains

   !> Find the pairs of a step and their unknowns.
   subroutine meet_surfaces(system, model)
      !> Numbered system; gets `surfaces`.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step, with contacts between bodies.
      type(model_type), intent(in) :: model

      if (.not. allocated(system%surfaces)) then
         allocate (system%surfaces)
         allocate (system%surfaces%last(0))
      end if
      associate (surfaces => system%surfaces)
         call find_surface_pairs(surfaces%pairs, model%body_contacts, model%tiling, &
                                 model%points%body, model%grid%smallest_spacing())
         if (any(model%bodies%meets_itself)) call drop_joined(system, model)
         call recall_surface_pairs(surfaces%pairs, surfaces%last)
         call couple_surfaces(surfaces, system%map, system%dofs)
      end associate
   end subroutine meet_surfaces

   !> Leave out pairs within a body whose edges move as one: those that hang on the same nodes
   !> wherever they share a place of the grid, as both faces of a thin strip and of a notch do.
   pure subroutine drop_joined(system, model)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      logical :: are_apart(size(system%surfaces%pairs))
      integer :: k

      associate (pairs => system%surfaces%pairs, map => system%map)
         do k = 1, size(pairs)
            are_apart(k) = .not. model%body_contacts(pairs(k)%contact)%is_within()
            if (are_apart(k)) cycle
            associate (own => map%node(:, pairs(k)%corner(pairs(k)%vertex)), &
                       other => map%node(:, pairs(k)%corner(5:6)))
               are_apart(k) = have_sheets([own], [other], system%cells%node_index)
            end associate
         end do
      end associate
      system%surfaces%pairs = pack(system%surfaces%pairs, are_apart)
   end subroutine drop_joined

   !> Are there two different nodes at one place, or none at the same?
   pure function have_sheets(own, other, place) result(answer)
      !> Nodes of two edges, and the grid index of every node.
      integer, intent(in) :: own(:), other(:), place(:, :)
      logical :: answer
      integer :: i, j

      answer = .true.
      do i = 1, size(own)
         do j = 1, size(other)
            if (any(place(:, own(i)) /= place(:, other(j)))) cycle
            answer = own(i) /= other(j)
            if (answer) return
         end do
      end do
   end function have_sheets

   !> Forces of all pairs on the corners, and their tangents.
   subroutine add_surfaces(system, model, at_corners)
      !> System at the present unknowns.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Forces on the corners, shape (2, n_corners).
      real(wp), intent(inout) :: at_corners(:, :)
      type(point_response_type) :: response
      type(edge_pair_type) :: place
      real(wp) :: force(2, 6), ends(2, 4)
      integer :: k, tile, v
      logical :: has_failed

      tile = 0
      do k = 1, size(system%surfaces%pairs)
         associate (pair => system%surfaces%pairs(k))
            call forget(pair)
            associate (corner => pair%corner([pair%vertex, 5, 6]))
               ends = model%tiling%position(:, corner) + system%map%increment(:, corner)
            end associate
            call compare_edges(place, ends, pair%half)
            if (.not. place%width > 0.0_wp) cycle
            pair%place = ends(:, 1) + place%own*(ends(:, 2) - ends(:, 1))
            if (pair%tile /= tile) call respond_tile(system, model, pair%tile, response, has_failed)
            tile = pair%tile
            call add_pair(system, model, pair, place, response, force, &
                          system%surfaces%stiffness(:, :, :, :, k))
            if (.not. pair%is_acting) cycle
            do v = 1, 6
               at_corners(:, pair%corner(v)) = at_corners(:, pair%corner(v)) + force(:, v)
            end do
         end associate
      end do
   end subroutine add_surfaces

   !> What the last iteration left.
   pure subroutine forget(pair)
      type(surface_pair_type), intent(inout) :: pair

      pair%is_acting = .false.
      pair%slip = 0
      pair%traction = 0.0_wp
      pair%weight = 0.0_wp
      pair%way = 0.0_wp
      pair%gap = 0.0_wp
   end subroutine forget

   !> One pair, if it presses.
   subroutine add_pair(system, model, pair, place, response, force, stiffness)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      type(surface_pair_type), intent(inout) :: pair
      type(edge_pair_type), intent(in) :: place
      type(point_response_type), intent(in) :: response
      !> Force on the six corners as it stands in the residual, and its tangent.
      real(wp), intent(out) :: force(2, 6), stiffness(2, 6, 2, 6)
      real(wp) :: penalty(2), material(2), by_vertices(2, 2, 4), turn(n_slopes)
      type(slope_type) :: own(2), carried(2)

      associate (contact => model%body_contacts(pair%contact))
         penalty = band_penalties(model, pair%tile, contact%band_ratio)
         call nominal_traction(system, model, pair%tile, pair%inward, response, material, &
                               by_vertices)
         turn = at_corners_of(pair, place%turn_slope)
         call resolve(own, place, material, by_vertices, turn)
         carried(1)%value = own(1)%value + penalty(1)*(place%gap + pair%shift)
         carried(1)%slope = own(1)%slope + penalty(1)*at_corners_of(pair, place%gap_slope)
         pair%is_acting = carried(1)%value &
            < touching*penalty(1)*model%grid%smallest_spacing() &
            .or. (system%is_predicting .and. pair%was_acting)
         pair%gap = place%least
         if (.not. pair%is_acting) return
         call rub_pair(system, contact, pair, place, own(2), penalty(2), carried)
      end associate
      pair%traction = carried%value
      pair%weight = place%width*pair%length
      pair%force = -pair%weight*(carried(1)%value*place%normal + carried(2)%value*place%tangent)
      call share_out(pair, place, carried, turn, force, stiffness)
   end subroutine add_pair

   !> Slopes by the ends of both edges as slopes by the six corners.
   pure function at_corners_of(pair, slope) result(whole)
      type(surface_pair_type), intent(in) :: pair
      real(wp), intent(in) :: slope(most_slopes)
      real(wp) :: whole(n_slopes)

      whole = 0.0_wp
      associate (v => pair%vertex)
         whole([2*v(1) - 1, 2*v(1), 2*v(2) - 1, 2*v(2), 9, 10, 11, 12]) = slope
      end associate
   end function at_corners_of

   !> Traction of the material along the normal and the edge, which turn.
   pure subroutine resolve(own, place, material, by_vertices, turn)
      type(slope_type), intent(out) :: own(2)
      type(edge_pair_type), intent(in) :: place
      !> The traction and its derivative by the vertices of the tile; how the edge turns.
      real(wp), intent(in) :: material(2), by_vertices(2, 2, 4), turn(n_slopes)
      real(wp) :: slope(2, n_slopes)

      slope = 0.0_wp
      slope(:, :8) = reshape(by_vertices, [2, 8])
      own(1)%value = dot_product(place%normal, material)
      own(2)%value = dot_product(place%tangent, material)
      own(1)%slope = matmul(place%normal, slope) - own(2)%value*turn
      own(2)%slope = matmul(place%tangent, slope) + own(1)%value*turn
   end subroutine resolve

   !> Shear by a stick-slip return mapping from where both stick.
   pure subroutine rub_pair(system, contact, pair, place, own, penalty, carried)
      type(system_type), intent(in) :: system
      type(body_contact_type), intent(in) :: contact
      type(surface_pair_type), intent(inout) :: pair
      type(edge_pair_type), intent(in) :: place
      !> Shear of the material; penalty, stress per length.
      type(slope_type), intent(in) :: own
      real(wp), intent(in) :: penalty
      !> Tractions; gets the shear.
      type(slope_type), intent(inout) :: carried(2)
      type(slope_type) :: way
      real(wp) :: capacity, by_pressure

      way = way_along(system, pair, place)
      pair%way = way%value
      if (.not. contact%rubs() .or. system%is_smooth) return
      carried(2)%value = own%value + penalty*(pair%lag + way%value)
      carried(2)%slope = own%slope + penalty*way%slope
      call shear_capacity(contact%friction, carried(1)%value, capacity, by_pressure)
      if (system%is_predicting .and. pair%was_acting) then
         pair%slip = pair%last_slip
      else if (abs(carried(2)%value) > capacity .and. .not. system%is_sticking) then
         pair%slip = nint(sign(1.0_wp, carried(2)%value))
      end if
      if (pair%slip /= 0) then
         carried(2)%value = real(pair%slip, wp)*capacity
         carried(2)%slope = real(pair%slip, wp)*by_pressure*carried(1)%slope
      end if
      pair%new_lag = (carried(2)%value - own%value)/penalty
   end subroutine rub_pair

   !> How far both slide along each other in the step.
   pure function way_along(system, pair, place) result(way)
      type(system_type), intent(in) :: system
      type(surface_pair_type), intent(in) :: pair
      type(edge_pair_type), intent(in) :: place
      type(slope_type) :: way
      real(wp) :: moved(2, 4), apart(2), direct(2, 4)

      associate (t => place%tangent)
         moved = system%map%increment(:, pair%corner([pair%vertex, 5, 6]))
         apart = moved(:, 1) - moved(:, 3) + place%own*(moved(:, 2) - moved(:, 1)) &
            - place%other*(moved(:, 4) - moved(:, 3))
         direct = outer_four(t, [1.0_wp - place%own, place%own, place%other - 1.0_wp, &
                                 -place%other])
         way%value = dot_product(t, apart)
         way%slope = at_corners_of(pair, reshape(direct, [most_slopes]) &
                                   + dot_product(place%normal, apart)*place%turn_slope &
                                   + dot_product(t, moved(:, 2) - moved(:, 1))*place%own_slope &
                                   - dot_product(t, moved(:, 4) - moved(:, 3))*place%other_slope)
      end associate
   end function way_along

   !> Vector times four shares.
   pure function outer_four(vector, share) result(product)
      real(wp), intent(in) :: vector(2), share(4)
      real(wp) :: product(2, 4)

      product = spread(vector, 2, 4)*spread(share, 1, 2)
   end function outer_four

   !> Forces on the ends of both edges, opposite to each other, and their derivatives.
   pure subroutine share_out(pair, place, carried, turn, force, stiffness)
      type(surface_pair_type), intent(in) :: pair
      type(edge_pair_type), intent(in) :: place
      type(slope_type), intent(in) :: carried(2)
      real(wp), intent(in) :: turn(n_slopes)
      real(wp), intent(out) :: force(2, 6), stiffness(2, 6, 2, 6)
      real(wp) :: traction(2), by_corners(2, n_slopes), by_share(2, n_slopes), share(6), &
         share_slope(n_slopes, 6), rows(2, n_slopes)
      integer :: v

      associate (n => place%normal, t => place%tangent)
         traction = carried(1)%value*n + carried(2)%value*t
         by_corners = spread(n, 2, n_slopes)*spread(carried(1)%slope, 1, 2) &
            + spread(t, 2, n_slopes)*spread(carried(2)%slope, 1, 2) &
            + spread(carried(2)%value*n - carried(1)%value*t, 2, n_slopes)*spread(turn, 1, 2)
      end associate
      by_corners = pair%weight*by_corners + pair%length*spread(traction, 2, n_slopes) &
         *spread(at_corners_of(pair, place%width_slope), 1, 2)
      share = 0.0_wp
      share(pair%vertex) = [1.0_wp - place%own, place%own]
      share(5:6) = [place%other - 1.0_wp, -place%other]
      share_slope = 0.0_wp
      share_slope(:, pair%vertex(2)) = at_corners_of(pair, place%own_slope)
      share_slope(:, pair%vertex(1)) = -share_slope(:, pair%vertex(2))
      share_slope(:, 5) = at_corners_of(pair, place%other_slope)
      share_slope(:, 6) = -share_slope(:, 5)
      do v = 1, 6
         force(:, v) = pair%weight*share(v)*traction
         by_share = spread(traction, 2, n_slopes)*spread(share_slope(:, v), 1, 2)
         rows = share(v)*by_corners + pair%weight*by_share
         stiffness(:, v, :, :) = reshape(rows, [2, 2, 6])
      end do
   end subroutine share_out

   !> Refuse a step in which surfaces slide farther than pairs have been looked for.
   pure subroutine check_sliding(system, model, failure)
      !> System in equilibrium.
      type(system_type), intent(in) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> Which bodies do; unallocated when none does.
      character(len=:), allocatable, intent(inout) :: failure
      integer :: k

      associate (pairs => system%surfaces%pairs)
         k = maxloc(abs(pairs%way), dim=1)
         if (k == 0) return
         if (abs(pairs(k)%way) <= reach_along*model%grid%smallest_spacing()) return
         associate (body => model%body_contacts(pairs(k)%contact)%body)
            failure = "bodies "//model%bodies(body(1))%name//" and "//model%bodies(body(2))%name
            if (body(1) == body(2)) failure = "parts of body "//model%bodies(body(1))%name
            failure = failure//" slide along each other by "//to_text(abs(pairs(k)%way), 2) &
               //" in one step, more than a cell"
         end associate
      end associate
   end subroutine check_sliding

end module coulter_assembly_surface_forces
