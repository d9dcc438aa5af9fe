/* Increments with Coulomb friction, (F1) of friction.c, by the methods and the constants of
 * faying.contact.frictional and faying.contact.fixed_bounds. Nothing is kept from one to the next,
 * so that a restored state continues with the same bits. */

/* Natural residual over the largest force at which an increment is solved, and which is accepted
 * where round-off allows no less. */
#define INCREMENT_ROUND_OFF 1e-13
#define INCREMENT_SOLVED 1e-9
#ifndef NEWTON_STEPS
#define NEWTON_STEPS 60
#endif
#define NEWTON_HALVINGS 12
/* Steps among which the residual must fall where it cannot fall in every one, and how often its
 * first value it may be then. */
#define WATCHED 5
#define BOLD 1e3
#define PROXIMAL_TRIALS 40
#define BOUND_TRIALS 40
/* Of problems with fixed friction bounds: least yield over what the structure yields, lengths of a
 * step that are tried, slope of the energy over that at the beginning of a step that is taken for
 * none, and residual over the largest force that is enough. */
#define LEAST_YIELD 1e-6
#define LENGTH_TRIALS 40
#define FLAT 0.1
#define BOUNDED_ENOUGH 1e-6

/* slack = G S G'x + (D + added own) x + free. */
static void find_slack(struct friction *f, double *slack, const double *x, const double *free_slack,
                       double added)
{
    move_pairs(f, x);
    for (size_t i = 0; i < 3 * f->n; i++)
        slack[i] = free_slack[i] + (f->D[i] + added * f->own[i]) * x[i];
    add_at_points(f->joint, slack, f->moved);
}

/* F of (F1). */
static void find_residual(struct friction *f, double *F, const double *x, const double *slack)
{
    for (size_t i = 0; i < 3 * f->n; i++)
        F[i] = x[i] - f->scale[i] * slack[i];
    admit(f, F, NULL);
    for (size_t i = 0; i < 3 * f->n; i++)
        F[i] = x[i] - F[i];
}

/* Largest residual over the largest force; one where it exceeds all forces. */
static double relative_to(const double *F, const double *x, size_t n)
{
    const double worst = largest(F, n), most = largest(x, n);
    return worst > 0.0 ? worst / fmax(worst, most) : 0.0;
}

static double norm(const double *x, size_t n)
{
    return sqrt(dot(x, x, n));
}

/* Try parts of a step until the residual is below a limit; its norm, or -1. */
static double shorten(struct friction *f, double *x, const double *free_slack, double added,
                      double limit)
{
    const size_t n = 3 * f->n;
    double part = 1.0;
    for (int halving = 0; halving < NEWTON_HALVINGS; halving++, part *= 0.5) {
        memcpy(f->tried, x, n * sizeof(double));
        add_row(f->tried, f->dx, part, n);
        find_slack(f, f->tried_slack, f->tried, free_slack, added);
        find_residual(f, f->tried_F, f->tried, f->tried_slack);
        const double size = norm(f->tried_F, n);
        if (size < (1.0 - 1e-4 * part) * limit) {
            memcpy(x, f->tried, n * sizeof(double));
            memcpy(f->slack, f->tried_slack, n * sizeof(double));
            memcpy(f->F, f->tried_F, n * sizeof(double));
            return size;
        }
    }
    return -1.0;
}

/* Newton's method from forces x; returns the natural residual that is left over the largest force.
 * Steps are halved until the residual is below the largest of the last ``watched``. */
static double find_root(struct friction *f, const double *free_slack, double *x, int watched,
                        double added)
{
    const size_t n = 3 * f->n;
    double norms[NEWTON_STEPS + 1];
    find_slack(f, f->slack, x, free_slack, added);
    find_residual(f, f->F, x, f->slack);
    norms[0] = norm(f->F, n) * (watched > 1 ? BOLD : 1.0);
    for (int step = 0; step < NEWTON_STEPS; step++) {
        double limit = 0.0;
        for (int i = step; i >= 0 && i > step - watched; i--)
            limit = fmax(limit, norms[i]);
        for (size_t i = 0; i < n; i++)
            f->tried[i] = x[i] - f->scale[i] * f->slack[i];
        differentiate(f, f->tried, NULL);
        for (size_t i = 0; i < n; i++) {
            f->dx[i] = -f->F[i];
            f->yields[i] = f->D[i] + added * f->own[i];
        }
        if (find_step(f, f->scale, f->yields) != 0)
            break;
        norms[step + 1] = shorten(f, x, free_slack, added, limit);
        if (norms[step + 1] < 0.0 || relative_to(f->F, x, n) <= INCREMENT_ROUND_OFF)
            break;
    }
    return relative_to(f->F, x, n);
}

/* ---- fixed friction bounds ---- */

/* f->trial and f->F = x - admissible(c - (y + c(c) + free) / Y) of (F1a), c in f->about and
 * c(c) + free in f->near, from x + part dx and y + part dy, y in f->apart and dy in f->moved_by. */
static void judge_bounded(struct friction *f, const double *x, double part)
{
    const size_t n = 3 * f->n;
    for (size_t i = 0; i < n; i++)
        f->trial[i] = f->F[i] = f->about[i]
                                - (f->apart[i] + part * f->moved_by[i] + f->near[i])
                                      * f->stiffness[i];
    admit(f, f->F, f->about);
    for (size_t i = 0; i < n; i++)
        f->F[i] = x[i] + part * f->dx[i] - f->F[i];
}

/* The length of a step dx: one, or where the energy, whose slope along it is dy F, is least. */
static double descend(struct friction *f, const double *x)
{
    const size_t n = 3 * f->n;
    judge_bounded(f, x, 0.0);
    const double flat = FLAT * fabs(dot(f->moved_by, f->F, n));
    double part = 1.0, low = 0.0, high = 1.0;
    for (int trial = 0; trial < LENGTH_TRIALS; trial++) {
        judge_bounded(f, x, part);
        const double slope = dot(f->moved_by, f->F, n);
        if (slope > flat)
            high = part;
        else if (slope < -flat && part < 1.0)
            low = part;
        else
            break;
        part = 0.5 * (low + high);
    }
    return part;
}

/* Forces x with the friction bounds of those given (Tresca), by steps that descend. */
static void solve_bounded(struct friction *f, const double *free_slack, double *x)
{
    const size_t n = 3 * f->n;
    admit(f, x, NULL);
    memcpy(f->about, x, n * sizeof(double));
    for (size_t i = 0; i < n; i++) {
        const double found = fmax(f->D[i], LEAST_YIELD * f->own[i]);
        f->yields[i] = found > 0.0 && isfinite(found) ? found : 1.0;
        f->stiffness[i] = 1.0 / f->yields[i];
        f->near[i] = f->D[i] * x[i] + free_slack[i];
        f->moved_by[i] = f->apart[i] = 0.0;
    }
    move_pairs(f, x);
    add_at_points(f->joint, f->apart, f->moved);
    for (int step = 0; step < NEWTON_STEPS; step++) {
        memset(f->dx, 0, n * sizeof(double));
        judge_bounded(f, x, 0.0);
        if (largest(f->F, n) <= BOUNDED_ENOUGH * largest(x, n))
            return;
        differentiate(f, f->trial, f->about);
        for (size_t i = 0; i < n; i++)
            f->dx[i] = -f->F[i];
        if (find_step(f, f->stiffness, f->yields) != 0)
            return;
        move_pairs(f, f->dx);
        memset(f->moved_by, 0, n * sizeof(double));
        add_at_points(f->joint, f->moved_by, f->moved);
        if (!(dot(f->moved_by, f->F, n) < 0.0))
            return;
        const double part = descend(f, x);
        add_row(x, f->dx, part, n);
        add_row(f->apart, f->moved_by, part, n);
    }
}

/* ---- where Newton's method from the forces before stops ---- */

/* Friction bounds of the forces so far, again and again; Newton's method goes on from each. */
static void renew_bounds(struct friction *f, const double *free_slack, double *x)
{
    for (int trial = 0; trial < BOUND_TRIALS; trial++) {
        solve_bounded(f, free_slack, x);
        memcpy(f->found, x, 3 * f->n * sizeof(double));
        if (find_root(f, free_slack, f->found, 1, 0.0) <= INCREMENT_SOLVED) {
            memcpy(x, f->found, 3 * f->n * sizeof(double));
            return;
        }
    }
}

/* Points that yield as much as the structure, from where forces are, then less and less. */
static void approach(struct friction *f, const double *free_slack, double *x)
{
    const size_t n = 3 * f->n;
    double added = 1.0;
    for (int trial = 0; trial < PROXIMAL_TRIALS && added <= 1e3; trial++) {
        for (size_t i = 0; i < n; i++)
            f->near[i] = free_slack[i] - added * f->own[i] * x[i];
        memcpy(f->found, x, n * sizeof(double));
        const double left = find_root(f, f->near, f->found, WATCHED, added);
        const int solved = left <= INCREMENT_SOLVED;
        if (solved)
            memcpy(x, f->found, n * sizeof(double));
        added *= solved ? 0.1 : 20.0;
        if (added < 1e-3 && solved) {
            memcpy(f->found, x, n * sizeof(double));
            if (find_root(f, free_slack, f->found, 1, 0.0) <= INCREMENT_SOLVED) {
                memcpy(x, f->found, n * sizeof(double));
                return;
            }
        }
    }
}

/* Natural residual of forces x, over the largest; notes z and where the residual is. */
static double judge(struct friction *f, const double *free_slack, const double *x)
{
    find_slack(f, f->slack, x, free_slack, 0.0);
    find_residual(f, f->F, x, f->slack);
    f->worst = 0;
    for (size_t i = 0; i < 3 * f->n; i++)
        if (!(fabs(f->F[i]) <= fabs(f->F[f->worst])))
            f->worst = i;
    f->left = are_finite(f->F, 3 * f->n) ? relative_to(f->F, x, 3 * f->n) : INFINITY;
    f->worst %= f->n;
    return f->left;
}

/* Solve an increment from forces x (3 n), those of the increment before; z is in f->slack then. */
static enum contact_status solve_friction(struct friction *f, const double *free_slack, double *x)
{
    typedef void (*way)(struct friction *, const double *, double *);
    static const way others[] = {renew_bounds, approach};
    if (!are_finite(free_slack, 3 * f->n))
        return CONTACT_NOT_FINITE;
    admit(f, x, NULL);
    (void)find_root(f, free_slack, x, 1, 0.0);
    double left = judge(f, free_slack, x);
    for (size_t i = 0; i < sizeof others / sizeof others[0] && left > INCREMENT_SOLVED; i++) {
        others[i](f, free_slack, x);
        left = judge(f, free_slack, x);
    }
    return left <= INCREMENT_SOLVED ? CONTACT_SOLVED : CONTACT_UNSETTLED;
}
