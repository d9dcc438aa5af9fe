/* FMI 3.0 for co-simulation. The declarations that FMI prescribes are written out here, so that
 * these sources need no other header than those of the C library. */

#include <stdbool.h>

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

/* Importers that link several models statically define a prefix. */
#if defined(FMI3_FUNCTION_PREFIX) && !defined(FMI3_OVERRIDE_FUNCTION_PREFIX)
#define JOINED(a, b) a##b
#define EXPANDED(a, b) JOINED(a, b)
#define NAMED(name) EXPANDED(FMI3_FUNCTION_PREFIX, name)
#else
#define NAMED(name) name
#endif

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef double fmi3Float64;
typedef bool fmi3Boolean;
typedef const char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String, fmi3String);
typedef void (*fmi3Callback)(void); /* of functions that are never called from here */

#define FMI3(type) EXPORTED type

/* What the log needs; the copy lives as long as the instance. */
struct logging {
    fmi3LogMessageCallback callback;
    fmi3InstanceEnvironment environment;
};

static void log_message(void *environment, const char *name, int is_error, const char *message)
{
    const struct logging *logging = environment;
    (void)name;
    if (logging && logging->callback)
        logging->callback(logging->environment, is_error ? fmi3Error : fmi3OK,
                          is_error ? "logStatusError" : "logAll", message);
}

static fmi3Status status_of(enum outcome outcome)
{
    return outcome == OUTCOME_OK ? fmi3OK : fmi3Error;
}

static fmi3Status refuse(fmi3Instance instance, const char *what)
{
    report(instance, "%s", what);
    return fmi3Error;
}

/* The path of joint.bin in the folder of resources; NULL without memory. */
static char *path_of(const char *folder)
{
    static const char file[] = "/joint.bin";
    const size_t length = strlen(folder);
    const int ends = length && (folder[length - 1] == '/' || folder[length - 1] == '\\');
    char *path = malloc(length + sizeof file);
    if (!path)
        return NULL;
    memcpy(path, folder, length);
    memcpy(path + length, file + (ends ? 1 : 0), sizeof file - (ends ? 1 : 0));
    return path;
}

FMI3(const char *) NAMED(fmi3GetVersion)(void) { return "3.0"; }

FMI3(fmi3Status)
NAMED(fmi3SetDebugLogging)(fmi3Instance instance, fmi3Boolean on, size_t n,
                           const fmi3String names[])
{
    (void)instance, (void)on, (void)n, (void)names;
    return fmi3OK; /* only errors are logged, and those always */
}

FMI3(fmi3Instance)
NAMED(fmi3InstantiateCoSimulation)(fmi3String name, fmi3String token, fmi3String resources,
                                   fmi3Boolean visible, fmi3Boolean logging_on,
                                   fmi3Boolean event_mode, fmi3Boolean early_return,
                                   const fmi3ValueReference intermediate[], size_t n_intermediate,
                                   fmi3InstanceEnvironment environment,
                                   fmi3LogMessageCallback callback, fmi3Callback update)
{
    (void)visible, (void)logging_on, (void)event_mode, (void)early_return, (void)intermediate;
    (void)n_intermediate, (void)update;
    struct logging *logging = malloc(sizeof *logging);
    char *path = resources ? path_of(resources) : NULL;
    struct motion *m = NULL;
    if (logging) {
        logging->callback = callback;
        logging->environment = environment;
    }
    if (path)
        m = create_motion(name, path, token, log_message, logging);
    else
        log_message(logging, name, 1, "the joint needs the path of its resources");
    free(path);
    if (!m)
        free(logging);
    return m;
}

FMI3(fmi3Instance)
NAMED(fmi3InstantiateModelExchange)(fmi3String name, fmi3String token, fmi3String resources,
                                    fmi3Boolean visible, fmi3Boolean logging_on,
                                    fmi3InstanceEnvironment environment,
                                    fmi3LogMessageCallback callback)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging_on;
    if (callback)
        callback(environment, fmi3Error, "logStatusError", "there is only co-simulation");
    return NULL;
}

FMI3(fmi3Instance)
NAMED(fmi3InstantiateScheduledExecution)(fmi3String name, fmi3String token, fmi3String resources,
                                         fmi3Boolean visible, fmi3Boolean logging_on,
                                         fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback callback, fmi3Callback clock,
                                         fmi3Callback lock, fmi3Callback unlock)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging_on;
    (void)clock, (void)lock, (void)unlock;
    if (callback)
        callback(environment, fmi3Error, "logStatusError", "there is only co-simulation");
    return NULL;
}

FMI3(void) NAMED(fmi3FreeInstance)(fmi3Instance instance)
{
    struct motion *m = instance;
    if (m)
        free(m->environment);
    destroy_motion(m);
}

FMI3(fmi3Status)
NAMED(fmi3EnterInitializationMode)(fmi3Instance instance, fmi3Boolean tolerance_defined,
                                   fmi3Float64 tolerance, fmi3Float64 start,
                                   fmi3Boolean stop_defined, fmi3Float64 stop)
{
    struct motion *m = instance;
    (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
    if (!is_mode(m, MODE_INSTANTIATED))
        return refuse(instance, "initialization follows instantiation only");
    m->state[AT_TIME] = start;
    m->state[AT_MODE] = MODE_INITIALIZING;
    return fmi3OK;
}

FMI3(fmi3Status) NAMED(fmi3ExitInitializationMode)(fmi3Instance instance)
{
    struct motion *m = instance;
    if (!is_mode(m, MODE_INITIALIZING))
        return refuse(instance, "there is no initialization to end");
    const enum outcome outcome = start_motion(m);
    if (outcome == OUTCOME_OK)
        m->state[AT_MODE] = MODE_STEPPING;
    return status_of(outcome);
}

FMI3(fmi3Status) NAMED(fmi3Terminate)(fmi3Instance instance)
{
    struct motion *m = instance;
    m->state[AT_MODE] = MODE_TERMINATED;
    return fmi3OK;
}

FMI3(fmi3Status) NAMED(fmi3Reset)(fmi3Instance instance)
{
    reset_motion(instance);
    return fmi3OK;
}

FMI3(fmi3Status)
NAMED(fmi3DoStep)(fmi3Instance instance, fmi3Float64 time, fmi3Float64 length,
                  fmi3Boolean no_return, fmi3Boolean *event_needed, fmi3Boolean *terminate,
                  fmi3Boolean *early_return, fmi3Float64 *last_time)
{
    struct motion *m = instance;
    (void)no_return;
    if (!is_mode(m, MODE_STEPPING))
        return refuse(instance, "steps follow initialization only");
    const enum outcome outcome = advance_motion(m, time, length);
    *event_needed = *terminate = *early_return = false;
    *last_time = m->state[AT_TIME];
    return status_of(outcome);
}

/* ---- variables ---- */

FMI3(fmi3Status)
NAMED(fmi3GetFloat64)(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                      fmi3Float64 values[], size_t n_values)
{
    return status_of(read_values(instance, references, n, values, n_values));
}

FMI3(fmi3Status)
NAMED(fmi3SetFloat64)(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                      const fmi3Float64 values[], size_t n_values)
{
    enum outcome outcome = OUTCOME_OK;
    if (n != n_values)
        return refuse(instance, "arrays cannot be set");
    for (size_t i = 0; outcome == OUTCOME_OK && i < n; i++)
        outcome = write_real(instance, references[i], values[i]);
    return status_of(outcome);
}

FMI3(fmi3Status)
NAMED(fmi3GetInt32)(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                    int32_t values[], size_t n_values)
{
    double value;
    for (size_t i = 0; i < n && i < n_values; i++) {
        if (read_choice(instance, KIND_INTEGRATOR, references[i], &value) != OUTCOME_OK)
            return fmi3Error;
        values[i] = (int32_t)value;
    }
    return fmi3OK;
}

FMI3(fmi3Status)
NAMED(fmi3SetInt32)(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                    const int32_t values[], size_t n_values)
{
    for (size_t i = 0; i < n && i < n_values; i++)
        if (write_choice(instance, KIND_INTEGRATOR, references[i], values[i]) != OUTCOME_OK)
            return fmi3Error;
    return fmi3OK;
}

FMI3(fmi3Status)
NAMED(fmi3GetBoolean)(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                      fmi3Boolean values[], size_t n_values)
{
    double value;
    for (size_t i = 0; i < n && i < n_values; i++) {
        if (read_choice(instance, KIND_START_LOADED, references[i], &value) != OUTCOME_OK)
            return fmi3Error;
        values[i] = value != 0.0;
    }
    return fmi3OK;
}

FMI3(fmi3Status)
NAMED(fmi3SetBoolean)(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                      const fmi3Boolean values[], size_t n_values)
{
    for (size_t i = 0; i < n && i < n_values; i++)
        if (write_choice(instance, KIND_START_LOADED, references[i], values[i] ? 1.0 : 0.0)
            != OUTCOME_OK)
            return fmi3Error;
    return fmi3OK;
}

/* Types that the joint has no variables of. */
#define NO_VARIABLES(name, type)                                                                   \
    FMI3(fmi3Status)                                                                               \
    NAMED(fmi3Get##name)(fmi3Instance instance, const fmi3ValueReference references[], size_t n,   \
                         type values[], size_t n_values)                                           \
    {                                                                                              \
        (void)references, (void)values, (void)n_values;                                            \
        return n ? refuse(instance, "there are no variables of type " #name) : fmi3OK;             \
    }                                                                                              \
    FMI3(fmi3Status)                                                                               \
    NAMED(fmi3Set##name)(fmi3Instance instance, const fmi3ValueReference references[], size_t n,   \
                         const type values[], size_t n_values)                                     \
    {                                                                                              \
        (void)references, (void)values, (void)n_values;                                            \
        return n ? refuse(instance, "there are no variables of type " #name) : fmi3OK;             \
    }

NO_VARIABLES(Float32, float)
NO_VARIABLES(Int8, int8_t)
NO_VARIABLES(UInt8, uint8_t)
NO_VARIABLES(Int16, int16_t)
NO_VARIABLES(UInt16, uint16_t)
NO_VARIABLES(UInt32, uint32_t)
NO_VARIABLES(Int64, int64_t)
NO_VARIABLES(UInt64, uint64_t)
NO_VARIABLES(String, fmi3String)

FMI3(fmi3Status)
NAMED(fmi3GetBinary)(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                     size_t sizes[], fmi3Binary values[], size_t n_values)
{
    (void)references, (void)sizes, (void)values, (void)n_values;
    return n ? refuse(instance, "there are no binary variables") : fmi3OK;
}

FMI3(fmi3Status)
NAMED(fmi3SetBinary)(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                     const size_t sizes[], const fmi3Binary values[], size_t n_values)
{
    (void)references, (void)sizes, (void)values, (void)n_values;
    return n ? refuse(instance, "there are no binary variables") : fmi3OK;
}

FMI3(fmi3Status)
NAMED(fmi3GetClock)(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                    fmi3Clock values[])
{
    (void)references, (void)values;
    return n ? refuse(instance, "there are no clocks") : fmi3OK;
}

FMI3(fmi3Status)
NAMED(fmi3SetClock)(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                    const fmi3Clock values[])
{
    (void)references, (void)values;
    return n ? refuse(instance, "there are no clocks") : fmi3OK;
}

/* ---- states ---- */

FMI3(fmi3Status) NAMED(fmi3GetFMUState)(fmi3Instance instance, fmi3FMUState *state)
{
    struct saved_state *saved = save_state(instance, *state);
    if (!saved)
        return refuse(instance, "not enough memory for the state");
    *state = saved;
    return fmi3OK;
}

FMI3(fmi3Status) NAMED(fmi3SetFMUState)(fmi3Instance instance, fmi3FMUState state)
{
    return status_of(restore_state(instance, state));
}

FMI3(fmi3Status) NAMED(fmi3FreeFMUState)(fmi3Instance instance, fmi3FMUState *state)
{
    (void)instance;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return fmi3OK;
}

FMI3(fmi3Status)
NAMED(fmi3SerializedFMUStateSize)(fmi3Instance instance, fmi3FMUState state, size_t *size)
{
    (void)state;
    *size = serialized_size(instance);
    return fmi3OK;
}

FMI3(fmi3Status)
NAMED(fmi3SerializeFMUState)(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[],
                             size_t size)
{
    return status_of(serialize_state(instance, state, bytes, size));
}

FMI3(fmi3Status)
NAMED(fmi3DeserializeFMUState)(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                               fmi3FMUState *state)
{
    struct saved_state *saved = deserialize_state(instance, bytes, size, *state);
    if (!saved)
        return fmi3Error;
    *state = saved;
    return fmi3OK;
}

/* ---- what FMI 3.0 wants to be there, and this joint does not provide ---- */

#define ABSENT(name, ...)                                                                          \
    FMI3(fmi3Status) NAMED(name)(fmi3Instance instance, __VA_ARGS__)

#define NOT_PROVIDED(name)                                                                         \
    FMI3(fmi3Status) NAMED(name)(fmi3Instance instance)                                            \
    {                                                                                              \
        return refuse(instance, #name " is not provided");                                         \
    }

NOT_PROVIDED(fmi3EnterEventMode)
NOT_PROVIDED(fmi3EnterStepMode)
NOT_PROVIDED(fmi3EnterConfigurationMode)
NOT_PROVIDED(fmi3ExitConfigurationMode)
NOT_PROVIDED(fmi3EnterContinuousTimeMode)
NOT_PROVIDED(fmi3EvaluateDiscreteStates)

ABSENT(fmi3UpdateDiscreteStates, fmi3Boolean *update, fmi3Boolean *terminate,
       fmi3Boolean *nominals, fmi3Boolean *values, fmi3Boolean *defined, fmi3Float64 *time)
{
    (void)update, (void)terminate, (void)nominals, (void)values, (void)defined, (void)time;
    return refuse(instance, "there are no discrete states");
}

ABSENT(fmi3GetNumberOfVariableDependencies, fmi3ValueReference reference, size_t *n)
{
    (void)reference, (void)n;
    return refuse(instance, "dependencies do not change");
}

ABSENT(fmi3GetVariableDependencies, fmi3ValueReference dependent, size_t of_dependent[],
       fmi3ValueReference independents[], size_t of_independents[], int kinds[], size_t n)
{
    (void)dependent, (void)of_dependent, (void)independents, (void)of_independents;
    (void)kinds, (void)n;
    return refuse(instance, "dependencies do not change");
}

#define NO_DERIVATIVE(name)                                                                        \
    ABSENT(name, const fmi3ValueReference unknowns[], size_t n_unknowns,                           \
           const fmi3ValueReference knowns[], size_t n_knowns, const fmi3Float64 seed[],           \
           size_t n_seed, fmi3Float64 result[], size_t n_result)                                   \
    {                                                                                              \
        (void)unknowns, (void)n_unknowns, (void)knowns, (void)n_knowns, (void)seed;                \
        (void)n_seed, (void)result, (void)n_result;                                                \
        return refuse(instance, #name " is not provided");                                         \
    }

NO_DERIVATIVE(fmi3GetDirectionalDerivative)
NO_DERIVATIVE(fmi3GetAdjointDerivative)

ABSENT(fmi3GetOutputDerivatives, const fmi3ValueReference references[], size_t n,
       const int32_t orders[], fmi3Float64 values[], size_t n_values)
{
    (void)references, (void)n, (void)orders, (void)values, (void)n_values;
    return refuse(instance, "output derivatives are not provided; velocities are outputs");
}

#define NO_INTERVAL(name, first, second)                                                           \
    ABSENT(name, const fmi3ValueReference references[], size_t n, first a, second b)               \
    {                                                                                              \
        (void)references, (void)n, (void)a, (void)b;                                               \
        return refuse(instance, "there are no clocks");                                            \
    }

NO_INTERVAL(fmi3GetIntervalDecimal, fmi3Float64 *, int *)
NO_INTERVAL(fmi3SetIntervalFraction, const uint64_t *, const uint64_t *)
NO_INTERVAL(fmi3GetShiftFraction, uint64_t *, uint64_t *)
NO_INTERVAL(fmi3SetShiftFraction, const uint64_t *, const uint64_t *)

ABSENT(fmi3GetIntervalFraction, const fmi3ValueReference references[], size_t n,
       uint64_t counters[], uint64_t resolutions[], int qualifiers[])
{
    (void)references, (void)n, (void)counters, (void)resolutions, (void)qualifiers;
    return refuse(instance, "there are no clocks");
}

#define NO_DECIMAL(name, type)                                                                     \
    ABSENT(name, const fmi3ValueReference references[], size_t n, type values)                     \
    {                                                                                              \
        (void)references, (void)n, (void)values;                                                   \
        return refuse(instance, "there are no clocks");                                            \
    }

NO_DECIMAL(fmi3SetIntervalDecimal, const fmi3Float64 *)
NO_DECIMAL(fmi3GetShiftDecimal, fmi3Float64 *)
NO_DECIMAL(fmi3SetShiftDecimal, const fmi3Float64 *)

ABSENT(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock, (void)time;
    return refuse(instance, "there are no model partitions");
}

/* Functions of model exchange. */
ABSENT(fmi3CompletedIntegratorStep, fmi3Boolean no_return, fmi3Boolean *event,
       fmi3Boolean *terminate)
{
    (void)no_return, (void)event, (void)terminate;
    return refuse(instance, "there is only co-simulation");
}

ABSENT(fmi3SetTime, fmi3Float64 time)
{
    (void)time;
    return refuse(instance, "there is only co-simulation");
}

#define NO_STATES(name, type)                                                                      \
    ABSENT(name, type values, size_t n)                                                            \
    {                                                                                              \
        (void)values, (void)n;                                                                     \
        return refuse(instance, "there is only co-simulation");                                    \
    }

NO_STATES(fmi3SetContinuousStates, const fmi3Float64 *)
NO_STATES(fmi3GetContinuousStates, fmi3Float64 *)
NO_STATES(fmi3GetContinuousStateDerivatives, fmi3Float64 *)
NO_STATES(fmi3GetEventIndicators, fmi3Float64 *)
NO_STATES(fmi3GetNominalsOfContinuousStates, fmi3Float64 *)

#define NO_COUNT(name)                                                                             \
    ABSENT(name, size_t *n)                                                                        \
    {                                                                                              \
        (void)n;                                                                                   \
        return refuse(instance, "there is only co-simulation");                                    \
    }

NO_COUNT(fmi3GetNumberOfEventIndicators)
NO_COUNT(fmi3GetNumberOfContinuousStates)
