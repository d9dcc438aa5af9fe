/* Variables by value reference: what they are, in which modes they may be set, how they are read.
 *
 * A value reference is 2^20 times the kind plus an index; the exporter numbers alike. WHOLE as
 * index means all of an array. */

enum kind {
    KIND_TIME,
    KIND_STEP_SIZE,
    KIND_RHO,
    KIND_PENALTY,
    KIND_FRICTION, /* coefficient */
    KIND_TANGENTIAL_PENALTY,
    KIND_INTEGRATOR,
    KIND_START_LOADED,
    KIND_FORCE,         /* boundary force */
    KIND_INITIAL_FORCE, /* of a bolt */
    KIND_FACTOR,        /* of a deck load */
    KIND_DISPLACEMENT,  /* the motion follows from here */
    KIND_VELOCITY,
    KIND_BOLT_FORCE,
    KIND_CONTACT_FORCE,
    KIND_MAX_PRESSURE,
    KIND_OPEN_FRACTION,
    KIND_MAX_TRACTION,
    KIND_STICK_FRACTION,
    KIND_SLIP_FRACTION,
    KIND_DISSIPATED_ENERGY,
    KIND_Q,
    KIND_Q_VELOCITY,
    KIND_Q_ACCELERATION,
    KIND_PRESSURE, /* of all points of an interface */
    KIND_TRACTION,
    N_KIND
};

#define INDEX_BITS 20
#define WHOLE ((1U << INDEX_BITS) - 1U)

static enum kind kind_of(unsigned int reference)
{
    return (enum kind)(reference >> INDEX_BITS);
}

static size_t index_of(unsigned int reference)
{
    return reference & WHOLE;
}

/* Number of variables of a kind. */
static size_t count_of(const struct motion *m, enum kind kind)
{
    const struct joint *j = &m->joint;
    switch (kind) {
    case KIND_PENALTY:
    case KIND_CONTACT_FORCE:
    case KIND_MAX_PRESSURE:
    case KIND_OPEN_FRACTION:
    case KIND_PRESSURE:
        return j->n_interface;
    case KIND_FRICTION:
    case KIND_TANGENTIAL_PENALTY:
    case KIND_MAX_TRACTION:
    case KIND_STICK_FRACTION:
    case KIND_SLIP_FRACTION:
    case KIND_DISSIPATED_ENERGY:
    case KIND_TRACTION:
        return has_friction(j) ? j->n_interface : 0;
    case KIND_FORCE:
    case KIND_DISPLACEMENT:
    case KIND_VELOCITY:
        return j->n_boundary;
    case KIND_INITIAL_FORCE:
    case KIND_BOLT_FORCE:
        return j->n_bolt;
    case KIND_FACTOR:
        return j->n_pattern;
    case KIND_Q:
    case KIND_Q_VELOCITY:
    case KIND_Q_ACCELERATION:
        return j->n_mode;
    case KIND_TIME:
    case KIND_STEP_SIZE:
    case KIND_RHO:
    case KIND_INTEGRATOR:
    case KIND_START_LOADED:
        return 1;
    case N_KIND:
        break;
    }
    return 0;
}

/* Number of values behind a reference; zero if there is no such variable. */
static size_t size_of(const struct motion *m, unsigned int reference)
{
    const enum kind kind = kind_of(reference);
    const size_t index = index_of(reference);
    const int is_motion
        = kind == KIND_Q || kind == KIND_Q_VELOCITY || kind == KIND_Q_ACCELERATION;
    if (kind >= N_KIND || kind == KIND_INTEGRATOR || kind == KIND_START_LOADED)
        return 0;
    if (is_motion && index == WHOLE)
        return m->joint.n_mode;
    if (index >= count_of(m, kind))
        return 0;
    if (kind == KIND_PRESSURE || kind == KIND_TRACTION)
        return (size_t)(m->joint.interface_start[index + 1] - m->joint.interface_start[index]);
    return 1;
}

static double bolt_force(const struct motion *m, size_t bolt)
{
    const struct joint *j = &m->joint;
    const double elongation = dot(j->elongations + bolt * j->n_mode, m->q, j->n_mode);
    return j->bolt_stiffness[bolt] * elongation + m->held[bolt];
}

/* Pressure, or length of the tangential traction. */
static double stress(const struct motion *m, enum kind kind, uint64_t p)
{
    const size_t n = m->joint.n_point;
    const int is_traction = kind == KIND_TRACTION || kind == KIND_MAX_TRACTION;
    return (is_traction ? hypot(m->forces[n + p], m->forces[2 * n + p]) : m->forces[p])
           / m->joint.weights[p];
}

/* Whether a point is in the state that an output has the share of area of. */
static int is_counted(const struct motion *m, enum kind kind, uint64_t p)
{
    const int is_closed_now = m->forces[p] > 0.0;
    if (kind == KIND_OPEN_FRACTION)
        return !is_closed_now;
    return is_closed_now && m->slides[p] == (kind == KIND_SLIP_FRACTION);
}

static double of_interface(const struct motion *m, enum kind kind, size_t interface)
{
    const struct joint *j = &m->joint;
    double total = 0.0, most = 0.0, area = 0.0, part = 0.0;
    const int is_share = kind == KIND_OPEN_FRACTION || kind == KIND_STICK_FRACTION
                         || kind == KIND_SLIP_FRACTION;
    for (uint64_t p = j->interface_start[interface]; p < j->interface_start[interface + 1]; p++) {
        total += m->forces[p];
        area += j->weights[p];
        if (is_share)
            part += is_counted(m, kind, p) ? j->weights[p] : 0.0;
        else
            most = fmax(most, stress(m, kind, p));
    }
    if (kind == KIND_CONTACT_FORCE)
        return total;
    return is_share ? area > 0.0 ? part / area : 0.0 : most;
}

static void copy_stresses(const struct motion *m, enum kind kind, size_t interface, double *values)
{
    const struct joint *j = &m->joint;
    for (uint64_t p = j->interface_start[interface]; p < j->interface_start[interface + 1]; p++)
        *values++ = stress(m, kind, p);
}

static void copy_motion(const struct motion *m, const double *values, size_t index, double *out)
{
    if (index == WHOLE)
        memcpy(out, values, m->joint.n_mode * sizeof *out);
    else
        *out = values[index];
}

/* Copy the values behind a reference that exists. */
static void copy_values(const struct motion *m, unsigned int reference, double *out)
{
    const struct joint *j = &m->joint;
    const enum kind kind = kind_of(reference);
    const size_t i = index_of(reference);
    switch (kind) {
    case KIND_TIME: *out = m->state[AT_TIME]; break;
    case KIND_STEP_SIZE: *out = m->state[AT_STEP_SIZE]; break;
    case KIND_RHO: *out = m->state[AT_RHO]; break;
    case KIND_PENALTY: *out = m->penalty[i]; break;
    case KIND_FRICTION: *out = m->mu[i]; break;
    case KIND_TANGENTIAL_PENALTY: *out = m->tangential[i]; break;
    case KIND_FORCE: *out = m->inputs[i]; break;
    case KIND_INITIAL_FORCE: *out = m->inputs[j->n_boundary + i]; break;
    case KIND_DISPLACEMENT: *out = m->q[j->boundary[i]]; break;
    case KIND_VELOCITY: *out = m->v[j->boundary[i]]; break;
    case KIND_BOLT_FORCE: *out = bolt_force(m, i); break;
    case KIND_CONTACT_FORCE:
    case KIND_MAX_PRESSURE:
    case KIND_OPEN_FRACTION:
    case KIND_MAX_TRACTION:
    case KIND_STICK_FRACTION:
    case KIND_SLIP_FRACTION: *out = of_interface(m, kind, i); break;
    case KIND_DISSIPATED_ENERGY: *out = m->dissipated[i]; break;
    case KIND_Q: copy_motion(m, m->q, i, out); break;
    case KIND_Q_VELOCITY: copy_motion(m, m->v, i, out); break;
    case KIND_Q_ACCELERATION: copy_motion(m, m->a, i, out); break;
    case KIND_PRESSURE:
    case KIND_TRACTION: copy_stresses(m, kind, i, out); break;
    case KIND_FACTOR: *out = m->inputs[j->n_boundary + j->n_bolt + i]; break;
    case KIND_INTEGRATOR:
    case KIND_START_LOADED:
    case N_KIND: break;
    }
}

/* Read values one after the other into room for n_values; every value must find its place. */
static enum outcome read_values(struct motion *m, const unsigned int *references, size_t n,
                                double *values, size_t n_values)
{
    size_t place = 0;
    for (size_t i = 0; i < n; i++) {
        const size_t size = size_of(m, references[i]);
        if (size == 0 || place + size > n_values) {
            report(m, "there is no real variable %u, or too little room for it", references[i]);
            return OUTCOME_ERROR;
        }
        const enum kind kind = kind_of(references[i]);
        if (is_mode(m, MODE_INITIALIZING) && kind >= KIND_DISPLACEMENT) {
            const enum outcome outcome = start_motion(m);
            if (outcome != OUTCOME_OK)
                return outcome;
        }
        copy_values(m, references[i], values + place);
        place += size;
    }
    if (place != n_values)
        report(m, "%lu values were asked for where there are %lu", (unsigned long)n_values,
               (unsigned long)place);
    return place == n_values ? OUTCOME_OK : OUTCOME_ERROR;
}

/* Where a variable that can be set lies; NULL where it cannot be set now. */
static double *settable(struct motion *m, unsigned int reference)
{
    const enum kind kind = kind_of(reference);
    const size_t i = index_of(reference);
    if (kind >= N_KIND || i >= count_of(m, kind))
        return NULL;
    if (kind == KIND_FORCE)
        return is_mode(m, MODE_TERMINATED) ? NULL : m->inputs + i;
    if (kind == KIND_INITIAL_FORCE)
        return is_mode(m, MODE_TERMINATED) ? NULL : m->inputs + m->joint.n_boundary + i;
    if (kind == KIND_FACTOR)
        return is_mode(m, MODE_TERMINATED)
                   ? NULL
                   : m->inputs + m->joint.n_boundary + m->joint.n_bolt + i;
    if (!is_mode(m, MODE_INSTANTIATED) && !is_mode(m, MODE_INITIALIZING))
        return NULL;
    switch (kind) {
    case KIND_STEP_SIZE: return m->state + AT_STEP_SIZE;
    case KIND_RHO: return m->state + AT_RHO;
    case KIND_INTEGRATOR: return m->state + AT_INTEGRATOR;
    case KIND_START_LOADED: return m->state + AT_START_LOADED;
    case KIND_PENALTY: return m->penalty + i;
    case KIND_FRICTION: return m->mu + i;
    case KIND_TANGENTIAL_PENALTY: return m->tangential + i;
    default: return NULL;
    }
}

static enum outcome write_value(struct motion *m, unsigned int reference, double value)
{
    double *place = settable(m, reference);
    if (!place) {
        report(m, "variable %u cannot be set, or not now", reference);
        return OUTCOME_ERROR;
    }
    *place = value;
    if (place >= m->inputs && place < m->inputs + m->n_input)
        m->rates[place - m->inputs] = 0.0;
    if (!is_mode(m, MODE_STEPPING))
        m->state[AT_INITIALIZED] = 0.0;
    return OUTCOME_OK;
}

/* The integer and the boolean parameter. */
static enum outcome read_choice(struct motion *m, enum kind kind, unsigned int reference,
                                double *value)
{
    if (kind_of(reference) != kind || index_of(reference) != 0) {
        report(m, "there is no variable %u of this type", reference);
        return OUTCOME_ERROR;
    }
    *value = m->state[kind == KIND_INTEGRATOR ? AT_INTEGRATOR : AT_START_LOADED];
    return OUTCOME_OK;
}

static enum outcome write_choice(struct motion *m, enum kind kind, unsigned int reference,
                                 double value)
{
    if (kind_of(reference) != kind) {
        report(m, "there is no variable %u of this type", reference);
        return OUTCOME_ERROR;
    }
    return write_value(m, reference, value);
}

/* Real variables only: what write_value takes, without integer and boolean parameters. */
static enum outcome write_real(struct motion *m, unsigned int reference, double value)
{
    const enum kind kind = kind_of(reference);
    if (kind == KIND_INTEGRATOR || kind == KIND_START_LOADED) {
        report(m, "variable %u is not real", reference);
        return OUTCOME_ERROR;
    }
    return write_value(m, reference, value);
}

/* ---- saved states ---- */

#define STATE_MAGIC UINT64_C(0x3154415453594146)

/* Words before the state block in serialized form: magic, checksum of the token, length. */
enum { N_STATE_HEADER = 3 };

struct saved_state {
    size_t n;
    double values[];
};

/* Save into a former state, or into a new one. */
static struct saved_state *save_state(const struct motion *m, struct saved_state *saved)
{
    if (!saved || saved->n != m->n_state)
        saved = malloc(sizeof *saved + m->n_state * sizeof(double));
    if (saved) {
        saved->n = m->n_state;
        memcpy(saved->values, m->state, m->n_state * sizeof(double));
    }
    return saved;
}

static enum outcome restore_state(struct motion *m, const struct saved_state *saved)
{
    if (!saved || saved->n != m->n_state) {
        report(m, "the state is not one of this joint");
        return OUTCOME_ERROR;
    }
    /* Matrices depend on parameters that the state may change. */
    const size_t n_law = (has_friction(&m->joint) ? 3 : 1) * m->joint.n_interface;
    if (memcmp(saved->values + AT_STEP_SIZE, m->state + AT_STEP_SIZE, N_PARAMETER * sizeof(double))
        || memcmp(saved->values + N_SCALAR, m->state + N_SCALAR, n_law * sizeof(double)))
        m->step = 0.0;
    memcpy(m->state, saved->values, m->n_state * sizeof(double));
    return OUTCOME_OK;
}

static uint64_t token_sum(const struct motion *m)
{
    uint64_t words[TOKEN_LENGTH / sizeof(uint64_t)];
    memcpy(words, m->joint.token, TOKEN_LENGTH);
    return checksum(words, TOKEN_LENGTH / sizeof(uint64_t));
}

static size_t serialized_size(const struct motion *m)
{
    return N_STATE_HEADER * sizeof(uint64_t) + m->n_state * sizeof(double);
}

static enum outcome serialize_state(struct motion *m, const struct saved_state *saved, void *bytes,
                                    size_t size)
{
    const uint64_t header[N_STATE_HEADER] = {STATE_MAGIC, token_sum(m), m->n_state};
    if (!saved || saved->n != m->n_state || size < serialized_size(m)) {
        report(m, "the state is not one of this joint, or there is too little room for it");
        return OUTCOME_ERROR;
    }
    memcpy(bytes, header, sizeof header);
    memcpy((char *)bytes + sizeof header, saved->values, saved->n * sizeof(double));
    return OUTCOME_OK;
}

static struct saved_state *deserialize_state(struct motion *m, const void *bytes, size_t size,
                                             struct saved_state *room)
{
    uint64_t header[N_STATE_HEADER] = {0};
    if (size >= sizeof header)
        memcpy(header, bytes, sizeof header);
    if (size != serialized_size(m) || header[0] != STATE_MAGIC || header[1] != token_sum(m)
        || header[2] != m->n_state) {
        report(m, "the serialized state is not one of this joint");
        return NULL;
    }
    struct saved_state *saved = save_state(m, room);
    if (saved)
        memcpy(saved->values, (const char *)bytes + sizeof header, m->n_state * sizeof(double));
    return saved;
}
