/* The mean contact force of an energy-decaying step, as faying.simulation.step_contact has it.
 *
 * With W = D + N R N' and gaps g without what W gives way by, the mean l >= 0 obeys
 * s = g1 + W (2 l - l0) >= 0, l's = 0. The forces l1 at the end follow from the law at g1. */

/* Residual compliance below this share of the compliance of a step is round-off of the basis. */
#define NO_RESIDUAL 1e-9

/* Make the law alone, S = R, and say whether R counts; to be done after condense(). */
static int prepare_law(struct motion *m)
{
    const struct joint *j = &m->joint;
    const size_t r = j->n_relative;
    int hard = 0;
    m->counts = j->has_residual != 0;
    if (!m->counts)
        return 0;
    if (!m->law.H && !m->law.S && create_contact(&m->law, j) != 0)
        return -1;
    for (size_t p = 0; p < j->n_point; p++)
        hard = hard || m->contact.D[p] == 0.0;
    double residual = 0.0, whole = 0.0;
    for (size_t i = 0; i < r; i++) {
        residual = fmax(residual, j->residual[i * r + i]);
        whole = fmax(whole, m->contact.S[i * r + i]);
    }
    m->counts = !hard || residual > NO_RESIDUAL * whole;
    memcpy(m->law.S, j->residual, r * r * sizeof(double));
    memcpy(m->law.D, m->contact.D, j->n_point * sizeof(double));
    renew_contact(&m->law);
    return 0;
}

/* way = W l. */
static void give_way(struct motion *m, const double *forces)
{
    const struct joint *j = &m->joint;
    const size_t r = j->n_relative;
    for (size_t p = 0; p < j->n_point; p++)
        m->way[p] = m->contact.D[p] * forces[p];
    if (!m->counts)
        return;
    memset(m->pairs, 0, r * sizeof(double));
    add_to_pairs(j, m->pairs, forces);
    memset(m->law.pairs, 0, r * sizeof(double));
    add_product(m->law.pairs, 1.0, j->residual, m->pairs, r, r);
    add_interpolated(j, m->way, m->law.pairs);
}

/* Twice the mean forces of a step in m->forces, from coordinates without them. */
static enum outcome solve_mean(struct motion *m, const double *free_q)
{
    const struct joint *j = &m->joint;
    memcpy(m->before, m->forces, j->n_point * sizeof(double));
    give_way(m, m->before);
    memset(m->pairs, 0, j->n_relative * sizeof(double));
    add_product(m->pairs, 1.0, j->relative, free_q, j->n_relative, j->n_mode);
    for (size_t p = 0; p < j->n_point; p++)
        m->gap[p] = j->initial_gap[p] - m->way[p];
    add_interpolated(j, m->gap, m->pairs);
    return contact_problem(m, solve_contact(&m->contact, m->gap, m->active, m->forces, m->last));
}

/* Forces at the end of a step in m->forces, in place of twice their mean. */
static enum outcome find_end(struct motion *m)
{
    const struct joint *j = &m->joint;
    const double *slack = m->contact.slack, *D = m->contact.D;
    int wrong = 0;
    for (size_t p = 0; p < j->n_point; p++) {
        const double twice = m->forces[p];
        m->forces[p] = twice - m->before[p];
        m->before[p] = twice;
        wrong = wrong || m->forces[p] < 0.0 || (slack[p] > 0.0 && m->forces[p] > 0.0);
    }
    if (!m->counts) {
        for (size_t p = 0; p < j->n_point; p++) {
            if (D[p] == 0.0)
                m->forces[p] = 0.5 * m->before[p];
            else if (m->forces[p] < 0.0 || (slack[p] > 0.0 && m->forces[p] > 0.0))
                m->forces[p] = fmax(D[p] * m->forces[p] - slack[p], 0.0) / D[p];
        }
        return OUTCOME_OK;
    }
    if (!wrong)
        return OUTCOME_OK;
    give_way(m, m->forces);
    for (size_t p = 0; p < j->n_point; p++)
        m->gap[p] = fmax(slack[p], 0.0) - m->way[p];
    unsigned char *active = (unsigned char *)m->way;
    for (size_t p = 0; p < j->n_point; p++)
        active[p] = m->forces[p] > 0.0;
    return contact_problem(m, solve_contact(&m->law, m->gap, active, m->forces, m->last));
}
