/* Sparse Cholesky factorisation by CHOLMOD (SuiteSparse), behind plain arrays and a handle.
 * CHOLMOD's own interface passes structures that Fortran cannot declare; this file does no more
 * than fill them.
 * SPDX-License-Identifier: BSD-3-Clause
 */
#include <cholmod.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
   cholmod_common common;
   cholmod_sparse matrix;
   cholmod_factor *factor;
   cholmod_dense *answer, *work[2]; /* kept from solve to solve */
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
   cholmod_free_dense(&self->answer, &self->common);
   cholmod_free_dense(&self->work[0], &self->common);
   cholmod_free_dense(&self->work[1], &self->common);
   cholmod_finish(&self->common);
   free(self->matrix.p);
   free(self->matrix.i);
   free(self);
}

/* Analyse a symmetric pattern in compressed columns, zero-based, rows ascending; the values above
 * the diagonal are never read. An elimination order may be given. NULL on failure. */
cholesky *coulter_cholesky_new(int n, const int *column_start, const int *row, const int *order)
{
   cholesky *self = calloc(1, sizeof *self);
   if (!self) return NULL;
   int n_entries = column_start[n], levels = forbid_threads();
   cholmod_start(&self->common);
   self->common.print = 0;
   self->common.supernodal = CHOLMOD_SUPERNODAL; /* simplicial LDL' passes over indefiniteness */
   self->common.nmethods = 1;
   self->common.method[0].ordering = order ? CHOLMOD_GIVEN : CHOLMOD_AMD;
   self->common.postorder = 1;
   self->matrix = (cholmod_sparse){
      .nrow = n, .ncol = n, .nzmax = n_entries, .stype = -1, .itype = CHOLMOD_INT,
      .xtype = CHOLMOD_REAL, .dtype = CHOLMOD_DOUBLE, .sorted = 1, .packed = 1,
      .p = malloc((n + 1) * sizeof(int)), .i = malloc((n_entries + 1) * sizeof(int))};
   if (self->matrix.p && self->matrix.i) {
      memcpy(self->matrix.p, column_start, (n + 1) * sizeof(int));
      memcpy(self->matrix.i, row, n_entries * sizeof(int));
      self->matrix.xtype = CHOLMOD_PATTERN;
      self->factor = cholmod_analyze_p(&self->matrix, (int *)order, NULL, 0, &self->common);
      self->matrix.xtype = CHOLMOD_REAL;
   }
   omp_set_max_active_levels(levels);
   if (!self->factor) {
      coulter_cholesky_free(self);
      return NULL;
   }
   return self;
}

/* Factorise values of the analysed pattern: 0 done, 1 not positive definite, 2 out of memory. */
int coulter_cholesky_factorise(cholesky *self, double *values)
{
   int levels = forbid_threads();
   self->matrix.x = values;
   int is_done = cholmod_factorize(&self->matrix, self->factor, &self->common);
   self->matrix.x = NULL;
   omp_set_max_active_levels(levels);
   if (!is_done || self->common.status < 0) return 2;
   return self->factor->minor < self->factor->n;
}

/* Solve with the factor: 0 done, 2 out of memory. */
int coulter_cholesky_solve(cholesky *self, double *b, double *x)
{
   int n = (int)self->matrix.nrow, levels = forbid_threads();
   cholmod_dense right = {.nrow = n, .ncol = 1, .nzmax = n, .d = n, .x = b,
                          .xtype = CHOLMOD_REAL, .dtype = CHOLMOD_DOUBLE};
   int is_done = cholmod_solve2(CHOLMOD_A, self->factor, &right, NULL, &self->answer, NULL,
                                &self->work[0], &self->work[1], &self->common);
   omp_set_max_active_levels(levels);
   if (!is_done) return 2;
   memcpy(x, self->answer->x, n * sizeof(double));
   return 0;
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
