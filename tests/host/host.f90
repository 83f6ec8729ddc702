!> A program of its own on the library of Coulter: runs a deck and prints what its first boundary
!> feels.
! SPDX-License-Identifier: BSD-3-Clause
program host
   use coulter_base_error, only: error_type
   use coulter_base_faults, only: fault_list_type
   use coulter_deck, only: deck_type, read_deck
   use coulter_model, only: model_type
   use coulter_model_output, only: output_type
   use coulter_model_prepare, only: prepare_model
   use coulter_step_run, only: run_model
   use host_observer, only: printer_type
   implicit none(type, external)
   type(deck_type) :: deck
   type(model_type) :: model
   type(output_type) :: output
   type(printer_type) :: printer
   type(fault_list_type) :: faults
   type(error_type), allocatable :: error
   character(len=1000) :: path

   call get_command_argument(1, path)
   call read_deck(trim(path), deck, model, output, error)
   if (allocated(error)) error stop error%message
   call prepare_model(model, faults)
   if (faults%n_faults > 0) error stop "the scene of the deck has faults"
   call run_model(model, printer, error)
   if (allocated(error)) error stop error%message
end program host
