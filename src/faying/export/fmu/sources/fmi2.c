/* FMI 2.0 for co-simulation. */

#include "identifier.h"

/* Source distributions carry the name of the model before those of the functions; shared libraries,
 * compiled with FMI2_OVERRIDE_FUNCTION_PREFIX, do not. */
#if defined(FMI2_OVERRIDE_FUNCTION_PREFIX)
#define FUNCTION(name) fmi2##name
#else
#define FUNCTION(name) EXPANDED(FMI2_FUNCTION_PREFIX, fmi2##name)
#endif
#define OF_STATE(action) FUNCTION(action##FMUstate)
#define STATE_SIZE SerializedFMUstateSize
#define DESERIALIZE DeSerializeFMUstate
#define N_VALUES
#define IS_ROOM 1

typedef int fmi_boolean;

#include "fmi.c"

enum fmu_type { MODEL_EXCHANGE, CO_SIMULATION };
enum status_kind { DO_STEP_STATUS, PENDING_STATUS, LAST_SUCCESSFUL_TIME, IS_TERMINATED };

struct callbacks {
    void (*logger)(void *, const char *, enum status, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*step_finished)(void *, enum status);
    void *environment;
};

static void log_message(void *environment, const char *name, int is_error, const char *message)
{
    const struct callbacks *callbacks = environment;
    if (callbacks && callbacks->logger)
        callbacks->logger(callbacks->environment, name, is_error ? STATUS_ERROR : STATUS_OK,
                          is_error ? "logStatusError" : "logAll", "%s", message);
}

static int digit_of(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    c = (char)(c | 0x20);
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* The folder that a URI names; NULL without memory. */
static char *folder_of(const char *uri)
{
    const char *from = uri;
    if (strncmp(from, "file:", 5) == 0) {
        from += 5;
        if (strncmp(from, "//", 2) == 0)
            for (from += 2; *from && *from != '/'; from++) {
            }
        /* file:///C:/folder */
        if (from[0] == '/' && from[1] && from[2] == ':')
            from++;
    }
    char *folder = malloc(strlen(from) + 1), *to = folder;
    if (!folder)
        return NULL;
    for (; *from; from++) {
        if (*from == '%' && digit_of(from[1]) >= 0 && digit_of(from[2]) >= 0) {
            *to++ = (char)(16 * digit_of(from[1]) + digit_of(from[2]));
            from += 2;
        } else {
            *to++ = *from;
        }
    }
    *to = '\0';
    return folder;
}

EXPORTED const char *FUNCTION(GetTypesPlatform)(void) { return "default"; }

EXPORTED const char *FUNCTION(GetVersion)(void) { return "2.0"; }

EXPORTED void *FUNCTION(Instantiate)(const char *name, enum fmu_type type, const char *guid,
                                     const char *resources, const struct callbacks *callbacks,
                                     fmi_boolean visible, fmi_boolean logging)
{
    static const struct callbacks silent;
    (void)visible, (void)logging;
    char *folder = resources && type == CO_SIMULATION ? folder_of(resources) : NULL;
    struct motion *m = instantiate(name, folder, guid, log_message, callbacks ? callbacks : &silent,
                                   sizeof silent);
    free(folder);
    return m;
}

FMI(SetupExperiment)(void *instance, fmi_boolean tolerance_defined, double tolerance, double start,
                     fmi_boolean stop_defined, double stop)
{
    struct motion *m = instance;
    (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
    if (!is_mode(m, MODE_INSTANTIATED))
        return refuse(instance, "the experiment is set up after instantiation only");
    m->state[AT_TIME] = start;
    return STATUS_OK;
}

FMI(EnterInitializationMode)(void *instance)
{
    struct motion *m = instance;
    if (!is_mode(m, MODE_INSTANTIATED))
        return refuse(instance, "initialization follows instantiation only");
    m->state[AT_MODE] = MODE_INITIALIZING;
    return STATUS_OK;
}

FMI(GetReal)(void *instance, const unsigned int references[], size_t n, double values[])
{
    for (size_t i = 0; i < n; i++)
        if (size_of(instance, references[i]) > 1)
            return refuse(instance, "arrays are read by element");
    return status_of(read_values(instance, references, n, values, n));
}

FMI(SetReal)(void *instance, const unsigned int references[], size_t n, const double values[])
{
    return write_reals(instance, references, n, values);
}

CHOICE(Integer, int, KIND_INTEGRATOR)
CHOICE(Boolean, int, KIND_START_LOADED)

FMI(GetDirectionalDerivative)(void *instance, const unsigned int unknowns[], size_t n_unknowns,
                              const unsigned int knowns[], size_t n_knowns, const double seed[],
                              double result[])
{
    (void)unknowns, (void)n_unknowns, (void)knowns, (void)n_knowns, (void)seed, (void)result;
    return refuse(instance, "directional derivatives are not provided");
}

/* Set the first derivative of an input by time, for the next communication step. */
static enum outcome write_rate(struct motion *m, unsigned int reference, double value)
{
    const enum kind kind = kind_of(reference);
    const int is_input = kind == KIND_FORCE || kind == KIND_INITIAL_FORCE || kind == KIND_FACTOR;
    double *place = is_input ? settable(m, reference) : NULL;
    if (!place) {
        report(m, "variable %u is no input that could be set now", reference);
        return OUTCOME_ERROR;
    }
    m->rates[place - m->inputs] = value;
    return OUTCOME_OK;
}

FMI(SetRealInputDerivatives)(void *instance, const unsigned int references[], size_t n,
                             const int orders[], const double values[])
{
    for (size_t i = 0; i < n; i++) {
        if (orders[i] != 1)
            return refuse(instance, "inputs are interpolated by their first derivative only");
        if (write_rate(instance, references[i], values[i]) != OUTCOME_OK)
            return STATUS_ERROR;
    }
    return STATUS_OK;
}

FMI(GetRealOutputDerivatives)(void *instance, const unsigned int references[], size_t n,
                              const int orders[], double values[])
{
    (void)references, (void)n, (void)orders, (void)values;
    return refuse(instance, "output derivatives are not provided; velocities are outputs");
}

FMI(DoStep)(void *instance, double time, double length, fmi_boolean no_return)
{
    (void)no_return;
    if (!is_mode(instance, MODE_STEPPING))
        return refuse(instance, "steps follow initialization only");
    return status_of(advance_motion(instance, time, length));
}

static enum status not_asynchronous(void *instance)
{
    return refuse(instance, "steps are not asynchronous");
}

FMI(CancelStep)(void *instance) { return not_asynchronous(instance); }

FMI(GetStatus)(void *instance, enum status_kind kind, enum status *value)
{
    (void)kind, (void)value;
    return not_asynchronous(instance);
}

FMI(GetRealStatus)(void *instance, enum status_kind kind, double *value)
{
    const struct motion *m = instance;
    if (kind != LAST_SUCCESSFUL_TIME)
        return not_asynchronous(instance);
    *value = m->state[AT_TIME];
    return STATUS_OK;
}

FMI(GetIntegerStatus)(void *instance, enum status_kind kind, int *value)
{
    (void)kind, (void)value;
    return not_asynchronous(instance);
}

FMI(GetBooleanStatus)(void *instance, enum status_kind kind, fmi_boolean *value)
{
    if (kind != IS_TERMINATED)
        return not_asynchronous(instance);
    *value = 0;
    return STATUS_OK;
}

FMI(GetStringStatus)(void *instance, enum status_kind kind, const char **value)
{
    (void)kind, (void)value;
    return not_asynchronous(instance);
}
