!> Public face of the deck room: a text file in, a model and output settings out.
!>
!> A deck is cut into groups and assignments that know their lines (scan), the names are checked
!> against the schema (names), and each group is read by the file named after its subject, which
!> has the compiler read one assignment at a time (values). Faults are gathered on the way and
!> reported together.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_deck
   use coulter_base_error, only: error_type, fatal_error
   use coulter_deck_bodies, only: read_bodies
   use coulter_deck_boundaries, only: read_boundaries
   use coulter_deck_contacts, only: read_contacts
   use coulter_deck_document, only: deck_type, describe_faults, first_group
   use coulter_deck_file, only: read_text
   use coulter_deck_fixities, only: read_fixities
   use coulter_deck_laws, only: read_laws
   use coulter_deck_loads, only: read_body_force, read_edge_loads, read_tables
   use coulter_deck_motions, only: read_motions
   use coulter_deck_names, only: check_names
   use coulter_deck_reference, only: write_deck_reference
   use coulter_deck_samples, only: read_samples, read_stages
   use coulter_deck_scan, only: scan_deck
   use coulter_deck_schedule, only: read_schedule
   use coulter_deck_settings, only: base_name, read_control, read_grid, read_output, read_scene
   use coulter_deck_tools, only: read_tools
   use coulter_model, only: model_type
   use coulter_model_output, only: output_type
   use coulter_sample, only: test_plan_type
   implicit none(type, external)
   private
   public :: deck_type, read_deck, parse_deck, describe_faults, write_deck_reference
   public :: read_test_plan

contains

   !> Read a deck file; see `parse_deck`.
   subroutine read_deck(path, deck, model, output, error)
      !> Path of the file.
      character(len=*), intent(in) :: path
      !> The deck, to describe faults that the model turns out to have.
      type(deck_type), intent(out) :: deck
      !> The scene, without points.
      type(model_type), intent(out) :: model
      !> When results are written, and how.
      type(output_type), intent(out) :: output
      !> Set when the file cannot be read or the deck has faults: one line for each.
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: text

      call read_text(path, text, error)
      if (allocated(error)) return
      call parse_deck(path, text, deck, model, output, error)
   end subroutine read_deck

   !> Make a scene from the text of a deck.
   subroutine parse_deck(path, text, deck, model, output, error)
      !> Path that messages show, and that names the results.
      character(len=*), intent(in) :: path
      !> Text of the deck.
      character(len=*), intent(in) :: text
      !> The deck, to describe faults that the model turns out to have.
      type(deck_type), intent(out) :: deck
      !> The scene, without points.
      type(model_type), intent(out) :: model
      !> When results are written, and how.
      type(output_type), intent(out) :: output
      !> Set when the deck has faults: one line for each.
      type(error_type), allocatable, intent(out) :: error

      deck%path = path
      deck%text = text
      call scan_deck(deck)
      if (size(deck%groups) == 0 .and. deck%faults%n_faults == 0) then
         call fatal_error(error, path//": holds no groups")
         return
      else if (first_group(deck, "sample") > 0 .and. first_group(deck, "grid") == 0) then
         call fatal_error(error, path//": holds samples and no scene; run it with `coulter point`")
         return
      end if
      call check_names(deck)

      call read_scene(deck, model)
      call read_grid(deck, model%grid)
      call read_control(deck, model%control)
      call read_laws(deck, model%laws)
      call read_bodies(deck, model%control%domains, model%bodies)
      call read_contacts(deck, model%body_contacts)
      call read_schedule(deck, model%schedule)
      call read_tables(deck, model%tables)
      call read_body_force(deck, model%body_force)
      call read_edge_loads(deck, model%control%domains, model%edge_loads)
      call read_fixities(deck, model%grid, model%fixities)
      call read_boundaries(deck, model%schedule, model%control%domains, model%boundaries)
      call read_tools(deck, model%schedule, model%control%domains, model%boundaries)
      call read_motions(deck, model%schedule, model%boundaries)
      call read_output(deck, size(model%schedule%end_time), output)

      if (deck%faults%n_faults > 0) call fatal_error(error, describe_faults(deck, deck%faults))
   end subroutine parse_deck

   !> Read the tests on samples that a deck file holds; the scene that may stand beside them is left
   !> alone.
   subroutine read_test_plan(path, plan, error)
      !> Path of the file.
      character(len=*), intent(in) :: path
      !> Laws, samples and stages.
      type(test_plan_type), intent(out) :: plan
      !> Set when the file cannot be read or the deck has faults: one line for each.
      type(error_type), allocatable, intent(out) :: error
      type(deck_type) :: deck
      character(len=*), parameter :: needed(*) = [character(len=6) :: "law", "sample", "stage"]

      call read_text(path, deck%text, error)
      if (allocated(error)) return
      deck%path = path
      call scan_deck(deck)
      call check_names(deck, needed)
      plan%name = base_name(path)
      call read_laws(deck, plan%laws)
      call read_samples(deck, plan%samples)
      call read_stages(deck, plan%stages)
      if (deck%faults%n_faults > 0) call fatal_error(error, describe_faults(deck, deck%faults))
   end subroutine read_test_plan

end module coulter_deck
