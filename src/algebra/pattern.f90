!> How the pattern of a sparse matrix is built from the unknowns that its elements couple.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_pattern
   use coulter_algebra_sparse, only: element_dofs_type, pattern_type
   implicit none(type, external)
   private
   public :: build_pattern

   !> Where the unknowns stand as columns of the elements.
   type :: uses_type
      !> First use of every unknown in `entry`, shape (n + 1).
      integer, allocatable :: start(:)
      !> Entries of the elements at which an unknown stands, and their elements, shape (n_uses).
      integer, allocatable :: entry(:), owner(:)
   end type uses_type

contains

   !> Pattern and scatter map of a matrix made of dense element matrices.
   subroutine build_pattern(pattern, n, elements)
      !> Pattern to make.
      type(pattern_type), intent(out) :: pattern
      !> Number of unknowns.
      integer, intent(in) :: n
      !> Unknowns of every element. Where an unknown is a row of another one's column, the other
      !> must be a row of its column.
      type(element_dofs_type), intent(in) :: elements
      type(uses_type) :: uses
      logical :: is_paired(elements%n_elements)
      integer :: place(n), column, k

      pattern%n = n
      call list_uses(uses, n, elements)
      allocate (pattern%is_twin(n))
      call find_twins(uses, pattern%is_twin)
      call find_paired(pattern, elements, is_paired)
      call collect_columns(pattern, elements, uses, is_paired)
      call allocate_slots(pattern, elements, is_paired)
      do column = 1, n
         do k = pattern%column_start(column) + 1, pattern%column_start(column + 1)
            place(pattern%row(k) + 1) = k
         end do
         call fill_slots(pattern, elements, uses, column, is_paired, place)
      end do
   end subroutine build_pattern

   !> Columns and rows of the pattern.
   pure subroutine collect_columns(pattern, elements, uses, is_paired)
      type(pattern_type), intent(inout) :: pattern
      type(element_dofs_type), intent(in) :: elements
      type(uses_type), intent(in) :: uses
      logical, intent(in) :: is_paired(:)
      integer :: rows(pattern%n), last_column(pattern%n), column, n_rows

      associate (n => pattern%n)
         allocate (pattern%column_start(n + 1), pattern%row(64*n))
         last_column = 0
         n_rows = 0
         pattern%column_start(1) = 0
         do column = 1, n
            if (.not. pattern%is_twin(column)) then
               call collect_rows(elements, uses, is_paired, column, last_column, rows, n_rows)
               call complete_rows(pattern%is_twin, rows, n_rows)
            end if
            call append_rows(pattern, column, rows(:n_rows))
         end do
      end associate
      pattern%row = pattern%row(:pattern%n_entries)
   end subroutine collect_columns

   !> Unknowns that stand right behind the one before wherever that stands, such as the second
   !> components of nodes: their columns have the same rows.
   pure subroutine find_twins(uses, is_twin)
      type(uses_type), intent(in) :: uses
      logical, intent(out) :: is_twin(:)
      integer :: d

      is_twin = .false.
      do d = 2, size(is_twin)
         if (is_twin(d - 1)) cycle
         associate (start => uses%start(d), n => uses%start(d + 1) - uses%start(d))
            if (start - uses%start(d - 1) /= n) cycle
            is_twin(d) = &
               all(uses%entry(start:start + n - 1) == uses%entry(start - n:start - 1) + 1) &
               .and. all(uses%owner(start:start + n - 1) == uses%owner(start - n:start - 1))
         end associate
      end do
   end subroutine find_twins

   !> Unknowns that share an element with a column; of elements of pairs, the first of every pair.
   pure subroutine collect_rows(elements, uses, is_paired, column, last_column, rows, n_rows)
      type(element_dofs_type), intent(in) :: elements
      type(uses_type), intent(in) :: uses
      logical, intent(in) :: is_paired(:)
      integer, intent(in) :: column
      !> Last column that had the unknown as a row.
      integer, intent(inout) :: last_column(:)
      integer, intent(inout) :: rows(:)
      integer, intent(out) :: n_rows
      integer :: u, e, k, dof

      n_rows = 0
      do u = uses%start(column), uses%start(column + 1) - 1
         e = uses%owner(u)
         do k = elements%start(e), elements%start(e + 1) - 1, merge(2, 1, is_paired(e))
            dof = elements%dof(k)
            if (dof == 0) cycle
            if (last_column(dof) == column) cycle
            last_column(dof) = column
            n_rows = n_rows + 1
            rows(n_rows) = dof
         end do
      end do
   end subroutine collect_rows

   !> The first unknown of every pair, sorted, and then all.
   pure subroutine complete_rows(is_twin, rows, n_rows)
      logical, intent(in) :: is_twin(:)
      integer, intent(inout) :: rows(:), n_rows
      integer :: u, n

      n = n_rows
      n_rows = 0
      do u = 1, n
         if (is_twin(rows(u))) cycle
         n_rows = n_rows + 1
         rows(n_rows) = rows(u)
      end do
      call sort_ascending(rows(:n_rows))
      call add_twins(is_twin, rows, n_rows)
   end subroutine complete_rows

   !> Let every pair be whole where only its first unknown stands.
   pure subroutine add_twins(is_twin, rows, n_rows)
      logical, intent(in) :: is_twin(:)
      integer, intent(inout) :: rows(:), n_rows
      integer :: u, k, dof, n_twins

      n_twins = 0
      do u = 1, n_rows
         if (has_twin(is_twin, rows(u))) n_twins = n_twins + 1
      end do
      k = n_rows + n_twins
      do u = n_rows, 1, -1
         dof = rows(u)
         if (has_twin(is_twin, dof)) then
            rows(k) = dof + 1
            k = k - 1
         end if
         rows(k) = dof
         k = k - 1
      end do
      n_rows = n_rows + n_twins
   end subroutine add_twins

   !> Is the next unknown the twin of this one?
   pure function has_twin(is_twin, dof) result(answer)
      logical, intent(in) :: is_twin(:)
      integer, intent(in) :: dof
      logical :: answer

      answer = .false.
      if (dof < size(is_twin)) answer = is_twin(dof + 1)
   end function has_twin

   !> Add the rows of the next column.
   pure subroutine append_rows(pattern, column, rows)
      type(pattern_type), intent(inout) :: pattern
      integer, intent(in) :: column
      !> Its rows, from 1.
      integer, intent(in) :: rows(:)
      integer, allocatable :: grown(:)
      integer :: n

      n = pattern%n_entries + size(rows)
      if (n > size(pattern%row)) then
         allocate (grown(2*n))
         grown(:pattern%n_entries) = pattern%row(:pattern%n_entries)
         call move_alloc(grown, pattern%row)
      end if
      pattern%row(pattern%n_entries + 1:n) = rows - 1
      pattern%n_entries = n
      pattern%column_start(column + 1) = n
   end subroutine append_rows

   !> Note where the values of all elements in a column go.
   pure subroutine fill_slots(pattern, elements, uses, column, is_paired, place)
      type(pattern_type), intent(inout) :: pattern
      type(element_dofs_type), intent(in) :: elements
      type(uses_type), intent(in) :: uses
      integer, intent(in) :: column
      logical, intent(in) :: is_paired(:)
      !> Entry of every row of the column.
      integer, intent(in) :: place(:)
      integer :: u, e, first, last, each, next, k

      do u = uses%start(column), uses%start(column + 1) - 1
         e = uses%owner(u)
         if (is_paired(e) .and. pattern%is_twin(column)) cycle
         each = merge(2, 1, is_paired(e))
         first = elements%start(e)
         last = elements%start(e + 1) - 1
         next = pattern%slot_start(e) + (uses%entry(u) - first)/each*((last - first + 1)/each)
         do k = first, last, each
            if (elements%dof(k) > 0) pattern%slot(next) = place(elements%dof(k))
            next = next + 1
         end do
      end do
   end subroutine fill_slots

   !> For every unknown, the entries at which it stands as a column of an element.
   pure subroutine list_uses(uses, n, elements)
      type(uses_type), intent(out) :: uses
      integer, intent(in) :: n
      type(element_dofs_type), intent(in) :: elements
      integer :: e, k, dof

      allocate (uses%start(n + 1), source=0)
      do e = 1, elements%n_elements
         do k = elements%start(e), elements%start(e) + elements%columns_of(e) - 1
            dof = elements%dof(k)
            if (dof > 0) uses%start(dof) = uses%start(dof) + 1
         end do
      end do
      uses%start(1) = uses%start(1) + 1
      do k = 2, n + 1
         uses%start(k) = uses%start(k) + uses%start(k - 1)
      end do
      allocate (uses%entry(uses%start(n + 1) - 1), uses%owner(uses%start(n + 1) - 1))
      do e = elements%n_elements, 1, -1
         do k = elements%start(e) + elements%columns_of(e) - 1, elements%start(e), -1
            dof = elements%dof(k)
            if (dof == 0) cycle
            uses%start(dof) = uses%start(dof) - 1
            uses%entry(uses%start(dof)) = k
            uses%owner(uses%start(dof)) = e
         end do
      end do
   end subroutine list_uses

   !> Elements that consist of twins, and of pairs of none.
   pure subroutine find_paired(pattern, elements, is_paired)
      type(pattern_type), intent(in) :: pattern
      type(element_dofs_type), intent(in) :: elements
      logical, intent(out) :: is_paired(:)
      integer :: e, k

      do e = 1, elements%n_elements
         is_paired(e) = mod(elements%start(e + 1) - elements%start(e), 2) == 0 &
            .and. mod(elements%columns_of(e), 2) == 0
         do k = elements%start(e), elements%start(e + 1) - 2, 2
            if (.not. is_paired(e)) exit
            associate (dof => elements%dof(k), next => elements%dof(k + 1))
               is_paired(e) = dof + next == 0
               if (dof > 0) is_paired(e) = next == dof + 1 .and. has_twin(pattern%is_twin, dof)
            end associate
         end do
      end do
   end subroutine find_paired

   !> Make room for the scatter map.
   pure subroutine allocate_slots(pattern, elements, is_paired)
      type(pattern_type), intent(inout) :: pattern
      type(element_dofs_type), intent(in) :: elements
      logical, intent(in) :: is_paired(:)
      integer :: e, n_values

      allocate (pattern%slot_start(elements%n_elements + 1))
      pattern%slot_start(1) = 1
      do e = 1, elements%n_elements
         n_values = (elements%start(e + 1) - elements%start(e))*elements%columns_of(e)
         pattern%slot_start(e + 1) = pattern%slot_start(e) + n_values/merge(4, 1, is_paired(e))
      end do
      allocate (pattern%slot(pattern%slot_start(elements%n_elements + 1) - 1), source=0)
   end subroutine allocate_slots

   !> Insertion sort: the rows of a column are few.
   pure subroutine sort_ascending(numbers)
      integer, intent(inout) :: numbers(:)
      integer :: i, j, number

      do i = 2, size(numbers)
         number = numbers(i)
         j = i - 1
         do while (j >= 1)
            if (numbers(j) <= number) exit
            numbers(j + 1) = numbers(j)
            j = j - 1
         end do
         numbers(j + 1) = number
      end do
   end subroutine sort_ascending

end module coulter_algebra_pattern
