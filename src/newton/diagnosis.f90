!> Why Newton's method has found no equilibrium: where forces are least in balance, what happened
!> there in the last iterations, and what may help.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_newton_diagnosis
   use coulter_base_kinds, only: wp
   use coulter_base_polygon, only: distance_to_segment
   use coulter_base_text, only: to_text
   use coulter_contact, only: contacts_type
   use coulter_model, only: model_type
   use coulter_newton_iterate, only: newton_type
   use coulter_newton_rigid_modes, only: name_free_body
   use coulter_system, only: system_type
   implicit none(type, external)
   private
   public :: contact_watch_type, watch_contacts, explain_stall, explain_singular, ghost_advice

   !> Iterations at the end that are looked at; contacts that change more often than this in them go
   !> to and fro.
   integer, parameter, public :: n_watched = 6
   integer, parameter :: few_changes = 2
   !> A residual that has fallen by this factor in these iterations is still falling.
   real(wp), parameter :: falling = 0.1_wp
   !> Boundaries and stations nearer than this, over the spacing, are at a place.
   real(wp), parameter :: near = 1.5_wp
   !> Free surfaces of incompressible elastic bodies wrinkle at a stretch of 0.544 (Biot, M. A.
   !> (1963), Appl. Sci. Res. A 12, 168-182); a tile averages the stretch below its surface.
   real(wp), parameter :: wrinkling_stretch = 0.6_wp

   !> How stations change in the last iterations.
   type :: contact_watch_type
      !> What every station does: 0 open, 2 closed, 1 and 3 slipping to either side, shape (n).
      integer, allocatable :: state(:)
      !> How often it has opened or closed, and how often its shear has changed, shape (n).
      integer, allocatable :: n_openings(:), n_slips(:)
   end type contact_watch_type

contains

   !> Note how stations have changed since the last call.
   pure subroutine watch_contacts(watch, contacts)
      !> What is known of them.
      type(contact_watch_type), intent(inout) :: watch
      !> The stations at the present unknowns.
      type(contacts_type), intent(in) :: contacts
      integer :: state(contacts%n), k

      do k = 1, contacts%n
         state(k) = merge(contacts%item(k)%slip + 2, 0, contacts%item(k)%is_acting)
      end do
      if (.not. allocated(watch%state)) then
         allocate (watch%n_openings(contacts%n), watch%n_slips(contacts%n), source=0)
      else
         where ((state == 0) .neqv. (watch%state == 0))
            watch%n_openings = watch%n_openings + 1
         else where (state /= watch%state)
            watch%n_slips = watch%n_slips + 1
         end where
      end if
      watch%state = state
   end subroutine watch_contacts

   !> What to add to "no equilibrium".
   pure function explain_stall(newton, watch, system, model) result(text)
      !> The iteration.
      type(newton_type), intent(in) :: newton
      !> What stations did in its last iterations.
      type(contact_watch_type), intent(in) :: watch
      !> System at the last unknowns.
      type(system_type), intent(in) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text
      integer :: point, n

      n = size(newton%residuals)
      text = ""
      if (.not. newton%residuals(n) <= huge(1.0_wp)) return
      point = worst_point(newton, system, model)
      text = "; forces are least in balance"//place_of(model, point)
      if (newton%residuals(n) < falling*newton%residuals(max(n - n_watched, 1))) then
         text = text//", but still come nearer to it: allow more `max_iterations`"
      else
         text = text//cause(watch, system, model, point)
      end if
   end function explain_stall

   !> What a singular tangent means.
   pure function explain_singular(system, model) result(text)
      !> System at the last unknowns.
      type(system_type), intent(in) :: system
      !> Scene at the start of the step.
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text
      character(len=:), allocatable :: free

      text = "the tangent is singular: "
      if (.not. allocated(model%tiling)) then
         text = text//"the material is unstable, or a body is free to move since no boundary or" &
            //" fixity holds it"
         return
      end if
      free = name_free_body(system, model)
      if (free /= "") then
         text = text//free//"; give it a fixity or a boundary that holds it"
      else
         text = text//"all bodies are held, but material is unstable, or at its limit load:" &
            //settling_advice(system, model)//ghost_advice(model)
      end if
   end function explain_singular

   !> What else may be free to move without ghost penalty.
   pure function ghost_advice(model) result(text)
      !> The scene.
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text

      text = ""
      if (allocated(model%tiling) .and. .not. model%control%ghost_ratio > 0.0_wp) then
         text = "; what fills little of a cell is held by `ghost_penalty` alone"
      end if
   end function ghost_advice

   !> How to get past a limit load.
   pure function settling_advice(system, model) result(text)
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text

      text = " load it less"
      if (allocated(model%tiling) .and. .not. model%control%may_settle &
          .and. system%n_settling == 0) then
         text = text//", or let it slide to where it rests (`settle = .true.`)"
      end if
   end function settling_advice

   !> The material point next to the node whose force is least in balance.
   pure function worst_point(newton, system, model) result(point)
      type(newton_type), intent(in) :: newton
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      integer :: point
      real(wp) :: worst, force(2), place(2)
      integer :: i, node

      worst = -1.0_wp
      place = model%grid%origin
      do node = 1, size(system%dofs%dof, 2)
         force = 0.0_wp
         do i = 1, 2
            if (system%dofs%dof(i, node) > 0) force(i) = newton%unbalanced(system%dofs%dof(i, node))
         end do
         if (norm2(force) <= worst) cycle
         worst = norm2(force)
         place = model%grid%node_position( &
                 system%cells%node_index(:, node))
      end do
      point = minloc(norm2(model%points%position - spread(place, 2, model%points%n_points), &
                           dim=1), dim=1)
   end function worst_point

   !> Where a point is: in which body, and beside what.
   pure function place_of(model, point) result(text)
      type(model_type), intent(in) :: model
      integer, intent(in) :: point
      character(len=:), allocatable :: text
      real(wp) :: distance, nearest
      integer :: b, beside, s

      associate (x => model%points%position(:, point))
         text = " in body "//model%bodies(model%points%body(point))%name//" near ("//to_text(x)//")"
         beside = 0
         nearest = near*model%grid%smallest_spacing()
         do b = 1, size(model%boundaries)
            if (.not. model%boundaries(b)%is_active) cycle
            associate (v => model%boundaries(b)%vertices)
               do s = 1, size(v, 2) - 1
                  distance = distance_to_segment(x, v(:, s), v(:, s + 1))
                  if (distance >= nearest) cycle
                  nearest = distance
                  beside = b
               end do
            end associate
         end do
      end associate
      if (beside > 0) text = text//" beside "//name_of(model, beside)
   end function place_of

   !> A boundary by its name.
   pure function name_of(model, b) result(text)
      type(model_type), intent(in) :: model
      integer, intent(in) :: b
      character(len=:), allocatable :: text

      text = trim(merge("tool    ", "boundary", model%boundaries(b)%is_tool))//" " &
         //model%boundaries(b)%name
   end function name_of

   !> What happens there, and what may help.
   pure function cause(watch, system, model, point) result(text)
      type(contact_watch_type), intent(in) :: watch
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      integer, intent(in) :: point
      character(len=:), allocatable :: text
      real(wp) :: stretch

      text = what_flips(watch, system, model)
      if (text /= "") return
      stretch = least_stretch(model%points%converged%deformation_gradient(:, point))
      associate (law => model%laws(model%bodies(model%points%body(point))%law)%law)
         if (.not. law%is_elastic) then
            text = ", where material may have reached its limit load: try more" &
               //" `max_iterations`; else"//settling_advice(system, model)
         else if (stretch < wrinkling_stretch) then
            text = ", where it is squeezed to "//to_text(stretch, 2)//" of its size: free" &
               //" surfaces of elastic bodies wrinkle at 0.54 (Biot), however small the step"
         else
            text = ": take smaller steps or a finer grid"
         end if
      end associate
   end function cause

   !> Stations that go to and fro; empty if none do.
   pure function what_flips(watch, system, model) result(text)
      type(contact_watch_type), intent(in) :: watch
      type(system_type), intent(in) :: system
      type(model_type), intent(in) :: model
      character(len=:), allocatable :: text
      integer :: k
      logical :: has_opened

      text = ""
      if (.not. allocated(watch%state)) return
      if (.not. any(watch%n_openings + watch%n_slips > few_changes)) return
      k = maxloc(watch%n_openings + watch%n_slips, dim=1)
      has_opened = watch%n_openings(k) >= watch%n_slips(k)
      associate (contact => system%contacts%item(k))
         text = "; near ("//to_text(model%tiling%position(:, contact%corner))//") contact with " &
            //name_of(model, contact%boundary)//trim(merge(" opens and closes ", &
                                                           " sticks and slips ", has_opened)) &
            //" in turns: take smaller steps or a finer grid"
      end associate
      if (.not. has_opened) text = text//", or less friction"
   end function what_flips

   !> Smaller principal stretch in the plane.
   pure function least_stretch(f) result(stretch)
      !> Deformation gradient, columns one after the other.
      real(wp), intent(in) :: f(:)
      real(wp) :: stretch
      real(wp) :: trace, determinant

      trace = sum(f(:4)**2)
      determinant = (f(1)*f(4) - f(2)*f(3))**2
      stretch = sqrt(0.5_wp*max(trace - sqrt(max(trace**2 - 4.0_wp*determinant, 0.0_wp)), 0.0_wp))
   end function least_stretch

end module coulter_newton_diagnosis
