!> Reads laws: those made from the parameters that law/parameters lists, and user materials.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_laws
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: wp
   use coulter_deck_document, only: blame, deck_type, find_groups
   use coulter_deck_references, only: check_unique_names
   use coulter_deck_schema, only: umat_parameters
   use coulter_deck_umat, only: read_umat
   use coulter_deck_values, only: demand, get_choice, get_list, get_value, is_given, refuse
   use coulter_law, only: has_word, law_item_type, law_model_type, law_models, law_parameters, &
      law_values_type, make_undrained, new_law
   implicit none(type, external)
   private
   public :: read_laws

contains

   !> All laws.
   subroutine read_laws(deck, laws)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Laws in the order of the deck; unallocated where at fault.
      type(law_item_type), allocatable, intent(out) :: laws(:)
      integer, allocatable :: groups(:)
      integer :: i, choice

      call check_unique_names(deck, "law")
      call find_groups(deck, "law", groups)
      allocate (laws(size(groups)))
      do i = 1, size(groups)
         choice = 1
         if (is_given(deck, groups(i), "model")) choice = 0
         call get_choice(deck, groups(i), "model", choice)
         ! of a model that is none, nothing more can be said
         if (choice == 0) cycle
         if (choice > size(law_models)) then
            call read_umat(deck, groups(i), laws(i))
         else
            call read_law(deck, groups(i), law_models(choice), laws(i))
         end if
         call read_water(deck, groups(i), laws(i))
      end do
   end subroutine read_laws

   !> A law that is made from its parameters.
   subroutine read_law(deck, group, model, item)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(law_model_type), intent(in) :: model
      type(law_item_type), intent(inout) :: item
      type(law_values_type) :: values
      type(error_type), allocatable :: error
      character(len=:), allocatable :: name
      integer :: known_faults
      logical :: is_complete

      known_faults = deck%faults%n_faults
      name = ""
      call get_value(deck, group, "name", name)
      call refuse_others(deck, group, model)
      call read_parameters(deck, group, model, values, is_complete)
      if (deck%faults%n_faults > known_faults .or. .not. is_complete) return
      call new_law(item, trim(model%word), name, values, error)
      ! the message begins with the name of the law, which that of the deck repeats
      if (.not. allocated(error)) return
      call blame(deck, group, "", &
                 error%message(index(error%message, name//": ") + len(name) + 2:))
   end subroutine read_law

   !> Water in the pores of any law.
   subroutine read_water(deck, group, item)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(law_item_type), intent(inout) :: item
      type(error_type), allocatable :: error
      real(wp) :: modulus

      if (.not. is_given(deck, group, "water_bulk_modulus")) return
      modulus = 1.0_wp
      call get_value(deck, group, "water_bulk_modulus", modulus)
      if (.not. allocated(item%law)) return
      call make_undrained(item, modulus, error)
      if (allocated(error)) call blame(deck, group, "water_bulk_modulus", &
                                       "must be positive")
   end subroutine read_water

   !> Values of the parameters that a model takes, unless the deck misses or misspells some.
   subroutine read_parameters(deck, group, model, values, is_complete)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(law_model_type), intent(in) :: model
      type(law_values_type), intent(inout) :: values
      logical, intent(out) :: is_complete
      character(len=:), allocatable :: name
      real(wp), allocatable :: list(:)
      integer :: i

      is_complete = .true.
      do i = 1, size(law_parameters)
         name = trim(law_parameters(i)%name)
         if (has_word(model%needs, name)) call demand(deck, group, name)
         call get_list(deck, group, name, list)
         if (allocated(list)) call values%set(name, list)
         is_complete = is_complete .and. (allocated(list) .or. .not. has_word(model%needs, name))
      end do
   end subroutine read_parameters

   !> Note parameters that belong to other models.
   subroutine refuse_others(deck, group, model)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(law_model_type), intent(in) :: model
      character(len=:), allocatable :: reason
      integer :: i

      reason = "is no parameter of model '"//trim(model%word)//"', which takes " &
         //trim(model%needs)//" "//trim(model%takes)
      do i = 1, size(law_parameters)
         if (has_word(trim(model%needs)//" "//model%takes, law_parameters(i)%name)) cycle
         call refuse(deck, group, trim(law_parameters(i)%name), reason)
      end do
      do i = 1, size(umat_parameters)
         call refuse(deck, group, trim(umat_parameters(i)), reason)
      end do
   end subroutine refuse_others

end module coulter_deck_laws
