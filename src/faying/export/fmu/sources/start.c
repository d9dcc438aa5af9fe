/* Where a motion starts: parameters that make sense, and the joint at rest under its loads. */

/* Least part of the way from rest under the bolts to the loads that is tried as one increment. */
#define LEAST_INCREMENT (1.0 / 64.0)
/* Coefficients of friction above this are taken for a slip of the pen. */
#define MOST_FRICTION 10.0

static enum outcome check_friction(struct motion *m, size_t i)
{
    const struct joint *j = &m->joint;
    const uint64_t first = j->interface_start[i], end = j->interface_start[i + 1];
    const int rubs = j->shear_start[first] < j->shear_start[end];
    if (!(m->mu[i] >= 0.0 && m->mu[i] <= MOST_FRICTION))
        report(m, "the coefficient of friction of interface %lu is %g; it must lie between 0 and "
                  "%g", (unsigned long)i + 1, m->mu[i], MOST_FRICTION);
    else if (!(m->tangential[i] > 0.0) || (isinf(m->tangential[i]) && !isinf(j->tangential[i])))
        report(m, "the tangential penalty of interface %lu is %g; it must be positive and finite",
               (unsigned long)i + 1, m->tangential[i]);
    else if (m->state[AT_INTEGRATOR] == ENERGY_DECAYING
             && (isinf(m->penalty[i]) || (rubs && isinf(m->tangential[i]))))
        report(m, "energy-decaying steps with friction need elastic contact, and interface %lu is "
                  "rigid; choose integrator 0 or 1", (unsigned long)i + 1);
    else
        return OUTCOME_OK;
    return OUTCOME_ERROR;
}

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
        for (size_t i = 0; i < m->joint.n_interface; i++) {
            if (!(m->penalty[i] > 0.0) || (isinf(m->penalty[i]) && !isinf(m->joint.penalty[i]))) {
                report(m, "the penalty of interface %lu is %g; it must be positive and finite",
                       (unsigned long)i + 1, m->penalty[i]);
                return OUTCOME_ERROR;
            }
            if (has_friction(&m->joint) && check_friction(m, i) != OUTCOME_OK)
                return OUTCOME_ERROR;
        }
        return OUTCOME_OK;
    }
    return OUTCOME_ERROR;
}

/* Acceleration that the forces at the start cause, averaged over the first step. */
static enum outcome find_acceleration(struct motion *m)
{
    const struct joint *j = &m->joint;
    const size_t n = j->n_mode;
    const double span = m->state[AT_STEP_SIZE];
    if (m->state[AT_INTEGRATOR] != GENERALIZED_ALPHA)
        return OUTCOME_OK;
    for (size_t i = 0; i < n * n; i++)
        m->A[i] = j->M[i] + span * span * j->K[i];
    if (cholesky(m->A, n) != 0) {
        report(m, "M + (%g)^2 K is not positive definite", span);
        return OUTCOME_ERROR;
    }
    memcpy(m->a, m->f, n * sizeof(double));
    add_product(m->a, -1.0, j->K, m->q, n, n);
    solve_cholesky(m->A, n, m->a);
    return OUTCOME_OK;
}

/* Go from displacements m->from of the pairs without contact forces to m->to in one increment, or
 * in halves of it where that is too far. */
static enum outcome follow_path(struct motion *m)
{
    const size_t r = m->joint.n_relative, n = m->contact.size;
    const report_function report_to = m->report;
    double done = 0.0, part = 1.0;
    while (done < 1.0) {
        for (size_t i = 0; i < r; i++)
            m->pairs[i] = m->from[i] + (done + part) * (m->to[i] - m->from[i]);
        memcpy(m->before, m->forces, n * sizeof(double));
        m->report = part > LEAST_INCREMENT ? NULL : report_to; /* only the last failure counts */
        const enum outcome outcome = slide(m, m->pairs);
        m->report = report_to;
        if (outcome == OUTCOME_OK) {
            done += part;
        } else if (part > LEAST_INCREMENT) {
            memcpy(m->forces, m->before, n * sizeof(double));
            part *= 0.5;
        } else {
            return outcome;
        }
    }
    memcpy(m->from, m->to, r * sizeof(double));
    return OUTCOME_OK;
}

/* m->to = displacements of the pairs under loads alone. */
static void load_pairs(struct motion *m, double loaded)
{
    const struct joint *j = &m->joint;
    memset(m->right, 0, j->n_mode * sizeof(double));
    add_external(m, m->right, loaded, 0.0);
    memcpy(m->q, m->right, j->n_mode * sizeof(double));
    solve_cholesky(m->A, j->n_mode, m->q);
    memset(m->to, 0, j->n_relative * sizeof(double));
    add_product(m->to, 1.0, j->relative, m->q, j->n_relative, j->n_mode);
}

/* Contact at rest: from the unstressed joint to the bolts, and then to the loads. */
static enum outcome tighten(struct motion *m)
{
    const struct joint *j = &m->joint;
    memset(m->forces, 0, m->contact.size * sizeof(double));
    if (has_friction(j))
        memset(m->slip, 0, 2 * j->n_point * sizeof(double));
    memset(m->from, 0, j->n_relative * sizeof(double));
    load_pairs(m, 0.0);
    enum outcome outcome = follow_path(m);
    if (outcome == OUTCOME_OK && m->state[AT_START_LOADED] != 0.0) {
        load_pairs(m, 1.0);
        if (memcmp(m->from, m->to, j->n_relative * sizeof(double)))
            outcome = follow_path(m);
    }
    if (has_friction(j))
        memset(m->dissipated, 0, j->n_interface * sizeof(double));
    return outcome;
}

/* Static equilibrium under the bolts, and under all other loads if the start is loaded. */
static enum outcome start_motion(struct motion *m)
{
    const struct joint *j = &m->joint;
    const size_t n = j->n_mode;
    m->step = 0.0;
    if (m->state[AT_INITIALIZED] != 0.0)
        return OUTCOME_OK;
    enum outcome outcome = check_parameters(m);
    if (outcome != OUTCOME_OK)
        return outcome;
    memcpy(m->A, j->K, n * n * sizeof(double));
    if (cholesky(m->A, n) != 0) {
        report(m, "the stiffness matrix is not positive definite");
        return OUTCOME_ERROR;
    }
    condense(m, 1.0);
    outcome = tighten(m);
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
