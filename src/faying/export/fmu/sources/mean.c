/* The mean contact force of an energy-decaying step, as faying.simulation.step_contact and with
 * friction faying.simulation.step_contact have it.
 *
 * With W = D + N R N' and gaps g without what W gives way by, the mean l >= 0 obeys
 * s = g1 + W (2 l - l0) >= 0, l's = 0. The forces l1 at the end follow from the law at g1. */

/* Residual compliance below this share of the compliance of a step is round-off of the basis. */
#define NO_RESIDUAL 1e-9
/* Excess of a tangential force over its bound, over the largest force, that is round-off. */
#define EXCESS 1e-12

/* ---- with friction ---- */

/* The law alone with friction, S = R. */
static int prepare_frictional_law(struct motion *m)
{
    const struct joint *j = &m->joint;
    if (!m->friction_law.S && create_friction(&m->friction_law, j) != 0)
        return -1;
    memcpy(m->friction_law.S, j->residual, j->n_relative * j->n_relative * sizeof(double));
    memcpy(m->friction_law.D, m->friction.D, 3 * j->n_point * sizeof(double));
    memcpy(m->friction_law.mu, m->friction.mu, j->n_point * sizeof(double));
    renew_friction(&m->friction_law);
    return 0;
}

/* way = W l. */
static void give_way_with_friction(struct motion *m, const double *forces)
{
    const struct joint *j = &m->joint;
    for (size_t i = 0; i < 3 * j->n_point; i++)
        m->way[i] = m->friction.D[i] * forces[i];
    if (!m->counts)
        return;
    move_pairs(&m->friction_law, forces);
    add_at_points(j, m->way, m->friction_law.moved);
}

/* Twice the mean forces of a step in m->forces, and their slip. */
static enum outcome slide_mean(struct motion *m, const double *free_q)
{
    const struct joint *j = &m->joint;
    const size_t n = 3 * j->n_point;
    memcpy(m->before, m->forces, n * sizeof(double));
    give_way_with_friction(m, m->before);
    memset(m->pairs, 0, j->n_relative * sizeof(double));
    add_product(m->pairs, 1.0, j->relative, free_q, j->n_relative, j->n_mode);
    free_slack(m, m->pairs);
    add_row(m->gap, m->way, -1.0, n);
    const enum contact_status status = solve_friction(&m->friction, m->gap, m->forces);
    if (status != CONTACT_SOLVED)
        return friction_problem(m, &m->friction, status);
    memset(m->change, 0, 2 * j->n_point * sizeof(double));
    take_slip(m, m->friction.slack, 0.5);
    return OUTCOME_OK;
}

/* Whether forces press closed points alone, and shear them no more than they may. */
static int are_admissible(const struct motion *m, const double *gap, const double *forces)
{
    const size_t n = m->joint.n_point;
    const double noise = EXCESS * largest(forces, 3 * n);
    for (size_t p = 0; p < n; p++)
        if (forces[p] < 0.0 || (gap[p] > 0.0 && forces[p] > 0.0)
            || hypot(forces[n + p], forces[2 * n + p]) > m->friction.mu[p] * forces[p] + noise)
            return 0;
    return 1;
}

/* Forces at the end of a step in m->forces, in place of twice their mean, and the slip they add. */
static enum outcome slide_end(struct motion *m)
{
    const struct joint *j = &m->joint;
    const size_t n = 3 * j->n_point;
    double *slack = m->friction.slack, *D = m->friction.D;
    for (size_t i = 0; i < n; i++) {
        m->forces[i] -= m->before[i];
        slack[i] = i < j->n_point ? slack[i] : 0.0;
    }
    if (are_admissible(m, slack, m->forces)) {
        note_sliding(m);
        return OUTCOME_OK;
    }
    give_way_with_friction(m, m->forces);
    for (size_t i = 0; i < n; i++)
        m->gap[i] = slack[i] - m->way[i];
    if (m->counts) {
        const enum contact_status status = solve_friction(&m->friction_law, m->gap, m->forces);
        if (status != CONTACT_SOLVED)
            return friction_problem(m, &m->friction_law, status);
        slack = m->friction_law.slack;
    } else {
        for (size_t i = 0; i < n; i++)
            m->forces[i] = D[i] > 0.0 ? -m->gap[i] / D[i] : 0.0;
        admit(&m->friction, m->forces, NULL);
        for (size_t i = 0; i < n; i++)
            slack[i] = m->gap[i] + D[i] * m->forces[i];
    }
    take_slip(m, slack, 1.0);
    note_sliding(m);
    return OUTCOME_OK;
}

/* ---- without ---- */

/* Make the law alone, S = R, and say whether R counts; to be done after condense(). */
static int prepare_law(struct motion *m)
{
    const struct joint *j = &m->joint;
    const size_t r = j->n_relative;
    int hard = 0;
    m->counts = j->has_residual != 0;
    if (!m->counts)
        return 0;
    if (has_friction(j))
        return prepare_frictional_law(m);
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
    if (has_friction(j))
        return slide_mean(m, free_q);
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
    if (has_friction(j))
        return slide_end(m);
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
