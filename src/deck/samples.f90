!> Reads samples and the stages of their tests.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck_samples
   use coulter_base_kinds, only: wp
   use coulter_deck_document, only: blame, deck_type, find_groups
   use coulter_deck_references, only: check_unique_names, get_reference
   use coulter_deck_values, only: demand, demand_one, get_choice, get_list, get_value, is_given, &
      refuse
   use coulter_sample, only: sample_type, stage_type
   implicit none(type, external)
   private
   public :: read_samples, read_stages

   !> Tests, by their places among the choices of the schema.
   integer, parameter :: oedometer = 1, triaxial = 2, undrained = 3, biaxial = 4, shear = 5, &
      free = 6
   !> Components.
   integer, parameter :: xx = 1, yy = 2, zz = 3, xy = 4

contains

   !> All samples.
   subroutine read_samples(deck, samples)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Samples in the order of the deck.
      type(sample_type), allocatable, intent(out) :: samples(:)
      integer, allocatable :: groups(:)
      integer :: i

      call check_unique_names(deck, "sample")
      call find_groups(deck, "sample", groups)
      allocate (samples(size(groups)))
      do i = 1, size(groups)
         samples(i)%name = ""
         call get_value(deck, groups(i), "name", samples(i)%name)
         if (scan(samples(i)%name, "/\") > 0) then
            call blame(deck, groups(i), "name", "becomes part of a file name: no / or \ in it")
         end if
         call get_reference(deck, groups(i), "law", samples(i)%law)
         call get_value(deck, groups(i), "initial_stress", samples(i)%initial_stress)
         call get_value(deck, groups(i), "void_ratio", samples(i)%void_ratio)
      end do
   end subroutine read_samples

   !> All stages.
   subroutine read_stages(deck, stages)
      !> Scanned deck, which notes faults.
      type(deck_type), intent(inout) :: deck
      !> Stages in the order of the deck.
      type(stage_type), allocatable, intent(out) :: stages(:)
      integer, allocatable :: groups(:)
      integer :: i, test

      call find_groups(deck, "stage", groups)
      allocate (stages(size(groups)))
      do i = 1, size(groups)
         call get_reference(deck, groups(i), "sample", stages(i)%sample)
         test = 0
         call get_choice(deck, groups(i), "test", test)
         if (test > 0) call read_test(deck, groups(i), test, stages(i))
         call get_value(deck, groups(i), "increments", stages(i)%n_increments)
         call get_value(deck, groups(i), "duration", stages(i)%duration)
      end do
   end subroutine read_stages

   !> What drives the components in a test; what is not named keeps its strain.
   subroutine read_test(deck, group, test, stage)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group, test
      type(stage_type), intent(inout) :: stage

      call refuse_others(deck, group, test)
      select case (test)
      case (triaxial)
         stage%is_round = .true.
         call drive_by(deck, group, "lateral_stress", .true., stage, xx)
         call drive_by(deck, group, "lateral_stress", .true., stage, zz)
      case (biaxial)
         call drive_by(deck, group, "lateral_stress", .true., stage, xx)
      case (shear)
         call drive(deck, group, "shear", stage, xy)
      case (undrained)
         call demand(deck, group, "axial_strain")
         call drive_by(deck, group, "axial_strain", .false., stage, yy)
         stage%target([xx, zz]) = -0.5_wp*stage%target(yy)
         return
      case (free)
         call read_control(deck, group, stage)
         return
      case default
         continue
      end select
      if (test == shear .and. .not. is_given(deck, group, "axial_strain")) then
         call drive_by(deck, group, "axial_stress", .true., stage, yy)
      else
         call drive(deck, group, "axial", stage, yy)
      end if
   end subroutine read_test

   !> A component by strain or stress, whichever is given; one must be.
   subroutine drive(deck, group, prefix, stage, component)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      !> First part of the names of both.
      character(len=*), intent(in) :: prefix
      type(stage_type), intent(inout) :: stage
      integer, intent(in) :: component

      call demand_one(deck, group, prefix//"_strain", prefix//"_stress")
      if (is_given(deck, group, prefix//"_stress")) then
         call drive_by(deck, group, prefix//"_stress", .true., stage, component)
      else
         call drive_by(deck, group, prefix//"_strain", .false., stage, component)
      end if
   end subroutine drive

   !> A component by one variable; a stress that is not given is kept.
   subroutine drive_by(deck, group, variable, is_stress, stage, component)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      character(len=*), intent(in) :: variable
      logical, intent(in) :: is_stress
      type(stage_type), intent(inout) :: stage
      integer, intent(in) :: component

      stage%is_stress(component) = is_stress
      stage%is_kept(component) = is_stress .and. .not. is_given(deck, group, variable)
      call get_value(deck, group, variable, stage%target(component))
   end subroutine drive_by

   !> Components by letters.
   subroutine read_control(deck, group, stage)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group
      type(stage_type), intent(inout) :: stage
      character(len=:), allocatable :: letters
      real(wp), allocatable :: targets(:)
      integer :: i

      call demand(deck, group, "control")
      call demand(deck, group, "target")
      letters = "eeee"
      call get_value(deck, group, "control", letters)
      call get_list(deck, group, "target", targets)
      if (allocated(targets)) stage%target = targets
      if (len(letters) /= 4 .or. verify(letters, "es") > 0) then
         call blame(deck, group, "control", "must be four letters `e` or `s`, such as 'sees'")
         return
      end if
      stage%is_stress = [(letters(i:i) == "s", i=1, 4)]
   end subroutine read_control

   !> Variables that mean nothing in a test.
   subroutine refuse_others(deck, group, test)
      type(deck_type), intent(inout) :: deck
      integer, intent(in) :: group, test

      if (all(test /= [triaxial, biaxial])) then
         call refuse(deck, group, "lateral_stress", "belongs to `triaxial` and `biaxial`")
      end if
      if (test /= shear) then
         call refuse(deck, group, "shear_strain", "belongs to `shear`")
         call refuse(deck, group, "shear_stress", "belongs to `shear`")
      end if
      if (test == undrained) call refuse(deck, group, "axial_stress", &
                                         "`undrained` is driven by axial_strain")
      if (test == free) then
         call refuse(deck, group, "axial_strain", "`free` is driven by control and target")
         call refuse(deck, group, "axial_stress", "`free` is driven by control and target")
      else
         call refuse(deck, group, "control", "belongs to `free`")
         call refuse(deck, group, "target", "belongs to `free`")
      end if
   end subroutine refuse_others

end module coulter_deck_samples
