/* FMI 3.0 for co-simulation. */

#include <stdbool.h>
#include <stddef.h>

/* Importers that link several models statically define a prefix. */
#if defined(FMI3_FUNCTION_PREFIX) && !defined(FMI3_OVERRIDE_FUNCTION_PREFIX)
#define FUNCTION(name) EXPANDED(FMI3_FUNCTION_PREFIX, fmi3##name)
#else
#define FUNCTION(name) fmi3##name
#endif
#define OF_STATE(action) FUNCTION(action##FMUState)
#define STATE_SIZE SerializedFMUStateSize
#define DESERIALIZE DeserializeFMUState
#define N_VALUES , size_t n_values
#define IS_ROOM (n_values == n)

typedef bool fmi_boolean;

#include "fmi.c"

typedef void (*message_callback)(void *, enum status, const char *, const char *);
typedef void (*other_callback)(void); /* of functions that are never called from here */

struct logging {
    message_callback callback;
    void *environment;
};

static void log_message(void *environment, const char *name, int is_error, const char *message)
{
    const struct logging *logging = environment;
    (void)name;
    if (logging && logging->callback)
        logging->callback(logging->environment, is_error ? STATUS_ERROR : STATUS_OK,
                          is_error ? "logStatusError" : "logAll", message);
}

EXPORTED const char *FUNCTION(GetVersion)(void) { return "3.0"; }

EXPORTED void *
FUNCTION(InstantiateCoSimulation)(const char *name, const char *token, const char *resources,
                                  fmi_boolean visible, fmi_boolean logging_on,
                                  fmi_boolean event_mode, fmi_boolean early_return,
                                  const unsigned int intermediate[], size_t n_intermediate,
                                  void *environment, message_callback callback,
                                  other_callback update)
{
    (void)visible, (void)logging_on, (void)event_mode, (void)early_return, (void)intermediate;
    (void)n_intermediate, (void)update;
    const struct logging logging = {callback, environment};
    return instantiate(name, resources, token, log_message, &logging, sizeof logging);
}

EXPORTED void *
FUNCTION(InstantiateModelExchange)(const char *name, const char *token, const char *resources,
                                   fmi_boolean visible, fmi_boolean logging_on, void *environment,
                                   message_callback callback)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging_on;
    if (callback)
        callback(environment, STATUS_ERROR, "logStatusError", "there is only co-simulation");
    return NULL;
}

EXPORTED void *
FUNCTION(InstantiateScheduledExecution)(const char *name, const char *token, const char *resources,
                                        fmi_boolean visible, fmi_boolean logging_on,
                                        void *environment, message_callback callback,
                                        other_callback clock, other_callback lock,
                                        other_callback unlock)
{
    (void)clock, (void)lock, (void)unlock;
    return FUNCTION(InstantiateModelExchange)(name, token, resources, visible, logging_on,
                                              environment, callback);
}

FMI(EnterInitializationMode)(void *instance, fmi_boolean tolerance_defined, double tolerance,
                             double start, fmi_boolean stop_defined, double stop)
{
    struct motion *m = instance;
    (void)tolerance_defined, (void)tolerance, (void)stop_defined, (void)stop;
    if (!is_mode(m, MODE_INSTANTIATED))
        return refuse(instance, "initialization follows instantiation only");
    m->state[AT_TIME] = start;
    m->state[AT_MODE] = MODE_INITIALIZING;
    return STATUS_OK;
}

FMI(DoStep)(void *instance, double time, double length, fmi_boolean no_return,
            fmi_boolean *event_needed, fmi_boolean *terminate, fmi_boolean *early_return,
            double *last_time)
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

FMI(GetFloat64)(void *instance, const unsigned int references[], size_t n, double values[],
                size_t n_values)
{
    return status_of(read_values(instance, references, n, values, n_values));
}

FMI(SetFloat64)(void *instance, const unsigned int references[], size_t n, const double values[],
                size_t n_values)
{
    if (n != n_values)
        return refuse(instance, "arrays cannot be set");
    return write_reals(instance, references, n, values);
}

CHOICE(Int32, int32_t, KIND_INTEGRATOR)
CHOICE(Boolean, bool, KIND_START_LOADED)

NO_VARIABLES(Float32, float)
NO_VARIABLES(Int8, int8_t)
NO_VARIABLES(UInt8, uint8_t)
NO_VARIABLES(Int16, int16_t)
NO_VARIABLES(UInt16, uint16_t)
NO_VARIABLES(UInt32, uint32_t)
NO_VARIABLES(Int64, int64_t)
NO_VARIABLES(UInt64, uint64_t)

FMI(GetBinary)(void *instance, const unsigned int references[], size_t n, size_t sizes[],
               const unsigned char *values[], size_t n_values)
{
    (void)references, (void)sizes, (void)values, (void)n_values;
    return n ? refuse(instance, "there are no binary variables") : STATUS_OK;
}

FMI(SetBinary)(void *instance, const unsigned int references[], size_t n, const size_t sizes[],
               const unsigned char *values[], size_t n_values)
{
    (void)references, (void)sizes, (void)values, (void)n_values;
    return n ? refuse(instance, "there are no binary variables") : STATUS_OK;
}

FMI(GetClock)(void *instance, const unsigned int references[], size_t n, bool values[])
{
    (void)references, (void)values;
    return n ? refuse(instance, "there are no clocks") : STATUS_OK;
}

FMI(SetClock)(void *instance, const unsigned int references[], size_t n, const bool values[])
{
    (void)references, (void)values;
    return n ? refuse(instance, "there are no clocks") : STATUS_OK;
}

/* ---- what FMI 3.0 wants to be there, and this joint does not provide ---- */

#define NOT_PROVIDED(name)                                                                         \
    FMI(name)(void *instance)                                                                      \
    {                                                                                              \
        return refuse(instance, "fmi3" #name " is not provided");                                  \
    }

NOT_PROVIDED(EnterEventMode)
NOT_PROVIDED(EnterStepMode)
NOT_PROVIDED(EnterConfigurationMode)
NOT_PROVIDED(ExitConfigurationMode)
NOT_PROVIDED(EnterContinuousTimeMode)
NOT_PROVIDED(EvaluateDiscreteStates)

FMI(UpdateDiscreteStates)(void *instance, fmi_boolean *update, fmi_boolean *terminate,
                          fmi_boolean *nominals, fmi_boolean *values, fmi_boolean *defined,
                          double *time)
{
    (void)update, (void)terminate, (void)nominals, (void)values, (void)defined, (void)time;
    return refuse(instance, "there are no discrete states");
}

FMI(GetNumberOfVariableDependencies)(void *instance, unsigned int reference, size_t *n)
{
    (void)reference, (void)n;
    return refuse(instance, "dependencies do not change");
}

FMI(GetVariableDependencies)(void *instance, unsigned int dependent, size_t of_dependent[],
                             unsigned int independents[], size_t of_independents[], int kinds[],
                             size_t n)
{
    (void)dependent, (void)of_dependent, (void)independents, (void)of_independents;
    (void)kinds, (void)n;
    return refuse(instance, "dependencies do not change");
}

#define NO_DERIVATIVE(name)                                                                        \
    FMI(name)(void *instance, const unsigned int unknowns[], size_t n_unknowns,                    \
              const unsigned int knowns[], size_t n_knowns, const double seed[], size_t n_seed,    \
              double result[], size_t n_result)                                                    \
    {                                                                                              \
        (void)unknowns, (void)n_unknowns, (void)knowns, (void)n_knowns, (void)seed;                \
        (void)n_seed, (void)result, (void)n_result;                                                \
        return refuse(instance, "fmi3" #name " is not provided");                                  \
    }

NO_DERIVATIVE(GetDirectionalDerivative)
NO_DERIVATIVE(GetAdjointDerivative)

FMI(GetOutputDerivatives)(void *instance, const unsigned int references[], size_t n,
                          const int32_t orders[], double values[], size_t n_values)
{
    (void)references, (void)n, (void)orders, (void)values, (void)n_values;
    return refuse(instance, "output derivatives are not provided; velocities are outputs");
}

#define NO_INTERVAL(name, first, second)                                                           \
    FMI(name)(void *instance, const unsigned int references[], size_t n, first a, second b)        \
    {                                                                                              \
        (void)references, (void)n, (void)a, (void)b;                                               \
        return refuse(instance, "there are no clocks");                                            \
    }

NO_INTERVAL(GetIntervalDecimal, double *, int *)
NO_INTERVAL(SetIntervalFraction, const uint64_t *, const uint64_t *)
NO_INTERVAL(GetShiftFraction, uint64_t *, uint64_t *)
NO_INTERVAL(SetShiftFraction, const uint64_t *, const uint64_t *)

FMI(GetIntervalFraction)(void *instance, const unsigned int references[], size_t n,
                         uint64_t counters[], uint64_t resolutions[], int qualifiers[])
{
    (void)references, (void)n, (void)counters, (void)resolutions, (void)qualifiers;
    return refuse(instance, "there are no clocks");
}

#define NO_DECIMAL(name, type)                                                                     \
    FMI(name)(void *instance, const unsigned int references[], size_t n, type values)              \
    {                                                                                              \
        (void)references, (void)n, (void)values;                                                   \
        return refuse(instance, "there are no clocks");                                            \
    }

NO_DECIMAL(SetIntervalDecimal, const double *)
NO_DECIMAL(GetShiftDecimal, double *)
NO_DECIMAL(SetShiftDecimal, const double *)

FMI(ActivateModelPartition)(void *instance, unsigned int clock, double time)
{
    (void)clock, (void)time;
    return refuse(instance, "there are no model partitions");
}

/* Functions of model exchange. */
FMI(CompletedIntegratorStep)(void *instance, fmi_boolean no_return, fmi_boolean *event,
                             fmi_boolean *terminate)
{
    (void)no_return, (void)event, (void)terminate;
    return refuse(instance, "there is only co-simulation");
}

FMI(SetTime)(void *instance, double time)
{
    (void)time;
    return refuse(instance, "there is only co-simulation");
}

#define NO_STATES(name, type)                                                                      \
    FMI(name)(void *instance, type values, size_t n)                                               \
    {                                                                                              \
        (void)values, (void)n;                                                                     \
        return refuse(instance, "there is only co-simulation");                                    \
    }

NO_STATES(SetContinuousStates, const double *)
NO_STATES(GetContinuousStates, double *)
NO_STATES(GetContinuousStateDerivatives, double *)
NO_STATES(GetEventIndicators, double *)
NO_STATES(GetNominalsOfContinuousStates, double *)

#define NO_COUNT(name)                                                                             \
    FMI(name)(void *instance, size_t *n)                                                           \
    {                                                                                              \
        (void)n;                                                                                   \
        return refuse(instance, "there is only co-simulation");                                    \
    }

NO_COUNT(GetNumberOfEventIndicators)
NO_COUNT(GetNumberOfContinuousStates)
