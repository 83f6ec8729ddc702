!> Skew part of sparse matrices: of tangents, what Nitsche's tractions and friction add.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_skew
   use coulter_algebra_sparse, only: pattern_type
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: skew_type, find_skew_part, multiply_skew

   !> Skew matrix by its entries above the diagonal.
   type :: skew_type
      !> Their rows and columns from 1, and their values, shape (n_entries).
      integer, allocatable :: row(:), column(:)
      real(wp), allocatable :: value(:)
   end type skew_type

   !> Entries that differ from their mirror images by less than this, over the root of the product
   !> of the diagonal entries beside them, do so by round-off.
   real(wp), parameter :: round_off = 1.0e-15_wp

contains

   !> (A - A^T)/2.
   pure subroutine find_skew_part(skew, pattern, mirror, values)
      !> Skew part to find.
      type(skew_type), intent(out) :: skew
      !> Pattern of A, structurally symmetric, rows ascending in every column.
      type(pattern_type), intent(in) :: pattern
      !> Mirrored place of every entry, from 1, shape (n_entries).
      integer, intent(in) :: mirror(:)
      !> Values of A, shape (n_entries).
      real(wp), intent(in) :: values(:)
      integer :: column, row, first, last, k, n
      real(wp) :: root(pattern%n), gap

      allocate (skew%row(pattern%n_entries), skew%column(pattern%n_entries), &
                skew%value(pattern%n_entries))
      root = 0.0_wp
      n = 0
      do column = 1, pattern%n
         first = pattern%column_start(column) + 1
         last = pattern%column_start(column + 1)
         k = first - 1 + findloc(pattern%row(first:last) + 1, column, dim=1)
         if (k >= first) root(column) = sqrt(round_off*abs(values(k)))
         do k = first, last
            row = pattern%row(k) + 1
            if (row >= column) exit
            gap = 0.5_wp*(values(k) - values(mirror(k)))
            if (abs(gap) <= root(row)*root(column)) cycle
            n = n + 1
            skew%row(n) = row
            skew%column(n) = column
            skew%value(n) = gap
         end do
      end do
      skew%row = skew%row(:n)
      skew%column = skew%column(:n)
      skew%value = skew%value(:n)
   end subroutine find_skew_part

   !> Skew matrix times vector.
   pure subroutine multiply_skew(skew, x, y)
      !> The matrix.
      type(skew_type), intent(in) :: skew
      !> Vector, shape (n).
      real(wp), intent(in) :: x(:)
      !> Product, shape (n).
      real(wp), intent(out) :: y(:)
      integer :: k

      y = 0.0_wp
      do k = 1, size(skew%value)
         associate (row => skew%row(k), column => skew%column(k))
            y(row) = y(row) + skew%value(k)*x(column)
            y(column) = y(column) - skew%value(k)*x(row)
         end associate
      end do
   end subroutine multiply_skew

end module coulter_algebra_skew
