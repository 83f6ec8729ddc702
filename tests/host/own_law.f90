!> A law of one's own and a scene without a deck: a block of a law that stiffens with its volume
!> change is pressed between smooth walls. What it is, and what of it is public: docs/library.md.
! SPDX-License-Identifier: BSD-3-Clause
module stiffening_law
   use coulter_base_kinds, only: wp
   use coulter_law, only: law_response_type, law_type, law_visit_type, n_plane
   implicit none(type, external)
   private
   public :: stiffening_type

   !> tau = K (1 + b v^2) v 1 + 2 G dev(eps), where v = tr(eps).
   type, extends(law_type) :: stiffening_type
      !> Bulk and shear modulus K and G, stress units, and growth b.
      real(wp) :: bulk_modulus = 0.0_wp, shear_modulus = 0.0_wp, growth = 0.0_wp
   contains
      procedure :: update
      procedure :: elastic_moduli
      procedure :: elastic_strain
   end type stiffening_type

contains

   !> Stress and its derivative by the strain.
   pure subroutine update(self, visit, trial_strain, state, response, new_state)
      class(stiffening_type), intent(in) :: self
      type(law_visit_type), intent(in) :: visit
      real(wp), intent(in) :: trial_strain(n_plane), state(self%n_state)
      type(law_response_type), intent(out) :: response
      real(wp), intent(out) :: new_state(self%n_state)
      real(wp) :: volume, slope
      integer :: i

      volume = sum(trial_strain(:3))
      associate (k => self%bulk_modulus, g => self%shear_modulus)
         response%stress(:3) = k*(1.0_wp + self%growth*volume**2)*volume &
            + 2.0_wp*g*(trial_strain(:3) - volume/3.0_wp)
         response%stress(4) = g*trial_strain(4)
         slope = k*(1.0_wp + 3.0_wp*self%growth*volume**2)
         response%tangent = 0.0_wp
         response%tangent(:3, :3) = slope - 2.0_wp/3.0_wp*g
         do i = 1, 3
            response%tangent(i, i) = slope + 4.0_wp/3.0_wp*g
         end do
         response%tangent(4, 4) = g
      end associate
      response%strain = trial_strain
      response%has_failed = .false.
      new_state = state
   end subroutine update

   !> What scales penalties.
   pure subroutine elastic_moduli(self, stress, state, lame_lambda, shear_modulus)
      class(stiffening_type), intent(in) :: self
      real(wp), intent(in) :: stress(n_plane), state(self%n_state)
      real(wp), intent(out) :: lame_lambda, shear_modulus

      shear_modulus = self%shear_modulus
      lame_lambda = self%bulk_modulus - 2.0_wp/3.0_wp*self%shear_modulus
   end subroutine elastic_moduli

   !> The strain of the initial stress; bodies of this law start without.
   pure function elastic_strain(self, stress, state) result(strain)
      class(stiffening_type), intent(in) :: self
      real(wp), intent(in) :: stress(n_plane), state(self%n_state)
      real(wp) :: strain(n_plane)

      strain = 0.0_wp
   end function elastic_strain

end module stiffening_law

program own_law
   use coulter_base_error, only: error_type
   use coulter_base_faults, only: fault_list_type
   use coulter_base_kinds, only: wp
   use coulter_boundary, only: boundary_type
   use coulter_grid, only: new_grid
   use coulter_model, only: model_type
   use coulter_model_prepare, only: prepare_model
   use coulter_points_body, only: region_type
   use coulter_step_run, only: run_model
   use host_observer, only: printer_type
   use stiffening_law, only: stiffening_type
   implicit none(type, external)
   type(model_type) :: model
   type(printer_type) :: printer
   type(fault_list_type) :: faults
   type(error_type), allocatable :: error
   integer :: i

   call new_grid(model%grid, [-0.5_wp, -0.5_wp], [0.25_wp, 0.25_wp], [9, 7], error)
   if (allocated(error)) error stop error%message

   allocate (model%laws(1), model%bodies(1))
   allocate (model%laws(1)%law, source=stiffening_type(bulk_modulus=100.0_wp, &
                                                       shear_modulus=60.0_wp, growth=8.0_wp))
   model%laws(1)%law%name = "stiffening"
   model%bodies(1)%name = "block"
   model%bodies(1)%law = 1
   model%bodies(1)%regions = [region_type(reshape( &
      [0.1_wp, 0.0_wp, 1.1_wp, 0.0_wp, 1.1_wp, 0.9_wp, 0.1_wp, 0.9_wp], [2, 4]))]

   ! the material is on the left of one who walks along a wall; walls push only
   allocate (model%boundaries(4))
   call put_wall(model%boundaries(1), "lid", [1.5_wp, 0.9_wp], [-0.5_wp, 0.9_wp])
   call put_wall(model%boundaries(2), "floor", [-0.5_wp, 0.0_wp], [1.5_wp, 0.0_wp])
   call put_wall(model%boundaries(3), "left", [0.1_wp, 1.2_wp], [0.1_wp, -0.5_wp])
   call put_wall(model%boundaries(4), "right", [1.1_wp, -0.5_wp], [1.1_wp, 1.2_wp])
   model%boundaries(1)%displacement = [0.0_wp, -0.3_wp]
   model%schedule%end_time = [0.5_wp, 1.0_wp]

   call prepare_model(model, faults)
   do i = 1, faults%n_faults
      print "(a)", faults%items(i)%group//" "//faults%items(i)%variable//": " &
         //faults%items(i)%message
   end do
   if (faults%n_faults > 0) error stop "the scene has faults"
   call run_model(model, printer, error)
   if (allocated(error)) error stop error%message

contains

   !> A smooth wall between two points.
   subroutine put_wall(wall, name, first, last)
      type(boundary_type), intent(inout) :: wall
      character(len=*), intent(in) :: name
      real(wp), intent(in) :: first(2), last(2)

      wall%name = name
      wall%vertices = reshape([first, last], [2, 2])
   end subroutine put_wall

end program own_law
