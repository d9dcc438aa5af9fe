/* One increment with friction as an FMU solves it, for tests; a shared library. */

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "linalg.c"
#include "joint.c"
#include "contact.c"

/* A solver for a compliance S (r, r) between pairs and rows (n, r), (2 n, r) in compressed form,
 * with what laws yield D (3 n) and coefficients mu (n); NULL without memory. The arrays of the rows
 * must live as long as it. */
void *make_solver(size_t n, size_t r, const double *S, const double *normal,
                  const uint64_t *row_start, const uint64_t *column, const double *shear,
                  const uint64_t *shear_start, const uint64_t *shear_column, const double *D,
                  const double *mu)
{
    struct joint *j = calloc(1, sizeof *j);
    struct contact *c = calloc(1, sizeof *c);
    if (!j || !c)
        return NULL;
    j->n_point = n;
    j->n_relative = r;
    j->n_shear = (size_t)shear_start[2 * n];
    j->interpolation = normal;
    j->row_start = row_start;
    j->column = column;
    j->shear = shear;
    j->shear_start = shear_start;
    j->shear_column = shear_column;
    if (create_contact(c, j) != 0)
        return NULL;
    memcpy(c->S, S, r * r * sizeof *S);
    memcpy(c->D, D, 3 * n * sizeof *D);
    memcpy(c->mu, mu, n * sizeof *mu);
    renew_contact(c);
    return c;
}

/* Solve an increment from forces x (3 n); returns the residual that is left. */
double solve_increment(void *solver, const double *free_slack, double *x, double *slack)
{
    struct contact *c = solver;
    const enum contact_status status = solve_contact(c, free_slack, x);
    memcpy(slack, c->slack, c->size * sizeof *slack);
    return status == CONTACT_NOT_FINITE ? INFINITY : c->left;
}

void free_solver(void *solver)
{
    struct contact *c = solver;
    free((void *)c->joint);
    free_contact(c);
    free(c);
}
