!> Public face of the constitutive laws. A new law is one file beside this one and one line here.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_law
   use coulter_law_abstract, only: law_item_type, law_response_type, law_type, law_variable_type, &
      law_verdict_type, law_visit_type, n_plane
   use coulter_law_hencky, only: hencky_type, new_hencky
   use coulter_law_umat, only: new_umat, umat_settings_type, umat_type
   implicit none(type, external)
   private
   public :: law_item_type, law_response_type, law_type, law_variable_type, law_verdict_type
   public :: law_visit_type, n_plane
   public :: hencky_type, new_hencky
   public :: new_umat, umat_settings_type, umat_type

end module coulter_law
