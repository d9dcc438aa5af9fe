/* Contact at the points of a joint, with or without friction.
 *
 * With the compliance S between pairs, the rows G that take displacements of pairs to gaps and
 * tangential displacements at the points, and ``free``, which holds these without contact forces,
 * less the slip so far, points move by z = free + G S p under forces p between pairs. Laws answer
 * x = admissible(-z / Y), where points yield Y per force, and a problem is
 *
 *     R(p) = p - G'x(free + G S p) = 0.                                                      (F8)
 *
 * A Newton step solves (I + G'K G S) dp = -R, K = -dx/dz, and is taken as far as S dp R vanishes
 * along it. Where a law does not yield, points yield d besides, about forces x_k of the stage
 * before, as often as it takes until these stay the same:
 *
 *     x = admissible((d x_k - z) / (D + d)).                                                (F1a)
 *
 * Methods and constants are those of faying.contact.newton_descent and faying.contact.augmented.
 * Vectors of points have all normal components, then, with friction, those along all first
 * tangents, then along all second ones. Factors are kept until K changes, of which they are a
 * function, so that a restored state continues with the same bits. */

#include <float.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Residual of a Newton step over the largest force at which a problem is solved, and which is
 * accepted where round-off allows no less. */
#define NEWTON_ROUND_OFF 2e-15
#define SOLVED 1e-9
#ifndef NEWTON_STEPS
#define NEWTON_STEPS 100
#endif
/* Parts of slope or residual that a whole step, or one of another length, may leave. */
#define LARGEST_REMAINDER 0.5
#define FLAT 0.1
#define LENGTH_TRIALS 8
/* Length of a step below which the next one fixes friction bounds; how many may be as short. */
#define SHORT_STEP 0.15
#define MOST_SHORT 8
/* Share of the forces before below which the largest force is no measure. */
#define SMALLEST_FORCE_SHARE 1e-4
/* What tangential forces are scaled by, so that points at their bound slip on at first. */
#define SLIP_ON_SCALE (1.0 + 1e-9)
/* Stages: what the structure yields at a point over d, from level to level and usually; changes of
 * forces over the largest one, and over the change before. */
#define SOFTEST 0.1
#define N_LEVEL 9
#define USUAL_LEVEL 4
#define STAGES 40
#define STAGE_ROUND_OFF 1e-12
#define SMALL_CHANGE 0.1
#define SLOW_CHANGE 0.3
#define SETTLED_CHANGE 1e-6
/* Part of its bound by which a tangential force is less where a point sticks. */
#define ON_THE_BOUND 1e-6

enum contact_status { CONTACT_SOLVED, CONTACT_UNSETTLED, CONTACT_NOT_FINITE };

/* Vectors of points and of pairs that a solver has room for. */
#define POINT_VECTORS 9
#define PAIR_VECTORS 7

struct contact {
    const struct joint *joint;
    size_t n, size;            /* points; components of force at all of them */
    double *S;                 /* (n_relative, n_relative) */
    double *mu;                /* (n) */
    double *D, *own;           /* (size) what laws and structure yield at points */
    double *slack;             /* (size) gaps and slip of the last solution */
    double left;               /* residual of the last solution, over the largest force */
    size_t worst;              /* the point whose force changed most in the last stage */

    double *yields;            /* (size) Y */
    double *z, *moved;         /* (size) where points are, and how a step moves them */
    double *found, *tried, *tried_z; /* (size) */
    double *K, *factored_K;    /* (n, 3, 3) */
    double *M, *B;             /* (n_touched, n_touched) factors of I + B S, and B = G'K G */
    double *p, *dp, *dy, *rest, *tried_rest, *right, *known; /* (n_relative) */
    size_t n_touched, *touched, *place, *order;              /* (n_relative) */
    int is_factored;
};

static void free_contact(struct contact *c)
{
    free(c->S);
    free(c->mu);
    free(c->touched);
    memset(c, 0, sizeof *c);
}

/* Allocate for a joint; returns 0, or -1 without memory. */
static int create_contact(struct contact *c, const struct joint *joint)
{
    const size_t n = joint->n_point, r = joint->n_relative, size = n_component(joint) * n;
    memset(c, 0, sizeof *c);
    c->joint = joint;
    c->n = n;
    c->size = size;
    c->S = malloc((3 * r * r + 1) * sizeof *c->S);
    c->mu = calloc(n + POINT_VECTORS * size + 18 * n + PAIR_VECTORS * r + 1, sizeof *c->mu);
    c->touched = calloc(3 * r + 1, sizeof *c->touched);
    if (!c->S || !c->mu || !c->touched) {
        free_contact(c);
        return -1;
    }
    c->M = c->S + r * r;
    c->B = c->M + r * r;
    double **of_points[POINT_VECTORS] = {&c->D,     &c->own,   &c->slack, &c->yields, &c->z,
                                         &c->moved, &c->found, &c->tried, &c->tried_z};
    double **of_pairs[PAIR_VECTORS] = {&c->p,          &c->dp,    &c->dy,   &c->rest,
                                       &c->tried_rest, &c->right, &c->known};
    double *place = c->mu + n;
    for (size_t i = 0; i < POINT_VECTORS; i++, place += size)
        *of_points[i] = place;
    for (size_t i = 0; i < PAIR_VECTORS; i++, place += r)
        *of_pairs[i] = place;
    c->K = place;
    c->factored_K = place + 9 * n;
    c->place = c->touched + r;
    c->order = c->place + r;
    return 0;
}

/* ---- between pairs and points ---- */

/* One row of G: a component at a point from the pairs. */
struct row {
    size_t n;
    const double *value;
    const uint64_t *column;
};

static struct row row_of(const struct joint *j, size_t component, size_t point)
{
    const size_t i = component ? (component - 1) * j->n_point + point : point;
    const uint64_t *start = component ? j->shear_start : j->row_start;
    const size_t first = (size_t)start[i];
    const struct row row = {(size_t)start[i + 1] - first,
                            (component ? j->shear : j->interpolation) + first,
                            (component ? j->shear_column : j->column) + first};
    return row;
}

/* y += G u: at the points from displacements of the pairs. */
static void add_at_points(const struct joint *j, double *y, const double *u)
{
    for (size_t c = 0; c < n_component(j); c++)
        for (size_t p = 0; p < j->n_point; p++) {
            const struct row row = row_of(j, c, p);
            for (size_t e = 0; e < row.n; e++)
                y[c * j->n_point + p] += row.value[e] * u[row.column[e]];
        }
}

/* y += factor G'x: forces at the pairs from forces at the points. */
static void add_at_pairs(const struct joint *j, double *y, double factor, const double *x)
{
    for (size_t c = 0; c < n_component(j); c++)
        for (size_t p = 0; p < j->n_point; p++) {
            const struct row row = row_of(j, c, p);
            const double force = factor * x[c * j->n_point + p];
            for (size_t e = 0; e < row.n && force != 0.0; e++)
                y[row.column[e]] += row.value[e] * force;
        }
}

/* way = G S G'x. */
static void give_way_to(struct contact *c, double *way, const double *x)
{
    const size_t r = c->joint->n_relative;
    memset(c->right, 0, r * sizeof(double));
    add_at_pairs(c->joint, c->right, 1.0, x);
    memset(c->dy, 0, r * sizeof(double));
    add_product(c->dy, 1.0, c->S, c->right, r, r);
    memset(way, 0, c->size * sizeof(double));
    add_at_points(c->joint, way, c->dy);
}

static double largest(const double *x, size_t n)
{
    double most = 0.0;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

/* Whether friction acts at a point. */
static int rubs(const struct contact *c, size_t point)
{
    return c->size > c->n && c->mu[point] > 0.0;
}

/* Take over new compliances S and D and coefficients mu. */
static void renew_contact(struct contact *c)
{
    const size_t n = c->n, r = c->joint->n_relative;
    c->is_factored = 0;
    for (size_t i = 0; i < c->size; i++) {
        const struct row row = row_of(c->joint, i / n, i % n);
        memset(c->dy, 0, r * sizeof(double));
        for (size_t e = 0; e < row.n; e++)
            add_row(c->dy, c->S + row.column[e] * r, row.value[e], r);
        c->own[i] = 0.0;
        for (size_t e = 0; e < row.n; e++)
            c->own[i] += row.value[e] * c->dy[row.column[e]];
        c->D[i] = fmin(c->D[i], DBL_MAX);
    }
    for (size_t p = 0; p < n && c->size > n; p++) /* no turn of the tangents changes the mean */
        c->own[n + p] = c->own[2 * n + p] = 0.5 * (c->own[n + p] + c->own[2 * n + p]);
    const double most = largest(c->own, c->size);
    for (size_t i = 0; i < c->size; i++)
        if (!(c->own[i] > 0.0)) /* nothing moves */
            c->own[i] = most > 0.0 ? most : 1.0;
}

/* ---- the law ---- */

/* Part of a tangential force that is admissible beside a normal one. */
static double admissible_part(double limit, double size)
{
    if (size <= limit && limit > 0.0)
        return 1.0;
    return size > 0.0 && limit > 0.0 ? limit / size : 0.0;
}

/* Replace forces by the nearest that are admissible. */
static void admit(const struct contact *c, double *x)
{
    const size_t n = c->n;
    for (size_t p = 0; p < n; p++) {
        x[p] = fmax(x[p], 0.0);
        if (c->size == n)
            continue;
        const double size = hypot(x[n + p], x[2 * n + p]);
        const double part = admissible_part(c->mu[p] * x[p], size);
        x[n + p] *= part;
        x[2 * n + p] *= part;
    }
}

/* K of a point that is pressed by ``normal``, with tangential forces t before they are cut. */
static void differentiate(const struct contact *c, size_t p, double normal, const double t[2])
{
    const double size = hypot(t[0], t[1]), part = admissible_part(c->mu[p] * normal, size);
    const double first = size > 0.0 ? t[0] / size : 0.0, second = size > 0.0 ? t[1] / size : 0.0;
    const double turned = part < 1.0 ? part : 0.0, stiffness = 1.0 / c->yields[c->n + p];
    double *K = c->K + 9 * p;
    K[4] = (part - turned * first * first) * stiffness;
    K[8] = (part - turned * second * second) * stiffness;
    K[5] = K[7] = -turned * first * second * stiffness;
    if (part < 1.0) {
        K[3] = c->mu[p] * first * K[0];
        K[6] = c->mu[p] * second * K[0];
    }
}

/* Forces x that points answer at z, and K. */
static void respond(struct contact *c, const double *z, double *x)
{
    const size_t n = c->n;
    memset(c->K, 0, 9 * n * sizeof(double));
    for (size_t i = 0; i < c->size; i++)
        x[i] = -z[i] / c->yields[i];
    for (size_t p = 0; p < n; p++) {
        if (!(x[p] > 0.0))
            continue;
        c->K[9 * p] = 1.0 / c->yields[p];
        if (c->size > n) {
            const double t[2] = {x[n + p], x[2 * n + p]};
            differentiate(c, p, x[p], t);
        }
    }
    admit(c, x);
}

/* Hold tangential forces in K to the bounds of the last normal ones. */
static void fix_bounds(struct contact *c)
{
    for (size_t p = 0; p < c->n; p++)
        c->K[9 * p + 3] = c->K[9 * p + 6] = 0.0;
}

/* ---- Newton steps ---- */

/* Number the pairs that points with stiffness touch. */
static void touch_pairs(struct contact *c)
{
    const struct joint *j = c->joint;
    const size_t none = j->n_relative;
    for (size_t i = 0; i < none; i++)
        c->place[i] = none;
    for (size_t p = 0; p < c->n; p++)
        for (size_t k = 0; k < n_component(j) && c->K[9 * p] != 0.0; k++) {
            const struct row row = row_of(j, k, p);
            for (size_t e = 0; e < row.n; e++)
                c->place[row.column[e]] = 0;
        }
    c->n_touched = 0;
    for (size_t i = 0; i < none; i++)
        if (c->place[i] != none) {
            c->place[i] = c->n_touched;
            c->touched[c->n_touched++] = i;
        }
}

/* B = G'K G at the pairs touched. */
static void fill_springs(struct contact *c)
{
    const size_t t = c->n_touched, components = n_component(c->joint);
    memset(c->B, 0, t * t * sizeof(double));
    for (size_t p = 0; p < c->n; p++)
        for (size_t i = 0; i < components && c->K[9 * p] != 0.0; i++) {
            const struct row row = row_of(c->joint, i, p);
            for (size_t k = 0; k < components; k++) {
                const struct row other = row_of(c->joint, k, p);
                const double K = c->K[9 * p + 3 * i + k];
                for (size_t e = 0; e < row.n && K != 0.0; e++) {
                    double *place = c->B + c->place[row.column[e]] * t;
                    for (size_t g = 0; g < other.n; g++)
                        place[c->place[other.column[g]]] += row.value[e] * K * other.value[g];
                }
            }
        }
}

/* M = I + B S at the pairs touched, factorized, unless K is that of the last one. */
WIDE static int factorize(struct contact *c)
{
    const size_t r = c->joint->n_relative, n = 9 * c->n;
    if (c->is_factored && memcmp(c->K, c->factored_K, n * sizeof(double)) == 0)
        return 0;
    c->is_factored = 0;
    touch_pairs(c);
    fill_springs(c);
    const size_t t = c->n_touched;
    memset(c->M, 0, t * t * sizeof(double));
    for (size_t k = 0; k < t; k++) {
        for (size_t i = 0; i < t; i++)
            c->right[i] = c->S[c->touched[k] * r + c->touched[i]];
        for (size_t i = 0; i < t; i++)
            if (c->B[i * t + k] != 0.0)
                add_row(c->M + i * t, c->right, c->B[i * t + k], t);
        c->M[k * t + k] += 1.0;
    }
    if (factorize_lu(c->M, t, c->order) != 0)
        return -1;
    memcpy(c->factored_K, c->K, n * sizeof(double));
    c->is_factored = 1;
    return 0;
}

/* Newton step dp from c->rest, with what it moves; -1 where the system is singular. */
static int find_step(struct contact *c)
{
    const size_t r = c->joint->n_relative;
    if (factorize(c) != 0)
        return -1;
    /* Forces between pairs that no closed point touches are known, and move the others. */
    const size_t t = c->n_touched;
    for (size_t i = 0; i < r; i++)
        c->dp[i] = -c->rest[i];
    for (size_t i = 0; i < t; i++) {
        c->right[i] = c->dp[c->touched[i]];
        c->dp[c->touched[i]] = 0.0;
    }
    memset(c->dy, 0, r * sizeof(double));
    if (t < r && largest(c->dp, r) > 0.0) {
        add_product(c->dy, 1.0, c->S, c->dp, r, r);
        for (size_t i = 0; i < t; i++)
            c->known[i] = c->dy[c->touched[i]];
        add_product(c->right, -1.0, c->B, c->known, t, t);
        memset(c->dy, 0, r * sizeof(double));
    }
    solve_lu(c->M, t, c->order, c->right);
    for (size_t i = 0; i < t; i++)
        c->dp[c->touched[i]] = c->right[i];
    add_product(c->dy, 1.0, c->S, c->dp, r, r);
    memset(c->moved, 0, c->size * sizeof(double));
    add_at_points(c->joint, c->moved, c->dy);
    return are_finite(c->dp, r) ? 0 : -1;
}

/* R = p + length dp - G'(x - about). */
static void find_rest(const struct contact *c, double *rest, double length, const double *x,
                      const double *about)
{
    const size_t r = c->joint->n_relative;
    memcpy(rest, c->p, r * sizeof(double));
    add_row(rest, c->dp, length, r);
    add_at_pairs(c->joint, rest, -1.0, x);
    add_at_pairs(c->joint, rest, 1.0, about);
}

/* Forces c->tried and K at a part of the step; returns the slope of the energy there. */
static double reach(struct contact *c, double length, const double *x)
{
    const size_t r = c->joint->n_relative;
    double slope = dot(c->dy, c->rest, r) + length * dot(c->dy, c->dp, r);
    memcpy(c->tried_z, c->z, c->size * sizeof(double));
    add_row(c->tried_z, c->moved, length, c->size);
    respond(c, c->tried_z, c->tried);
    for (size_t i = 0; i < c->size; i++)
        slope += c->moved[i] * (x[i] - c->tried[i]);
    return slope;
}

/* Length of the step from forces x: one, or about where the slope vanishes; c->tried is there. */
static double find_length(struct contact *c, const double *x, const double *about)
{
    const size_t r = c->joint->n_relative;
    const double at_first = dot(c->dy, c->rest, r), last = reach(c, 1.0, x);
    if (fabs(last) <= LARGEST_REMAINDER * fabs(at_first) || !(at_first < 0.0 && last > 0.0))
        return 1.0;
    find_rest(c, c->tried_rest, 1.0, c->tried, about);
    if (dot(c->tried_rest, c->tried_rest, r)
        <= LARGEST_REMAINDER * LARGEST_REMAINDER * dot(c->rest, c->rest, r))
        return 1.0;
    double low = 0.0, high = 1.0, below = at_first, above = last, length = 1.0;
    for (int trial = 0; trial < LENGTH_TRIALS; trial++) {
        /* A chord that ends where the slope jumps would stay there: away from both ends. */
        const double chord = low - below * (high - low) / (above - below);
        const double margin = 0.1 * (high - low);
        length = fmin(fmax(chord, low + margin), high - margin);
        const double slope = reach(c, length, x);
        if (fabs(slope) <= FLAT * fabs(at_first))
            break;
        if (slope > 0.0) {
            high = length;
            above = slope;
        } else {
            low = length;
            below = slope;
        }
    }
    return length;
}

/* The step from the state before, whose forces are ``about``, along its tangent; from no forces as
 * if every point were closed and stuck. */
static void begin(struct contact *c, const double *about)
{
    const size_t n = c->n, r = c->joint->n_relative;
    const int is_new = largest(about, c->size) == 0.0;
    for (size_t i = 0; i < c->size; i++)
        c->tried_z[i] = -c->yields[i] * about[i] * (i < n ? 1.0 : SLIP_ON_SCALE);
    respond(c, c->tried_z, c->tried);
    for (size_t p = 0; p < n && is_new; p++) {
        c->K[9 * p] = 1.0 / c->yields[p];
        if (rubs(c, p))
            c->K[9 * p + 4] = c->K[9 * p + 8] = 1.0 / c->yields[n + p];
    }
    memset(c->tried, 0, c->size * sizeof(double));
    for (size_t i = 0; i < c->size; i++)
        for (size_t k = 0; k < c->size / n; k++) {
            const size_t other = k * n + i % n;
            const double K = c->K[9 * (i % n) + 3 * (i / n) + k];
            c->tried[i] += K * (c->z[other] + c->yields[other] * about[other]);
        }
    memset(c->p, 0, r * sizeof(double));
    memset(c->rest, 0, r * sizeof(double));
    add_at_pairs(c->joint, c->rest, 1.0, c->tried);
    if (find_step(c) != 0) {
        memset(c->dp, 0, r * sizeof(double));
        return;
    }
    memcpy(c->p, c->dp, r * sizeof(double));
    add_row(c->z, c->moved, 1.0, c->size);
}

/* Newton's method from forces ``about``, which move points to c->z; forces are in x then. Returns
 * the residual over the largest force. */
static double descend(struct contact *c, const double *about, double *x)
{
    const size_t r = c->joint->n_relative;
    const double least = fmax(SMALLEST_FORCE_SHARE * largest(about, c->size), DBL_MIN);
    double left = INFINITY, previous = INFINITY;
    const int is_rough = c->size > c->n;
    int n_short = 0, bounded = 0;
    begin(c, about);
    respond(c, c->z, x);
    for (int step = 0;; step++) {
        find_rest(c, c->rest, 0.0, x, about);
        left = are_finite(c->rest, r) ? largest(c->rest, r) / fmax(largest(x, c->size), least)
                                      : INFINITY;
        if (left <= NEWTON_ROUND_OFF || (left <= SOLVED && left > LARGEST_REMAINDER * previous)
            || step == NEWTON_STEPS || n_short == MOST_SHORT || find_step(c) != 0)
            return left;
        if (is_rough && !bounded && dot(c->dy, c->rest, r) >= 0.0) {
            bounded = 1;
            fix_bounds(c);
            continue;
        }
        previous = left;
        const double length = find_length(c, x, about);
        const int is_short = is_rough && length < SHORT_STEP;
        bounded = is_short && !bounded;
        n_short += is_short;
        add_row(c->p, c->dp, length, r);
        memcpy(c->z, c->tried_z, c->size * sizeof(double));
        memcpy(x, c->tried, c->size * sizeof(double));
        if (bounded)
            fix_bounds(c);
    }
}

/* ---- stages ---- */

/* Whether forces do not follow from displacements at some point. */
static int is_hard(const struct contact *c)
{
    for (size_t i = 0; i < c->size; i++)
        if (!(c->D[i] > 0.0) && (i < c->n || rubs(c, i % c->n)))
            return 1;
    return 0;
}

/* Forces c->found of points that yield besides, by the share of the structure, about forces x;
 * returns what Newton's method leaves. */
static double solve_stage(struct contact *c, const double *free_slack, const double *x, double share)
{
    give_way_to(c, c->z, x);
    for (size_t i = 0; i < c->size; i++) {
        const double besides = share * c->own[i];
        c->yields[i] = c->D[i] + besides > 0.0 ? c->D[i] + besides : 1.0;
        c->z[i] += free_slack[i] - besides * x[i];
    }
    return descend(c, x, c->found);
}

/* Change from forces x to c->found over the largest one, most of it at c->worst. */
static double find_change(struct contact *c, const double *x)
{
    double most = 0.0;
    for (size_t i = 0; i < c->size; i++)
        if (fabs(c->found[i] - x[i]) > most) {
            most = fabs(c->found[i] - x[i]);
            c->worst = i % c->n;
        }
    const double force = largest(c->found, c->size);
    return most / (force > 0.0 ? force : 1.0);
}

/* Stages from forces x; what is left of the last one, over the largest force. */
static double follow_stages(struct contact *c, const double *free_slack, double *x)
{
    double change = INFINITY, residual = INFINITY;
    int level = USUAL_LEVEL, begun = largest(x, c->size) > 0.0;
    for (int stage = 0; stage < STAGES; stage++) {
        const double hardness = SOFTEST * pow(10.0, level);
        const double unsolved = solve_stage(c, free_slack, x, 1.0 / hardness);
        const double previous = change, following = find_change(c, x);
        if (!(unsolved <= SOLVED)) {
            residual = isfinite(change) ? residual : unsolved;
            if (level-- == 0)
                break;
            continue;
        }
        const int is_settled = change <= SETTLED_CHANGE && residual <= STAGE_ROUND_OFF;
        if (is_settled && following >= change)
            break; /* round-off: further stages gain nothing */
        change = following;
        residual = fmax(change / hardness, unsolved);
        if (begun && change <= 10.0 * STAGE_ROUND_OFF)
            break; /* what begins at its solution keeps the last digits of that */
        memcpy(x, c->found, c->size * sizeof(double));
        if (change <= STAGE_ROUND_OFF)
            break;
        if (change <= SMALL_CHANGE && level < N_LEVEL - 1
            && (level < USUAL_LEVEL || change > SLOW_CHANGE * previous))
            level++;
        begun = 0;
    }
    return isfinite(change) && change > SETTLED_CHANGE ? change : residual;
}

/* Find gaps and slip that belong to forces x: none where points are pressed, or stick. */
static void find_slack(struct contact *c, const double *free_slack, const double *x)
{
    const size_t n = c->n;
    give_way_to(c, c->slack, x);
    for (size_t i = 0; i < c->size; i++)
        c->slack[i] += free_slack[i] + c->D[i] * x[i];
    for (size_t p = 0; p < n; p++) {
        c->slack[p] = x[p] > 0.0 ? 0.0 : fmax(c->slack[p], 0.0);
        if (rubs(c, p)
            && hypot(x[n + p], x[2 * n + p]) < (1.0 - ON_THE_BOUND) * c->mu[p] * x[p])
            c->slack[n + p] = c->slack[2 * n + p] = 0.0;
    }
}

/* Solve from forces x, those of the increment before; gaps and slip are in c->slack then. */
static enum contact_status solve_contact(struct contact *c, const double *free_slack, double *x)
{
    if (!are_finite(free_slack, c->size))
        return CONTACT_NOT_FINITE;
    admit(c, x);
    c->left = is_hard(c) ? INFINITY : solve_stage(c, free_slack, x, 0.0);
    if (c->left <= SOLVED)
        memcpy(x, c->found, c->size * sizeof(double));
    else
        c->left = follow_stages(c, free_slack, x);
    if (!(c->left <= SOLVED)) {
        /* What another load left may lead where points contradict each other. */
        memset(x, 0, c->size * sizeof(double));
        c->left = follow_stages(c, free_slack, x);
    }
    find_slack(c, free_slack, x);
    return c->left <= SOLVED ? CONTACT_SOLVED : CONTACT_UNSETTLED;
}
