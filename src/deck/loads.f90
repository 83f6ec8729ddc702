!> Reads loads and the tables that schedule them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_loads
   use coulter_base_kinds, only: wp
   use coulter_base_table, only: is_increasing, new_table, table_type
   use coulter_base_text, only: to_text
   use coulter_boundary_edge_load, only: edge_load_type
   use coulter_deck_document, only: blame, deck_type, first_group, find_groups
   use coulter_deck_outline, only: new_polyline
   use coulter_deck_references, only: check_unique_names, get_reference
   use coulter_deck_schedule, only: read_load_phases
   use coulter_deck_values, only: demand_one, get_list, get_value
   use coulter_model_body_force, only: body_force_type
   use coulter_model_control, only: domains_tiles
   implicit none(type, external)
   private
   public :: read_tables, read_body_force, read_edge_loads

contains

   !> All loads on the edges of bodies.
   subroutine read_edge_loads(deck, domains, loads)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> What a point stands for: one of `domains_*`.
      integer, intent(in) :: domains
      !> Loads in the order of the deck.
      type(edge_load_type), allocatable, intent(out) :: loads(:)
      integer, allocatable :: groups(:)
      integer :: i

      call check_unique_names(deck, "edge_load")
      call find_groups(deck, "edge_load", groups)
      allocate (loads(size(groups)))
      do i = 1, size(groups)
         call read_edge_load(deck, groups(i), loads(i))
         if (domains == domains_tiles) cycle
         call blame(deck, groups(i), "", "needs domains = 'cpdi2', whose tiles have edges")
      end do
   end subroutine read_edge_loads

   !> One load on edges.
   subroutine read_edge_load(deck, group, load)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(edge_load_type), intent(out) :: load
      character(len=:), allocatable :: message
      real(wp), allocatable :: list(:)

      load%name = ""
      call get_value(deck, group, "name", load%name)
      call get_value(deck, group, "traction", load%traction)
      call get_value(deck, group, "pressure", load%pressure)
      call get_reference(deck, group, "table", load%table)
      call read_load_phases(deck, group, load%table, load%ramp_phase, load%last_phase)
      call get_list(deck, group, "vertices", list)
      if (allocated(list)) then
         call new_polyline(list, load%vertices, message)
         if (message /= "") call blame(deck, group, "vertices", message)
      end if
      call demand_one(deck, group, "traction", "pressure")
   end subroutine read_edge_load

   !> All tables.
   subroutine read_tables(deck, tables)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Tables in the order of the deck.
      type(table_type), allocatable, intent(out) :: tables(:)
      integer, allocatable :: groups(:)
      integer :: i

      call check_unique_names(deck, "table")
      call find_groups(deck, "table", groups)
      allocate (tables(size(groups)))
      do i = 1, size(groups)
         call read_table(deck, groups(i), tables(i))
      end do
   end subroutine read_tables

   !> One table.
   subroutine read_table(deck, group, table)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(table_type), intent(out) :: table
      character(len=:), allocatable :: name
      real(wp), allocatable :: time(:), value(:)
      real(wp) :: period

      name = ""
      period = 0.0_wp
      call get_value(deck, group, "name", name)
      call get_list(deck, group, "time", time)
      call get_list(deck, group, "value", value)
      call get_value(deck, group, "period", period)
      if (.not. (allocated(time) .and. allocated(value))) return
      if (size(time) /= size(value)) then
         call blame(deck, group, "value", "must have as many values as time, which has " &
                    //to_text(size(time)))
      else if (.not. is_increasing(time)) then
         call blame(deck, group, "time", "must increase")
      else
         call new_table(table, name, time, value)
         table%period = period
      end if
   end subroutine read_table

   !> The body force; none when the deck gives none.
   subroutine read_body_force(deck, body_force)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Acceleration and its table.
      type(body_force_type), intent(out) :: body_force
      integer :: group

      group = first_group(deck, "body_force")
      if (group == 0) return
      call get_value(deck, group, "acceleration", body_force%acceleration)
      call get_reference(deck, group, "table", body_force%table)
      call read_load_phases(deck, group, body_force%table, body_force%ramp_phase, &
                            body_force%last_phase)
   end subroutine read_body_force

end module coulter_deck_loads
