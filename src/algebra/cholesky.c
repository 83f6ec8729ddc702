/* Sparse Cholesky factorisation by CHOLMOD (SuiteSparse), behind plain arrays and a handle.
 * CHOLMOD's own interface passes structures that Fortran cannot declare; this file does no more
 * than fill them.
 * SPDX-License-Identifier: BSD-3-Clause
 */
#include <cholmod.h>
#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* CHOLMOD would permute a matrix and transpose it twice for every factorisation. Here the lower
 * triangle of the permuted matrix is gathered at once, and the factor believes in natural order. */
typedef struct {
   cholmod_common common;
   cholmod_sparse matrix;  /* lower triangle of the symmetric part, permuted */
   cholmod_factor *factor;
   int *order;             /* unknown of every permuted one */
   int *entry[2];          /* entries whose mean is that of the triangle */
   double *right;          /* permuted right-hand side */
   double *work;           /* of solves */
} cholesky;

/* CHOLMOD of SuiteSparse 5 asks for four threads whatever the caller wants; its fronts are too
 * small for them. */
static int forbid_threads(void)
{
   int levels = omp_get_max_active_levels();
   omp_set_max_active_levels(0);
   return levels;
}

void coulter_cholesky_free(cholesky *self)
{
   if (!self) return;
   cholmod_free_factor(&self->factor, &self->common);
   cholmod_finish(&self->common);
   free(self->matrix.p);
   free(self->matrix.i);
   free(self->matrix.x);
   free(self->order);
   free(self->entry[0]);
   free(self->entry[1]);
   free(self->right);
   free(self->work);
   free(self);
}

/* Elimination order by minimum degree. Columns with the rows of the one before, such as those of one
 * node, stay together: the same order comes out of a graph of a quarter of the entries. NULL when
 * memory runs out. */
static int *find_order(cholesky *self, const cholmod_sparse *pattern)
{
   int n = (int)pattern->ncol, n_groups = 0, n_entries = 0;
   const int *start = pattern->p, *row = pattern->i;
   int *first = malloc((n + 1) * sizeof(int)), *group = malloc(n * sizeof(int));
   int *order = malloc(n * sizeof(int)), *group_order = malloc(n * sizeof(int));
   int *group_start = malloc((n + 1) * sizeof(int)), *group_row = malloc(start[n] * sizeof(int));
   int is_done = first && group && order && group_order && group_start && group_row;
   for (int j = 0; is_done && j < n; j++) {
      int length = start[j + 1] - start[j];
      int is_twin = j > 0 && length == start[j] - start[j - 1]
         && !memcmp(row + start[j], row + start[j - 1], length * sizeof(int));
      if (!is_twin) first[n_groups++] = j;
      group[j] = n_groups - 1;
   }
   for (int g = 0; is_done && g < n_groups; g++) {
      group_start[g] = n_entries;
      for (int k = start[first[g]]; k < start[first[g] + 1]; k++)
         if (row[k] == first[group[row[k]]]) group_row[n_entries++] = group[row[k]];
   }
   if (is_done) {
      first[n_groups] = n;
      group_start[n_groups] = n_entries;
      cholmod_sparse graph = *pattern;
      graph.nrow = graph.ncol = n_groups;
      graph.nzmax = n_entries;
      graph.p = group_start;
      graph.i = group_row;
      is_done = cholmod_amd(&graph, NULL, 0, group_order, &self->common);
   }
   for (int g = 0, next = 0; is_done && g < n_groups; g++)
      for (int j = first[group_order[g]]; j < first[group_order[g] + 1]; j++) order[next++] = j;
   free(first);
   free(group);
   free(group_order);
   free(group_start);
   free(group_row);
   if (is_done) return order;
   free(order);
   return NULL;
}

/* Room for the permuted triangle and vectors. */
static int make_room(cholesky *self, size_t n, size_t n_entries)
{
   self->matrix = (cholmod_sparse){
      .nrow = n, .ncol = n, .nzmax = n_entries, .stype = -1, .itype = CHOLMOD_INT,
      .xtype = CHOLMOD_REAL, .dtype = CHOLMOD_DOUBLE, .sorted = 0, .packed = 1,
      .p = calloc(n + 1, sizeof(int)), .i = malloc(n_entries * sizeof(int)),
      .x = malloc(n_entries * sizeof(double))};
   self->order = malloc(n * sizeof(int));
   self->entry[0] = malloc(n_entries * sizeof(int));
   self->entry[1] = malloc(n_entries * sizeof(int));
   self->right = malloc(n * sizeof(double));
   self->work = malloc(n * sizeof(double));
   return self->matrix.p && self->matrix.i && self->matrix.x && self->order && self->entry[0]
      && self->entry[1] && self->right && self->work;
}

/* Lower triangle in an elimination order, and where its values come from. */
static void permute(cholesky *self, const int *order, const int *column_start, const int *row,
                    const int *mirror)
{
   int n = (int)self->matrix.ncol, *place = self->common.Iwork;
   int *start = self->matrix.p, *index = self->matrix.i;
   memcpy(self->order, order, n * sizeof(int));
   for (int k = 0; k < n; k++) place[self->order[k]] = k;
   for (int j = 0; j < n; j++)
      for (int k = column_start[j]; k < column_start[j + 1]; k++)
         if (place[row[k]] >= place[j]) start[place[j] + 1]++;
   for (int k = 0; k < n; k++) start[k + 1] += start[k];
   for (int j = 0; j < n; j++) {
      int next = start[place[j]];
      for (int k = column_start[j]; k < column_start[j + 1]; k++) {
         if (place[row[k]] < place[j]) continue;
         index[next] = place[row[k]];
         self->entry[0][next] = k;
         self->entry[1][next++] = mirror[k] - 1;
      }
   }
   self->matrix.nzmax = start[n];
}

/* Find order and pattern of the factor. Minimum degree leaves the tree of columns in postorder, so
 * that the matrix can be permuted first; an order that is given becomes so while it is analysed. */
static int analyse(cholesky *self, cholmod_sparse *pattern, const int *mirror, const int *order)
{
   self->common.supernodal = CHOLMOD_SUPERNODAL; /* simplicial LDL' passes over indefiniteness */
   self->common.nmethods = 1;
   self->common.method[0].ordering = order ? CHOLMOD_GIVEN : CHOLMOD_NATURAL;
   self->common.postorder = order != NULL;
   if (order) {
      self->factor = cholmod_analyze_p(pattern, (int *)order, NULL, 0, &self->common);
      if (!self->factor) return 0;
      permute(self, self->factor->Perm, pattern->p, pattern->i, mirror);
      self->factor->ordering = CHOLMOD_NATURAL;
   } else {
      int *found = find_order(self, pattern);
      if (!found) return 0;
      permute(self, found, pattern->p, pattern->i, mirror);
      free(found);
      self->factor = cholmod_analyze(&self->matrix, &self->common);
   }
   return self->factor != NULL;
}

/* Analyse a symmetric pattern in compressed columns, zero-based, rows ascending, with the mirrored
 * place of every entry, from 1. An elimination order may be given. NULL on failure. */
cholesky *coulter_cholesky_new(int n, const int *column_start, const int *row, const int *mirror,
                               const int *order)
{
   cholesky *self = calloc(1, sizeof *self);
   if (!self) return NULL;
   size_t n_entries = column_start[n];
   cholmod_sparse pattern = {
      .nrow = n, .ncol = n, .nzmax = n_entries, .stype = -1, .itype = CHOLMOD_INT,
      .xtype = CHOLMOD_PATTERN, .dtype = CHOLMOD_DOUBLE, .sorted = 1, .packed = 1,
      .p = (int *)column_start, .i = (int *)row};
   int levels = forbid_threads();
   cholmod_start(&self->common);
   self->common.print = 0;
   int is_done = make_room(self, n, (n_entries + n + 1) / 2)
      && cholmod_allocate_work(0, n, 0, &self->common) && analyse(self, &pattern, mirror, order);
   omp_set_max_active_levels(levels);
   if (is_done) return self;
   coulter_cholesky_free(self);
   return NULL;
}

/* Gather the symmetric part of a matrix in permuted order: half the largest difference of mirrored
 * entries over the largest one. */
static double gather(cholesky *self, const double *values)
{
   double *mean = self->matrix.x, largest = 0, skew = 0;
   const int *first = self->entry[0], *second = self->entry[1];
   for (size_t k = 0; k < self->matrix.nzmax; k++) {
      double a = values[first[k]], b = values[second[k]], size = fabs(a), gap = fabs(a - b);
      mean[k] = 0.5 * (a + b);
      if (size > largest) largest = size;
      if (gap > skew) skew = gap;
   }
   return largest > 0 ? 0.5 * skew / largest : 0;
}

/* Factorise the symmetric part of a matrix of the analysed pattern: 0 done, 1 not positive definite,
 * 2 out of memory. Its skew part over its largest entry is told. */
int coulter_cholesky_factorise(cholesky *self, const double *values, double *skewness)
{
   int levels = forbid_threads();
   *skewness = gather(self, values);
   int is_done = cholmod_factorize(&self->matrix, self->factor, &self->common);
   omp_set_max_active_levels(levels);
   if (!is_done || self->common.status < 0) return 2;
   return self->factor->minor < self->factor->n;
}

/* Solve with the factor: 0 done, 2 out of memory. */
int coulter_cholesky_solve(cholesky *self, const double *b, double *x)
{
   size_t n = self->matrix.nrow;
   int levels = forbid_threads();
   cholmod_dense right = {.nrow = n, .ncol = 1, .nzmax = n, .d = n, .x = self->right,
                          .xtype = CHOLMOD_REAL, .dtype = CHOLMOD_DOUBLE};
   cholmod_dense work = right;
   work.x = self->work;
   for (size_t k = 0; k < n; k++) self->right[k] = b[self->order[k]];
   int is_done = cholmod_super_lsolve(self->factor, &right, &work, &self->common)
      && cholmod_super_ltsolve(self->factor, &right, &work, &self->common);
   for (size_t k = 0; k < n; k++) x[self->order[k]] = self->right[k];
   omp_set_max_active_levels(levels);
   return is_done ? 0 : 2;
}

/* Smallest over largest pivot of the factor. */
double coulter_cholesky_pivot_ratio(cholesky *self)
{
   return cholmod_rcond(self->factor, &self->common);
}

/* Bytes that the factor occupies. */
long long coulter_cholesky_bytes(const cholesky *self)
{
   return (long long)self->factor->xsize * (long long)sizeof(double);
}

/* Operations of a factorisation over entries of the factor. */
double coulter_cholesky_intensity(const cholesky *self)
{
   return self->common.lnz > 0 ? self->common.fl / self->common.lnz : 0;
}
