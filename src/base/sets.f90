!> Disjoint sets of members that are numbered from 1: union and find.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_sets
   implicit none(type, external)
   private
   public :: join_sets, root_of

contains

   !> Make one of the sets of two members.
   pure subroutine join_sets(parent, first, second)
      !> A member nearer to the root of its set for every member, itself at the root.
      integer, intent(inout) :: parent(:)
      !> Two members.
      integer, intent(in) :: first, second
      integer :: a, b

      a = root_of(parent, first)
      b = root_of(parent, second)
      parent(max(a, b)) = min(a, b)
      parent(first) = min(a, b)
      parent(second) = min(a, b)
   end subroutine join_sets

   !> The member that stands for the set of a member.
   pure function root_of(parent, member) result(root)
      !> See `join_sets`.
      integer, intent(in) :: parent(:), member
      integer :: root

      root = member
      do while (parent(root) /= root)
         root = parent(root)
      end do
   end function root_of

end module coulter_base_sets
