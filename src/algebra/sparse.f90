!> Sparse matrices in compressed columns, and the map by which element matrices enter them.
! SPDX-License-Identifier: BSD-3-Clause
module coulter_algebra_sparse
   use, intrinsic :: iso_c_binding, only: c_int
   use coulter_base_kinds, only: wp
   implicit none(type, external)
   private
   public :: element_dofs_type, pattern_type, add_element_matrix, add_blocks, add_twice, &
      multiply, find_mirror, joined

   !> The unknowns that every element couples, in ragged rows.
   type :: element_dofs_type
      !> Number of elements.
      integer :: n_elements = 0
      !> First entry of every element in `dof`, shape (n_elements + 1).
      integer, allocatable :: start(:)
      !> Unknowns from 1, or 0 for a degree of freedom that is not unknown, shape (n_entries).
      integer, allocatable :: dof(:)
      !> How many of them, the first ones, are the columns of an element; all of them are its rows.
      !> Shape (n_elements); unallocated where all elements are square.
      integer, allocatable :: n_columns(:)
   contains
      procedure :: columns_of
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

   !> Elements of two lists in one.
   pure function joined(first, second) result(both)
      !> The lists.
      type(element_dofs_type), intent(in) :: first, second
      type(element_dofs_type) :: both
      integer :: n, e

      n = first%start(first%n_elements + 1) - 1
      both%n_elements = first%n_elements + second%n_elements
      both%start = [first%start(:first%n_elements), second%start(:second%n_elements + 1) + n]
      both%dof = [first%dof(:n), second%dof(:second%start(second%n_elements + 1) - 1)]
      if (.not. (allocated(first%n_columns) .or. allocated(second%n_columns))) return
      both%n_columns = [(first%columns_of(e), e=1, first%n_elements), &
                        (second%columns_of(e), e=1, second%n_elements)]
   end function joined

   !> Number of columns of an element.
   pure function columns_of(self, element) result(n)
      class(element_dofs_type), intent(in) :: self
      !> Number of the element.
      integer, intent(in) :: element
      integer :: n

      if (allocated(self%n_columns)) then
         n = self%n_columns(element)
      else
         n = self%start(element + 1) - self%start(element)
      end if
   end function columns_of

   !> Add a dense element matrix to the values of a sparse one.
   pure subroutine add_element_matrix(pattern, element, matrix, values)
      !> Pattern with the scatter map.
      type(pattern_type), intent(in) :: pattern
      !> Number of the element.
      integer, intent(in) :: element
      !> Element matrix, columns first, shape (n_rows*n_columns).
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

   !> Add the matrix of a square element of pairs.
   pure subroutine add_pairs(pattern, n, slot, matrix, values)
      type(pattern_type), intent(in) :: pattern
      !> Number of pairs.
      integer, intent(in) :: n
      !> Their slots.
      integer, intent(in) :: slot(n, n)
      !> Rows first.
      real(wp), intent(in) :: matrix(2, n, 2, n)
      real(wp), intent(inout) :: values(:)
      integer :: a, b, entry, beside

      do b = 1, n
         if (slot(b, b) == 0) cycle
         beside = column_length(pattern, slot(b, b))
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

   !> Add the matrix of one component to both components of the pairs of a square element.
   pure subroutine add_twice(pattern, element, n, matrix, values)
      !> Pattern with the scatter map.
      type(pattern_type), intent(in) :: pattern
      !> Number of the element, and of its pairs.
      integer, intent(in) :: element, n
      !> Matrix of one component.
      real(wp), intent(in) :: matrix(n, n)
      !> Values of the sparse matrix, shape (n_entries).
      real(wp), intent(inout) :: values(:)
      integer :: first, a, b, entry, beside

      first = pattern%slot_start(element) - 1
      if (pattern%slot_start(element + 1) - first - 1 > n*n) then
         call add_element_matrix(pattern, element, on_both(matrix), values)
         return
      end if
      do b = 1, n
         entry = pattern%slot(first + b + n*(b - 1))
         if (entry == 0) cycle
         beside = column_length(pattern, entry)
         do a = 1, n
            entry = pattern%slot(first + a + n*(b - 1))
            if (entry == 0) cycle
            values(entry) = values(entry) + matrix(a, b)
            values(entry + beside + 1) = values(entry + beside + 1) + matrix(a, b)
         end do
      end do
   end subroutine add_twice

   !> The matrix of one component on both, columns first; components do not mix.
   pure function on_both(single) result(matrix)
      real(wp), intent(in) :: single(:, :)
      real(wp) :: matrix(4*size(single))
      integer :: a, b, n, first

      n = size(single, 1)
      matrix = 0.0_wp
      do b = 1, n
         do a = 1, n
            first = 2*a - 1 + 4*n*(b - 1)
            matrix(first) = single(a, b)
            matrix(first + 2*n + 1) = single(a, b)
         end do
      end do
   end function on_both

   !> Number of rows of the column with a diagonal entry.
   pure function column_length(pattern, diagonal) result(n)
      type(pattern_type), intent(in) :: pattern
      !> The entry.
      integer, intent(in) :: diagonal
      integer :: n

      associate (column => pattern%row(diagonal) + 1)
         n = pattern%column_start(column + 1) - pattern%column_start(column)
      end associate
   end function column_length

   !> Add an element matrix of blocks that belong to pairs of unknowns.
   pure subroutine add_blocks(pattern, element, n, m, block, values)
      !> Pattern with the scatter map.
      type(pattern_type), intent(in) :: pattern
      !> Number of the element.
      integer, intent(in) :: element
      !> Pairs of its rows, and of its columns, which are the first rows.
      integer, intent(in) :: n, m
      !> Matrix, shape (component, component of the column, n, m).
      real(wp), intent(in) :: block(2, 2, n, m)
      !> Values of the sparse matrix, shape (n_entries).
      real(wp), intent(inout), contiguous :: values(:)
      integer :: first, a, b, k, entry, beside

      first = pattern%slot_start(element) - 1
      if (pattern%slot_start(element + 1) - first - 1 > n*m) then
         call add_element_matrix(pattern, element, &
                                 [((block(:, k, :, b), k=1, 2), b=1, m)], values)
         return
      end if
      do b = 1, m
         ! its own row is on the diagonal
         entry = pattern%slot(first + b)
         if (entry > 0) then
            beside = column_length(pattern, entry)
            do a = 1, n
               entry = pattern%slot(first + a)
               if (entry == 0) cycle
               values(entry) = values(entry) + block(1, 1, a, b)
               values(entry + 1) = values(entry + 1) + block(2, 1, a, b)
               values(entry + beside) = values(entry + beside) + block(1, 2, a, b)
               values(entry + beside + 1) = values(entry + beside + 1) + block(2, 2, a, b)
            end do
         end if
         first = first + n
      end do
   end subroutine add_blocks

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
      integer :: column, k, row, next, m

      y = 0.0_wp
      do column = 1, pattern%n
         if (pattern%is_twin(column)) cycle
         next = 0
         if (column < pattern%n) next = merge(column + 1, 0, pattern%is_twin(column + 1))
         if (next > 0) then
            m = pattern%column_start(next) - pattern%column_start(column)
            do k = pattern%column_start(column) + 1, pattern%column_start(next)
               row = pattern%row(k) + 1
               y(row) = y(row) + values(k)*x(column) + values(k + m)*x(next)
            end do
         else
            do k = pattern%column_start(column) + 1, pattern%column_start(column + 1)
               row = pattern%row(k) + 1
               y(row) = y(row) + values(k)*x(column)
            end do
         end if
      end do
   end subroutine multiply

end module coulter_algebra_sparse
