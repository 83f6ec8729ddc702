!> Sparse matrices in compressed columns, and the map by which element matrices enter them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_sparse
   use, intrinsic :: iso_c_binding, only: c_int
   use coulter_algebra_pairs, only: find_pairs
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: element_dofs_type, pattern_type, build_pattern, add_element_matrix, multiply
   public :: find_mirror, joined

   !> The unknowns that every element couples, in ragged rows.
   type :: element_dofs_type
      !> Number of elements.
      integer :: n_elements = 0
      !> First entry of every element in `dof`, shape (n_elements + 1).
      integer, allocatable :: start(:)
      !> Unknowns from 1, or 0 for a degree of freedom that is not unknown, shape (n_entries).
      integer, allocatable :: dof(:)
   end type element_dofs_type

   !> Sparsity pattern of a square matrix, zero-based as the C solvers want it.
   type :: pattern_type
      !> Number of rows and columns.
      integer :: n = 0
      !> Number of entries.
      integer :: n_entries = 0
      !> First entry of every column, zero-based, shape (n + 1).
      integer(c_int), allocatable :: column_start(:)
      !> Row of every entry, zero-based, ascending in each column, shape (n_entries).
      integer(c_int), allocatable :: row(:)
      !> Has the column the same rows as the one before, which has no such twin itself, shape (n)?
      logical, allocatable :: is_twin(:)
      !> First slot of every element, shape (n_elements + 1).
      integer, allocatable :: slot_start(:)
      !> Entry (from 1) of every value of the element matrices, columns first; 0: left out. Elements
      !> whose unknowns go in pairs have a slot for every second row of every second column: the
      !> values of the other rows follow it, those of the other columns are a column farther on.
      integer, allocatable :: slot(:)
   end type pattern_type

contains

   !> Pattern and scatter map of a matrix made of dense element matrices.
   subroutine build_pattern(pattern, n, elements)
      !> Pattern to make.
      type(pattern_type), intent(out) :: pattern
      !> Number of unknowns.
      integer, intent(in) :: n
      !> Unknowns of every element.
      type(element_dofs_type), intent(in) :: elements
      integer, allocatable :: user_start(:), user(:), owner(:), place(:), rows(:)
      logical :: is_first(n), is_paired(elements%n_elements)
      integer :: column, n_rows, i

      call transpose_elements(elements, n, user_start, user, owner)
      call find_pairs(n, elements%start(:elements%n_elements + 1), elements%dof, is_first, &
                      is_paired)
      call allocate_slots(pattern, elements, is_paired)
      pattern%n = n
      allocate (pattern%column_start(n + 1), pattern%is_twin(n), place(n), rows(n))
      allocate (pattern%row(count_values(elements)))
      place = 0
      pattern%column_start(1) = 0
      do column = 1, n
         if (.not. is_second(column)) call collect_rows(column)
         do i = 1, n_rows
            pattern%row(pattern%n_entries + i) = rows(i) - 1
            place(rows(i)) = pattern%n_entries + i
         end do
         call fill_slots(column)
         place(rows(:n_rows)) = 0
         call find_twin(column)
         pattern%n_entries = pattern%n_entries + n_rows
         pattern%column_start(column + 1) = pattern%n_entries
      end do
      pattern%row = pattern%row(:pattern%n_entries)

   contains

      !> Is the unknown the second of a pair? Its column has the rows of the first.
      pure function is_second(dof) result(answer)
         integer, intent(in) :: dof
         logical :: answer

         answer = .false.
         if (dof > 1) answer = is_first(dof - 1)
      end function is_second

      !> Sorted unknowns that share an element with the column: the first of every pair, and then
      !> all.
      subroutine collect_rows(column)
         integer, intent(in) :: column
         integer :: u, e, k, dof, n_pairs

         n_rows = 0
         do u = user_start(column), user_start(column + 1) - 1
            e = owner(user(u))
            do k = elements%start(e), elements%start(e + 1) - 1
               dof = elements%dof(k)
               if (dof == 0) cycle
               if (place(dof) /= 0 .or. is_second(dof)) cycle
               place(dof) = 1
               n_rows = n_rows + 1
               rows(n_rows) = dof
            end do
         end do
         call sort_ascending(rows(:n_rows))
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
      end subroutine collect_rows

      !> Compare with the column before.
      subroutine find_twin(column)
         integer, intent(in) :: column
         integer :: first

         pattern%is_twin(column) = .false.
         if (column == 1) return
         first = pattern%column_start(column - 1) + 1
         if (pattern%is_twin(column - 1) .or. pattern%n_entries - first + 1 /= n_rows) return
         pattern%is_twin(column) = all(pattern%row(first:pattern%n_entries) == rows(:n_rows) - 1)
      end subroutine find_twin

      !> Note where the values of all elements in this column go.
      subroutine fill_slots(column)
         integer, intent(in) :: column
         integer :: u, e, first, last, each, next, k

         do u = user_start(column), user_start(column + 1) - 1
            e = owner(user(u))
            if (is_paired(e) .and. is_second(column)) cycle
            each = merge(2, 1, is_paired(e))
            first = elements%start(e)
            last = elements%start(e + 1) - 1
            next = pattern%slot_start(e) + (user(u) - first)/each*((last - first + 1)/each)
            do k = first, last, each
               if (elements%dof(k) > 0) pattern%slot(next) = place(elements%dof(k))
               next = next + 1
            end do
         end do
      end subroutine fill_slots

   end subroutine build_pattern

   !> Elements of two lists in one.
   pure function joined(first, second) result(both)
      !> The lists.
      type(element_dofs_type), intent(in) :: first, second
      type(element_dofs_type) :: both
      integer :: n

      n = first%start(first%n_elements + 1) - 1
      both%n_elements = first%n_elements + second%n_elements
      both%start = [first%start(:first%n_elements), second%start(:second%n_elements + 1) + n]
      both%dof = [first%dof(:n), second%dof(:second%start(second%n_elements + 1) - 1)]
   end function joined

   !> Add a dense element matrix to the values of a sparse one.
   pure subroutine add_element_matrix(pattern, element, matrix, values)
      !> Pattern with the scatter map.
      type(pattern_type), intent(in) :: pattern
      !> Number of the element.
      integer, intent(in) :: element
      !> Element matrix, columns first, shape (m*m).
      real(wp), intent(in) :: matrix(:)
      !> Values of the sparse matrix, shape (n_entries).
      real(wp), intent(inout) :: values(:)
      integer :: first, n_slots, k, entry

      first = pattern%slot_start(element)
      n_slots = pattern%slot_start(element + 1) - first
      if (n_slots < size(matrix)) then
         call add_pairs(pattern, nint(sqrt(real(n_slots, wp))), &
                        pattern%slot(first:first + n_slots - 1), matrix, values)
         return
      end if
      do k = 1, size(matrix)
         entry = pattern%slot(first - 1 + k)
         if (entry > 0) values(entry) = values(entry) + matrix(k)
      end do
   end subroutine add_element_matrix

   !> Add the matrix of an element of pairs.
   pure subroutine add_pairs(pattern, n, slot, matrix, values)
      type(pattern_type), intent(in) :: pattern
      !> Number of pairs.
      integer, intent(in) :: n
      !> Their slots.
      integer, intent(in) :: slot(n, n)
      !> Rows first.
      real(wp), intent(in) :: matrix(2, n, 2, n)
      real(wp), intent(inout) :: values(:)
      integer :: a, b, entry, column, beside

      do b = 1, n
         if (slot(b, b) == 0) cycle
         column = pattern%row(slot(b, b)) + 1
         beside = pattern%column_start(column + 1) - pattern%column_start(column)
         do a = 1, n
            entry = slot(a, b)
            if (entry == 0) cycle
            values(entry) = values(entry) + matrix(1, a, 1, b)
            values(entry + 1) = values(entry + 1) + matrix(2, a, 1, b)
            values(entry + beside) = values(entry + beside) + matrix(1, a, 2, b)
            values(entry + beside + 1) = values(entry + beside + 1) + matrix(2, a, 2, b)
         end do
      end do
   end subroutine add_pairs

   !> Entry at the mirrored place of every entry; empty if the pattern is not symmetric.
   pure subroutine find_mirror(pattern, mirror)
      !> The pattern, rows ascending in every column.
      type(pattern_type), intent(in) :: pattern
      !> Mirrored entries, from 1, shape (n_entries) or (0).
      integer, allocatable, intent(out) :: mirror(:)
      integer :: next(pattern%n), column, k, row

      allocate (mirror(pattern%n_entries))
      next = pattern%column_start(:pattern%n) + 1
      ! going through the columns in order meets the rows of every other column in order
      do column = 1, pattern%n
         do k = pattern%column_start(column) + 1, pattern%column_start(column + 1)
            row = pattern%row(k) + 1
            mirror(k) = next(row)
            if (next(row) > pattern%column_start(row + 1)) exit
            if (pattern%row(next(row)) + 1 /= column) exit
            next(row) = next(row) + 1
         end do
         if (k <= pattern%column_start(column + 1)) exit
      end do
      if (column <= pattern%n) mirror = mirror(:0)
   end subroutine find_mirror

   !> Matrix times vector, y = A x. Columns with the same rows, such as those of one node, go
   !> together.
   pure subroutine multiply(pattern, values, x, y)
      !> Pattern of A.
      type(pattern_type), intent(in) :: pattern
      !> Values of A, shape (n_entries).
      real(wp), intent(in) :: values(:)
      !> Vector, shape (n).
      real(wp), intent(in) :: x(:)
      !> Product, shape (n).
      real(wp), intent(out) :: y(:)
      integer :: column, k, row, next

      y = 0.0_wp
      do column = 1, pattern%n
         if (pattern%is_twin(column)) cycle
         next = 0
         if (column < pattern%n) next = merge(column + 1, 0, pattern%is_twin(column + 1))
         if (next > 0) then
            associate (m => pattern%column_start(next) - pattern%column_start(column))
               do k = pattern%column_start(column) + 1, pattern%column_start(next)
                  row = pattern%row(k) + 1
                  y(row) = y(row) + values(k)*x(column) + values(k + m)*x(next)
               end do
            end associate
         else
            do k = pattern%column_start(column) + 1, pattern%column_start(column + 1)
               row = pattern%row(k) + 1
               y(row) = y(row) + values(k)*x(column)
            end do
         end if
      end do
   end subroutine multiply

   !> For every unknown, its entries in the elements, and the element of every entry.
   pure subroutine transpose_elements(elements, n, user_start, user, owner)
      type(element_dofs_type), intent(in) :: elements
      integer, intent(in) :: n
      integer, allocatable, intent(out) :: user_start(:), user(:), owner(:)
      integer :: e, k, dof

      allocate (user_start(n + 1), source=0)
      allocate (owner(size(elements%dof)))
      do k = 1, size(elements%dof)
         if (elements%dof(k) > 0) user_start(elements%dof(k)) = user_start(elements%dof(k)) + 1
      end do
      user_start(1) = user_start(1) + 1
      do k = 2, n + 1
         user_start(k) = user_start(k) + user_start(k - 1)
      end do
      allocate (user(user_start(n + 1) - 1))
      do e = elements%n_elements, 1, -1
         do k = elements%start(e), elements%start(e + 1) - 1
            owner(k) = e
            dof = elements%dof(k)
            if (dof == 0) cycle
            user_start(dof) = user_start(dof) - 1
            user(user_start(dof)) = k
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

end module coulter_algebra_sparse
