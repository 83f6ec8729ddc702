!> Unknowns that go in pairs, such as both components of a node: what holds for one holds for both.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_pairs
   implicit none(type, external)
   private
   public :: find_pairs

   !> Marks of unknowns that no element has, and of those without a partner.
   integer, parameter :: unseen = -2, alone = -1

contains

   !> Find the pairs of unknowns d, d + 1 that stand side by side wherever one of them stands, and
   !> the elements that consist of them.
   subroutine find_pairs(n, start, dof, is_first, is_paired)
      !> Number of unknowns.
      integer, intent(in) :: n
      !> First entry of every element in `dof`, shape (n_elements + 1).
      integer, intent(in) :: start(:)
      !> Unknowns of all elements, 0 for none.
      integer, intent(in) :: dof(:)
      !> Is an unknown the first of a pair, shape (n)?
      logical, intent(out) :: is_first(:)
      !> Does an element consist of such pairs, and of pairs of none, shape (n_elements)?
      logical, intent(out) :: is_paired(:)
      integer :: partner(0:n), e, k, last

      partner = unseen
      do e = 1, size(start) - 1
         last = start(e + 1) - 1
         do k = start(e), last - 1, 2
            call meet(dof(k), dof(k + 1))
            call meet(dof(k + 1), dof(k))
         end do
         if (mod(last - start(e), 2) == 0) call meet(dof(last), alone)
      end do
      do k = 1, n - 1
         is_first(k) = partner(k) == k + 1 .and. partner(k + 1) == k
      end do
      if (n > 0) is_first(n) = .false.
      do e = 1, size(start) - 1
         is_paired(e) = mod(start(e + 1) - start(e), 2) == 0
         do k = start(e), start(e + 1) - 2, 2
            if (.not. is_paired(e)) exit
            is_paired(e) = dof(k) + dof(k + 1) == 0
            if (dof(k) > 0) is_paired(e) = is_first(dof(k)) .and. dof(k + 1) == dof(k) + 1
         end do
      end do

   contains

      !> Let an unknown have a partner, unless it has another one.
      subroutine meet(one, other)
         integer, intent(in) :: one, other

         if (partner(one) == unseen) then
            partner(one) = other
         else if (partner(one) /= other) then
            partner(one) = alone
         end if
      end subroutine meet

   end subroutine find_pairs

end module coulter_algebra_pairs
