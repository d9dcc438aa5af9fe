/* One simulated joint, M q'' + C q' + K q = f + V'N'l: its state, and where it starts.
 *
 * All that changes in time lies in one block, so that a state is saved and restored by a copy.
 * Everything else is a function of the joint, the parameters and the step. */

#include <stdarg.h>

/* Part of a step over which the initial acceleration is averaged. */
#define INITIAL_FRACTION 1e-3

enum mode { MODE_INSTANTIATED, MODE_INITIALIZING, MODE_STEPPING, MODE_TERMINATED };
enum integrator { IMPLICIT_EULER, GENERALIZED_ALPHA, ENERGY_DECAYING };
enum outcome { OUTCOME_OK, OUTCOME_ERROR };

/* Scalars of the state block. */
enum scalar {
    AT_MODE,
    AT_TIME,
    AT_STEP_SIZE, /* parameters from here */
    AT_RHO,
    AT_INTEGRATOR,
    AT_START_LOADED,
    AT_INITIALIZED, /* whether the initial state belongs to the present inputs and parameters */
    N_SCALAR
};

enum { N_PARAMETER = AT_INITIALIZED - AT_STEP_SIZE };

typedef void (*report_function)(void *environment, const char *name, int is_error,
                                const char *message);

struct motion {
    struct joint joint;
    char *name;
    report_function report;
    void *environment;

    size_t n_input, n_state; /* inputs; words of the state block */
    double *state;
    double *penalty;         /* (n_interface) */
    double *inputs, *rates;  /* (n_input) boundary forces, initial bolt forces, factors of deck
                              * loads; their derivatives */
    double *held;            /* (n_bolt) initial forces that acted at the end of the last step */
    double *q, *v, *a, *f;   /* (n_mode) motion and the forces that act; energy-decaying: external
                              * ones alone */
    double *lagging;         /* (n_mode) velocity that lags behind, energy-decaying */
    double *forces;          /* (n_point) */
    unsigned char *active;   /* (n_point) */

    double step;   /* what A and the contact matrices belong to; zero if to nothing */
    double *A;     /* (n_mode, n_mode) factorized effective matrix */
    double *shape; /* (n_mode, n_relative) room for U'^-1 V' */
    double *saved; /* (n_state) */
    double *right, *next, *pull, *inertia, *drag; /* (n_mode) */
    double *pairs, *gap, *last;                   /* (n_relative), (n_point), (n_point) */
    double *before, *way;                         /* (n_point) energy-decaying: see mean.c */
    struct contact contact;
    struct contact law; /* the law alone, S = R; made when it is first needed */
    int counts;         /* whether the residual compliance is more than round-off */
};

static void report(struct motion *m, const char *format, ...)
{
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    if (m->report)
        m->report(m->environment, m->name, 1, message);
}

static int is_mode(const struct motion *m, enum mode mode)
{
    return m->state[AT_MODE] == (double)mode;
}

/* ---- storage ---- */

static size_t lay_out_state(struct motion *m)
{
    const struct joint *j = &m->joint;
    double *place = m->state ? m->state + N_SCALAR : NULL;
    const size_t lengths[] = {j->n_interface, m->n_input, m->n_input, j->n_bolt,  j->n_mode,
                              j->n_mode,      j->n_mode,  j->n_mode,  j->n_mode, j->n_point};
    double **arrays[] = {&m->penalty, &m->inputs, &m->rates, &m->held,  &m->q,
                         &m->v,       &m->a,      &m->f,     &m->lagging, &m->forces};
    size_t total = N_SCALAR;
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        if (place) {
            *arrays[i] = place;
            place += lengths[i];
        }
        total += lengths[i];
    }
    if (place)
        m->active = (unsigned char *)place;
    return total + (j->n_point + sizeof(double) - 1) / sizeof(double);
}

/* Start values, as after instantiation. */
static void reset_motion(struct motion *m)
{
    const struct joint *j = &m->joint;
    memset(m->state, 0, m->n_state * sizeof *m->state);
    m->state[AT_MODE] = MODE_INSTANTIATED;
    m->state[AT_STEP_SIZE] = j->defaults[0];
    m->state[AT_RHO] = j->defaults[1];
    m->state[AT_INTEGRATOR] = j->defaults[2];
    m->state[AT_START_LOADED] = j->defaults[3];
    memcpy(m->penalty, j->penalty, j->n_interface * sizeof(double));
    for (size_t i = 0; i < j->n_bolt; i++)
        m->inputs[j->n_boundary + i] = j->initial_forces[i];
    m->step = 0.0;
}

static void destroy_motion(struct motion *m)
{
    if (!m)
        return;
    free_contact(&m->contact);
    free_contact(&m->law);
    free(m->A);
    free(m->state);
    free(m->name);
    free_joint(&m->joint);
    free(m);
}

static int allocate(struct motion *m)
{
    const struct joint *j = &m->joint;
    const size_t n = j->n_mode, r = j->n_relative;
    m->n_input = j->n_boundary + j->n_bolt + j->n_pattern;
    m->n_state = lay_out_state(m);
    m->state = calloc(2 * m->n_state, sizeof *m->state);
    m->A = malloc((n * n + n * r + 5 * n + r + 4 * j->n_point) * sizeof *m->A);
    if (!m->state || !m->A || create_contact(&m->contact, j) != 0)
        return -1;
    (void)lay_out_state(m);
    m->saved = m->state + m->n_state;
    m->shape = m->A + n * n;
    m->right = m->shape + n * r;
    m->next = m->right + n;
    m->pull = m->next + n;
    m->inertia = m->pull + n;
    m->drag = m->inertia + n;
    m->pairs = m->drag + n;
    m->gap = m->pairs + r;
    m->last = m->gap + j->n_point;
    m->before = m->last + j->n_point;
    m->way = m->before + j->n_point;
    return 0;
}

/* Read the joint at a path and make an instance; NULL after a report of what went wrong. */
static struct motion *create_motion(const char *name, const char *path, const char *token,
                                    report_function report_to, void *environment)
{
    struct motion *m = calloc(1, sizeof *m);
    if (!m)
        return NULL;
    m->report = report_to;
    m->environment = environment;
    const size_t length = name ? strlen(name) : 0;
    m->name = calloc(length + 1, 1);
    if (m->name && length)
        memcpy(m->name, name, length);
    const char *problem = read_joint(&m->joint, path);
    if (problem)
        report(m, "%s %s", path, problem);
    else if (!token || strcmp(token, m->joint.token) != 0)
        report(m, "the token of the model description is not that of %s", path);
    else if (!m->name || allocate(m) != 0)
        report(m, "not enough memory for %lu contact points", (unsigned long)m->joint.n_point);
    else {
        reset_motion(m);
        return m;
    }
    destroy_motion(m);
    return NULL;
}

/* ---- contact ---- */

/* Set the contact matrices to those of a factorized A: S = weight V A^-1 V' + R. */
static void condense(struct motion *m, double weight)
{
    const struct joint *j = &m->joint;
    const size_t n = j->n_mode, r = j->n_relative;
    double *S = m->contact.S;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < r; k++)
            m->shape[i * r + k] = j->relative[k * n + i];
    solve_lower_many(m->A, n, m->shape, r);
    if (j->has_residual)
        memcpy(S, j->residual, r * r * sizeof *S);
    else
        memset(S, 0, r * r * sizeof *S);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < r; k++)
            add_row(S + k * r, m->shape + i * r, weight * m->shape[i * r + k], r);
    for (size_t i = 0; i < j->n_interface; i++)
        for (uint64_t p = j->interface_start[i]; p < j->interface_start[i + 1]; p++)
            m->contact.D[p] = 1.0 / (m->penalty[i] * j->weights[p]);
    renew_contact(&m->contact);
}

static enum outcome contact_problem(struct motion *m, enum contact_status status)
{
    static const char *const reasons[] = {
        "",
        "the contact flexibility is zero or not positive semidefinite at the points in contact",
        "the contact problem did not settle; choose a smaller step, or a lower penalty",
        "a force, a displacement or a parameter is not finite, or the motion grows without bound",
    };
    if (status == CONTACT_SOLVED)
        return OUTCOME_OK;
    report(m, "at time %g: %s", m->state[AT_TIME], reasons[status]);
    return OUTCOME_ERROR;
}

/* Solve for the contact forces that coordinates without them call up. */
static enum outcome solve_forces(struct motion *m, const double *free_q)
{
    const struct joint *j = &m->joint;
    memset(m->pairs, 0, j->n_relative * sizeof(double));
    add_product(m->pairs, 1.0, j->relative, free_q, j->n_relative, j->n_mode);
    memcpy(m->gap, j->initial_gap, j->n_point * sizeof(double));
    add_interpolated(j, m->gap, m->pairs);
    return contact_problem(m, solve_contact(&m->contact, m->gap, m->active, m->forces, m->last));
}

/* pull = V'N'l. */
static void pull_of_contact(struct motion *m)
{
    const struct joint *j = &m->joint;
    memset(m->pairs, 0, j->n_relative * sizeof(double));
    add_to_pairs(j, m->pairs, m->forces);
    memset(m->pull, 0, j->n_mode * sizeof(double));
    add_transposed_product(m->pull, j->relative, m->pairs, j->n_relative, j->n_mode);
}

/* y += external forces of the inputs, all but those of the bolts times a factor, ``later`` after
 * they were set. An initial force pulls head and nut together. */
static void add_external(const struct motion *m, double *y, double loaded, double later)
{
    const struct joint *j = &m->joint;
    for (size_t i = 0; i < j->n_boundary; i++)
        y[j->boundary[i]] += loaded * (m->inputs[i] + later * m->rates[i]);
    for (size_t i = 0; i < j->n_bolt; i++) {
        const size_t k = j->n_boundary + i;
        add_row(y, j->elongations + i * j->n_mode, -(m->inputs[k] + later * m->rates[k]),
                j->n_mode);
    }
    for (size_t i = 0; i < j->n_pattern; i++) {
        const size_t k = j->n_boundary + j->n_bolt + i;
        add_row(y, j->patterns + i * j->n_mode, loaded * (m->inputs[k] + later * m->rates[k]),
                j->n_mode);
    }
}

/* ---- start ---- */

static enum outcome check_parameters(struct motion *m)
{
    const double step = m->state[AT_STEP_SIZE], rho = m->state[AT_RHO];
    const double scheme = m->state[AT_INTEGRATOR];
    if (!(step > 0.0) || !isfinite(step))
        report(m, "step_size is %g; it must be positive", step);
    else if (!(rho >= 0.0 && rho <= 1.0))
        report(m, "rho_infinity is %g; it must lie between 0 and 1", rho);
    else if (scheme != IMPLICIT_EULER && scheme != GENERALIZED_ALPHA && scheme != ENERGY_DECAYING)
        report(m, "integrator is %g; it must be 0 (implicit Euler), 1 (generalized-alpha) or 2 "
                  "(energy-decaying)", scheme);
    else {
        for (size_t i = 0; i < m->joint.n_interface; i++)
            if (!(m->penalty[i] > 0.0) || (isinf(m->penalty[i]) && !isinf(m->joint.penalty[i]))) {
                report(m, "the penalty of interface %lu is %g; it must be positive and finite",
                       (unsigned long)i + 1, m->penalty[i]);
                return OUTCOME_ERROR;
            }
        return OUTCOME_OK;
    }
    return OUTCOME_ERROR;
}

/* Acceleration that the forces at the start cause, averaged over a fraction of a step. */
static enum outcome find_acceleration(struct motion *m)
{
    const struct joint *j = &m->joint;
    const size_t n = j->n_mode;
    const double span = INITIAL_FRACTION * m->state[AT_STEP_SIZE];
    if (m->state[AT_INTEGRATOR] == IMPLICIT_EULER)
        return OUTCOME_OK;
    for (size_t i = 0; i < n * n; i++)
        m->A[i] = j->M[i] + span * span * j->K[i];
    if (cholesky(m->A, n, 0.0) != 0) {
        report(m, "M + (%g)^2 K is not positive definite", span);
        return OUTCOME_ERROR;
    }
    memcpy(m->a, m->f, n * sizeof(double));
    add_product(m->a, -1.0, j->K, m->q, n, n);
    solve_cholesky(m->A, n, m->a);
    return OUTCOME_OK;
}

/* Static equilibrium under the bolts, and under all other loads if the start is loaded. */
static enum outcome start_motion(struct motion *m)
{
    const struct joint *j = &m->joint;
    const size_t n = j->n_mode;
    const double loaded = m->state[AT_START_LOADED];
    m->step = 0.0;
    if (m->state[AT_INITIALIZED] != 0.0)
        return OUTCOME_OK;
    enum outcome outcome = check_parameters(m);
    if (outcome != OUTCOME_OK)
        return outcome;
    memcpy(m->A, j->K, n * n * sizeof(double));
    if (cholesky(m->A, n, 0.0) != 0) {
        report(m, "the stiffness matrix is not positive definite");
        return OUTCOME_ERROR;
    }
    condense(m, 1.0);
    memset(m->right, 0, n * sizeof(double));
    add_external(m, m->right, loaded, 0.0);
    memcpy(m->q, m->right, n * sizeof(double));
    solve_cholesky(m->A, n, m->q);
    /* No guess: points that would overlap without contact forces. */
    memset(m->pairs, 0, j->n_relative * sizeof(double));
    add_product(m->pairs, 1.0, j->relative, m->q, j->n_relative, n);
    memcpy(m->gap, j->initial_gap, j->n_point * sizeof(double));
    add_interpolated(j, m->gap, m->pairs);
    for (size_t p = 0; p < j->n_point; p++)
        m->active[p] = m->gap[p] < 0.0;
    outcome = solve_forces(m, m->q);
    if (outcome != OUTCOME_OK)
        return outcome;
    pull_of_contact(m);
    memcpy(m->q, m->right, n * sizeof(double));
    add_row(m->q, m->pull, 1.0, n);
    solve_cholesky(m->A, n, m->q);
    memset(m->v, 0, n * sizeof(double));
    memset(m->a, 0, n * sizeof(double));
    memcpy(m->f, m->pull, n * sizeof(double));
    add_external(m, m->f, 1.0, 0.0);
    for (size_t p = 0; p < j->n_point; p++)
        m->active[p] = m->forces[p] > 0.0;
    memcpy(m->held, m->inputs + j->n_boundary, j->n_bolt * sizeof(double));
    outcome = find_acceleration(m);
    memset(m->lagging, 0, n * sizeof(double));
    if (m->state[AT_INTEGRATOR] == ENERGY_DECAYING) {
        memset(m->f, 0, n * sizeof(double));
        add_external(m, m->f, 1.0, 0.0);
    }
    if (outcome == OUTCOME_OK)
        m->state[AT_INITIALIZED] = 1.0;
    return outcome;
}
