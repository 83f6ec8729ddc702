!> The program: a deck in, results out.
! SPDX-License-Identifier: BSD-3-Clause
program main
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use coulter_base_error, only: error_type, fatal_error
   use coulter_base_faults, only: fault_list_type
   use coulter_base_process, only: blas_name, tune_process
   use coulter_base_terminal, only: is_terminal, stdout_descriptor
   use coulter_command_line, only: command_type, read_command, task_check, task_deck_reference, &
      task_help, task_point, task_version, write_usage
   use coulter_deck, only: deck_type, describe_faults, read_deck, read_test_plan, &
      write_deck_reference
   use coulter_model, only: model_type
   use coulter_model_observer, only: scene_report_type
   use coulter_model_observer_list, only: observer_list_type
   use coulter_model_output, only: output_type
   use coulter_model_prepare, only: prepare_model
   use coulter_point_tests, only: check_user_laws, run_plan
   use coulter_results, only: new_results, provenance_type, results_type
   use coulter_results_hdf5_io, only: forgo_cleanup
   use coulter_results_log_scene, only: write_scene
   use coulter_results_run_log, only: new_run_log, run_log_type
   use coulter_results_tool_table, only: new_tool_table, tool_table_type
   use coulter_sample, only: test_plan_type
   use coulter_step_run, only: describe_scene, run_model
   use coulter_version, only: build_type, compiler, compiler_flags, git_revision, version
   implicit none(type, external)
   type(command_type) :: command

   call tune_process()
   call forgo_cleanup()
   call read_command_line()
   select case (command%task)
   case (task_help)
      call write_usage(output_unit)
   case (task_version)
      write (output_unit, "(a)") "coulter "//version//" ("//git_revision//")", &
         compiler//", "//build_type//", "//blas_name(), compiler_flags
   case (task_deck_reference)
      call write_deck_reference(output_unit)
   case (task_point)
      call test_samples()
   case default
      call compute()
   end select

contains

   !> Parse the command line.
   subroutine read_command_line()
      type(error_type), allocatable :: error

      call read_command(command, error)
      call stop_on(error, 2, "coulter: ")
   end subroutine read_command_line

   !> Read the deck, make the model, and run it or report on it.
   subroutine compute()
      type(model_type) :: model
      type(output_type) :: output
      type(deck_type) :: deck
      type(fault_list_type) :: faults
      type(error_type), allocatable :: error

      call read_deck(command%deck_path, deck, model, output, error)
      if (.not. allocated(error)) then
         call prepare_model(model, faults)
         if (faults%n_faults > 0) call fatal_error(error, describe_faults(deck, faults))
      end if
      ! no prefix: editors jump to file:line
      call stop_on(error, 2, "")
      if (command%task == task_check) then
         call report_scene(model)
      else
         model%schedule%most_steps = command%most_steps
         call run(model, output, deck)
      end if
   end subroutine compute

   !> Run the tests on samples.
   subroutine test_samples()
      type(test_plan_type) :: plan
      type(error_type), allocatable :: error

      call read_test_plan(command%deck_path, plan, error)
      call stop_on(error, 2, "")
      call run_plan(plan, command%directory, output_unit, command%is_quiet, error)
      call stop_on(error, 1, "coulter: ")
   end subroutine test_samples

   !> Print facts about the scene.
   subroutine report_scene(model)
      type(model_type), intent(in) :: model
      type(scene_report_type) :: scene
      type(error_type), allocatable :: error

      call describe_scene(model, scene, error)
      call stop_on(error, 1, "coulter: ")
      if (command%is_quiet) return
      call write_scene(output_unit, model, scene)
      call check_user_laws(model, output_unit)
   end subroutine report_scene

   !> Run the model; results and log watch it.
   subroutine run(model, output, deck)
      type(model_type), intent(inout) :: model
      type(output_type), intent(in) :: output
      type(deck_type), intent(in) :: deck
      type(observer_list_type) :: observers
      type(results_type) :: results
      type(tool_table_type) :: table
      type(run_log_type) :: log
      type(error_type), allocatable :: error

      call new_results(results, command%directory, output, deck%path, deck%text, provenance(), &
                       error)
      call stop_on(error, 2, "coulter: ")
      call observers%add(results)
      call new_tool_table(table, command%directory, output%name)
      call observers%add(table)
      if (.not. command%is_quiet) then
         call new_run_log(log, output_unit, is_terminal(stdout_descriptor))
         call observers%add(log)
      end if
      call run_model(model, observers, error)
      call stop_on(error, 1, "coulter: ")
      if (.not. command%is_quiet) write (output_unit, "(a)") "  results in "//results%path()
   end subroutine run

   !> Which program this is.
   function provenance() result(facts)
      type(provenance_type) :: facts

      facts%version = version
      facts%revision = git_revision
      facts%compiler = compiler
      facts%flags = compiler_flags
      facts%build_type = build_type
   end function provenance

   !> End the program with a message if there is an error.
   subroutine stop_on(error, status, prefix)
      type(error_type), allocatable, intent(in) :: error
      integer, intent(in) :: status
      character(len=*), intent(in) :: prefix

      if (.not. allocated(error)) return
      flush (output_unit)
      write (error_unit, "(a)") prefix//error%message
      stop status, quiet=.true.
   end subroutine stop_on

end program main
