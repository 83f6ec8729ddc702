!> How the pattern of a sparse matrix is built from the unknowns that its elements couple.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_pattern
   use coulter_algebra_pairs, only: find_pairs
   use coulter_algebra_sparse, only: element_dofs_type, pattern_type
   implicit none(type, external)
   private
   public :: build_pattern

   !> Where the unknowns stand in the elements.
   type :: uses_type
      !> First use of every unknown in `entry`, shape (n + 1).
      integer, allocatable :: start(:)
      !> Entries of the elements at which an unknown stands, shape (n_uses).
      integer, allocatable :: entry(:)
      !> Element of every entry of the elements, shape (n_entries).
      integer, allocatable :: owner(:)
   end type uses_type

contains

   !> Pattern and scatter map of a matrix made of dense element matrices.
   subroutine build_pattern(pattern, n, elements)
      !> Pattern to make.
      type(pattern_type), intent(out) :: pattern
      !> Number of unknowns.
      integer, intent(in) :: n
      !> Unknowns of every element.
      type(element_dofs_type), intent(in) :: elements
      type(uses_type) :: uses
      integer, allocatable :: place(:), rows(:)
      logical :: is_first(n), is_paired(elements%n_elements)
      integer :: column, n_rows, i

      call transpose_elements(elements, n, uses)
      call find_pairs(n, elements%start(:elements%n_elements + 1), elements%dof, is_first, &
                      is_paired)
      call allocate_slots(pattern, elements, is_paired)
      pattern%n = n
      allocate (pattern%column_start(n + 1), pattern%is_twin(n), place(n), rows(n))
      allocate (pattern%row(count_values(elements)))
      place = 0
      pattern%column_start(1) = 0
      do column = 1, n
         if (.not. is_second(is_first, column)) then
            call collect_rows(elements, uses, column, is_first, place, rows, n_rows)
         end if
         do i = 1, n_rows
            pattern%row(pattern%n_entries + i) = rows(i) - 1
            place(rows(i)) = pattern%n_entries + i
         end do
         call fill_slots(pattern, elements, uses, column, is_first, is_paired, place)
         place(rows(:n_rows)) = 0
         call find_twin(pattern, column, rows(:n_rows))
         pattern%n_entries = pattern%n_entries + n_rows
         pattern%column_start(column + 1) = pattern%n_entries
      end do
      pattern%row = pattern%row(:pattern%n_entries)
   end subroutine build_pattern

   !> Is the unknown the second of a pair? Its column has the rows of the first.
   pure function is_second(is_first, dof) result(answer)
      logical, intent(in) :: is_first(:)
      integer, intent(in) :: dof
      logical :: answer

      answer = .false.
      if (dof > 1) answer = is_first(dof - 1)
   end function is_second

   !> Sorted unknowns that share an element with a column: the first of every pair, and then all.
   pure subroutine collect_rows(elements, uses, column, is_first, place, rows, n_rows)
      type(element_dofs_type), intent(in) :: elements
      type(uses_type), intent(in) :: uses
      integer, intent(in) :: column
      logical, intent(in) :: is_first(:)
      !> Zeros; marks what has been collected.
      integer, intent(inout) :: place(:)
      integer, intent(inout) :: rows(:)
      integer, intent(out) :: n_rows
      integer :: u, e, k, dof

      n_rows = 0
      do u = uses%start(column), uses%start(column + 1) - 1
         e = uses%owner(uses%entry(u))
         do k = elements%start(e), elements%start(e + 1) - 1
            dof = elements%dof(k)
            if (dof == 0) cycle
            if (place(dof) /= 0 .or. is_second(is_first, dof)) cycle
            place(dof) = 1
            n_rows = n_rows + 1
            rows(n_rows) = dof
         end do
      end do
      call sort_ascending(rows(:n_rows))
      call add_seconds(is_first, rows, n_rows)
   end subroutine collect_rows

   !> Let every pair be whole where only its first unknown stands.
   pure subroutine add_seconds(is_first, rows, n_rows)
      logical, intent(in) :: is_first(:)
      integer, intent(inout) :: rows(:), n_rows
      integer :: u, k, dof, n_pairs

      n_pairs = count(is_first(rows(:n_rows)))
      k = n_rows + n_pairs
      do u = n_rows, 1, -1
         dof = rows(u)
         if (is_first(dof)) rows(k) = dof + 1
         if (is_first(dof)) k = k - 1
         rows(k) = dof
         k = k - 1
      end do
      n_rows = n_rows + n_pairs
   end subroutine add_seconds

   !> Has the column the rows of the one before?
   pure subroutine find_twin(pattern, column, rows)
      type(pattern_type), intent(inout) :: pattern
      integer, intent(in) :: column
      !> Its rows, from 1.
      integer, intent(in) :: rows(:)
      integer :: first

      pattern%is_twin(column) = .false.
      if (column == 1) return
      first = pattern%column_start(column - 1) + 1
      if (pattern%is_twin(column - 1) .or. pattern%n_entries - first + 1 /= size(rows)) return
      pattern%is_twin(column) = all(pattern%row(first:pattern%n_entries) == rows - 1)
   end subroutine find_twin

   !> Note where the values of all elements in a column go.
   pure subroutine fill_slots(pattern, elements, uses, column, is_first, is_paired, place)
      type(pattern_type), intent(inout) :: pattern
      type(element_dofs_type), intent(in) :: elements
      type(uses_type), intent(in) :: uses
      integer, intent(in) :: column
      logical, intent(in) :: is_first(:), is_paired(:)
      !> Entry of every row of the column.
      integer, intent(in) :: place(:)
      integer :: u, e, first, last, each, next, k

      do u = uses%start(column), uses%start(column + 1) - 1
         e = uses%owner(uses%entry(u))
         if (is_paired(e) .and. is_second(is_first, column)) cycle
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

   !> For every unknown, its entries in the elements, and the element of every entry.
   pure subroutine transpose_elements(elements, n, uses)
      type(element_dofs_type), intent(in) :: elements
      integer, intent(in) :: n
      type(uses_type), intent(out) :: uses
      integer :: e, k, dof

      allocate (uses%start(n + 1), source=0)
      allocate (uses%owner(size(elements%dof)))
      do k = 1, size(elements%dof)
         dof = elements%dof(k)
         if (dof > 0) uses%start(dof) = uses%start(dof) + 1
      end do
      uses%start(1) = uses%start(1) + 1
      do k = 2, n + 1
         uses%start(k) = uses%start(k) + uses%start(k - 1)
      end do
      allocate (uses%entry(uses%start(n + 1) - 1))
      do e = elements%n_elements, 1, -1
         do k = elements%start(e), elements%start(e + 1) - 1
            uses%owner(k) = e
            dof = elements%dof(k)
            if (dof == 0) cycle
            uses%start(dof) = uses%start(dof) - 1
            uses%entry(uses%start(dof)) = k
         end do
      end do
   end subroutine transpose_elements

   !> Make room for the scatter map.
   pure subroutine allocate_slots(pattern, elements, is_paired)
      type(pattern_type), intent(inout) :: pattern
      type(element_dofs_type), intent(in) :: elements
      logical, intent(in) :: is_paired(:)
      integer :: e, m

      allocate (pattern%slot_start(elements%n_elements + 1))
      pattern%slot_start(1) = 1
      do e = 1, elements%n_elements
         m = elements%start(e + 1) - elements%start(e)
         if (is_paired(e)) m = m/2
         pattern%slot_start(e + 1) = pattern%slot_start(e) + m**2
      end do
      allocate (pattern%slot(pattern%slot_start(elements%n_elements + 1) - 1), source=0)
   end subroutine allocate_slots

   !> Number of values of all element matrices.
   pure function count_values(elements) result(n)
      type(element_dofs_type), intent(in) :: elements
      integer :: n
      integer :: e

      n = 0
      do e = 1, elements%n_elements
         n = n + (elements%start(e + 1) - elements%start(e))**2
      end do
   end function count_values

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
