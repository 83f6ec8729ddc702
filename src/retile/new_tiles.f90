!> New tiles of bodies: their outlines as they are now, along walls, tools and each other, filled.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_new_tiles
   use coulter_base_kinds, only: wp
   use coulter_boundary_face, only: face_type
   use coulter_boundary_plate, only: find_plates
   use coulter_contact_cut, only: cut_type
   use coulter_model, only: model_type
   use coulter_points_folds, only: deepest_overlap
   use coulter_points_outline, only: edges_of, outline_type, trace_outline
   use coulter_points_parts, only: find_parts, part_type
   use coulter_points_tiling, only: corner_gradients, depth_in_tiles, new_tiling, tiling_type
   use coulter_retile_beside_faces, only: is_near_face
   use coulter_retile_filling, only: tile_outline
   use coulter_retile_interfaces, only: edges_of_tiles, find_interfaces, interfaces_type, &
      is_on_interface, is_torn, keep_ends
   use coulter_retile_meetings, only: join_surfaces
   use coulter_retile_state_transfer, only: restore_area
   use coulter_retile_slits, only: are_facing, close_slits, open_slits
   use coulter_retile_surface_transfer, only: is_on_other_piece
   use coulter_retile_trimming, only: push_corners_out, trim_outline
   implicit none(type, external)
   private
   public :: make_tiles

   !> Loops of less than these shares of a cell are dropped, without and with plates that may be in
   !> them.
   real(wp), parameter :: smallest_loop = 0.5_wp, smallest_plate = 0.02_wp
   !> Corners of tiles nearer than this are one, over the spacing.
   real(wp), parameter :: corner_tolerance = 1.0e-7_wp
   !> Corners of the outline this near to a face stay where they are, over the spacing.
   real(wp), parameter :: touching = 0.02_wp
   !> Corners this near to an interface of bonded bodies belong to it, over the spacing.
   real(wp), parameter :: bonded = 0.05_wp
   !> Largest shift of free corners that restores the area, over the spacing.
   real(wp), parameter :: farthest_shift = 0.05_wp
   !> Beside cuts of corners that go in, the share falls with this power of the distance.
   integer, parameter :: nearness = 4
   !> Tiles that lie over each other by this much more than their outline are refused, over the
   !> spacing.
   real(wp), parameter :: tolerated = 0.05_wp
   !> Tips deeper in tiles than this are bridged, over the spacing.
   real(wp), parameter :: bridged = 0.1_wp
   !> Offsets of the lattices that are tried from the nodes of the grid, over the spacing.
   real(wp), parameter :: offsets(2, 3) = reshape([0.0_wp, 0.0_wp, 0.5_wp, 0.5_wp, &
                                                   0.25_wp, -0.25_wp], [2, 3])

contains

   !> New tiles of all bodies. Where bodies are cut and tiles on the nodes of the grid do not fit
   !> or bridge the gap that a tool is in, others are tried; in the end bridges are put up with.
   pure subroutine make_tiles(model, tiling, owner, has_failed, cuts)
      !> Scene between two steps.
      type(model_type), intent(in) :: model
      !> The tiles.
      type(tiling_type), intent(out) :: tiling
      !> Body of every tile, shape (n_tiles).
      integer, allocatable, intent(out) :: owner(:)
      !> Would bodies that share corners do so no more, has a tile no area, or do tiles lie over
      !> each other?
      logical, intent(out) :: has_failed
      !> Cuts ahead of corners of tools.
      type(cut_type), intent(in), optional :: cuts(:)
      integer :: k

      do k = 1, size(offsets, 2)
         call tile_bodies(model, tiling, owner, has_failed, offsets(:, k), cuts)
         if (.not. present(cuts)) return
         if (.not. has_failed) has_failed = do_bridge(tiling, cuts, model%grid%smallest_spacing())
         if (.not. has_failed .or. size(cuts) == 0) return
      end do
      call tile_bodies(model, tiling, owner, has_failed, offsets(:, 1), cuts)
   end subroutine make_tiles

   !> Is a corner of a tool in a tile before which bodies are cut?
   pure function do_bridge(tiling, cuts, spacing) result(answer)
      type(tiling_type), intent(in) :: tiling
      type(cut_type), intent(in) :: cuts(:)
      real(wp), intent(in) :: spacing
      logical :: answer
      integer :: i

      answer = .false.
      do i = 1, size(cuts)
         answer = answer .or. depth_in_tiles(tiling, cuts(i)%tip) > bridged*spacing
      end do
   end function do_bridge

   !> New tiles of all bodies on one lattice, body by body.
   pure subroutine tile_bodies(model, tiling, owner, has_failed, offset, cuts)
      type(model_type), intent(in) :: model
      type(tiling_type), intent(out) :: tiling
      integer, allocatable, intent(out) :: owner(:)
      logical, intent(out) :: has_failed
      !> Offset of the lattice from the nodes of the grid, over its spacing.
      real(wp), intent(in) :: offset(2)
      type(cut_type), intent(in), optional :: cuts(:)
      type(interfaces_type) :: interfaces
      real(wp), allocatable :: vertices(:, :, :), all_vertices(:, :, :)
      integer, allocatable :: field(:)
      integer :: piece(model%points%n_points), b, k, p
      real(wp) :: gradient(2, 4), area
      logical :: lies_over, do_lie_over

      do_lie_over = .false.
      call find_interfaces(interfaces, model%tiling, model%points%body)
      call find_pieces(piece, model, interfaces)
      allocate (owner(0), field(0), all_vertices(2, 4, 0))
      do k = 1, maxval(piece)
         b = model%points%body(findloc(piece, k, dim=1))
         call tile_piece(vertices, model, b, piece == k, interfaces, offset, lies_over, cuts)
         do_lie_over = do_lie_over .or. lies_over
         all_vertices = reshape([all_vertices, vertices], [2, 4, size(owner) + size(vertices, 3)])
         owner = [owner, spread(b, 1, size(vertices, 3))]
         ! pieces of a body that meet share no corners
         field = [field, spread(merge(size(model%bodies) + k, model%bodies(b)%field, &
                                      any(model%points%body == b .and. piece /= k)), &
                                1, size(vertices, 3))]
      end do
      call new_tiling(tiling, all_vertices, corner_tolerance*model%grid%smallest_spacing(), field)
      has_failed = size(owner) == 0 .or. do_lie_over &
         .or. is_torn(interfaces, tiling, bonded*model%grid%smallest_spacing())
      do p = 1, size(owner)
         call corner_gradients(tiling%position(:, tiling%corner(:, p)), gradient, area)
         has_failed = has_failed .or. .not. area > 0.0_wp
      end do
   end subroutine tile_bodies

   !> Pieces that are tiled by themselves: bodies, or parts of those whose surfaces press and rub,
   !> unless other bodies are bonded to them.
   pure subroutine find_pieces(piece, model, interfaces)
      !> Number of the piece of every tile, shape (n_tiles).
      integer, intent(out) :: piece(:)
      type(model_type), intent(in) :: model
      type(interfaces_type), intent(in) :: interfaces
      type(part_type), allocatable :: parts(:)
      integer :: part(size(piece)), b, k, n

      call find_parts(parts, model%tiling, model%points%body, size(model%bodies), part)
      n = 0
      do b = 1, size(model%bodies)
         do k = 1, size(parts)
            if (parts(k)%body /= b) cycle
            n = n + 1
            if (model%bodies(b)%meets_itself &
                .and. .not. any(interfaces%body(1, :) == b .and. interfaces%body(2, :) > 0)) then
               where (part == k) piece = n
            else
               where (model%points%body == b) piece = n
               exit
            end if
         end do
      end do
   end subroutine find_pieces

   !> New tiles of a piece.
   pure subroutine tile_piece(vertices, model, b, is_mine, interfaces, offset, lies_over, cuts)
      !> Corners of the tiles, shape (2, 4, n).
      real(wp), allocatable, intent(out) :: vertices(:, :, :)
      type(model_type), intent(in) :: model
      !> Number of its body, and does a tile belong to it, shape (n_tiles)?
      integer, intent(in) :: b
      logical, intent(in) :: is_mine(:)
      type(interfaces_type), intent(in) :: interfaces
      !> See `tile_bodies`.
      real(wp), intent(in) :: offset(2)
      !> Do tiles lie over each other where the outline does not?
      logical, intent(out) :: lies_over
      type(cut_type), intent(in), optional :: cuts(:)
      type(outline_type) :: outline
      type(face_type), allocatable :: plates(:)
      real(wp), allocatable :: shift(:, :)
      real(wp) :: edge(2), depth, least

      edge = model%grid%spacing/real(model%bodies(b)%points_per_cell, wp)
      call find_plates(plates, model%boundaries, model%points%position, &
                       model%grid%smallest_spacing())
      least = merge(smallest_loop, smallest_plate, size(plates) == 0)*product(edge)
      call trace_outline(outline, model%tiling%position, edges_of_tiles(interfaces, is_mine), least)
      call keep_ends(outline, interfaces)
      if (.not. model%bodies(b)%meets_itself) call join_surfaces(outline, model, least)
      call trim_outline(outline, model%boundaries, model%grid%smallest_spacing(), cuts)
      depth = deepest_overlap(outline%corner, edges_of(outline))
      if (model%bodies(b)%meets_itself) then
         call open_slits(outline, shift, minval(edge))
      else if (size(plates) > 0) then
         call open_slits(outline, shift, minval(edge), plates)
      end if
      call tile_outline(outline, model%grid%origin + offset*edge, edge, vertices)
      if (allocated(shift)) call close_slits(vertices, outline, shift, minval(edge))
      call settle_corners(vertices, model, is_mine, interfaces, depth, cuts)
      lies_over = depth > tolerated*model%grid%smallest_spacing()
   end subroutine tile_piece

   !> Push corners out of tools, and shift free ones: new tiles of a piece get the area of its old
   !> ones.
   pure subroutine settle_corners(vertices, model, is_mine, interfaces, depth, cuts)
      real(wp), intent(inout) :: vertices(:, :, :)
      type(model_type), intent(in) :: model
      logical, intent(in) :: is_mine(:)
      type(interfaces_type), intent(in) :: interfaces
      !> How far the outline lies over itself; on return, how much farther the tiles do.
      real(wp), intent(inout) :: depth
      type(cut_type), intent(in), optional :: cuts(:)
      type(tiling_type) :: tiling
      logical, allocatable :: is_free(:)
      real(wp) :: h, area, total, gradient(2, 4)
      integer :: c, p

      h = model%grid%smallest_spacing()
      total = 0.0_wp
      do p = 1, model%points%n_points
         if (.not. is_mine(p)) cycle
         call corner_gradients(model%tiling%position(:, model%tiling%corner(:, p)), gradient, area)
         total = total + area
      end do
      if (size(vertices, 3) == 0) return
      call new_tiling(tiling, vertices, corner_tolerance*h)
      call push_corners_out(tiling, model%boundaries, h)
      allocate (is_free(tiling%n_corners))
      call find_free_corners(is_free, tiling, model, cuts)
      if (any(model%bodies%meets_itself)) is_free = is_free &
         .and. .not. are_facing(tiling%position, tiling%outer_edge, bonded*h)
      do c = 1, tiling%n_corners
         if (is_free(c)) is_free(c) = .not. is_on_interface(interfaces, tiling%position(:, c), &
                                                            bonded*h)
         if (.not. (is_free(c) .and. size(model%body_contacts) > 0)) cycle
         is_free(c) = .not. is_on_other_piece(model, is_mine, tiling%position(:, c), bonded*h)
      end do
      call restore_area(tiling, shares_of(tiling, is_free, h, cuts), total, farthest_shift*h)
      depth = deepest_overlap(tiling%position, tiling%outer_edge) - depth
      do p = 1, size(vertices, 3)
         vertices(:, :, p) = tiling%position(:, tiling%corner(:, p))
      end do
   end subroutine settle_corners

   !> How much of what restores the area every corner takes: all free ones the same, but beside
   !> corners of tools that go in with both faces the nearest ones most. There the soil that a cut
   !> leaves out is what the faces do not press upwards in the step.
   pure function shares_of(tiling, is_free, spacing, cuts) result(share)
      type(tiling_type), intent(in) :: tiling
      logical, intent(in) :: is_free(:)
      real(wp), intent(in) :: spacing
      type(cut_type), intent(in), optional :: cuts(:)
      real(wp) :: share(size(is_free))
      real(wp) :: distance(size(is_free))
      integer :: c, k

      share = merge(1.0_wp, 0.0_wp, is_free)
      if (.not. (present(cuts) .and. any(is_free))) return
      if (.not. any(cuts%goes_in)) return
      distance = huge(1.0_wp)
      do k = 1, size(cuts)
         if (.not. cuts(k)%goes_in) cycle
         do c = 1, size(distance)
            distance(c) = min(distance(c), &
                              max(spacing, norm2(tiling%position(:, c) - cuts(k)%place)))
         end do
      end do
      where (is_free) share = (minval(distance, mask=is_free)/distance)**nearness
   end function shares_of

   !> Corners on the outline that are near no boundary, no root of a cut, no held node and no side
   !> of the grid.
   pure subroutine find_free_corners(is_free, tiling, model, cuts)
      logical, intent(out) :: is_free(:)
      type(tiling_type), intent(in) :: tiling
      type(model_type), intent(in) :: model
      type(cut_type), intent(in), optional :: cuts(:)
      real(wp) :: near
      integer :: b, c, f, k

      near = touching*model%grid%smallest_spacing()
      is_free = .false.
      is_free(tiling%outer_edge(1, :)) = .true.
      do c = 1, tiling%n_corners
         associate (place => tiling%position(:, c))
            is_free(c) = is_free(c) .and. all(place > model%grid%origin + near) &
               .and. all(place < model%grid%upper_corner() - near)
            do f = 1, size(model%fixities)
               associate (fixity => model%fixities(f))
                  is_free(c) = is_free(c) .and. .not. (fixity%is_active &
                     .and. all(place > fixity%lower - near) .and. all(place < fixity%upper + near))
               end associate
            end do
         end associate
      end do
      do b = 1, size(model%boundaries)
         if (.not. model%boundaries(b)%is_active) cycle
         do c = 1, tiling%n_corners
            if (is_free(c)) is_free(c) = .not. is_near_face(model%boundaries(b), &
                                                            tiling%position(:, c), near)
         end do
      end do
      if (.not. present(cuts)) return
      do k = 1, size(cuts)
         do c = 1, tiling%n_corners
            is_free(c) = is_free(c) .and. norm2(tiling%position(:, c) - cuts(k)%place) > near
         end do
      end do
   end subroutine find_free_corners

end module coulter_retile_new_tiles
