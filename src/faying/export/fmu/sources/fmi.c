/* What FMI 2.0 and FMI 3.0 have in common. fmi2.c and fmi3.c include it after these macros:
 *
 *     FUNCTION(name)              the name of a function of FMI, with the prefix it must carry
 *     OF_STATE(action)            the same for functions of states, which both spell differently
 *     STATE_SIZE, DESERIALIZE
 *     N_VALUES, IS_ROOM           the parameter that counts values, and whether they are enough
 *     fmi_boolean                 type of a boolean
 *
 * The declarations that FMI prescribes are written out, so that these sources need no other header
 * than those of the C library. */

#include "linalg.c"
#include "joint.c"
#include "contact.c"
#include "motion.c"
#include "forces.c"
#include "mean.c"
#include "start.c"
#include "steps.c"
#include "variables.c"

#if defined(_WIN32)
#define EXPORTED __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif

#define JOINED(a, b) a##b
#define EXPANDED(a, b) JOINED(a, b)

enum status { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL };

#define FMI(name) EXPORTED enum status FUNCTION(name)

static enum status status_of(enum outcome outcome)
{
    return outcome == OUTCOME_OK ? STATUS_OK : STATUS_ERROR;
}

static enum status refuse(void *instance, const char *what)
{
    report(instance, "%s", what);
    return STATUS_ERROR;
}

/* ---- instances ---- */

/* The path of joint.bin in the folder of resources; NULL without memory. */
static char *path_in(const char *folder)
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

/* Make a joint from the folder of its resources. What messages need is copied, for importers need
 * not keep theirs. */
static struct motion *instantiate(const char *name, const char *folder, const char *token,
                                  report_function log_message, const void *log, size_t size)
{
    void *own = malloc(size);
    char *path = folder ? path_in(folder) : NULL;
    struct motion *m = NULL;
    if (own)
        memcpy(own, log, size);
    if (own && path)
        m = create_motion(name, path, token, log_message, own);
    else
        log_message(own, name, 1, "there is only co-simulation, and it needs its resources");
    free(path);
    if (!m)
        free(own);
    return m;
}

EXPORTED void FUNCTION(FreeInstance)(void *instance)
{
    struct motion *m = instance;
    if (m)
        free(m->environment);
    destroy_motion(m);
}

FMI(SetDebugLogging)(void *instance, fmi_boolean on, size_t n, const char *const names[])
{
    (void)instance, (void)on, (void)n, (void)names;
    return STATUS_OK; /* only errors are logged, and those always */
}

FMI(ExitInitializationMode)(void *instance)
{
    struct motion *m = instance;
    if (!is_mode(m, MODE_INITIALIZING))
        return refuse(instance, "there is no initialization to end");
    const enum outcome outcome = start_motion(m);
    if (outcome == OUTCOME_OK)
        m->state[AT_MODE] = MODE_STEPPING;
    return status_of(outcome);
}

FMI(Terminate)(void *instance)
{
    struct motion *m = instance;
    m->state[AT_MODE] = MODE_TERMINATED;
    return STATUS_OK;
}

FMI(Reset)(void *instance)
{
    reset_motion(instance);
    return STATUS_OK;
}

/* ---- variables ---- */

static enum status write_reals(void *instance, const unsigned int references[], size_t n,
                               const double values[])
{
    enum outcome outcome = OUTCOME_OK;
    for (size_t i = 0; outcome == OUTCOME_OK && i < n; i++)
        outcome = write_real(instance, references[i], values[i]);
    return status_of(outcome);
}

/* The parameters that are no real numbers, one of each type. */
#define CHOICE(name, type, kind)                                                                   \
    FMI(Get##name)(void *instance, const unsigned int references[], size_t n,                      \
                   type values[] N_VALUES)                                                         \
    {                                                                                              \
        double value;                                                                              \
        if (!IS_ROOM)                                                                              \
            return refuse(instance, "there are other numbers of values and variables");            \
        for (size_t i = 0; i < n; i++) {                                                           \
            if (read_choice(instance, kind, references[i], &value) != OUTCOME_OK)                  \
                return STATUS_ERROR;                                                               \
            values[i] = (type)value;                                                               \
        }                                                                                          \
        return STATUS_OK;                                                                          \
    }                                                                                              \
    FMI(Set##name)(void *instance, const unsigned int references[], size_t n,                      \
                   const type values[] N_VALUES)                                                   \
    {                                                                                              \
        if (!IS_ROOM)                                                                              \
            return refuse(instance, "there are other numbers of values and variables");            \
        for (size_t i = 0; i < n; i++)                                                             \
            if (write_choice(instance, kind, references[i],                                        \
                             (double)(kind == KIND_START_LOADED ? values[i] != 0 : values[i]))     \
                != OUTCOME_OK)                                                                     \
                return STATUS_ERROR;                                                               \
        return STATUS_OK;                                                                          \
    }

/* Types that the joint has no variables of. */
#define NO_VARIABLES(name, type)                                                                   \
    FMI(Get##name)(void *instance, const unsigned int references[], size_t n,                      \
                   type values[] N_VALUES)                                                         \
    {                                                                                              \
        (void)references, (void)values;                                                            \
        return n || !IS_ROOM ? refuse(instance, "there are no variables of type " #name)           \
                             : STATUS_OK;                                                          \
    }                                                                                              \
    FMI(Set##name)(void *instance, const unsigned int references[], size_t n,                      \
                   const type values[] N_VALUES)                                                   \
    {                                                                                              \
        (void)references, (void)values;                                                            \
        return n || !IS_ROOM ? refuse(instance, "there are no variables of type " #name)           \
                             : STATUS_OK;                                                          \
    }

NO_VARIABLES(String, char *const)

/* ---- states ---- */

EXPORTED enum status OF_STATE(Get)(void *instance, void **state)
{
    struct saved_state *saved = save_state(instance, *state);
    if (!saved)
        return refuse(instance, "not enough memory for the state");
    *state = saved;
    return STATUS_OK;
}

EXPORTED enum status OF_STATE(Set)(void *instance, void *state)
{
    return status_of(restore_state(instance, state));
}

EXPORTED enum status OF_STATE(Free)(void *instance, void **state)
{
    (void)instance;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return STATUS_OK;
}

FMI(STATE_SIZE)(void *instance, void *state, size_t *size)
{
    (void)state;
    *size = serialized_size(instance);
    return STATUS_OK;
}

EXPORTED enum status OF_STATE(Serialize)(void *instance, void *state, unsigned char bytes[],
                                         size_t size)
{
    return status_of(serialize_state(instance, state, bytes, size));
}

FMI(DESERIALIZE)(void *instance, const unsigned char bytes[], size_t size, void **state)
{
    struct saved_state *saved = deserialize_state(instance, bytes, size, *state);
    if (!saved)
        return STATUS_ERROR;
    *state = saved;
    return STATUS_OK;
}
