!> The whole scene as plain values: grid, points, laws, boundaries, loads and control settings.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_model
   use coulter_base_kinds, only: wp
   use coulter_base_table, only: table_type
   use coulter_boundary, only: boundary_type
   use coulter_boundary_edge_load, only: edge_load_type
   use coulter_boundary_motion, only: motion_type
   use coulter_contact_body_contact, only: body_contact_type
   use coulter_grid, only: grid_type
   use coulter_law_abstract, only: law_item_type
   use coulter_model_body_force, only: body_force_type
   use coulter_model_control, only: control_type, no_last_phase, schedule_type
   use coulter_points, only: points_type
   use coulter_points_body, only: body_type
   use coulter_points_tiling, only: tiling_type
   implicit none(type, external)
   private
   public :: model_type, fixity_type, units_type
   public :: load_factor, edge_load_factor, body_force_factor, boundary_motion, point_moduli

   !> Labels for logs and plots; Coulter computes in any consistent units.
   type :: units_type
      !> Label of lengths, such as "mm".
      character(len=:), allocatable :: length
      !> Label of stresses, such as "MPa".
      character(len=:), allocatable :: stress
      !> Label of forces, such as "N"; plane-strain forces are per unit length of thickness.
      character(len=:), allocatable :: force
   end type units_type

   !> Zero displacement at the grid nodes in a box.
   type :: fixity_type
      !> Name under which the reaction is reported.
      character(len=:), allocatable :: name
      !> Lower corner of the box, length units, shape (n_dim).
      real(wp), allocatable :: lower(:)
      !> Upper corner of the box, length units, shape (n_dim).
      real(wp), allocatable :: upper(:)
      !> Which displacement components are held, shape (n_dim).
      logical, allocatable :: is_held(:)
      !> First and last phase in which it holds, and does it hold now?
      integer :: first_phase = 1, last_phase = no_last_phase
      logical :: is_active = .true.
   end type fixity_type

   !> A scene: what is computed, and nothing about files.
   type :: model_type
      !> One line that describes the scene.
      character(len=:), allocatable :: title
      !> Labels of the units.
      type(units_type) :: units
      !> Background grid.
      type(grid_type) :: grid
      !> Constitutive laws.
      type(law_item_type), allocatable :: laws(:)
      !> Bodies, as described by the user.
      type(body_type), allocatable :: bodies(:)
      !> Conforming boundary conditions on grid nodes.
      type(fixity_type), allocatable :: fixities(:)
      !> Implicit boundaries.
      type(boundary_type), allocatable :: boundaries(:)
      !> Contacts between bodies that are not bonded.
      type(body_contact_type), allocatable :: body_contacts(:)
      !> Loads on the edges of tiled bodies.
      type(edge_load_type), allocatable :: edge_loads(:)
      !> Tables that schedule loads.
      type(table_type), allocatable :: tables(:)
      !> Gravity or another acceleration.
      type(body_force_type) :: body_force
      !> Load steps.
      type(schedule_type) :: schedule
      !> Solution settings.
      type(control_type) :: control
      !> Domains of the points, if they tile the bodies.
      type(tiling_type), allocatable :: tiling
      !> Material points, made from the bodies.
      type(points_type) :: points
      !> Time reached so far.
      real(wp) :: time = 0.0_wp
   end type model_type

contains

   !> Factor of a load at a time: from its table, or growing from 0 to 1 over a phase.
   pure function load_factor(model, table, time, ramp_phase) result(factor)
      !> Scene with tables and schedule.
      type(model_type), intent(in) :: model
      !> Number of the table, or 0 for the ramp.
      integer, intent(in) :: table
      !> Time, between 0 and the end of the last step.
      real(wp), intent(in) :: time
      !> Phase of the ramp; 0: it is over before the run starts.
      integer, intent(in) :: ramp_phase
      real(wp) :: factor

      if (table > 0) then
         factor = model%tables(table)%at(time)
      else
         factor = model%schedule%share_of_phase(ramp_phase, time)
      end if
   end function load_factor

   !> Factor of a load that is taken off over the phase after its last.
   pure function passing_factor(model, table, time, ramp_phase, last_phase) result(factor)
      !> See `load_factor`.
      type(model_type), intent(in) :: model
      integer, intent(in) :: table
      real(wp), intent(in) :: time
      integer, intent(in) :: ramp_phase
      !> Last phase in which the load acts in full.
      integer, intent(in) :: last_phase
      real(wp) :: factor

      factor = load_factor(model, table, time, ramp_phase)
      if (last_phase == no_last_phase) return
      factor = factor*(1.0_wp - model%schedule%share_of_phase(last_phase + 1, time))
   end function passing_factor

   !> Factor of a load on edges at a time.
   pure function edge_load_factor(model, load, time) result(factor)
      !> Scene with tables and schedule.
      type(model_type), intent(in) :: model
      !> Number of the load.
      integer, intent(in) :: load
      !> Time.
      real(wp), intent(in) :: time
      real(wp) :: factor

      associate (item => model%edge_loads(load))
         factor = passing_factor(model, item%table, time, item%ramp_phase, item%last_phase)
      end associate
   end function edge_load_factor

   !> Factor of the body force at a time.
   pure function body_force_factor(model, time) result(factor)
      !> Scene with tables and schedule.
      type(model_type), intent(in) :: model
      !> Time.
      real(wp), intent(in) :: time
      real(wp) :: factor

      associate (item => model%body_force)
         factor = passing_factor(model, item%table, time, item%ramp_phase, item%last_phase)
      end associate
   end function body_force_factor

   !> How a boundary moves between two times.
   pure function boundary_motion(model, boundary, start_time, end_time) result(motion)
      !> Scene with tables and schedule.
      type(model_type), intent(in) :: model
      !> Number of the boundary.
      integer, intent(in) :: boundary
      !> Times.
      real(wp), intent(in) :: start_time, end_time
      type(motion_type) :: motion
      integer :: i

      associate (item => model%boundaries(boundary))
         motion%translation = item%displacement*advance(item%table, item%ramp_phase)
         motion%centre = item%centre
         if (abs(item%rotation) > 0.0_wp) then
            motion%rotation = item%rotation*advance(item%rotation_table, item%ramp_phase)
         end if
         if (.not. allocated(item%legs)) return
         do i = 1, size(item%legs)
            associate (leg => item%legs(i))
               motion%translation = motion%translation &
                  + leg%displacement*advance(leg%table, leg%phase)
               motion%rotation = motion%rotation + leg%rotation*advance(leg%table, leg%phase)
            end associate
         end do
      end associate

   contains

      !> How far a table or a phase gets from the first time to the last.
      pure function advance(table, phase)
         integer, intent(in) :: table, phase
         real(wp) :: advance

         advance = load_factor(model, table, end_time, phase) &
            - load_factor(model, table, start_time, phase)
      end function advance

   end function boundary_motion

   !> Elastic moduli of a point at the start of the step, which scale penalties.
   pure subroutine point_moduli(model, point, lame_lambda, shear_modulus)
      !> Scene.
      type(model_type), intent(in) :: model
      !> Number of the point.
      integer, intent(in) :: point
      !> First Lame parameter, stress units.
      real(wp), intent(out) :: lame_lambda
      !> Shear modulus, stress units.
      real(wp), intent(out) :: shear_modulus

      associate (law => model%laws(model%bodies(model%points%body(point))%law)%law, &
                 state => model%points%converged)
         call law%elastic_moduli(state%kirchhoff_stress(:, point), &
                                 state%law_state(:law%n_state, point), lame_lambda, shear_modulus)
      end associate
   end subroutine point_moduli

end module coulter_model
