/* Steps in time by implicit Euler, generalized-alpha (Chung & Hulbert 1993) or the energy-decaying
 * scheme (faying.simulation.integrators.energy_decaying), with the contact problem of every step
 * solved exactly. */

/* Steps are whole multiples of this fraction of the nominal one: communication steps that differ
 * by round-off only share their matrices. */
#define STEP_RESOLUTION (1.0 / 16777216.0)
/* How much longer than nominal a step may be by round-off of the communication points. */
#define STEP_SLACK 1e-6
/* Steps within one communication step. */
#define MOST_STEPS 1e9

struct scheme {
    double alpha_m, alpha_f, beta, gamma, force_weight;
    double lead, follow, stiffness; /* energy-decaying: d^2 / follow, 1/2 + 2 d, 1/2 + lead */
};

static struct scheme scheme_of(const struct motion *m)
{
    const double rho = m->state[AT_RHO];
    struct scheme s;
    s.alpha_m = (2.0 * rho - 1.0) / (rho + 1.0);
    s.alpha_f = rho / (rho + 1.0);
    s.gamma = 0.5 - s.alpha_m + s.alpha_f;
    s.beta = 0.25 * (1.0 - s.alpha_m + s.alpha_f) * (1.0 - s.alpha_m + s.alpha_f);
    const double lag = 0.5 * (1.0 - rho) / (1.0 + rho);
    s.follow = 0.5 + 2.0 * lag;
    s.lead = lag * lag / s.follow;
    s.stiffness = 0.5 + s.lead;
    s.force_weight = 1.0;
    if (m->state[AT_INTEGRATOR] == GENERALIZED_ALPHA)
        s.force_weight = 1.0 - s.alpha_f;
    else if (m->state[AT_INTEGRATOR] == ENERGY_DECAYING)
        s.force_weight = 0.5;
    return s;
}

/* Factorize the effective matrix of a step unless that is the last one. */
static enum outcome prepare_step(struct motion *m, const struct scheme *s, double h)
{
    const struct joint *j = &m->joint;
    double mass = 1.0 / (h * h), damping = 1.0 / h, stiffness = s->force_weight;
    if (m->step == h)
        return OUTCOME_OK;
    m->step = 0.0;
    if (m->state[AT_INTEGRATOR] == GENERALIZED_ALPHA) {
        mass = (1.0 - s->alpha_m) / (s->beta * h * h);
        damping = (1.0 - s->alpha_f) * s->gamma / (s->beta * h);
    } else if (m->state[AT_INTEGRATOR] == ENERGY_DECAYING) {
        mass /= s->stiffness;
        stiffness = s->stiffness;
    }
    for (size_t i = 0; i < j->n_mode * j->n_mode; i++)
        m->A[i] = mass * j->M[i] + damping * j->C[i] + stiffness * j->K[i];
    if (cholesky(m->A, j->n_mode) != 0) {
        report(m, "the effective matrix of a step of %g is not positive definite", h);
        return OUTCOME_ERROR;
    }
    condense(m, s->force_weight);
    if (m->state[AT_INTEGRATOR] == ENERGY_DECAYING && prepare_law(m) != 0) {
        report(m, "not enough memory for %lu contact points", (unsigned long)j->n_point);
        return OUTCOME_ERROR;
    }
    m->step = h;
    return OUTCOME_OK;
}

/* right = what the start of the step contributes. */
static void right_hand_side(struct motion *m, const struct scheme *s, double h)
{
    const struct joint *j = &m->joint;
    const size_t n = j->n_mode;
    const double *q = m->q, *v = m->v, *a = m->a;
    memset(m->right, 0, n * sizeof(double));
    if (m->state[AT_INTEGRATOR] == IMPLICIT_EULER) {
        for (size_t i = 0; i < n; i++) {
            m->inertia[i] = q[i] / (h * h) + v[i] / h;
            m->drag[i] = q[i] / h;
        }
    } else if (m->state[AT_INTEGRATOR] == ENERGY_DECAYING) {
        for (size_t i = 0; i < n; i++) {
            m->inertia[i] = (q[i] / (h * h) + (v[i] - s->lead * h * a[i]) / h) / s->stiffness;
            m->drag[i] = q[i] / h;
            m->next[i] = (1.0 - s->stiffness) * q[i] - s->lead * h * m->lagging[i];
        }
        memcpy(m->right, m->f, n * sizeof(double));
        for (size_t i = 0; i < n; i++)
            m->right[i] *= s->force_weight;
        add_product(m->right, -1.0, j->K, m->next, n, n);
    } else {
        const double kept = 1.0 - s->alpha_m, weight = 1.0 - s->alpha_f;
        const double a_inertia = kept * (0.5 / s->beta - 1.0) - s->alpha_m;
        const double a_drag = weight * h * (0.5 * s->gamma / s->beta - 1.0);
        for (size_t i = 0; i < n; i++) {
            m->inertia[i] = kept / s->beta * (q[i] / (h * h) + v[i] / h) + a_inertia * a[i];
            m->drag[i] = weight * s->gamma / (s->beta * h) * q[i]
                         + (weight * s->gamma / s->beta - 1.0) * v[i] + a_drag * a[i];
        }
        memcpy(m->right, m->f, n * sizeof(double));
        add_product(m->right, -1.0, j->K, q, n, n);
        for (size_t i = 0; i < n; i++)
            m->right[i] *= s->alpha_f;
    }
    add_product(m->right, 1.0, j->M, m->inertia, n, n);
    add_product(m->right, 1.0, j->C, m->drag, n, n);
}

/* Take over the new coordinates in m->next. */
static void advance(struct motion *m, const struct scheme *s, double h)
{
    const size_t n = m->joint.n_mode;
    for (size_t i = 0; i < n; i++) {
        double a, v;
        if (m->state[AT_INTEGRATOR] == IMPLICIT_EULER) {
            v = (m->next[i] - m->q[i]) / h;
            a = (v - m->v[i]) / h;
        } else if (m->state[AT_INTEGRATOR] == ENERGY_DECAYING) {
            const double speed = (m->next[i] - m->q[i]) / h;
            const double change = (speed - m->v[i] + s->lead * h * m->a[i]) / s->stiffness;
            v = m->v[i] + change;
            a = m->a[i] + (change / h - m->a[i]) / s->follow;
            m->lagging[i] += (speed - m->lagging[i]) / s->follow;
        } else {
            a = (m->next[i] - m->q[i] - h * m->v[i]) / (s->beta * h * h)
                - (0.5 / s->beta - 1.0) * m->a[i];
            v = m->v[i] + h * ((1.0 - s->gamma) * m->a[i] + s->gamma * a);
        }
        m->q[i] = m->next[i];
        m->v[i] = v;
        m->a[i] = a;
    }
}

/* One step of length h whose end is ``later`` after the inputs were set. */
static enum outcome step_once(struct motion *m, const struct scheme *s, double h, double later)
{
    const size_t n = m->joint.n_mode;
    const int decaying = m->state[AT_INTEGRATOR] == ENERGY_DECAYING;
    right_hand_side(m, s, h);
    memset(m->f, 0, n * sizeof(double));
    add_external(m, m->f, 1.0, later);
    add_row(m->right, m->f, s->force_weight, n);
    memcpy(m->next, m->right, n * sizeof(double));
    solve_cholesky(m->A, n, m->next);
    const enum outcome outcome = decaying ? solve_mean(m, m->next) : solve_forces(m, m->next);
    if (outcome != OUTCOME_OK)
        return outcome;
    pull_of_contact(m);
    memcpy(m->next, m->right, n * sizeof(double));
    add_row(m->next, m->pull, s->force_weight, n);
    solve_cholesky(m->A, n, m->next);
    advance(m, s, h);
    if (decaying)
        return find_end(m);
    add_row(m->f, m->pull, 1.0, n);
    return OUTCOME_OK;
}

/* Inputs at the end of a communication step become what is held; derivatives have done their work. */
static void hold_inputs(struct motion *m, double length)
{
    for (size_t i = 0; i < m->n_input; i++) {
        m->inputs[i] += length * m->rates[i];
        m->rates[i] = 0.0;
    }
    memcpy(m->held, m->inputs + m->joint.n_boundary, m->joint.n_bolt * sizeof(double));
}

/* Advance by a communication step: in equal steps that are no longer than nominal. On failure the
 * state is that at the start. */
static enum outcome advance_motion(struct motion *m, double time, double length)
{
    const double nominal = m->state[AT_STEP_SIZE], now = m->state[AT_TIME];
    if (!(length > 0.0) || !(length <= MOST_STEPS * nominal)) {
        report(m, "the communication step is %g; it must be positive and at most 1e9 step_size",
               length);
        return OUTCOME_ERROR;
    }
    if (!(fabs(time - now) <= 1e-3 * length + 1e-9 * fabs(now))) {
        report(m, "a step from %.17g was asked for, but the joint is at %.17g; restore a state to "
                  "go back", time, now);
        return OUTCOME_ERROR;
    }
    const double count = fmax(1.0, ceil(length / nominal - STEP_SLACK));
    const double h = nominal * STEP_RESOLUTION * round(length / count / nominal / STEP_RESOLUTION);
    if (!(h > 0.0)) {
        report(m, "the communication step %g is too short for a step_size of %g", length, nominal);
        return OUTCOME_ERROR;
    }
    const struct scheme scheme = scheme_of(m);
    enum outcome outcome = prepare_step(m, &scheme, h);
    memcpy(m->saved, m->state, m->n_state * sizeof(double));
    for (double k = 1.0; outcome == OUTCOME_OK && k <= count; k += 1.0) {
        m->state[AT_TIME] = time + k / count * length;
        outcome = step_once(m, &scheme, h, k / count * length);
    }
    if (outcome != OUTCOME_OK) {
        memcpy(m->state, m->saved, m->n_state * sizeof(double));
        return outcome;
    }
    m->state[AT_TIME] = time + length;
    hold_inputs(m, length);
    return OUTCOME_OK;
}
