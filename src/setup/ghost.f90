!> Setting up the ghost penalty of a step: which faces, how stiff, and what they add to the tangent.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_setup_ghost
   use coulter_algebra_sparse, only: add_twice
   use coulter_base_kinds, only: wp
   use coulter_base_tensor, only: equivalent_stress
   use coulter_model, only: model_type, point_moduli
   use coulter_system, only: system_type
   use coulter_system_ghost, only: find_ghost_faces, ghost_matrix, ghost_type
   use coulter_system_unknowns, only: coupling_type, couple_vertices, new_coupling
   implicit none(type, external)
   private
   public :: find_stabilised_faces, couple_faces, set_ghost_values

   !> Strain of a step in flow beyond which ghost penalties do not stiffen any more.
   real(wp), parameter :: ghost_strain = 0.01_wp

   !> Share of the elastic penalty that is left in any case.
   real(wp), parameter :: ghost_rest = 1.0e-4_wp

contains

   !> Faces that need a ghost penalty, with the shear modulus of the material beside them.
   subroutine find_stabilised_faces(system, model)
      !> System with located tiles; gets `ghost` and `ghost_stiffness`.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      real(wp) :: lame_lambda, shear_modulus
      integer :: f

      system%ghost = ghost_type()
      if (model%control%ghost_ratio > 0.0_wp) then
         call find_ghost_faces(system%ghost, system%cells, system%map%fill)
      end if
      if (allocated(system%ghost_stiffness)) deallocate (system%ghost_stiffness)
      allocate (system%ghost_stiffness(system%ghost%n_faces))
      do f = 1, system%ghost%n_faces
         call point_moduli(model, system%map%tile_in_cell(system%ghost%cell(f)), lame_lambda, &
                           shear_modulus)
         system%ghost_stiffness(f) = 2.0_wp*model%control%ghost_ratio*shear_modulus
      end do
      if (allocated(model%points%has_flowed)) call soften_faces(system, model)
   end subroutine find_stabilised_faces

   !> Around material that flowed in the last step, penalties take no more than the secant modulus
   !> of its stress, q/(3 strain): else mechanisms that break through the outline of stiff soil
   !> would find their resistance in them. Where there is no shear stress, as at the apex of a
   !> cone, enough is left to tie nodes together that hang on one corner.
   pure subroutine soften_faces(system, model)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      real(wp) :: modulus(system%cells%n_nodes), secant
      integer :: p, v, f

      modulus = huge(1.0_wp)
      do p = 1, model%points%n_points
         if (.not. model%points%has_flowed(p)) cycle
         secant = equivalent_stress(model%points%converged%kirchhoff_stress(:, p)) &
            /(3.0_wp*ghost_strain)
         do v = 1, 4
            associate (node => system%map%node(:, model%tiling%corner(v, p)))
               modulus(node) = min(modulus(node), secant)
            end associate
         end do
      end do
      do f = 1, system%ghost%n_faces
         secant = minval(modulus([system%ghost%node(:, :, f)]))
         associate (stiffness => system%ghost_stiffness(f))
            stiffness = min(stiffness, max(2.0_wp*model%control%ghost_ratio*secant, &
                                           ghost_rest*stiffness))
         end associate
      end do
   end subroutine soften_faces

   !> Unknowns of all stabilised faces: six nodes each.
   subroutine couple_faces(faces, system)
      !> Elements, one a face.
      type(coupling_type), intent(out) :: faces
      !> System with numbered unknowns.
      type(system_type), intent(in) :: system
      integer :: f, node(1, 6)
      real(wp), parameter :: one(1, 6) = 1.0_wp

      call new_coupling(faces, system%ghost%n_faces, 6)
      do f = 1, system%ghost%n_faces
         node = reshape(system%ghost%node(:, :, f), [1, 6])
         call couple_vertices(faces, system%dofs, node, one)
      end do
   end subroutine couple_faces

   !> What the stabilised faces add to the tangent: constant during the step.
   subroutine set_ghost_values(system, faces)
      !> System with a pattern; gets `ghost_values`.
      type(system_type), intent(inout) :: system
      !> What `couple_faces` made.
      type(coupling_type), intent(in) :: faces
      integer :: f, first, last

      if (allocated(system%ghost_values)) deallocate (system%ghost_values)
      allocate (system%ghost_values(system%pattern%n_entries), source=0.0_wp)
      do f = 1, system%ghost%n_faces
         first = (faces%elements%start(f) + 1)/2
         last = (faces%elements%start(f + 1) - 1)/2
         call add_twice(system%pattern, system%groups%elements%n_elements + f, last - first + 1, &
                        system%ghost_stiffness(f)*ghost_matrix(faces%share(:, first:last)), &
                        system%ghost_values)
      end do
   end subroutine set_ghost_values

end module coulter_setup_ghost
