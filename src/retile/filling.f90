!> A new tiling inside the outline of distorted tiles.
!>
!> The nodes of a regular lattice move to the outline where they are near it; the outline itself is
!> not simplified (theory, section 8).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_retile_filling
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: append, area_and_centroid, polygon_type
   use coulter_points_domains, only: add_domain, cut_domains, domain_list_type, weld_domains
   use coulter_points_outline, only: encloses, outline_type
   use coulter_retile_lattice, only: cell_node, fit_lattice, lattice_type
   use coulter_retile_outline_fitting, only: follow_outline, runs_along
   implicit none(type, external)
   private
   public :: tile_outline

   !> Corners of tiles nearer than this are one, over the spacing.
   real(wp), parameter :: corner_tolerance = 1.0e-7_wp
   !> Tiles smaller than this share of a cell are left out.
   real(wp), parameter :: smallest_share = 2.0e-3_wp
   !> Places beside the middle one of three corners, as shares in all of them.
   real(wp), parameter :: beside(3, 2) = reshape([0.1_wp, 0.88_wp, 0.02_wp, &
                                                  0.02_wp, 0.88_wp, 0.1_wp], [3, 2])

contains

   !> Tile the inside of an outline: one tile per whole cell of a lattice, polygons at the outline
   !> that are split into quadrilaterals and triangles.
   pure subroutine tile_outline(outline, origin, spacing, vertices)
      !> Outline of the body.
      type(outline_type), intent(in) :: outline
      !> A node of the lattice, and its spacing per direction, length units.
      real(wp), intent(in) :: origin(2), spacing(2)
      !> Corners of the tiles, counter-clockwise; a triangle repeats its last one, shape
      !> (2, 4, n_tiles).
      real(wp), allocatable, intent(out) :: vertices(:, :, :)
      type(lattice_type) :: lattice
      type(domain_list_type) :: domains
      integer, allocatable :: owner(:)
      real(wp) :: h
      integer :: i, j, n

      allocate (vertices(2, 4, 0))
      if (outline%n == 0) return
      h = minval(spacing)
      call fit_lattice(lattice, outline, origin, spacing)
      do j = 1, size(lattice%state, 2) - 1
         do i = 1, size(lattice%state, 1) - 1
            call add_cell(lattice, outline, [i, j], product(spacing), domains)
         end do
      end do
      call weld_domains(domains, corner_tolerance*h, n)
      call follow_outline(domains, outline, h)
      call cut_domains(domains, [corner_tolerance*product(spacing)], vertices, owner)
   end subroutine tile_outline

   !> Append what of a cell is inside: its nodes inside and on the outline, and the crossings
   !> between; in two parts where a gap leads through it.
   pure subroutine add_cell(lattice, outline, cell, cell_area, domains)
      type(lattice_type), intent(in) :: lattice
      type(outline_type), intent(in) :: outline
      integer, intent(in) :: cell(2)
      real(wp), intent(in) :: cell_area
      type(domain_list_type), intent(inout) :: domains
      type(polygon_type) :: polygon
      integer :: state(8), first, last, tip, k
      logical :: is_gap(8)

      call walk_cell(lattice, cell, polygon, state, is_gap)
      associate (n => polygon%n, gap => findloc(is_gap, .true., dim=1))
         first = gap
         last = findloc(is_gap, .true., dim=1, back=.true.)
         tip = 0
         if (count(is_gap) == 1) then
            ! it ends at a node of the cell
            tip = findloc([(state(k) == 0 .and. k /= gap .and. k /= modulo(gap, n) + 1, k=1, n)], &
                          .true., dim=1)
            first = min(gap, tip)
            last = max(gap, tip)
         end if
         if (.not. allocated(outline%is_slit) .or. first == last .or. first == 0) then
            call add_part(polygon, state, [(k, k=1, n)], outline, cell_area, domains)
            return
         end if
         ! a tip belongs to both parts
         call add_part(polygon, state, [(k, k=first + merge(0, 1, first == tip), last)], outline, &
                       cell_area, domains)
         call add_part(polygon, state, [(k, k=last + merge(0, 1, last == tip), n), &
                                        (k, k=1, first)], outline, cell_area, domains)
      end associate
   end subroutine add_cell

   !> Append a part of a cell.
   pure subroutine add_part(whole, state, corners, outline, cell_area, domains)
      !> Corners of all of it, and their states, see `walk_cell`.
      type(polygon_type), intent(in) :: whole
      integer, intent(in) :: state(8)
      !> Numbers of the corners of the part.
      integer, intent(in) :: corners(:)
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: cell_area
      type(domain_list_type), intent(inout) :: domains
      type(polygon_type) :: part
      logical :: is_on_outline(8), has_inside
      real(wp) :: area, centroid(2)

      part%n = size(corners)
      part%corner = whole%corner(:, corners)
      has_inside = any(state(corners) > 0)
      is_on_outline(:part%n) = state(corners) == 0
      call cut_off_gaps(part, is_on_outline, outline, has_inside)
      if (part%n < 3) return
      call area_and_centroid(part%corner(:, :part%n), area, centroid)
      if (area < smallest_share*cell_area) return
      if (.not. (has_inside .or. encloses(outline, centroid))) return
      call add_domain(domains, part%corner(:, :part%n), 1)
   end subroutine add_part

   !> Corners of what of a cell is inside.
   pure subroutine walk_cell(lattice, cell, polygon, state, is_gap)
      type(lattice_type), intent(in) :: lattice
      integer, intent(in) :: cell(2)
      type(polygon_type), intent(out) :: polygon
      !> State of the nodes among them, -1 for crossings and beyond the last corner.
      integer, intent(out) :: state(8)
      !> Does a gap lie between a corner and the next one?
      logical, intent(out) :: is_gap(8)
      integer :: k, along, here(2), next(2), low(2), own
      logical :: is_wide

      allocate (polygon%corner(2, 8))
      state = -1
      is_gap = .false.
      do k = 1, 4
         here = cell + cell_node(:, k)
         next = cell + cell_node(:, modulo(k, 4) + 1)
         own = lattice%state(here(1), here(2))
         low = min(here, next)
         along = merge(1, 2, here(2) == next(2))
         is_wide = lattice%is_wide(along, low(1), low(2))
         if (own >= 0) then
            call append(polygon, lattice%position(:, here(1), here(2)))
            state(polygon%n) = own
            is_gap(polygon%n) = is_wide .and. own == 0
         end if
         if (.not. lattice%is_crossed(along, low(1), low(2))) cycle
         call append(polygon, lattice%crossing(:, along, low(1), low(2)))
         is_gap(polygon%n) = is_wide .and. own > 0
      end do
   end subroutine walk_cell

   !> Leave out nodes on the outline whose corner of the cell is outside: beside a re-entrant corner
   !> of the body they belong to the other face of the gap. Those stay that bound material on the
   !> same face as a neighbour: where the outline is hollow, as around the nose of a tool, most of
   !> the corner may be outside; but not those from which the outline comes, or goes, round another
   !> corner of the cell.
   pure subroutine cut_off_gaps(polygon, is_on_outline, outline, has_inside)
      type(polygon_type), intent(inout) :: polygon
      logical, intent(inout) :: is_on_outline(8)
      type(outline_type), intent(in) :: outline
      !> Is a node of the cell inside the body?
      logical, intent(in) :: has_inside
      integer :: k, n, last, next
      logical :: is_gap

      k = 1
      do while (k <= polygon%n .and. polygon%n >= 3)
         n = polygon%n
         last = modulo(k - 2, n) + 1
         next = modulo(k, n) + 1
         is_gap = is_on_outline(k)
         if (is_gap) is_gap = is_outside(outline, polygon%corner(:, [last, k, next]))
         if (is_gap .and. has_inside) is_gap = .not. &
            (runs_along(outline, polygon%corner(:, last), polygon%corner(:, k), &
                        polygon%corner(:, next)) &
             .or. runs_along(outline, polygon%corner(:, k), polygon%corner(:, next), &
                             polygon%corner(:, last)))
         if (is_gap) then
            polygon%corner(:, k:n - 1) = polygon%corner(:, k + 1:n)
            is_on_outline(k:n - 1) = is_on_outline(k + 1:n)
            polygon%n = n - 1
            k = 1
         else
            k = k + 1
         end if
      end do
   end subroutine cut_off_gaps

   !> Is a convex ear outside, both in the middle and, since its edges are chords, beside its tip?
   pure function is_outside(outline, ear) result(answer)
      type(outline_type), intent(in) :: outline
      real(wp), intent(in) :: ear(2, 3)
      logical :: answer
      real(wp) :: area, centroid(2)

      call area_and_centroid(ear, area, centroid)
      answer = area > 0.0_wp
      if (answer) answer = .not. encloses(outline, centroid)
      if (answer) answer = .not. encloses(outline, matmul(ear, beside(:, 1)))
      if (answer) answer = .not. encloses(outline, matmul(ear, beside(:, 2)))
   end function is_outside

end module coulter_retile_filling
