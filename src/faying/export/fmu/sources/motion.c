/* One simulated joint, M q'' + C q' + K q = f + V'G'l: its state.
 *
 * All that changes in time lies in one block, so that a state is saved and restored by a copy.
 * Everything else is a function of the joint, the parameters and the step. */

#include <stdarg.h>

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
    double *mu, *tangential; /* (n_interface) coefficients of friction and tangential penalties,
                              * nothing without friction; as slip, dissipated and slides */
    double *inputs, *rates;  /* (n_input) boundary forces, initial bolt forces, factors of deck
                              * loads; their derivatives */
    double *held;            /* (n_bolt) initial forces that acted at the end of the last step */
    double *q, *v, *a, *f;   /* (n_mode) motion and the forces that act; energy-decaying: external
                              * ones alone */
    double *lagging;         /* (n_mode) velocity that lags behind, energy-decaying */
    double *forces;          /* (n_component * n_point), normal ones first */
    double *slip;            /* (2 n_point) */
    double *dissipated;      /* (n_interface) since the start */
    unsigned char *slides;   /* (n_point) in the last step */

    double step;   /* what A and the contact matrices belong to; zero if to nothing */
    double *A;     /* (n_mode, n_mode) factorized effective matrix */
    double *shape; /* (n_mode, n_relative) room for U'^-1 V' */
    double *saved; /* (n_state) */
    double *right, *next, *pull, *inertia, *drag; /* (n_mode) */
    double *pairs, *from, *to;                    /* (n_relative) */
    double *gap;                                  /* (n_component * n_point) */
    double *before, *way;                         /* the same; energy-decaying: see mean.c */
    double *change;         /* (2 n_point) slip of a step, with friction */
    struct contact contact;
    struct contact law;     /* the law alone, S = R; made when it is first needed */
    int counts;             /* whether the residual compliance is more than round-off */
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
    const size_t once = has_friction(j) ? 1 : 0, n = j->n_point, laws = once * j->n_interface;
    const size_t lengths[] = {j->n_interface, laws,      laws,      m->n_input,
                              m->n_input,     j->n_bolt, j->n_mode, j->n_mode,
                              j->n_mode,      j->n_mode, j->n_mode, n_component(j) * n,
                              once * 2 * n,   laws};
    double **arrays[] = {&m->penalty, &m->mu,   &m->tangential, &m->inputs, &m->rates,
                         &m->held,    &m->q,    &m->v,          &m->a,      &m->f,
                         &m->lagging, &m->forces, &m->slip,     &m->dissipated};
    size_t total = N_SCALAR;
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        if (place) {
            *arrays[i] = place;
            place += lengths[i];
        }
        total += lengths[i];
    }
    if (place)
        m->slides = (unsigned char *)place;
    return total + (once * n + sizeof(double) - 1) / sizeof(double);
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
    for (size_t i = 0; has_friction(j) && i < j->n_interface; i++) {
        m->mu[i] = j->friction[i];
        m->tangential[i] = j->tangential[i];
    }
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
    const size_t n = j->n_mode, r = j->n_relative, every = n_component(j) * j->n_point;
    m->n_input = j->n_boundary + j->n_bolt + j->n_pattern;
    m->n_state = lay_out_state(m);
    m->state = calloc(2 * m->n_state, sizeof *m->state);
    m->A = malloc((n * n + n * r + 5 * n + 3 * r + 3 * every + 2 * j->n_point) * sizeof *m->A);
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
    m->from = m->pairs + r;
    m->to = m->from + r;
    m->gap = m->to + r;
    m->before = m->gap + every;
    m->way = m->before + every;
    m->change = m->way + every;
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
