!> Essential boundaries that need not match the grid: a polyline and how it holds the material.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_boundary
   use coulter_base_kinds, only: wp
   use coulter_boundary_motion, only: leg_type
   implicit none(type, external)
   private
   public :: boundary_type, kind_roller, kind_fixed
   public :: formulation_implicit, formulation_nitsche, formulation_augmented
   public :: implicit_band_ratio, nitsche_band_ratio, augmented_band_ratio

   !> Only the displacement along the normal is prescribed.
   integer, parameter :: kind_roller = 1
   !> Both components of the displacement are prescribed.
   integer, parameter :: kind_fixed = 2

   !> The paper's implicit boundary method: stations on the segments, for points.
   integer, parameter :: formulation_implicit = 1
   !> Penalty band over the spacing that suits it (theory, section 3).
   real(wp), parameter :: implicit_band_ratio = 5.0e-6_wp
   !> Stations on the corners of tiles, with the traction of the material (Nitsche).
   integer, parameter :: formulation_nitsche = 2

   !> Stations on the corners of tiles, with augmented Lagrangian updates of a symmetric penalty.
   integer, parameter :: formulation_augmented = 3
   !> Penalty band over the spacing that suits augmented Lagrangian updates.
   real(wp), parameter :: augmented_band_ratio = 0.02_wp
   !> Penalty band over the spacing that suits Nitsche's method: any is exact in a patch test, this
   !> one is stiff enough against penetration and soft enough for the linear algebra.
   real(wp), parameter :: nitsche_band_ratio = 0.1_wp

   !> A chain of straight segments with the material on the left of each, at which the
   !> displacement is prescribed (theory, sections 3 and 4).
   type :: boundary_type
      !> Name under which reactions are reported.
      character(len=:), allocatable :: name
      !> `kind_roller` or `kind_fixed`.
      integer :: kind = kind_roller
      !> One of `formulation_*`.
      integer :: formulation = formulation_nitsche
      !> Does the boundary hold the material that starts on it also against being pulled off? Else
      !> it is a wall that only pushes; for `formulation_nitsche`.
      logical :: is_bilateral = .false.
      !> Current corners of the polyline, length units, shape (2, n_segments + 1).
      real(wp), allocatable :: vertices(:, :)
      !> Total prescribed displacement at a table value of 1, length units. The boundary moves with
      !> it; a roller prescribes only the normal part.
      real(wp) :: displacement(2) = 0.0_wp
      !> Number of the table that schedules the displacement; 0: it grows evenly over `ramp_phase`.
      integer :: table = 0
      !> Phase over which displacement and rotation grow without a table.
      integer :: ramp_phase = 1
      !> First and last phase in which the boundary acts, and does it act now? It moves anyway.
      integer :: first_phase = 1, last_phase = huge(1)
      logical :: is_active = .true.
      !> Width delta of the Dirichlet band over the grid spacing h.
      real(wp) :: band_ratio = nitsche_band_ratio
      !> Gauss points per piece of segment in a cell: 1 to 3. Two are exact for uniform stress; one
      !> keeps inclined boundaries from locking under bending (theory, section 3, trap 2).
      integer :: n_gauss = 2
      !> Is the coupling term K2 of the paper kept beside the penalty K3?
      logical :: has_coupling_term = .true.
      !> Are tractions remembered from step to step, so that held steps do not drift?
      logical :: has_memory = .false.
      !> May the boundary start away from all material?
      logical :: may_start_apart = .false.
      !> Coefficient of Coulomb friction, for `formulation_nitsche`.
      real(wp) :: friction = 0.0_wp
      !> Shear that it carries without pressure, and the largest shear, stress units.
      real(wp) :: adhesion = 0.0_wp, shear_limit = huge(1.0_wp)
      !> Does what presses against it stick up to the largest shear, whatever the pressure?
      logical :: is_rough = .false.
      !> Tension that it holds where material has touched it once, stress units, and opening over
      !> which that fades, length units; 0: it is lost at once.
      real(wp) :: tension_limit = 0.0_wp, tension_opening = 0.0_wp
      !> Is it a rigid tool, whose sharp corners press on edges of bodies as well, and is that a
      !> solid: a closed chain with the material outside?
      logical :: is_tool = .false., is_solid = .false.
      !> Do the bodies leave out its place at the start?
      logical :: is_embedded = .false.
      !> Components of its displacement that are free, and does it turn freely about its centre? A
      !> load decides: at a table value of 1, force units per thickness, and a moment beside it,
      !> counter-clockwise. The force acts at a place on the tool, from the centre, length units.
      logical :: is_free(2) = .false., turns_freely = .false.
      real(wp) :: load(2) = 0.0_wp, moment = 0.0_wp, lever(2) = 0.0_wp
      integer :: load_table = 0
      !> Bulge of every segment: tangent of a quarter of the angle of an arc, positive when it runs
      !> counter-clockwise, shape (n_segments); unallocated if all are straight.
      real(wp), allocatable :: bulges(:)
      !> Total rotation at a table value of 1, counter-clockwise, radians, and its table.
      real(wp) :: rotation = 0.0_wp
      integer :: rotation_table = 0
      !> Further parts of its way; unallocated if there are none.
      type(leg_type), allocatable :: legs(:)
      !> Displacement and rotation since the start, length units and radians.
      real(wp) :: travel(2) = 0.0_wp, turned = 0.0_wp
      !> Displacement in the last step in which it moved, length units.
      real(wp) :: heading(2) = 0.0_wp
      !> Rough ones: do they carry so little shear that what flows on them slides along?
      logical :: slides = .false.
      !> Current centre of the rotation, length units; it moves with the displacement.
      real(wp) :: centre(2) = 0.0_wp
   contains
      procedure :: has_friction
      procedure :: bulge
   end type boundary_type

contains

   !> Does what slides along the boundary rub?
   elemental function has_friction(self) result(answer)
      class(boundary_type), intent(in) :: self
      logical :: answer

      answer = self%friction > 0.0_wp .or. self%adhesion > 0.0_wp .or. self%is_rough
   end function has_friction

   !> Bulge of a segment, 0 if it is straight.
   pure function bulge(self, segment)
      class(boundary_type), intent(in) :: self
      !> Number of the segment.
      integer, intent(in) :: segment
      real(wp) :: bulge

      bulge = 0.0_wp
      if (allocated(self%bulges)) bulge = self%bulges(segment)
   end function bulge

end module coulter_boundary
