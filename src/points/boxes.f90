!> Boxes of points: axis-aligned domains that stretch with the material (GIMP).
! SPDX-License-Identifier: BSD-3-Clause
module coulter_points_boxes
   use coulter_base_kinds, only: wp
   use coulter_points, only: points_type
   implicit none(type, external)
   private
   public :: current_boxes

contains

   !> Edges of the boxes of all points, length units, shape (2, n_points).
   !>
   !> A box begins as the box around the domain that was seeded, with the area of that domain, and
   !> its edges stretch by the diagonal of the right stretch tensor U = (F^T F)^(1/2), which does
   !> not see rotations (Coombs & Augarde, AMPLE, 2020). In the plane
   !> U = (F^T F + J I)/(tr F^T F + 2 J)^(1/2).
   pure function current_boxes(points) result(box)
      !> Points at the start of the step.
      type(points_type), intent(in) :: points
      real(wp) :: box(2, points%n_points)
      real(wp) :: square(2), area_ratio
      integer :: p

      do p = 1, points%n_points
         associate (f => points%converged%deformation_gradient(:4, p), &
                    seeded => points%domain_size(:, p))
            square = [f(1)**2 + f(2)**2, f(3)**2 + f(4)**2]
            area_ratio = f(1)*f(4) - f(2)*f(3)
            box(:, p) = seeded*sqrt(points%reference_volume(p)/product(seeded)) &
               *(square + area_ratio)/sqrt(sum(square) + 2.0_wp*area_ratio)
         end associate
      end do
   end function current_boxes

end module coulter_points_boxes
