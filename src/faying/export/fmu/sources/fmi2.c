/* FMI 2.0 for co-simulation. The declarations that FMI prescribes are written out here, so that
 * these sources need no other header than those of the C library. */

#include "identifier.h"

#include "linalg.c"
#include "joint.c"
#include "contact.c"
#include "motion.c"
#include "mean.c"
#include "steps.c"
#include "variables.c"

#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif

/* Source distributions carry the name of the model before those of the functions; shared libraries,
 * compiled with FMI2_OVERRIDE_FUNCTION_PREFIX, do not. */
#if defined(FMI2_OVERRIDE_FUNCTION_PREFIX)
#define NAMED(name) name
#else
#define JOINED(a, b) a##b
#define EXPANDED(a, b) JOINED(a, b)
#define NAMED(name) EXPANDED(FMI2_FUNCTION_PREFIX, name)
#endif

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum {
    fmi2DoStepStatus,
    fmi2PendingStatus,
    fmi2LastSuccessfulTime,
    fmi2Terminated
} fmi2StatusKind;
typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#define FMI2(type) EXPORTED type

static fmi2Status status_of(enum outcome outcome)
{
    return outcome == OUTCOME_OK ? fmi2OK : fmi2Error;
}

static fmi2Status refuse(fmi2Component c, const char *what)
{
    report(c, "%s", what);
    return fmi2Error;
}

/* The environment is a copy of the callbacks: importers need not keep theirs. */
static void log_message(void *environment, const char *name, int is_error, const char *message)
{
    const fmi2CallbackFunctions *callbacks = environment;
    if (callbacks && callbacks->logger)
        callbacks->logger(callbacks->componentEnvironment, name, is_error ? fmi2Error : fmi2OK,
                          is_error ? "logStatusError" : "logAll", "%s", message);
}

static int digit_of(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    c = (char)(c | 0x20);
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* The path of resources/joint.bin from the URI of resources; NULL without memory. */
static char *path_of(const char *uri)
{
    static const char file[] = "/joint.bin";
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
    char *path = malloc(strlen(from) + sizeof file), *to = path;
    if (!path)
        return NULL;
    for (; *from; from++) {
        if (*from == '%' && digit_of(from[1]) >= 0 && digit_of(from[2]) >= 0) {
            *to++ = (char)(16 * digit_of(from[1]) + digit_of(from[2]));
            from += 2;
        } else {
            *to++ = *from;
        }
    }
    if (to > path && to[-1] == '/')
        to--;
    memcpy(to, file, sizeof file);
    return path;
}

FMI2(const char *) NAMED(fmi2GetTypesPlatform)(void) { return "default"; }

FMI2(const char *) NAMED(fmi2GetVersion)(void) { return "2.0"; }

FMI2(fmi2Status)
NAMED(fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[])
{
    (void)c, (void)on, (void)n, (void)names;
    return fmi2OK; /* only errors are logged, and those always */
}

FMI2(fmi2Component)
NAMED(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                       const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                       fmi2Boolean logging)
{
    (void)visible, (void)logging;
    fmi2CallbackFunctions *own = callbacks ? malloc(sizeof *own) : NULL;
    char *path = resources ? path_of(resources) : NULL;
    struct motion *m = NULL;
    if (own)
        *own = *callbacks;
    if (path && type == fmi2CoSimulation)
        m = create_motion(name, path, guid, log_message, own);
    else
        log_message(own, name, 1, "there is only co-simulation, and it needs its resources");
    free(path);
    if (!m)
        free(own);
    return m;
}

FMI2(void) NAMED(fmi2FreeInstance)(fmi2Component c)
{
    struct motion *m = c;
    if (m)
        free(m->environment);
    destroy_motion(m);
}

FMI2(fmi2Status)
NAMED(fmi2SetupExperiment)(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                           fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop)
{
    struct motion *m = c;
    (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
    if (!is_mode(m, MODE_INSTANTIATED))
        return refuse(c, "the experiment is set up after instantiation only");
    m->state[AT_TIME] = start;
    return fmi2OK;
}

FMI2(fmi2Status) NAMED(fmi2EnterInitializationMode)(fmi2Component c)
{
    struct motion *m = c;
    if (!is_mode(m, MODE_INSTANTIATED))
        return refuse(c, "initialization follows instantiation only");
    m->state[AT_MODE] = MODE_INITIALIZING;
    return fmi2OK;
}

FMI2(fmi2Status) NAMED(fmi2ExitInitializationMode)(fmi2Component c)
{
    struct motion *m = c;
    if (!is_mode(m, MODE_INITIALIZING))
        return refuse(c, "there is no initialization to end");
    const enum outcome outcome = start_motion(m);
    if (outcome == OUTCOME_OK)
        m->state[AT_MODE] = MODE_STEPPING;
    return status_of(outcome);
}

FMI2(fmi2Status) NAMED(fmi2Terminate)(fmi2Component c)
{
    struct motion *m = c;
    m->state[AT_MODE] = MODE_TERMINATED;
    return fmi2OK;
}

FMI2(fmi2Status) NAMED(fmi2Reset)(fmi2Component c)
{
    reset_motion(c);
    return fmi2OK;
}

FMI2(fmi2Status)
NAMED(fmi2GetReal)(fmi2Component c, const fmi2ValueReference references[], size_t n,
                   fmi2Real values[])
{
    for (size_t i = 0; i < n; i++)
        if (size_of(c, references[i]) > 1)
            return refuse(c, "arrays are read by element");
    return status_of(read_values(c, references, n, values, n));
}

FMI2(fmi2Status)
NAMED(fmi2SetReal)(fmi2Component c, const fmi2ValueReference references[], size_t n,
                   const fmi2Real values[])
{
    enum outcome outcome = OUTCOME_OK;
    for (size_t i = 0; outcome == OUTCOME_OK && i < n; i++)
        outcome = write_real(c, references[i], values[i]);
    return status_of(outcome);
}

static fmi2Status read_integers(fmi2Component c, enum kind kind, const fmi2ValueReference refs[],
                                size_t n, int values[])
{
    for (size_t i = 0; i < n; i++) {
        double value;
        if (read_choice(c, kind, refs[i], &value) != OUTCOME_OK)
            return fmi2Error;
        values[i] = (int)value;
    }
    return fmi2OK;
}

static fmi2Status write_integers(fmi2Component c, enum kind kind, const fmi2ValueReference refs[],
                                 size_t n, const int values[])
{
    for (size_t i = 0; i < n; i++)
        if (write_choice(c, kind, refs[i],
                         kind == KIND_START_LOADED ? (double)(values[i] != 0) : (double)values[i])
            != OUTCOME_OK)
            return fmi2Error;
    return fmi2OK;
}

FMI2(fmi2Status)
NAMED(fmi2GetInteger)(fmi2Component c, const fmi2ValueReference references[], size_t n,
                      fmi2Integer values[])
{
    return read_integers(c, KIND_INTEGRATOR, references, n, values);
}

FMI2(fmi2Status)
NAMED(fmi2SetInteger)(fmi2Component c, const fmi2ValueReference references[], size_t n,
                      const fmi2Integer values[])
{
    return write_integers(c, KIND_INTEGRATOR, references, n, values);
}

FMI2(fmi2Status)
NAMED(fmi2GetBoolean)(fmi2Component c, const fmi2ValueReference references[], size_t n,
                      fmi2Boolean values[])
{
    return read_integers(c, KIND_START_LOADED, references, n, values);
}

FMI2(fmi2Status)
NAMED(fmi2SetBoolean)(fmi2Component c, const fmi2ValueReference references[], size_t n,
                      const fmi2Boolean values[])
{
    return write_integers(c, KIND_START_LOADED, references, n, values);
}

FMI2(fmi2Status)
NAMED(fmi2GetString)(fmi2Component c, const fmi2ValueReference references[], size_t n,
                     fmi2String values[])
{
    (void)references, (void)values;
    return n ? refuse(c, "there are no strings") : fmi2OK;
}

FMI2(fmi2Status)
NAMED(fmi2SetString)(fmi2Component c, const fmi2ValueReference references[], size_t n,
                     const fmi2String values[])
{
    (void)references, (void)values;
    return n ? refuse(c, "there are no strings") : fmi2OK;
}

FMI2(fmi2Status) NAMED(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    struct saved_state *saved = save_state(c, *state);
    if (!saved)
        return refuse(c, "not enough memory for the state");
    *state = saved;
    return fmi2OK;
}

FMI2(fmi2Status) NAMED(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    return status_of(restore_state(c, state));
}

FMI2(fmi2Status) NAMED(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    (void)c;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi2OK;
}

FMI2(fmi2Status)
NAMED(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)state;
    *size = serialized_size(c);
    return fmi2OK;
}

FMI2(fmi2Status)
NAMED(fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    return status_of(serialize_state(c, state, bytes, size));
}

FMI2(fmi2Status)
NAMED(fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size,
                               fmi2FMUstate *state)
{
    struct saved_state *saved = deserialize_state(c, bytes, size, *state);
    if (!saved)
        return fmi2Error;
    *state = saved;
    return fmi2OK;
}

FMI2(fmi2Status)
NAMED(fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknowns[],
                                    size_t n_unknowns, const fmi2ValueReference knowns[],
                                    size_t n_knowns, const fmi2Real seed[], fmi2Real result[])
{
    (void)unknowns, (void)n_unknowns, (void)knowns, (void)n_knowns, (void)seed, (void)result;
    return refuse(c, "directional derivatives are not provided");
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

FMI2(fmi2Status)
NAMED(fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference references[],
                                   size_t n, const fmi2Integer orders[], const fmi2Real values[])
{
    for (size_t i = 0; i < n; i++) {
        if (orders[i] != 1)
            return refuse(c, "inputs are interpolated by their first derivative only");
        if (write_rate(c, references[i], values[i]) != OUTCOME_OK)
            return fmi2Error;
    }
    return fmi2OK;
}

FMI2(fmi2Status)
NAMED(fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference references[],
                                    size_t n, const fmi2Integer orders[], fmi2Real values[])
{
    (void)references, (void)n, (void)orders, (void)values;
    return refuse(c, "output derivatives are not provided; velocities are outputs");
}

FMI2(fmi2Status)
NAMED(fmi2DoStep)(fmi2Component c, fmi2Real time, fmi2Real length, fmi2Boolean no_return)
{
    (void)no_return;
    if (!is_mode(c, MODE_STEPPING))
        return refuse(c, "steps follow initialization only");
    return status_of(advance_motion(c, time, length));
}

FMI2(fmi2Status) NAMED(fmi2CancelStep)(fmi2Component c)
{
    return refuse(c, "steps are not asynchronous");
}

FMI2(fmi2Status)
NAMED(fmi2GetStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value)
{
    (void)kind, (void)value;
    return refuse(c, "steps are not asynchronous");
}

FMI2(fmi2Status)
NAMED(fmi2GetRealStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value)
{
    const struct motion *m = c;
    if (kind != fmi2LastSuccessfulTime)
        return refuse(c, "steps are not asynchronous");
    *value = m->state[AT_TIME];
    return fmi2OK;
}

FMI2(fmi2Status)
NAMED(fmi2GetIntegerStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value)
{
    (void)kind, (void)value;
    return refuse(c, "steps are not asynchronous");
}

FMI2(fmi2Status)
NAMED(fmi2GetBooleanStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    if (kind != fmi2Terminated)
        return refuse(c, "steps are not asynchronous");
    *value = 0;
    return fmi2OK;
}

FMI2(fmi2Status)
NAMED(fmi2GetStringStatus)(fmi2Component c, const fmi2StatusKind kind, fmi2String *value)
{
    (void)kind, (void)value;
    return refuse(c, "steps are not asynchronous");
}
