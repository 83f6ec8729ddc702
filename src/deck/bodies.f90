!> Reads bodies and their regions.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_bodies
   use coulter_base_kinds, only: wp
   use coulter_deck_document, only: blame, deck_type, find_groups
   use coulter_deck_initial_stress, only: read_body_stress, read_stress_profiles
   use coulter_deck_outline, only: new_polygon
   use coulter_deck_references, only: check_unique_names, get_reference
   use coulter_deck_values, only: demand_one, get_list, get_value
   use coulter_model_control, only: domains_tiles
   use coulter_points_body, only: body_type, region_type
   implicit none(type, external)
   private
   public :: read_bodies

contains

   !> All bodies with their regions.
   subroutine read_bodies(deck, domains, bodies)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> What a point stands for: one of `domains_*`.
      integer, intent(in) :: domains
      !> Bodies in the order of the deck.
      type(body_type), allocatable, intent(out) :: bodies(:)
      integer, allocatable :: groups(:)
      integer :: i

      call check_unique_names(deck, "body")
      call find_groups(deck, "body", groups)
      allocate (bodies(size(groups)))
      do i = 1, size(groups)
         associate (body => bodies(i))
            body%name = ""
            call get_value(deck, groups(i), "name", body%name)
            call get_reference(deck, groups(i), "law", body%law)
            call get_value(deck, groups(i), "density", body%density)
            if (domains /= domains_tiles) body%points_per_cell = 2
            call get_value(deck, groups(i), "points_per_cell", body%points_per_cell)
            call read_body_stress(deck, groups(i), body)
         end associate
      end do
      call read_stress_profiles(deck, bodies)
      call read_regions(deck, groups, bodies)
   end subroutine read_bodies

   !> All regions, handed to their bodies in the order of the deck.
   subroutine read_regions(deck, body_groups, bodies)
      type(deck_type), intent(inout) :: deck
      !> Numbers of the body groups in the deck.
      integer, intent(in) :: body_groups(:)
      type(body_type), intent(inout) :: bodies(:)
      type(region_type), allocatable :: regions(:)
      integer, allocatable :: groups(:), owner(:), order(:), own(:)
      integer :: i, k

      call find_groups(deck, "region", groups)
      allocate (regions(size(groups)))
      allocate (owner(size(groups)), source=0)
      do i = 1, size(groups)
         call get_reference(deck, groups(i), "body", owner(i))
         call read_region(deck, groups(i), regions(i)%vertices)
      end do
      allocate (order(0))
      do k = 1, size(bodies)
         own = pack([(i, i=1, size(groups))], owner == k)
         order = [order, own]
         allocate (bodies(k)%regions(size(own)))
         do i = 1, size(own)
            bodies(k)%regions(i) = regions(own(i))
         end do
         if (size(own) == 0 .and. size(owner) > 0 .and. all(owner > 0)) then
           call blame(deck, body_groups(k), "", "has no &region")
         end if
      end do
      ! faults of the deck count regions as the deck does, those of the model as the model does
      if (deck%faults%n_faults == 0) deck%region_order = order
   end subroutine read_regions

   !> Corners of one region; none if it is at fault.
   subroutine read_region(deck, group, vertices)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      real(wp), allocatable, intent(out) :: vertices(:, :)
      character(len=:), allocatable :: message
      real(wp), allocatable :: box(:), list(:)

      call demand_one(deck, group, "rectangle", "polygon")
      call get_list(deck, group, "rectangle", box)
      call get_list(deck, group, "polygon", list)
      if (allocated(box)) then
         vertices = reshape(box([1, 2, 3, 2, 3, 4, 1, 4]), [2, 4])
         if (any(box(3:) <= box(:2))) call blame(deck, group, "rectangle", &
            "must give left, bottom, right and top: right > left and top > bottom")
      else if (allocated(list)) then
         call new_polygon(list, vertices, message)
         if (message /= "") call blame(deck, group, "polygon", message)
      end if
   end subroutine read_region

end module coulter_deck_bodies
