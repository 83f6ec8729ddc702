!> Public face of the constitutive laws. A new law is one file beside this one and three lines here.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law
   use coulter_base_error, only: error_type, fatal_error
   use coulter_law_abstract, only: law_item_type, law_response_type, law_sites_type, law_type, &
      law_variable_type, law_verdict_type, law_visit_type, n_plane
   use coulter_law_cam_clay, only: cam_clay_model, cam_clay_type, new_cam_clay
   use coulter_law_drucker_prager, only: drucker_prager_model, drucker_prager_type, &
      new_drucker_prager
   use coulter_law_hencky, only: hencky_model, hencky_type, new_hencky, new_hencky_law
   use coulter_law_houlsby, only: houlsby_model, houlsby_type, new_houlsby
   use coulter_law_mohr_coulomb, only: mohr_coulomb_model, mohr_coulomb_type, new_mohr_coulomb
   use coulter_law_parameters, only: has_word, law_model_type, law_parameters, law_values_type
   use coulter_law_tresca, only: new_tresca, tresca_model
   use coulter_law_umat, only: n_plane_umat, n_solid_umat, new_umat, umat_settings_type, umat_type
   use coulter_law_undrained, only: make_undrained
   use coulter_law_von_mises, only: new_von_mises, von_mises_model
   implicit none(type, external)
   private
   public :: law_item_type, law_response_type, law_type, law_variable_type, law_verdict_type
   public :: law_sites_type, law_visit_type, n_plane
   public :: law_model_type, law_models, law_parameters, law_values_type
   public :: hencky_type, new_hencky, new_law, has_word
   public :: make_undrained, n_plane_umat, n_solid_umat, new_umat, umat_settings_type, umat_type

   !> Kinds of law that are built from parameters alone.
   type(law_model_type), parameter :: law_models(*) = [hencky_model, houlsby_model, &
      von_mises_model, tresca_model, drucker_prager_model, mohr_coulomb_model, cam_clay_model]

contains

   !> Make a law of any kind.
   pure subroutine new_law(item, word, name, values, error)
      !> Gets the law, if there is no error.
      type(law_item_type), intent(out) :: item
      !> Word of its kind, one of those of `law_models`.
      character(len=*), intent(in) :: word
      !> Name by which bodies refer to it.
      character(len=*), intent(in) :: name
      !> Its parameters.
      type(law_values_type), intent(in) :: values
      !> Set when there is no such word, or they are missing, out of range or contradict each other.
      type(error_type), allocatable, intent(out) :: error
      type(hencky_type) :: hencky
      type(houlsby_type) :: houlsby
      type(drucker_prager_type) :: cone
      type(mohr_coulomb_type) :: pyramid
      type(cam_clay_type) :: cam_clay

      select case (word)
      case ("hencky")
         call new_hencky_law(hencky, name, values, error)
         if (.not. allocated(error)) allocate (item%law, source=hencky)
      case ("houlsby")
         call new_houlsby(houlsby, name, values, error)
         if (.not. allocated(error)) allocate (item%law, source=houlsby)
      case ("von_mises")
         call new_von_mises(cone, name, values, error)
         if (.not. allocated(error)) allocate (item%law, source=cone)
      case ("drucker_prager")
         call new_drucker_prager(cone, name, values, error)
         if (.not. allocated(error)) allocate (item%law, source=cone)
      case ("tresca")
         call new_tresca(pyramid, name, values, error)
         if (.not. allocated(error)) allocate (item%law, source=pyramid)
      case ("mohr_coulomb")
         call new_mohr_coulomb(pyramid, name, values, error)
         if (.not. allocated(error)) allocate (item%law, source=pyramid)
      case ("cam_clay")
         call new_cam_clay(cam_clay, name, values, error)
         if (.not. allocated(error)) allocate (item%law, source=cam_clay)
      case default
         call fatal_error(error, "law "//name//": there is no model '"//word//"'")
      end select
   end subroutine new_law

end module coulter_law
