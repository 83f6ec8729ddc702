!> Pure algebra of symmetric tensors in the plane: logarithm and exponential with derivatives.
!>
!> Tensors are stored as xx, yy, zz, xy; zz is a principal direction of its own.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_tensor
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: log_strain_plane, log_strain_tangent_plane, finger_of_log_strain_plane, inverse_2d
   public :: equivalent_stress

contains

   !> Logarithmic strain 1/2 ln b of a left Cauchy-Green tensor b.
   pure subroutine log_strain_plane(finger, strain)
      !> Left Cauchy-Green tensor b: xx, yy, zz, xy; positive definite.
      real(wp), intent(in) :: finger(4)
      !> Logarithmic strain: xx, yy, zz and engineering shear 2 xy.
      real(wp), intent(out) :: strain(4)
      real(wp) :: mean, radius, logarithm_mean, slope

      call split_in_plane(finger, mean, radius)
      logarithm_mean = 0.25_wp*log((mean - radius)*(mean + radius))
      slope = 0.5_wp*logarithm_slope(mean, radius)
      strain(1) = logarithm_mean + slope*0.5_wp*(finger(1) - finger(2))
      strain(2) = logarithm_mean - slope*0.5_wp*(finger(1) - finger(2))
      strain(3) = 0.5_wp*log(finger(3))
      strain(4) = slope*2.0_wp*finger(4)
   end subroutine log_strain_plane

   !> Derivative of the in-plane logarithmic strain by the in-plane left Cauchy-Green tensor.
   !> In the eigenbasis it is 1/(2 a) on the diagonal and (ln a - ln b)/(2 (a - b)) off it
   !> (theory, section 1).
   pure subroutine log_strain_tangent_plane(finger, tangent)
      !> Left Cauchy-Green tensor: xx, yy, zz, xy; positive definite.
      real(wp), intent(in) :: finger(4)
      !> Rows: strain xx, yy, 2 xy; columns: change of finger xx, yy, xy (as a symmetric tensor,
      !> so that the last column stands for xy and yx together).
      real(wp), intent(out) :: tangent(3, 3)
      real(wp) :: mean, radius, cosine, sine, slope, major, minor, average, spread

      call split_in_plane(finger, mean, radius)
      if (radius > epsilon(radius)*mean) then
         cosine = 0.5_wp*(finger(1) - finger(2))/radius
         sine = finger(4)/radius
      else
         cosine = 1.0_wp
         sine = 0.0_wp
      end if
      major = 0.25_wp/(mean + radius)
      minor = 0.25_wp/(mean - radius)
      average = major + minor
      spread = major - minor
      slope = 0.5_wp*logarithm_slope(mean, radius)
      ! mean and deviator of the strain change with mean, dev = (xx - yy)/2 and xy of the finger
      associate (along => average*cosine**2 + slope*sine**2, &
                 across => average*sine**2 + slope*cosine**2, &
                 mixed => (average - slope)*cosine*sine)
         tangent(1, 1) = 0.5_wp*(average + along) + spread*cosine
         tangent(1, 2) = 0.5_wp*(average - along)
         tangent(1, 3) = spread*sine + mixed
         tangent(2, 1) = tangent(1, 2)
         tangent(2, 2) = 0.5_wp*(average + along) - spread*cosine
         tangent(2, 3) = spread*sine - mixed
         tangent(3, 1) = spread*sine + mixed
         tangent(3, 2) = spread*sine - mixed
         tangent(3, 3) = 2.0_wp*across
      end associate
   end subroutine log_strain_tangent_plane

   !> Left Cauchy-Green tensor exp(2 eps) of a logarithmic strain.
   pure subroutine finger_of_log_strain_plane(strain, finger)
      !> Logarithmic strain: xx, yy, zz and engineering shear 2 xy.
      real(wp), intent(in) :: strain(4)
      !> Left Cauchy-Green tensor: xx, yy, zz, xy.
      real(wp), intent(out) :: finger(4)
      real(wp) :: scale, deviator, radius, ratio

      scale = exp(strain(1) + strain(2))
      deviator = strain(1) - strain(2)
      radius = sqrt(deviator**2 + strain(4)**2)
      ratio = 1.0_wp + radius**2/6.0_wp
      if (radius > 1.0e-4_wp) ratio = sinh(radius)/radius
      finger(1) = scale*(cosh(radius) + ratio*deviator)
      finger(2) = scale*(cosh(radius) - ratio*deviator)
      finger(3) = exp(2.0_wp*strain(3))
      finger(4) = scale*ratio*strain(4)
   end subroutine finger_of_log_strain_plane

   !> Inverse of a 2 x 2 matrix of known, non-zero determinant.
   pure function inverse_2d(matrix, determinant) result(inverse)
      !> Matrix to invert.
      real(wp), intent(in) :: matrix(2, 2)
      !> Its determinant.
      real(wp), intent(in) :: determinant
      real(wp) :: inverse(2, 2)

      inverse(1, 1) = matrix(2, 2)/determinant
      inverse(2, 1) = -matrix(2, 1)/determinant
      inverse(1, 2) = -matrix(1, 2)/determinant
      inverse(2, 2) = matrix(1, 1)/determinant
   end function inverse_2d

   !> Mean of the in-plane eigenvalues and half their difference.
   pure subroutine split_in_plane(finger, mean, radius)
      real(wp), intent(in) :: finger(4)
      real(wp), intent(out) :: mean, radius

      mean = 0.5_wp*(finger(1) + finger(2))
      radius = sqrt((0.5_wp*(finger(1) - finger(2)))**2 + finger(4)**2)
   end subroutine split_in_plane

   !> (ln a - ln b)/(a - b) for a = mean + radius, b = mean - radius; 1/mean in the limit.
   pure function logarithm_slope(mean, radius) result(slope)
      real(wp), intent(in) :: mean, radius
      real(wp) :: slope
      real(wp) :: ratio

      ratio = radius/mean
      if (ratio > 1.0e-3_wp) then
         slope = atanh(ratio)/radius
      else
         slope = (1.0_wp + ratio**2*(1.0_wp/3.0_wp + ratio**2*(0.2_wp + ratio**2/7.0_wp)))/mean
      end if
   end function logarithm_slope

   !> Von Mises' equivalent stress: sqrt(3/2) times the norm of the deviator.
   pure function equivalent_stress(stress) result(equivalent)
      !> Stress xx, yy, zz, xy.
      real(wp), intent(in) :: stress(4)
      real(wp) :: equivalent
      real(wp) :: deviator(3)

      deviator = stress(:3) - sum(stress(:3))/3.0_wp
      equivalent = sqrt(1.5_wp*(sum(deviator**2) + 2.0_wp*stress(4)**2))
   end function equivalent_stress

end module coulter_base_tensor
