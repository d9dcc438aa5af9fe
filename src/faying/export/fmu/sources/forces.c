/* The contact forces that a motion calls up, and what loads and contact do to its coordinates. */

/* Part of the largest slip and the largest force that is round-off. */
#define NOTICEABLE 1e-9

/* Set the contact matrices to those of a factorized A: S = weight V A^-1 V' + R. */
static void condense(struct motion *m, double weight)
{
    const struct joint *j = &m->joint;
    const size_t n = j->n_mode, r = j->n_relative;
    double *S = m->contact.S, *D = m->contact.D;
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
        for (uint64_t p = j->interface_start[i]; p < j->interface_start[i + 1]; p++) {
            D[p] = 1.0 / (m->penalty[i] * j->weights[p]);
            if (!has_friction(j))
                continue;
            D[j->n_point + p] = 1.0 / (m->tangential[i] * j->weights[p]);
            D[2 * j->n_point + p] = D[j->n_point + p];
            m->contact.mu[p] = m->mu[i];
        }
    renew_contact(&m->contact);
}

static enum outcome contact_problem(struct motion *m, const struct contact *c,
                                    enum contact_status status)
{
    size_t interface = 0;
    if (status == CONTACT_SOLVED)
        return OUTCOME_OK;
    if (status == CONTACT_NOT_FINITE) {
        report(m, "at time %g: a force, a displacement or a parameter is not finite, or the motion "
                  "grows without bound", m->state[AT_TIME]);
        return OUTCOME_ERROR;
    }
    while (m->joint.interface_start[interface + 1] <= c->worst)
        interface++;
    report(m,
           "at time %g: contact was not solved: at contact point %lu of interface %lu %.1e of the "
           "largest force is left; choose a smaller step%s",
           m->state[AT_TIME],
           (unsigned long)(c->worst - m->joint.interface_start[interface]) + 1,
           (unsigned long)interface + 1, c->left,
           has_friction(&m->joint) ? ", or a smaller coefficient of friction"
                                   : ", or a lower penalty");
    return OUTCOME_ERROR;
}

/* m->gap = gaps and tangential displacements that pairs call up, less the slip so far. */
static void free_slack(struct motion *m, const double *relative)
{
    const struct joint *j = &m->joint;
    memcpy(m->gap, j->initial_gap, j->n_point * sizeof(double));
    for (size_t i = 0; has_friction(j) && i < 2 * j->n_point; i++)
        m->gap[j->n_point + i] = -m->slip[i];
    add_at_points(j, m->gap, relative);
}

/* The slip that forces in ``slack`` add, and a share of what they take. */
static void take_slip(struct motion *m, const double *slack, double share)
{
    const struct joint *j = &m->joint;
    const size_t n = j->n_point;
    for (size_t i = 0; has_friction(j) && i < j->n_interface; i++)
        for (uint64_t p = j->interface_start[i]; p < j->interface_start[i + 1]; p++)
            for (size_t c = 0; c < 2; c++) {
                const double slid = slack[(c + 1) * n + p];
                m->slip[c * n + p] += slid;
                m->change[c * n + p] += slid;
                m->dissipated[i] -= share * m->forces[(c + 1) * n + p] * slid;
            }
}

/* Tell which points slide: at their friction bound, with a slip that changes. */
static void note_sliding(struct motion *m)
{
    const size_t n = m->joint.n_point;
    if (!has_friction(&m->joint))
        return;
    const double *shear = m->forces + n, noise = NOTICEABLE * largest(m->forces, n);
    double farthest = 0.0;
    for (size_t p = 0; p < n; p++)
        farthest = fmax(farthest, hypot(m->slip[p], m->slip[n + p]));
    for (size_t p = 0; p < n; p++) {
        const double bound = m->contact.mu[p] * m->forces[p];
        m->slides[p] = hypot(shear[p], shear[n + p]) >= bound - ON_THE_BOUND * bound - noise
                       && hypot(m->change[p], m->change[n + p]) > NOTICEABLE * farthest;
    }
}

/* Forces that m->gap calls up, their slip, and a share of what they take. */
static enum outcome answer_gap(struct motion *m, double share)
{
    const enum contact_status status = solve_contact(&m->contact, m->gap, m->forces);
    if (status != CONTACT_SOLVED)
        return contact_problem(m, &m->contact, status);
    memset(m->change, 0, 2 * m->joint.n_point * sizeof(double));
    take_slip(m, m->contact.slack, share);
    return OUTCOME_OK;
}

/* One increment to displacements of the pairs without contact forces. */
static enum outcome slide(struct motion *m, const double *relative)
{
    free_slack(m, relative);
    const enum outcome outcome = answer_gap(m, 1.0);
    if (outcome == OUTCOME_OK)
        note_sliding(m);
    return outcome;
}

/* ---- forces ---- */

/* Solve for the contact forces that coordinates without them call up. */
static enum outcome solve_forces(struct motion *m, const double *free_q)
{
    const struct joint *j = &m->joint;
    memset(m->pairs, 0, j->n_relative * sizeof(double));
    add_product(m->pairs, 1.0, j->relative, free_q, j->n_relative, j->n_mode);
    return slide(m, m->pairs);
}

/* pull = V'G'l. */
static void pull_of_contact(struct motion *m)
{
    const struct joint *j = &m->joint;
    memset(m->pairs, 0, j->n_relative * sizeof(double));
    add_at_pairs(j, m->pairs, 1.0, m->forces);
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
