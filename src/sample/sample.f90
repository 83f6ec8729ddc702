!> A soil sample in the laboratory: one material point that is strained, or loaded, in stages.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_sample
   use coulter_base_kinds, only: wp
   use coulter_law_abstract, only: law_item_type
   implicit none(type, external)
   private
   public :: sample_type, stage_type, test_plan_type

   !> A sample as the user describes it.
   type :: sample_type
      !> Name for messages and files.
      character(len=:), allocatable :: name
      !> Number of its law.
      integer :: law = 0
      !> Cauchy stress xx, yy, zz, xy at the start, tension positive.
      real(wp) :: initial_stress(4) = 0.0_wp
      !> Void ratio at the start; negative when it does not matter.
      real(wp) :: void_ratio = -1.0_wp
   end type sample_type

   !> A stage of a test. Every component xx, yy, zz, xy is driven by strain or by stress. Lines
   !> along x keep their direction: the deformation gradient is F = [[xx, xy], [0, yy]] and zz, and
   !> the strains are ln F for xx, yy, zz, and F_xy/F_yy, the shear of layers, for xy.
   type :: stage_type
      !> Number of the sample.
      integer :: sample = 0
      !> Is a component driven by stress?
      logical :: is_stress(4) = .false.
      !> Does the sample stay round: are the strains xx and zz equal? The mean of their stresses is
      !> then driven: at edges of a yield surface the two have no answer of their own.
      logical :: is_round = .false.
      !> Is a stress kept as it is when the stage begins?
      logical :: is_kept(4) = .false.
      !> Change of a strain, or Cauchy stress to reach.
      real(wp) :: target(4) = 0.0_wp
      !> Number of equal increments.
      integer :: n_increments = 100
      !> How long it takes.
      real(wp) :: duration = 1.0_wp
   end type stage_type

   !> All tests of a deck.
   type :: test_plan_type
      !> Base name of the files to write.
      character(len=:), allocatable :: name
      !> Constitutive laws.
      type(law_item_type), allocatable :: laws(:)
      !> Samples.
      type(sample_type), allocatable :: samples(:)
      !> Stages of all samples, in order.
      type(stage_type), allocatable :: stages(:)
   end type test_plan_type

end module coulter_sample
