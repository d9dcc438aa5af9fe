/* The mean contact force of an energy-decaying step, as faying.simulation.step_contact has it.
 *
 * With W = D + G R G' and gaps g without what W gives way by, the mean l >= 0 obeys
 * s = g1 + W (2 l - l0) >= 0, l's = 0. The forces l1 at the end follow from the law at g1. */

/* Residual compliance below this share of the compliance of a step is round-off of the basis. */
#define NO_RESIDUAL 1e-9
/* Excess of a tangential force over its bound, over the largest force, that is round-off. */
#define EXCESS 1e-12

/* Make the law alone, S = R, and say whether R counts; to be done after condense(). */
static int prepare_law(struct motion *m)
{
    const struct joint *j = &m->joint;
    const size_t r = j->n_relative;
    m->counts = j->has_residual != 0;
    if (!m->counts)
        return 0;
    if (!m->law.S && create_contact(&m->law, j) != 0)
        return -1;
    double residual = 0.0, whole = 0.0;
    for (size_t i = 0; i < r; i++) {
        residual = fmax(residual, j->residual[i * r + i]);
        whole = fmax(whole, m->contact.S[i * r + i]);
    }
    m->counts = !is_hard(&m->contact) || residual > NO_RESIDUAL * whole;
    memcpy(m->law.S, j->residual, r * r * sizeof(double));
    memcpy(m->law.D, m->contact.D, m->contact.size * sizeof(double));
    memcpy(m->law.mu, m->contact.mu, j->n_point * sizeof(double));
    renew_contact(&m->law);
    return 0;
}

/* way = W l. */
static void give_way(struct motion *m, const double *forces)
{
    memset(m->way, 0, m->contact.size * sizeof(double));
    if (m->counts)
        give_way_to(&m->law, m->way, forces);
    for (size_t i = 0; i < m->contact.size; i++)
        m->way[i] += m->contact.D[i] * forces[i];
}

/* Twice the mean forces of a step in m->forces, and their slip, from coordinates without them. */
static enum outcome solve_mean(struct motion *m, const double *free_q)
{
    const struct joint *j = &m->joint;
    memcpy(m->before, m->forces, m->contact.size * sizeof(double));
    give_way(m, m->before);
    memset(m->pairs, 0, j->n_relative * sizeof(double));
    add_product(m->pairs, 1.0, j->relative, free_q, j->n_relative, j->n_mode);
    free_slack(m, m->pairs);
    add_row(m->gap, m->way, -1.0, m->contact.size);
    return answer_gap(m, 0.5);
}

/* Whether forces press closed points alone, and shear them no more than they may. */
static int are_admissible(const struct motion *m, const double *gap, const double *forces)
{
    const size_t n = m->joint.n_point;
    const double noise = EXCESS * largest(forces, m->contact.size);
    for (size_t p = 0; p < n; p++)
        if (forces[p] < 0.0 || (gap[p] > 0.0 && forces[p] > 0.0)
            || (has_friction(&m->joint)
                && hypot(forces[n + p], forces[2 * n + p])
                       > m->contact.mu[p] * forces[p] + noise))
            return 0;
    return 1;
}

/* Forces at the end of a step in m->forces, in place of twice their mean, and the slip they add. */
static enum outcome find_end(struct motion *m)
{
    const struct joint *j = &m->joint;
    const size_t n = j->n_point;
    const double *D = m->contact.D;
    double *slack = m->contact.slack;
    for (size_t i = 0; i < m->contact.size; i++) {
        const int is_rigid = !m->counts && !(D[i] > 0.0) && i < n; /* the end has no law but that */
        m->forces[i] = is_rigid ? 0.5 * m->forces[i] : m->forces[i] - m->before[i];
        slack[i] = i < n ? slack[i] : 0.0;
    }
    if (are_admissible(m, slack, m->forces)) {
        note_sliding(m);
        return OUTCOME_OK;
    }
    give_way(m, m->forces);
    for (size_t i = 0; i < m->contact.size; i++)
        m->gap[i] = slack[i] - m->way[i];
    if (m->counts) {
        const enum contact_status status = solve_contact(&m->law, m->gap, m->forces);
        if (status != CONTACT_SOLVED)
            return contact_problem(m, &m->law, status);
        slack = m->law.slack;
    } else {
        for (size_t i = 0; i < m->contact.size; i++)
            m->forces[i] = D[i] > 0.0 ? -m->gap[i] / D[i] : i < n ? m->forces[i] : 0.0;
        admit(&m->contact, m->forces);
        for (size_t i = 0; i < m->contact.size; i++)
            slack[i] = m->gap[i] + D[i] * m->forces[i];
    }
    take_slip(m, slack, 1.0);
    note_sliding(m);
    return OUTCOME_OK;
}
