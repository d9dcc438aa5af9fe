/* Coulomb friction at the points, and the linear systems of Newton's method on an increment.
 *
 * With the forces x = (l_n, l_t) at the points, the rows G that take pairs to gaps and tangential
 * displacements, and the slack z = G S G'x + D x + free, where ``free`` holds gaps and tangential
 * displacements without contact forces, less the slip so far, an increment solves for any r > 0
 * (Alart & Curnier 1991)
 *
 *     F(x) = x - admissible(x - r z) = 0.                                                    (F1)
 *
 * With the derivative J of what is admissible, a Newton step is A dx + E G S G'dx = -F, E = J r,
 * A = I - J + E D: local but for the pairs. With the forces q between them
 *
 *     (I + G'K G S) q = -G'A^-1 F,   K = A^-1 E,   dx = -A^-1 F - K G S q.                   (F3)
 *
 * The tangential part of z is the slip of the increment. Vectors (3 n) have all normal components,
 * then those along all first tangents, then along all second ones. */

/* r over the diagonal of the compliance, of tangential components. */
#define TANGENTIAL_SCALE 10.0
/* Yield of a rigid point in a step over what the structure yields at it. */
#define RIGID_YIELD 1e-8
/* Vectors (3 n) of a solver. */
#define VECTORS 17

struct friction {
    const struct joint *joint;
    size_t n;                      /* points */
    double *S;                     /* (n_relative, n_relative) */
    double *M, *B, *S_touched;     /* (n_relative, n_relative) room for systems between pairs */
    double *D, *own, *scale;       /* (3 n) what laws and structure yield, and r of (F1) */
    double *mu;                    /* (n) */
    double *slack;                 /* (3 n) z of the last increment */
    double left;                   /* natural residual of the last increment */
    size_t worst;                  /* the point where that is */
    double *F, *dx, *tried, *tried_slack, *tried_F, *found, *near; /* (3 n) room */
    double *yields, *stiffness, *about, *apart, *moved_by, *trial;         /* (3 n) room */
    double *K, *J;                                                                /* (n, 3, 3) */
    double *pairs, *moved, *rows;              /* (n_relative), (n_relative), (3, n_relative) */
    size_t *touched, *order, *place;           /* (n_relative) */
};

static void free_friction(struct friction *f)
{
    free(f->S);
    free(f->D);
    free(f->touched);
    memset(f, 0, sizeof *f);
}

/* Allocate for a joint; returns 0, or -1 without memory. */
static int create_friction(struct friction *f, const struct joint *joint)
{
    const size_t n = joint->n_point, r = joint->n_relative;
    memset(f, 0, sizeof *f);
    f->joint = joint;
    f->n = n;
    f->S = malloc((4 * r * r + 1) * sizeof *f->S);
    f->D = calloc(VECTORS * 3 * n + n + 18 * n + 5 * r + 1, sizeof *f->D);
    f->touched = calloc(3 * r + 1, sizeof *f->touched);
    if (!f->S || !f->D || !f->touched) {
        free_friction(f);
        return -1;
    }
    f->M = f->S + r * r;
    f->B = f->M + r * r;
    f->S_touched = f->B + r * r;
    double **vectors[VECTORS] = {
        &f->D,           &f->own,     &f->scale,  &f->slack,     &f->F,     &f->dx,
        &f->tried,       &f->found,  &f->near,      &f->about, &f->apart,
        &f->tried_slack, &f->tried_F, &f->yields, &f->stiffness, &f->trial, &f->moved_by};
    for (size_t i = 0; i < VECTORS; i++)
        *vectors[i] = f->D + 3 * n * i;
    f->mu = f->D + VECTORS * 3 * n;
    f->K = f->mu + n;
    f->J = f->K + 9 * n;
    f->pairs = f->J + 9 * n;
    f->moved = f->pairs + r;
    f->rows = f->moved + r;
    f->order = f->touched + r;
    f->place = f->order + r;
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

/* y += G u: (3 n) at the points from displacements of the pairs. */
static void add_at_points(const struct joint *j, double *y, const double *u)
{
    for (size_t c = 0; c < 3; c++)
        for (size_t p = 0; p < j->n_point; p++) {
            const struct row row = row_of(j, c, p);
            for (size_t e = 0; e < row.n; e++)
                y[c * j->n_point + p] += row.value[e] * u[row.column[e]];
        }
}

/* y += G'x: forces at the pairs from forces (3 n) at the points. */
static void add_at_pairs(const struct joint *j, double *y, const double *x)
{
    for (size_t c = 0; c < 3; c++)
        for (size_t p = 0; p < j->n_point; p++) {
            const struct row row = row_of(j, c, p);
            for (size_t e = 0; e < row.n && x[c * j->n_point + p] != 0.0; e++)
                y[row.column[e]] += row.value[e] * x[c * j->n_point + p];
        }
}

/* moved = S G'x, by way of f->pairs. */
static void move_pairs(struct friction *f, const double *x)
{
    const size_t r = f->joint->n_relative;
    memset(f->pairs, 0, r * sizeof(double));
    add_at_pairs(f->joint, f->pairs, x);
    memset(f->moved, 0, r * sizeof(double));
    add_product(f->moved, 1.0, f->S, f->pairs, r, r);
}

/* Set half = row of G S. */
static void multiply_row(const struct friction *f, double *half, size_t component, size_t point)
{
    const size_t r = f->joint->n_relative;
    const struct row row = row_of(f->joint, component, point);
    memset(half, 0, r * sizeof(double));
    for (size_t e = 0; e < row.n; e++)
        add_row(half, f->S + row.column[e] * r, row.value[e], r);
}

/* Take over new compliances S and D and coefficients mu. */
static void renew_friction(struct friction *f)
{
    const size_t n = f->n;
    for (size_t c = 0; c < 3; c++)
        for (size_t p = 0; p < n; p++) {
            const struct row row = row_of(f->joint, c, p);
            multiply_row(f, f->rows, c, p);
            f->own[c * n + p] = 0.0;
            for (size_t e = 0; e < row.n; e++)
                f->own[c * n + p] += row.value[e] * f->rows[row.column[e]];
        }
    for (size_t p = 0; p < n; p++) /* no turn of the tangents changes the mean */
        f->own[n + p] = f->own[2 * n + p] = 0.5 * (f->own[n + p] + f->own[2 * n + p]);
    for (size_t i = 0; i < 3 * n; i++) {
        const double total = f->own[i] + f->D[i];
        f->scale[i] = total > 0.0 && isfinite(total) ? 1.0 / total : 1.0;
        if (i >= n)
            f->scale[i] *= TANGENTIAL_SCALE;
    }
}

/* ---- the law ---- */

/* What |l_t| is held to, by fixed normal forces where these are given. */
static double bound_of(const struct friction *f, size_t p, double normal, const double *pressing)
{
    return normal > 0.0 ? f->mu[p] * (pressing ? pressing[p] : normal) : 0.0;
}

/* Replace forces (3 n) by the nearest that are admissible. */
static void admit(const struct friction *f, double *x, const double *pressing)
{
    const size_t n = f->n;
    for (size_t p = 0; p < n; p++) {
        x[p] = fmax(x[p], 0.0);
        const double limit = bound_of(f, p, x[p], pressing);
        const double size = hypot(x[n + p], x[2 * n + p]);
        const double cut = size > limit ? limit / size : 1.0;
        x[n + p] *= cut;
        x[2 * n + p] *= cut;
    }
}

/* The derivative J of what is admissible, at forces (3 n). */
static void differentiate(const struct friction *f, const double *x, const double *pressing)
{
    const size_t n = f->n;
    memset(f->J, 0, 9 * n * sizeof(double));
    for (size_t p = 0; p < n; p++) {
        if (!(x[p] > 0.0))
            continue;
        double *J = f->J + 9 * p;
        const double limit = bound_of(f, p, x[p], pressing);
        const double size = hypot(x[n + p], x[2 * n + p]);
        const double over = size > 0.0 ? 1.0 / size : 1.0;
        const double first = x[n + p] * over, second = x[2 * n + p] * over;
        const int slips = size > limit || limit <= 0.0;
        const double held = slips ? limit * over : 1.0, turned = slips ? held : 0.0;
        J[0] = 1.0;
        J[4] = held - turned * first * first;
        J[8] = held - turned * second * second;
        J[5] = J[7] = -turned * first * second;
        J[3] = slips && !pressing ? f->mu[p] * first : 0.0;
        J[6] = slips && !pressing ? f->mu[p] * second : 0.0;
    }
}

/* ---- Newton steps ---- */

/* Solve A [K, y] = [E, y] at a point, A = I - J + E yield; -1 where A is singular. */
static int solve_point(const double *J, const double r[3], const double yield[3], double *K,
                       double y[3])
{
    double A[3][7];
    for (size_t i = 0; i < 3; i++) {
        for (size_t k = 0; k < 3; k++) {
            A[i][3 + k] = J[3 * i + k] * r[k];
            A[i][k] = (i == k ? 1.0 : 0.0) - J[3 * i + k] + A[i][3 + k] * yield[k];
        }
        A[i][6] = y[i];
    }
    for (size_t k = 0; k < 3; k++) {
        size_t best = k;
        for (size_t i = k + 1; i < 3; i++)
            best = fabs(A[i][k]) > fabs(A[best][k]) ? i : best;
        if (!(fabs(A[best][k]) > 0.0))
            return -1;
        for (size_t c = 0; c < 7; c++) {
            const double swapped = A[k][c];
            A[k][c] = A[best][c];
            A[best][c] = swapped;
        }
        for (size_t i = 0; i < 3; i++) {
            const double factor = A[i][k] / A[k][k];
            for (size_t c = k; i != k && c < 7; c++)
                A[i][c] -= factor * A[k][c];
        }
    }
    for (size_t i = 0; i < 3; i++) {
        for (size_t k = 0; k < 3; k++)
            K[3 * i + k] = A[i][3 + k] / A[i][i];
        y[i] = A[i][6] / A[i][i];
    }
    return 0;
}

/* y += factor K u at the points, u and y (3 n). */
static void add_springs(const struct friction *f, double *y, double factor, const double *u)
{
    const size_t n = f->n;
    for (size_t p = 0; p < n; p++)
        for (size_t i = 0; i < 3; i++)
            for (size_t k = 0; k < 3; k++)
                y[i * n + p] += factor * f->K[9 * p + 3 * i + k] * u[k * n + p];
}

static int is_closed(const struct friction *f, size_t p)
{
    return f->J[9 * p] != 0.0;
}

/* Number the pairs that closed points touch; returns how many. */
static size_t touch_pairs(struct friction *f)
{
    const size_t r = f->joint->n_relative;
    size_t count = 0;
    memset(f->pairs, 0, r * sizeof(double));
    for (size_t p = 0; p < f->n; p++)
        for (size_t c = 0; c < 3 && is_closed(f, p); c++) {
            const struct row row = row_of(f->joint, c, p);
            for (size_t e = 0; e < row.n; e++)
                f->pairs[row.column[e]] = 1.0;
        }
    for (size_t i = 0; i < r; i++)
        if (f->pairs[i] != 0.0)
            f->touched[count++] = i;
    return count;
}

/* B = G'K G at the pairs touched (t). */
static void fill_springs(struct friction *f, size_t t)
{
    memset(f->B, 0, t * t * sizeof(double));
    for (size_t p = 0; p < f->n; p++)
        for (size_t c = 0; c < 3 && is_closed(f, p); c++) {
            const struct row row = row_of(f->joint, c, p);
            for (size_t d = 0; d < 3; d++) {
                const struct row other = row_of(f->joint, d, p);
                const double K = f->K[9 * p + 3 * c + d];
                for (size_t e = 0; e < row.n && K != 0.0; e++) {
                    double *place = f->B + f->place[row.column[e]] * t;
                    for (size_t g = 0; g < other.n; g++)
                        place[f->place[other.column[g]]] += row.value[e] * K * other.value[g];
                }
            }
        }
}

/* M = I + B S at the pairs touched (t). */
WIDE static void fill_system(struct friction *f, size_t t)
{
    const size_t r = f->joint->n_relative;
    for (size_t i = 0; i < t; i++) {
        f->place[f->touched[i]] = i;
        for (size_t k = 0; k < t; k++)
            f->S_touched[i * t + k] = f->S[f->touched[i] * r + f->touched[k]];
    }
    fill_springs(f, t);
    memset(f->M, 0, t * t * sizeof(double));
    for (size_t i = 0; i < t; i++) {
        f->M[i * t + i] = 1.0;
        for (size_t k = 0; k < t; k++)
            if (f->B[i * t + k] != 0.0)
                add_row(f->M + i * t, f->S_touched + k * t, f->B[i * t + k], t);
    }
}

/* Newton step f->dx from f->dx = -F, with J, factors r and yields (3 n); -1 where a system is
 * singular. */
static int find_step(struct friction *f, const double *r_factors, const double *yields)
{
    const struct joint *j = f->joint;
    const size_t n = f->n, r = j->n_relative;
    memset(f->K, 0, 9 * n * sizeof(double));
    for (size_t p = 0; p < n; p++) {
        double y[3], scale[3], yield[3];
        if (!is_closed(f, p))
            continue;
        for (size_t c = 0; c < 3; c++) {
            const size_t i = c * n + p;
            y[c] = f->dx[i];
            scale[c] = r_factors[i];
            yield[c] = fmax(yields[i], RIGID_YIELD * f->own[i]);
        }
        if (solve_point(f->J + 9 * p, scale, yield, f->K + 9 * p, y) != 0)
            return -1;
        for (size_t c = 0; c < 3; c++)
            f->dx[c * n + p] = y[c];
    }
    const size_t t = touch_pairs(f);
    fill_system(f, t);
    if (factorize_lu(f->M, t, f->order) != 0)
        return -1;
    /* Forces between pairs that no closed point touches are known, and move the others. */
    double *q = f->rows, *right = q + r, *other = right + r, *springs = f->tried;
    memset(q, 0, r * sizeof(double));
    add_at_pairs(j, q, f->dx);
    for (size_t i = 0; i < t; i++) {
        right[i] = q[f->touched[i]];
        q[f->touched[i]] = 0.0;
    }
    if (largest(q, r) > 0.0) {
        memset(f->moved, 0, r * sizeof(double));
        add_product(f->moved, 1.0, f->S, q, r, r);
        memset(f->tried_slack, 0, 3 * n * sizeof(double));
        add_at_points(j, f->tried_slack, f->moved);
        memset(springs, 0, 3 * n * sizeof(double));
        add_springs(f, springs, 1.0, f->tried_slack);
        memset(other, 0, r * sizeof(double));
        add_at_pairs(j, other, springs);
        for (size_t i = 0; i < t; i++)
            right[i] -= other[f->touched[i]];
    }
    solve_lu(f->M, t, f->order, right);
    for (size_t i = 0; i < t; i++)
        q[f->touched[i]] = right[i];
    memset(f->moved, 0, r * sizeof(double));
    add_product(f->moved, 1.0, f->S, q, r, r);
    memset(f->tried_slack, 0, 3 * n * sizeof(double));
    add_at_points(j, f->tried_slack, f->moved);
    add_springs(f, f->dx, -1.0, f->tried_slack);
    return are_finite(f->dx, 3 * n) ? 0 : -1;
}
