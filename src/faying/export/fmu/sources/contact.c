/* The contact problem s = H l + g >= 0, l >= 0, l's = 0 with H = N S N' + D.
 *
 * S is the compliance between node pairs, N takes it to the contact points, D is the flexibility of
 * the penalty. The active set is found by block principal pivoting with Murty's rule as backup
 * (Judice & Pires 1994); a singular H by the proximal point iteration (Rockafellar 1976). Both are
 * those of faying.contact.active_set, with the same constants.
 *
 * Factorizations are kept until the active set changes. They are a function of the set alone, so
 * that a restored state continues with the same bits. */

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Exchanges of the whole active set without progress before single ones take over. */
#define BLOCK_ATTEMPTS 20
/* Sign violations below this fraction of the largest gap are noise, as is what round-off makes of
 * sums over the sum of their magnitudes. */
#define ROUND_OFF 1e-13
#define EPSILON 2.220446049250313e-16
/* Proximal term over the largest diagonal of H. */
#define PROXIMAL_FRACTION 1e-7
#define PROXIMAL_STEPS 200
/* Points from which systems of pairs are smaller and faster. */
#ifndef MANY_POINTS
#define MANY_POINTS 1000
#endif
/* Smallest over largest pivot below which H counts as singular (condition 1e14). */
#define SINGULAR_PIVOT 1e-7
/* Added to the diagonal of B, relative: it is singular where a facet has one active point. */
#define SINGULAR_SPRINGS 1e-12

enum contact_status { CONTACT_SOLVED, CONTACT_SINGULAR, CONTACT_UNSETTLED, CONTACT_NOT_FINITE };

struct contact {
    const struct joint *joint;
    size_t n; /* points */
    int by_pairs;
    double *H; /* (n, n) without D; nothing where systems of pairs are solved */
    double *S; /* (n_relative, n_relative); nothing where systems of points are solved */
    double *D, *diagonal; /* (n) */
    double delta; /* proximal term on the diagonal */

    /* Factorization of the last active set. */
    int factored;
    double factored_delta;
    unsigned char *factored_active;
    size_t n_active, n_touched;
    size_t *index;   /* active points */
    size_t *touched; /* pairs they touch */
    size_t *place;   /* of a pair among those touched */
    size_t *order;   /* row exchanges of an LU factorization */
    double *U;       /* of H at the active points; or LU factors of I + B S at the pairs touched */
    double *U_B;     /* of B at the pairs touched, made regular */

    double *work, *pairs, *slack, *target; /* (n), (3 n_relative), (n), (n) */
    unsigned char *wrong;
};

static void free_contact(struct contact *c)
{
    free(c->H);
    free(c->S);
    free(c->D);
    free(c->factored_active);
    free(c->index);
    free(c->U);
    memset(c, 0, sizeof *c);
}

/* Allocate for a joint; returns 0, or -1 without memory. */
static int create_contact(struct contact *c, const struct joint *joint)
{
    const size_t n = joint->n_point, r = joint->n_relative;
    memset(c, 0, sizeof *c);
    c->joint = joint;
    c->n = n;
    c->by_pairs = n >= MANY_POINTS && 2 * r <= n;
    for (size_t i = 0; i < joint->n_interface; i++)
        if (!isfinite(joint->penalty[i]))
            c->by_pairs = 0; /* B needs a penalty */
    const size_t size = c->by_pairs ? r : n;
    c->H = c->by_pairs ? NULL : malloc((n * n + 1) * sizeof *c->H);
    c->S = malloc((r * r + 1) * sizeof *c->S);
    c->D = calloc(5 * n + 3 * r + 1, sizeof *c->D);
    c->factored_active = calloc(2 * n + 1, 1);
    c->index = calloc(n + 3 * r + 1, sizeof *c->index);
    c->U = malloc(((c->by_pairs ? 2 : 1) * size * size + 1) * sizeof *c->U);
    if (!(c->H || c->by_pairs) || !c->S || !c->D || !c->factored_active || !c->index || !c->U) {
        free_contact(c);
        return -1;
    }
    c->diagonal = c->D + n;
    c->work = c->diagonal + n;
    c->slack = c->work + n;
    c->target = c->slack + n;
    c->pairs = c->target + n;
    c->wrong = c->factored_active + n;
    c->touched = c->index + n;
    c->place = c->touched + r;
    c->order = c->place + r;
    c->U_B = c->by_pairs ? c->U + size * size : NULL;
    return 0;
}

/* y += N x: gaps at points (n) from relative displacements (n_relative). */
static void add_interpolated(const struct joint *j, double *y, const double *x)
{
    for (size_t p = 0; p < j->n_point; p++)
        for (uint64_t e = j->row_start[p]; e < j->row_start[p + 1]; e++)
            y[p] += j->interpolation[e] * x[j->column[e]];
}

/* y += N'x: forces at pairs from forces at points. */
static void add_to_pairs(const struct joint *j, double *y, const double *x)
{
    for (size_t p = 0; p < j->n_point; p++)
        if (x[p] != 0.0)
            for (uint64_t e = j->row_start[p]; e < j->row_start[p + 1]; e++)
                y[j->column[e]] += j->interpolation[e] * x[p];
}

/* Set half = row p of N S. */
static void interpolate_row(const struct contact *c, double *half, size_t p)
{
    const struct joint *j = c->joint;
    memset(half, 0, j->n_relative * sizeof *half);
    for (uint64_t e = j->row_start[p]; e < j->row_start[p + 1]; e++)
        add_row(half, c->S + j->column[e] * j->n_relative, j->interpolation[e], j->n_relative);
}

/* Take over a new S (in c->S, complete) and penalty flexibilities (in c->D). */
static void renew_contact(struct contact *c)
{
    const struct joint *j = c->joint;
    c->factored = 0;
    c->delta = 0.0;
    for (size_t p = 0; p < c->n; p++) {
        interpolate_row(c, c->pairs, p);
        for (size_t q = c->by_pairs ? p : 0; q < (c->by_pairs ? p + 1 : c->n); q++) {
            double sum = 0.0;
            for (uint64_t e = j->row_start[q]; e < j->row_start[q + 1]; e++)
                sum += j->interpolation[e] * c->pairs[j->column[e]];
            if (!c->by_pairs)
                c->H[p * c->n + q] = sum;
            if (p == q)
                c->diagonal[p] = sum + c->D[p];
        }
    }
}

static double largest(const double *x, size_t n)
{
    double most = 0.0;
    for (size_t i = 0; i < n; i++)
        if (x[i] > most || -x[i] > most)
            most = x[i] > 0 ? x[i] : -x[i];
    return most;
}

static double most_of(const double *x, size_t n)
{
    double most = 0.0;
    for (size_t i = 0; i < n; i++)
        most = x[i] > most ? x[i] : most;
    return most;
}

/* Factorize H at the active points. */
static int factorize_points(struct contact *c)
{
    const size_t a = c->n_active;
    for (size_t i = 0; i < a; i++) {
        const double *row = c->H + c->index[i] * c->n;
        for (size_t k = i; k < a; k++)
            c->U[i * a + k] = row[c->index[k]];
        c->U[i * a + i] += c->D[c->index[i]] + c->delta;
    }
    return cholesky(c->U, a, SINGULAR_PIVOT);
}

/* Number the pairs that the active points touch. */
static void find_touched(struct contact *c)
{
    const struct joint *j = c->joint;
    const size_t none = j->n_relative;
    for (size_t i = 0; i < j->n_relative; i++)
        c->place[i] = none;
    for (size_t i = 0; i < c->n_active; i++)
        for (uint64_t e = j->row_start[c->index[i]]; e < j->row_start[c->index[i] + 1]; e++)
            c->place[j->column[e]] = 0;
    c->n_touched = 0;
    for (size_t i = 0; i < j->n_relative; i++)
        if (c->place[i] != none) {
            c->place[i] = c->n_touched;
            c->touched[c->n_touched++] = i;
        }
}

/* Factorize I + B S and B = N'D^-1 N of the active points, at the pairs they touch: the active gaps
 * close where the forces r at the pairs obey (I + B S) r = -N'D^-1 g. */
static int factorize_pairs(struct contact *c)
{
    const struct joint *j = c->joint;
    find_touched(c);
    const size_t t = c->n_touched;
    memset(c->U_B, 0, t * t * sizeof *c->U_B);
    memset(c->U, 0, t * t * sizeof *c->U);
    for (size_t i = 0; i < c->n_active; i++) {
        const size_t p = c->index[i];
        const double stiffness = 1.0 / c->D[p];
        double *full = c->pairs, *seen = full + j->n_relative;
        interpolate_row(c, full, p);
        for (size_t k = 0; k < t; k++)
            seen[k] = full[c->touched[k]];
        for (uint64_t e = j->row_start[p]; e < j->row_start[p + 1]; e++) {
            const size_t row = c->place[j->column[e]];
            const double force = stiffness * j->interpolation[e];
            add_row(c->U + row * t, seen, force, t);
            for (uint64_t f = j->row_start[p]; f < j->row_start[p + 1]; f++)
                c->U_B[row * t + c->place[j->column[f]]] += force * j->interpolation[f];
        }
    }
    for (size_t i = 0; i < t; i++) {
        c->U[i * t + i] += 1.0;
        c->U_B[i * t + i] *= 1.0 + SINGULAR_SPRINGS;
    }
    return cholesky(c->U_B, t, 0.0) != 0 || factorize_lu(c->U, t, c->order) != 0 ? -1 : 0;
}

/* Factorize for an active set unless that is the last one. */
static int factorize_active(struct contact *c, const unsigned char *active)
{
    if (c->factored && c->factored_delta == c->delta
        && memcmp(active, c->factored_active, c->n) == 0)
        return 0;
    c->factored = 0;
    c->n_active = 0;
    for (size_t p = 0; p < c->n; p++)
        if (active[p])
            c->index[c->n_active++] = p;
    if ((c->by_pairs ? factorize_pairs(c) : factorize_points(c)) != 0)
        return -1;
    memcpy(c->factored_active, active, c->n);
    c->factored_delta = c->delta;
    c->factored = 1;
    return 0;
}

/* slack = H l + g with H = N S N' + D + delta. */
static void multiply(struct contact *c, double *slack, const double *forces, const double *gap)
{
    const size_t r = c->joint->n_relative;
    for (size_t p = 0; p < c->n; p++)
        slack[p] = gap[p] + (c->D[p] + c->delta) * forces[p];
    if (!c->by_pairs) {
        for (size_t p = 0; p < c->n; p++)
            if (forces[p] != 0.0)
                add_row(slack, c->H + p * c->n, forces[p], c->n);
        return;
    }
    memset(c->pairs, 0, 2 * r * sizeof *c->pairs);
    add_to_pairs(c->joint, c->pairs, forces);
    for (size_t i = 0; i < r; i++)
        if (c->pairs[i] != 0.0)
            add_row(c->pairs + r, c->S + i * r, c->pairs[i], r);
    add_interpolated(c->joint, slack, c->pairs + r);
}

/* Gap (before contact) of an active point that displacements of the pairs touched add to. */
static double opened(const struct contact *c, size_t p, const double *moved)
{
    const struct joint *j = c->joint;
    double sum = 0.0;
    for (uint64_t e = j->row_start[p]; e < j->row_start[p + 1]; e++)
        sum += j->interpolation[e] * moved[c->place[j->column[e]]];
    return sum;
}

/* y += N'x at the pairs touched, for the active points; x as a function of the point in c->work. */
static void add_to_touched(const struct contact *c, double *y)
{
    const struct joint *j = c->joint;
    for (size_t i = 0; i < c->n_active; i++)
        for (uint64_t e = j->row_start[c->index[i]]; e < j->row_start[c->index[i] + 1]; e++)
            y[c->place[j->column[e]]] += j->interpolation[e] * c->work[c->index[i]];
}

/* Forces of the active points by way of the pairs they touch. */
static void close_by_pairs(struct contact *c, const double *gap, double *forces)
{
    const size_t r = c->joint->n_relative, t = c->n_touched;
    double *missing = c->pairs, *change = missing + r, *moved = change + r;
    memset(change, 0, t * sizeof *change);
    for (size_t i = 0; i < c->n_active; i++)
        c->work[c->index[i]] = -gap[c->index[i]] / c->D[c->index[i]];
    add_to_touched(c, change);
    memcpy(missing, change, t * sizeof *missing);
    solve_lu(c->U, t, c->order, change);
    /* Displacements y of the pairs from B y = b - r: y = S r would lose as many digits as the
     * structure is softer than the penalty. Twice, for B was made regular. */
    for (size_t i = 0; i < t; i++)
        missing[i] -= change[i];
    memcpy(moved, missing, t * sizeof *moved);
    solve_cholesky(c->U_B, t, moved);
    for (size_t i = 0; i < c->n_active; i++)
        c->work[c->index[i]] = -opened(c, c->index[i], moved) / c->D[c->index[i]];
    add_to_touched(c, missing);
    solve_cholesky(c->U_B, t, missing);
    add_row(moved, missing, 1.0, t);
    for (size_t i = 0; i < c->n_active; i++) {
        const size_t p = c->index[i];
        forces[p] = -(gap[p] + opened(c, p, moved)) / c->D[p];
    }
}

/* Forces that close the active gaps, and the slack of all points. */
static int equilibrate(struct contact *c, const double *gap, const unsigned char *active,
                       double *forces, double *slack)
{
    if (factorize_active(c, active) != 0)
        return -1;
    memset(forces, 0, c->n * sizeof *forces);
    if (c->by_pairs) {
        close_by_pairs(c, gap, forces);
    } else {
        for (size_t i = 0; i < c->n_active; i++)
            c->work[i] = -gap[c->index[i]];
        solve_cholesky(c->U, c->n_active, c->work);
        for (size_t i = 0; i < c->n_active; i++)
            forces[c->index[i]] = c->work[i];
    }
    multiply(c, slack, forces, gap);
    for (size_t i = 0; i < c->n_active; i++)
        slack[c->index[i]] = 0.0;
    return 0;
}

/* What round-off makes of gaps that vanish, over the root of the diagonal. */
static double summed(const struct contact *c, const double *forces)
{
    double sum = 0.0;
    for (size_t p = 0; p < c->n; p++)
        sum += sqrt(c->diagonal[p] + c->delta) * fabs(forces[p]);
    return EPSILON * sum;
}

/* Mark points with a wrong sign; returns how many there are. */
static size_t find_wrong(struct contact *c, const unsigned char *active, const double *forces,
                         const double *slack, double least)
{
    const double sum = summed(c, forces);
    size_t count = 0;
    for (size_t p = 0; p < c->n; p++) {
        const double own = c->diagonal[p] + c->delta;
        const double noise = fmax(sum * sqrt(own), least);
        c->wrong[p] = active[p] ? forces[p] < -noise / own : slack[p] < -noise;
        count += c->wrong[p];
    }
    return count;
}

static void exchange(struct contact *c, unsigned char *active, int last_only)
{
    for (size_t p = c->n; p-- > 0;)
        if (c->wrong[p]) {
            active[p] = !active[p];
            if (last_only)
                return;
        }
}

static enum contact_status pivot(struct contact *c, const double *gap, unsigned char *active,
                                 double *forces)
{
    const double noise = ROUND_OFF * largest(gap, c->n);
    size_t fewest = c->n + 1;
    int attempts = BLOCK_ATTEMPTS;
    for (size_t iteration = 0; iteration < 50 * c->n + 200; iteration++) {
        if (equilibrate(c, gap, active, forces, c->slack) != 0)
            return CONTACT_SINGULAR;
        const size_t count = find_wrong(c, active, forces, c->slack, noise);
        if (count == 0) {
            for (size_t p = 0; p < c->n; p++)
                forces[p] = forces[p] > 0.0 ? forces[p] : 0.0;
            return CONTACT_SOLVED;
        }
        if (count < fewest) {
            fewest = count;
            attempts = BLOCK_ATTEMPTS;
            exchange(c, active, 0);
        } else if (attempts > 0) {
            attempts--;
            exchange(c, active, 0);
        } else {
            exchange(c, active, 1);
        }
    }
    return CONTACT_UNSETTLED;
}

static enum contact_status proximal_point(struct contact *c, const double *gap,
                                          unsigned char *active, double *forces, double *last)
{
    const double tolerance = ROUND_OFF * largest(gap, c->n);
    c->delta = PROXIMAL_FRACTION * most_of(c->diagonal, c->n);
    memset(last, 0, c->n * sizeof *last);
    for (int step = 0; step < PROXIMAL_STEPS; step++) {
        for (size_t p = 0; p < c->n; p++)
            c->target[p] = gap[p] - c->delta * last[p];
        const enum contact_status status = pivot(c, c->target, active, forces);
        if (status != CONTACT_SOLVED)
            return status;
        double change = 0.0;
        for (size_t p = 0; p < c->n; p++) {
            const double moved = forces[p] > last[p] ? forces[p] - last[p] : last[p] - forces[p];
            change = moved > change ? moved : change;
        }
        memcpy(last, forces, c->n * sizeof *last);
        const double noise = summed(c, forces) * sqrt(most_of(c->diagonal, c->n) + c->delta);
        if (c->delta * change <= fmax(tolerance, noise))
            return CONTACT_SOLVED;
    }
    return CONTACT_UNSETTLED;
}

/* Solve for the forces that a gap (n) calls up, from a guess of the active points.
 * ``last`` (n) is room for a former iterate. */
static enum contact_status solve_contact(struct contact *c, const double *gap,
                                         unsigned char *active, double *forces, double *last)
{
    if (!are_finite(gap, c->n))
        return CONTACT_NOT_FINITE;
    unsigned char *start = (unsigned char *)last;
    memcpy(start, active, c->n);
    c->delta = 0.0;
    enum contact_status status = pivot(c, gap, active, forces);
    if (status != CONTACT_SINGULAR)
        return status;
    memcpy(active, start, c->n);
    status = proximal_point(c, gap, active, forces, last);
    c->delta = 0.0;
    return status;
}
