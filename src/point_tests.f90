!> Tests of single points: those of a plan, with a table for every sample, and the check of the user
!> materials of a scene.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_point_tests
   use coulter_base_directory, only: make_directory
   use coulter_base_error, only: error_type
   use coulter_base_kinds, only: wp
   use coulter_base_text, only: to_text
   use coulter_model, only: model_type
   use coulter_sample, only: stage_type, test_plan_type
   use coulter_sample_law_check, only: check_law, good_rest, good_tangent, law_check_type
   use coulter_sample_record, only: record_type, write_record
   use coulter_sample_run, only: run_sample
   use coulter_sample_state, only: sample_state_type
   implicit none(type, external)
   private
   public :: run_plan, check_user_laws

contains

   !> Run the tests of all samples. One that fails does not keep the others from theirs.
   subroutine run_plan(plan, directory, unit, is_quiet, error)
      !> Laws, samples and stages.
      type(test_plan_type), intent(in) :: plan
      !> Directory of the tables; made if need be.
      character(len=*), intent(in) :: directory
      !> Unit of the log.
      integer, intent(in) :: unit
      !> Is there no log?
      logical, intent(in) :: is_quiet
      !> Set when a test fails or a table cannot be written: the first of these errors.
      type(error_type), allocatable, intent(out) :: error
      type(error_type), allocatable :: failure, fault
      type(record_type) :: record
      character(len=:), allocatable :: path
      integer :: i

      call make_directory(directory, error)
      if (allocated(error)) return
      do i = 1, size(plan%samples)
         associate (sample => plan%samples(i))
            call run_sample(sample, plan%laws(sample%law)%law, &
                            stages_of(plan, i), record, failure)
            path = directory//"/"//plan%name//"_"//sample%name//".csv"
            call write_record(record, path, fault)
            if (.not. is_quiet) write (unit, "(a)") &
               "  "//sample%name//": "//to_text(record%n_rows - 1)//" increments, " &
               //to_text(mean_iterations(record), 2)//" iterations each, in "//path
         end associate
         if (allocated(failure) .and. .not. allocated(error)) call move_alloc(failure, error)
         if (allocated(fault) .and. .not. allocated(error)) call move_alloc(fault, error)
      end do
   end subroutine run_plan

   !> Stages of a sample in order.
   pure function stages_of(plan, sample) result(stages)
      type(test_plan_type), intent(in) :: plan
      integer, intent(in) :: sample
      type(stage_type), allocatable :: stages(:)

      stages = pack(plan%stages, plan%stages%sample == sample)
   end function stages_of

   !> Newton corrections per increment.
   pure function mean_iterations(record) result(mean)
      type(record_type), intent(in) :: record
      real(wp) :: mean
      integer :: column

      column = findloc(record%names, "iterations", dim=1)
      mean = sum(record%values(column, :record%n_rows))/real(max(record%n_rows - 1, 1), wp)
   end function mean_iterations

   !> Check the user materials of a scene, each at the first point of its own.
   subroutine check_user_laws(model, unit)
      !> Prepared scene.
      type(model_type), intent(in) :: model
      !> Unit of the log.
      integer, intent(in) :: unit
      type(sample_state_type) :: state
      type(law_check_type) :: check
      integer :: i, p

      do i = 1, size(model%laws)
         associate (law => model%laws(i)%law, points => model%points)
            p = findloc(model%bodies(points%body)%law, i, dim=1)
            if (p == 0 .or. .not. law%is_incremental) cycle
            state%finger = points%converged%elastic_finger(:, p)
            state%stress = points%converged%kirchhoff_stress(:, p)
            state%law_state = points%converged%law_state(:law%n_state, p)
            call check_law(law, state, model%schedule%end_time(1), check)
            write (unit, "(a)") "", "user material of law "//law%name//", at one point"
            call write_check(unit, check)
         end associate
      end do
   end subroutine check_user_laws

   !> What a check found, in words.
   subroutine write_check(unit, check)
      integer, intent(in) :: unit
      type(law_check_type), intent(in) :: check
      character(len=:), allocatable :: verdict

      if (allocated(check%failure)) then
         write (unit, "(a)") "  fails at a small strain: "//check%failure
         return
      end if
      if (check%stress_change <= good_rest) then
         write (unit, "(a)") "  zero strain leaves the stress as it is"
      else
         write (unit, "(a)") "  WRONG: zero strain changes the stress by " &
            //to_text(check%stress_change, 2)//" of its stiffness"
      end if
      verdict = "  "
      if (check%tangent_error > good_tangent) verdict = "  WRONG: "
      write (unit, "(a)") verdict//"its tangent (DDSDDE) differs from differences of the" &
         //" stress by "//to_text(check%tangent_error, 2)//" of its largest entry"
   end subroutine write_check

end module coulter_point_tests
