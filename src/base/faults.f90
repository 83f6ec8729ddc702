!> A growing list of faults found in a scene, so that all of them can be reported in one go.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_base_faults
   implicit none(type, external)
   private
   public :: fault_type, fault_list_type

   !> One fault, located by the names that the user of a scene knows.
   type :: fault_type
      !> Kind of object, named as its deck group: "grid", "body", "boundary", ...
      character(len=:), allocatable :: group
      !> Number of the object among its kind, from 1; 0 when the fault concerns all of them.
      integer :: instance = 0
      !> Property at fault, named as its deck variable; empty when it is the whole object.
      character(len=:), allocatable :: variable
      !> What is wrong and what would be allowed.
      character(len=:), allocatable :: message
   end type fault_type

   !> All faults found so far, in the order in which they were found.
   type :: fault_list_type
      !> Number of faults.
      integer :: n_faults = 0
      !> The faults; only the first `n_faults` are meaningful.
      type(fault_type), allocatable :: items(:)
   contains
      procedure :: add => add_fault
   end type fault_list_type

contains

   !> Append one fault.
   pure subroutine add_fault(self, group, instance, variable, message)
      class(fault_list_type), intent(inout) :: self
      !> Kind of object, see `fault_type`.
      character(len=*), intent(in) :: group
      !> Number of the object among its kind, or 0.
      integer, intent(in) :: instance
      !> Property at fault, or an empty text.
      character(len=*), intent(in) :: variable
      !> What is wrong and what would be allowed.
      character(len=*), intent(in) :: message
      type(fault_type), allocatable :: grown(:)
      integer :: i

      if (.not. allocated(self%items)) allocate (self%items(8))
      if (self%n_faults == size(self%items)) then
         allocate (grown(2*self%n_faults))
         do i = 1, self%n_faults
            grown(i) = self%items(i)
         end do
         call move_alloc(grown, self%items)
      end if
      self%n_faults = self%n_faults + 1
      associate (fault => self%items(self%n_faults))
         fault%group = group
         fault%instance = instance
         fault%variable = variable
         fault%message = message
      end associate
   end subroutine add_fault

end module coulter_base_faults
