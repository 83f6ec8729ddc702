!> Reads laws of model 'umat': a user material in a shared library.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_umat
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_deck_document, only: blame, deck_type
   use coulter_deck_values, only: demand, get_list, get_value, is_given
   use coulter_law, only: law_item_type, n_plane_umat, n_solid_umat, new_umat, umat_settings_type, &
      umat_type
   implicit none(type, external)
   private
   public :: read_umat

contains

   !> A law of model 'umat'. Its library is loaded and asked once.
   subroutine read_umat(deck, group, item)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Number of the group in the deck.
      integer, intent(in) :: group
      !> Law to make; unallocated when at fault.
      type(law_item_type), intent(inout) :: item
      type(umat_type) :: law
      type(umat_settings_type) :: settings
      type(error_type), allocatable :: error
      character(len=:), allocatable :: name
      integer :: known_faults

      known_faults = deck%faults%n_faults
      name = ""
      call get_value(deck, group, "name", name)
      call read_settings(deck, group, name, settings)
      if (deck%faults%n_faults > known_faults .or. settings%library == "") return
      call new_umat(law, name, settings, error)
      if (allocated(error)) then
         call blame(deck, group, "library", error%message)
      else
         allocate (item%law, source=law)
      end if
   end subroutine read_umat

   !> What the deck says of the library.
   subroutine read_settings(deck, group, name, settings)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      character(len=*), intent(in) :: name
      type(umat_settings_type), intent(out) :: settings
      real(wp), allocatable :: first(:)
      integer :: n_state

      settings%library = ""
      settings%material = name
      n_state = 0
      call demand(deck, group, "library")
      call get_value(deck, group, "library", settings%library)
      if (index(settings%library, "/") /= 1 .and. settings%library /= "") then
         settings%library = folder_of(deck%path)//settings%library
      end if
      call get_value(deck, group, "material", settings%material)
      call get_list(deck, group, "constants", settings%constants)
      if (.not. allocated(settings%constants)) allocate (settings%constants(0))
      call get_value(deck, group, "umat_components", settings%n_components)
      if (all([n_plane_umat, n_solid_umat] /= settings%n_components)) then
         call blame(deck, group, "umat_components", "must be 4 or 6")
      end if
      call get_value(deck, group, "n_state", n_state)
      call get_list(deck, group, "initial_state", first)
      allocate (settings%initial_state(n_state), source=0.0_wp)
      if (allocated(first)) then
         if (size(first) > n_state) then
            call blame(deck, group, "initial_state", "holds "//to_text(size(first)) &
                       //" values, but n_state is "//to_text(n_state))
         else
            settings%initial_state(:size(first)) = first
         end if
      end if
      call get_value(deck, group, "youngs_modulus", settings%youngs_modulus)
      call get_value(deck, group, "poisson_ratio", settings%poisson_ratio)
      if (is_given(deck, group, "youngs_modulus")) call demand(deck, group, "poisson_ratio")
      if (is_given(deck, group, "poisson_ratio")) call demand(deck, group, "youngs_modulus")
   end subroutine read_settings

   !> Folder of a file with a slash at its end.
   pure function folder_of(path) result(folder)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: folder

      folder = path(:index(path, "/", back=.true.))
      if (folder == "") folder = "./"
   end function folder_of

end module coulter_deck_umat
