!> Tiles as they were before new ones were made, with all that hangs on them: a step that fails with
!> the new ones is repeated with others, which are made from these.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_system_kept_tiles
   use coulter_base_kinds, only: wp
   use coulter_boundary_edge_load, only: loaded_edge_type
   use coulter_boundary_held_edge, only: held_edge_type
   use coulter_contact, only: contacts_type
   use coulter_contact_surface_pairs, only: surface_pair_type
   use coulter_points, only: points_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: kept_tiles_type

   !> Tiles and points between two steps, and what the system remembers of their edges.
   type :: kept_tiles_type
      type(tiling_type) :: tiling
      type(points_type) :: points
      type(held_edge_type), allocatable :: held_edges(:)
      type(loaded_edge_type), allocatable :: loaded_edges(:)
      !> Largest openings, length units, as in `system_type`.
      real(wp), allocatable :: bonds(:, :, :)
      !> Contacts of the last accepted step, and pairs of surfaces where some meet.
      type(contacts_type) :: last_contacts
      type(surface_pair_type), allocatable :: pairs(:)
      !> As in `system_type`.
      real(wp) :: way_since_tiling = 0.0_wp
   end type kept_tiles_type

end module coulter_system_kept_tiles
