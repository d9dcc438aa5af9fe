/* Increments with Coulomb friction, (F1) of friction.c, by the Newton method and the constants of
 * faying.contact.frictional, and by other ways where that stops. Nothing is kept from one to the
 * next, so that a restored state continues with the same bits. */

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
/* Most that the structure counts over the law in r where a part is hardly held. */
#define SOFT 100.0
/* Distance from the friction bound within which a point slips on, and the share of slipping points
 * that may slip back before they are taken as stuck. */
#define AT_BOUND 1e-6
#define FEW_BACK 0.1
#define PROXIMAL_TRIALS 40
#define BOUND_TRIALS 100

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
static void find_residual(struct friction *f, double *F, const double *x, const double *slack,
                          const double *pressing)
{
    for (size_t i = 0; i < 3 * f->n; i++)
        F[i] = x[i] - f->scale[i] * slack[i];
    admit(f, F, pressing);
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
static double shorten(struct friction *f, double *x, const double *free_slack,
                      const double *pressing, double added, double limit)
{
    const size_t n = 3 * f->n;
    double part = 1.0;
    for (int halving = 0; halving < NEWTON_HALVINGS; halving++, part *= 0.5) {
        memcpy(f->tried, x, n * sizeof(double));
        add_row(f->tried, f->dx, part, n);
        find_slack(f, f->tried_slack, f->tried, free_slack, added);
        find_residual(f, f->tried_F, f->tried, f->tried_slack, pressing);
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
static double find_root(struct friction *f, const double *free_slack, double *x,
                        const double *pressing, int watched, double added)
{
    const size_t n = 3 * f->n;
    double norms[NEWTON_STEPS + 1];
    find_slack(f, f->slack, x, free_slack, added);
    find_residual(f, f->F, x, f->slack, pressing);
    norms[0] = norm(f->F, n) * (watched > 1 ? BOLD : 1.0);
    for (int step = 0; step < NEWTON_STEPS; step++) {
        double limit = 0.0;
        for (int i = step; i >= 0 && i > step - watched; i--)
            limit = fmax(limit, norms[i]);
        for (size_t i = 0; i < n; i++)
            f->tried[i] = x[i] - f->scale[i] * f->slack[i];
        differentiate(f, f->tried, pressing);
        for (size_t i = 0; i < n; i++)
            f->dx[i] = -f->F[i];
        if (find_step(f, added) != 0)
            break;
        norms[step + 1] = shorten(f, x, free_slack, pressing, added, limit);
        if (norms[step + 1] < 0.0 || relative_to(f->F, x, n) <= INCREMENT_ROUND_OFF)
            break;
    }
    return relative_to(f->F, x, n);
}

/* Replace forces x by where they go if no point changes sides: points at their friction bound slip
 * on, unless many would slip back, as where a load reverses; then those stick. */
static void predict(struct friction *f, const double *free_slack, double *x)
{
    const size_t n = f->n;
    admit(f, x, NULL);
    memcpy(f->start, x, 3 * n * sizeof(double));
    for (size_t p = 0; p < n; p++)
        f->outward[p] = 1.0 + AT_BOUND;
    find_slack(f, f->slack, f->start, free_slack, 0.0);
    for (int attempt = 0; attempt < 2; attempt++) {
        size_t slipping = 0, back = 0;
        for (size_t i = 0; i < 3 * n; i++)
            f->tried[i] = f->start[i] * (i < n ? 1.0 : f->outward[i % n]);
        differentiate(f, f->tried, NULL);
        for (size_t p = 0; p < n; p++)
            for (size_t i = 0; i < 3; i++) {
                double sum = 0.0;
                for (size_t k = 0; k < 3; k++)
                    sum += f->J[9 * p + 3 * i + k] * f->scale[k * n + p] * f->slack[k * n + p];
                f->dx[i * n + p] = -sum;
            }
        if (find_step(f, 0.0) != 0) {
            memcpy(x, f->start, 3 * n * sizeof(double));
            return;
        }
        memcpy(x, f->start, 3 * n * sizeof(double));
        add_row(x, f->dx, 1.0, 3 * n);
        find_slack(f, f->tried_slack, x, free_slack, 0.0);
        for (size_t p = 0; p < n; p++) {
            const double *J = f->J + 9 * p;
            if (!is_closed(f, p) || !(J[4] < 1.0 || J[8] < 1.0))
                continue;
            slipping++;
            if (f->tried_slack[n + p] * f->start[n + p]
                    + f->tried_slack[2 * n + p] * f->start[2 * n + p]
                > 0.0) {
                back++;
                f->outward[p] = 1.0 - AT_BOUND;
            }
        }
        if ((double)back <= FEW_BACK * (double)slipping)
            return;
    }
}

/* ---- where Newton's method from the forces before stops ---- */

/* Forces f->found without friction, as near as Newton's method comes. */
static void find_smooth(struct friction *f, const double *free_slack)
{
    memset(f->found, 0, 3 * f->n * sizeof(double));
    memset(f->pressing, 0, f->n * sizeof(double));
    (void)find_root(f, free_slack, f->found, f->pressing, 1, 0.0);
}

/* From contact without friction, with all that it presses sticking. */
static void begin_smooth(struct friction *f, const double *free_slack, double *x)
{
    find_smooth(f, free_slack);
    predict(f, free_slack, f->found);
    if (find_root(f, free_slack, f->found, NULL, WATCHED, 0.0) <= INCREMENT_SOLVED)
        memcpy(x, f->found, 3 * f->n * sizeof(double));
}

/* Factors r that a part which little holds does not make small, from contact without friction. */
static void scale_as_law(struct friction *f, const double *free_slack, double *x)
{
    double left = INFINITY;
    set_scale(f, SOFT);
    find_smooth(f, free_slack);
    for (int watched = 1; watched <= WATCHED && left > INCREMENT_SOLVED; watched += WATCHED - 1) {
        memcpy(f->near, f->found, 3 * f->n * sizeof(double));
        left = find_root(f, free_slack, f->near, NULL, watched, 0.0);
    }
    if (left <= INCREMENT_SOLVED)
        memcpy(x, f->near, 3 * f->n * sizeof(double));
    set_scale(f, INFINITY);
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
        const double left = find_root(f, f->near, f->found, NULL, WATCHED, added);
        const int solved = left <= INCREMENT_SOLVED;
        if (solved)
            memcpy(x, f->found, n * sizeof(double));
        added *= solved ? 0.1 : 20.0;
        if (added < 1e-3 && solved) {
            memcpy(f->found, x, n * sizeof(double));
            if (find_root(f, free_slack, f->found, NULL, 1, 0.0) <= INCREMENT_SOLVED) {
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
    find_residual(f, f->F, x, f->slack, NULL);
    f->worst = 0;
    for (size_t i = 0; i < 3 * f->n; i++)
        if (!(fabs(f->F[i]) <= fabs(f->F[f->worst])))
            f->worst = i;
    f->left = are_finite(f->F, 3 * f->n) ? relative_to(f->F, x, 3 * f->n) : INFINITY;
    f->worst %= f->n;
    return f->left;
}

/* Fixed friction bounds, a convex problem, and these renewed (Tresca). */
static void renew_bounds(struct friction *f, const double *free_slack, double *x)
{
    double left = INFINITY;
    for (int trial = 0; trial < BOUND_TRIALS; trial++) {
        const double before = left;
        for (size_t p = 0; p < f->n; p++)
            f->pressing[p] = fmax(x[p], 0.0);
        (void)find_root(f, free_slack, x, f->pressing, 1, 0.0);
        left = judge(f, free_slack, x);
        if (left <= INCREMENT_SOLVED || left > 0.999 * before)
            return;
    }
}

/* Solve an increment from forces x (3 n), those of the increment before; z is in f->slack then. */
static enum contact_status solve_friction(struct friction *f, const double *free_slack, double *x)
{
    typedef void (*way)(struct friction *, const double *, double *);
    static const way others[] = {begin_smooth, scale_as_law, approach, renew_bounds};
    if (!are_finite(free_slack, 3 * f->n))
        return CONTACT_NOT_FINITE;
    predict(f, free_slack, x);
    if (find_root(f, free_slack, x, NULL, 1, 0.0) > INCREMENT_SOLVED)
        (void)find_root(f, free_slack, x, NULL, WATCHED, 0.0);
    double left = judge(f, free_slack, x);
    for (size_t i = 0; i < sizeof others / sizeof others[0] && left > INCREMENT_SOLVED; i++) {
        others[i](f, free_slack, x);
        left = judge(f, free_slack, x);
    }
    return left <= INCREMENT_SOLVED ? CONTACT_SOLVED : CONTACT_UNSETTLED;
}
