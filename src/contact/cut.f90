!> Cuts ahead of sharp corners of tools that part what is before them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_contact_cut
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: open_tip_type, cut_type

   !> A corner of a tool that parts material.
   type :: open_tip_type
      !> Number of the tool, and of its vertex.
      integer :: boundary = 0, vertex = 0
      !> Do both of its faces press what it parts?
      logical :: goes_in = .false.
   end type open_tip_type

   !> Such a corner, and the root of the cut before it.
   type, extends(open_tip_type) :: cut_type
      !> Where the vertex is now, length units.
      real(wp) :: tip(2) = 0.0_wp
      !> Where the root must be now for the vertex to reach it at the end of the next step.
      real(wp) :: place(2) = 0.0_wp
      !> Corner of the tiling that is the root, 0 if there is none near.
      integer :: corner = 0
      !> Motion of the root in the last step that found equilibrium, also in one that was refused,
      !> and way of the vertex meanwhile, length units; 0 if nothing is known.
      real(wp) :: motion(2) = 0.0_wp, way = 0.0_wp
   end type cut_type

end module coulter_contact_cut
