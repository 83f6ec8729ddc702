!> Forces and tangent of patches: points with boxes, and points that share their volume change.
!>
!> Against volumetric locking the volume change of the step, J = det dF, is averaged over the patch
!> with current volumes v: J_mean = sum v J/sum v, and a point sees dF (J_mean/J)^(1/2), the F-bar
!> of de Souza Neto et al. (1996), whose in-plane form Coombs et al. (2018) use for material points.
!> The forces are the derivative of the energy stored by that, as in the mean dilatation method of
!> Nagtegaal, Parks & Rice (1974), so that the tangent is as symmetric as that of the law. With
!> l = grad du and the weights w = v J/sum v J the rate of J_mean is t = sum w tr l, and
!>   f du = sum V0 (dev tau + p I) : l,     p = w/V0 sum V0 tr tau/2,
!>   df du = sum V0 [lm : c : mm - (dev tau + p I) : l m + p tr l tr m] - (sum V0 p) t(l) t(m),
!> where m is a second l, c m the change of tau, and lm = l - tr l/2 I + t/2 I.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_assembly_patches
   use coulter_assembly_mean_volume, only: average_moduli, unit
   use coulter_base_kinds, only: wp
   use coulter_model, only: model_type
   use coulter_system, only: system_type
   use coulter_system_patches, only: functions_in_patch, most_patch_nodes, patch_functions_type, &
      scatter_patch
   use coulter_system_point_kernel, only: point_response_type, respond
   implicit none(type, external)
   private
   public :: add_patches, displacement_gradient, unit_gradient

   !> Gradients that make the increments of two imaginary nodes a displacement gradient.
   real(wp), parameter :: unit_gradient(2, 4) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, &
                                                         0.0_wp, 0.0_wp, 0.0_wp], [2, 4])

   !> A point of the patch in the current iteration.
   type :: part_type
      integer :: point = 0
      type(patch_functions_type) :: functions
      !> Reference volume; the mean volume change of the patch over that of the point, and the share
      !> of the point in the volume of the patch.
      real(wp) :: volume = 0.0_wp, scale = 1.0_wp, weight = 0.0_wp
      !> Displacement gradient of the step as increments of imaginary nodes.
      real(wp) :: slope(2, 4) = 0.0_wp
      type(point_response_type) :: response
   end type part_type

contains

   !> Internal force and tangent of all patches.
   subroutine add_patches(system, model, failed_point)
      !> System of the step; gets `internal`, `values` and the volume scales.
      type(system_type), intent(inout) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      !> A point that is turned inside out or whose law failed, else 0.
      integer, intent(out) :: failed_point
      type(part_type), allocatable :: part(:)
      integer :: e, n

      failed_point = 0
      associate (start => system%patches%point_start(:system%patches%n + 1))
         allocate (part(maxval(start(2:) - start(:size(start) - 1))))
      end associate
      do e = 1, system%patches%n
         if (.not. system%takes_part(system%patches%cell(e))) cycle
         n = system%patches%point_start(e + 1) - system%patches%point_start(e)
         call add_patch(system, model, e, system%patches%n_nodes(e), part(:n), failed_point)
         if (failed_point > 0) return
      end do
   end subroutine add_patches

   !> Displacement gradient of the step at a point, as increments of two imaginary nodes for
   !> `unit_gradient`, shape (2, 4).
   pure function displacement_gradient(functions, increment) result(slope)
      !> Functions of the point.
      type(patch_functions_type), intent(in) :: functions
      !> Displacement increments of the nodes of its patch, length units.
      real(wp), intent(in) :: increment(:, :)
      real(wp) :: slope(2, 4)
      integer :: k

      slope = 0.0_wp
      do k = 1, functions%n
         associate (moved => increment(:, functions%place(k)))
            slope(:, 1) = slope(:, 1) + moved*functions%gradient(1, k)
            slope(:, 2) = slope(:, 2) + moved*functions%gradient(2, k)
         end associate
      end do
   end function displacement_gradient

   !> Internal force and tangent of one patch.
   subroutine add_patch(system, model, e, n, part, failed_point)
      type(system_type), intent(inout) :: system
      type(model_type), intent(in) :: model
      integer, intent(in) :: e, n
      type(part_type), intent(inout) :: part(:)
      integer, intent(out) :: failed_point
      real(wp) :: force(2, n), stiffness(2, n, 2, n)
      integer :: k

      call deform_parts(system, model, e, part, failed_point)
      if (failed_point > 0) return
      call stress_parts(system, model, part, failed_point)
      if (failed_point > 0) return
      force = 0.0_wp
      stiffness = 0.0_wp
      if (allocated(system%volume_scale)) then
         system%volume_scale(part%point) = part%scale
         call share_pressure(part, n, stiffness)
      end if
      do k = 1, size(part)
         call add_part(part(k)%functions, part(k)%response, part(k)%volume, force, stiffness)
      end do
      associate (node => system%patches%node(:n, e))
         system%internal(:, node) = system%internal(:, node) + force
      end associate
      if (.not. system%needs_tangent) return
      call scatter_patch(system%patches, e, n, stiffness, system%pattern, &
                         system%cells%n_cells + e, system%values)
   end subroutine add_patch

   !> Functions and displacement gradients of the points of a patch, and how they share their volume
   !> change.
   pure subroutine deform_parts(system, model, e, part, failed_point)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      type(part_type), intent(inout) :: part(:)
      integer, intent(out) :: failed_point
      real(wp) :: before(size(part)), after(size(part)), increment(2, system%patches%n_nodes(e))
      integer :: k

      increment = system%increment(:, system%patches%node(:size(increment, 2), e))
      do k = 1, size(part)
         part(k)%point = system%patches%point(system%patches%point_start(e) + k - 1)
         associate (p => part(k)%point, slope => part(k)%slope)
            call functions_in_patch(system%patches, model%grid, e, model%points%position(:, p), p, &
                                    part(k)%functions)
            slope = displacement_gradient(part(k)%functions, increment)
            part(k)%volume = model%points%reference_volume(p)
            before(k) = part(k)%volume*model%points%volume_ratio(p)
            after(k) = before(k)*((1.0_wp + slope(1, 1))*(1.0_wp + slope(2, 2)) &
                                  - slope(1, 2)*slope(2, 1))
         end associate
      end do
      failed_point = 0
      if (.not. allocated(system%volume_scale)) return
      k = minloc(after/before, dim=1)
      if (.not. after(k) > 0.0_wp) then
         failed_point = part(k)%point
         return
      end if
      part%weight = after/sum(after)
      part%scale = sum(after)/sum(before)*before/after
   end subroutine deform_parts

   !> Stress and moduli of the points of a patch.
   subroutine stress_parts(system, model, part, failed_point)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      type(part_type), intent(inout) :: part(:)
      integer, intent(out) :: failed_point
      real(wp) :: stretch
      integer :: k

      do k = 1, size(part)
         associate (p => part(k)%point, &
                    item => model%laws(model%bodies(model%points%body(part(k)%point))%law))
            stretch = sqrt(part(k)%scale)
            call respond(item%law, system%visit(p), unit_gradient, &
                         stretch*part(k)%slope + (stretch - 1.0_wp)*unit_gradient, &
                         model%points%converged%elastic_finger(:, p), &
                         model%points%converged%law_state(:, p), part(k)%response)
            failed_point = p
            if (part(k)%response%has_failed) return
            ! gradients are those of the deformation itself
            part(k)%response%inverse = stretch*part(k)%response%inverse
         end associate
      end do
      failed_point = 0
   end subroutine stress_parts

   !> Replace stress and moduli of every point by those that the shared volume change makes of them,
   !> and add what couples the points of the patch.
   pure subroutine share_pressure(part, n, stiffness)
      type(part_type), intent(inout) :: part(:)
      integer, intent(in) :: n
      real(wp), intent(inout) :: stiffness(2, n, 2, n)
      real(wp) :: mean_slope(2, n), left(2, n), right(2, n), column(4), row(4)
      real(wp) :: pressure_force, bulk, total
      integer :: k, i, a

      pressure_force = 0.0_wp
      do k = 1, size(part)
         pressure_force = pressure_force &
            + part(k)%volume*0.5_wp*sum(part(k)%response%stress(:2))
      end do
      mean_slope = 0.0_wp
      left = 0.0_wp
      right = 0.0_wp
      total = -pressure_force
      do k = 1, size(part)
         call average_moduli(part(k)%response, pressure_force*part(k)%weight/part(k)%volume, &
                             column, row, bulk)
         total = total + part(k)%volume*bulk
         call add_slopes(part(k), part(k)%weight*unit, mean_slope)
         call add_slopes(part(k), part(k)%volume*column, left)
         call add_slopes(part(k), part(k)%volume*row, right)
      end do
      right = right + total*mean_slope
      do a = 1, n
         do i = 1, 2
            stiffness(:, :, i, a) = stiffness(:, :, i, a) + left*mean_slope(i, a) &
               + mean_slope*right(i, a)
         end do
      end do
   end subroutine share_pressure

   !> Contract a tensor with the gradients at the end of the step, node by node.
   pure subroutine add_slopes(part, tensor, nodal)
      type(part_type), intent(in) :: part
      real(wp), intent(in) :: tensor(2, 2)
      real(wp), intent(inout) :: nodal(:, :)
      real(wp) :: pulled(2, 2)
      integer :: k

      pulled = matmul(tensor, transpose(part%response%inverse))
      do k = 1, part%functions%n
         associate (place => part%functions%place(k))
            nodal(:, place) = nodal(:, place) + matmul(pulled, part%functions%gradient(:, k))
         end associate
      end do
   end subroutine add_slopes

   !> Add force and tangent of a point; see `add_force` and `add_stiffness` of the point kernel.
   pure subroutine add_part(functions, response, volume, force, stiffness)
      type(patch_functions_type), intent(in) :: functions
      type(point_response_type), intent(in) :: response
      real(wp), intent(in) :: volume
      real(wp), intent(inout) :: force(:, :), stiffness(:, :, :, :)
      real(wp) :: gradient(2, most_patch_nodes), half(2, 2)
      integer :: n, a, b, k

      n = functions%n
      gradient(:, :n) = matmul(transpose(response%inverse), functions%gradient(:, :n))
      associate (place => functions%place, stress => response%stress, moduli => response%moduli)
         do b = 1, n
            force(:, place(b)) = force(:, place(b)) &
               + volume*(stress([1, 4])*gradient(1, b) + stress([4, 2])*gradient(2, b))
            do k = 1, 2
               half = volume*(moduli(:, :, k, 1)*gradient(1, b) + moduli(:, :, k, 2)*gradient(2, b))
               do a = 1, n
                  stiffness(:, place(a), k, place(b)) = stiffness(:, place(a), k, place(b)) &
                     + half(:, 1)*gradient(1, a) + half(:, 2)*gradient(2, a)
               end do
            end do
         end do
      end associate
   end subroutine add_part

end module coulter_assembly_patches
