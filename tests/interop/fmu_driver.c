/* Drives an FMI 2.0 joint through all that masters do, right and wrong; for sanitizers.
 *
 *     fmu_driver RESOURCES TOKEN N_INPUT N_OUTPUT     with the references of both on standard input
 *
 * Exits with the number of the check that failed. */

#include "fmi2.c"

#define MOST_VARIABLES 256

static void quiet(void *environment, const char *name, enum status status, const char *category,
                  const char *message, ...)
{
    int *count = environment;
    (void)name, (void)status, (void)category, (void)message;
    ++*count;
}

#define CHECK(number, condition)                                                                   \
    do {                                                                                           \
        if (!(condition))                                                                          \
            return number;                                                                         \
    } while (0)

static enum status run(void *c, const unsigned int *inputs, size_t n, double force, double t,
                      int steps, double h)
{
    for (int k = 0; k < steps; k++) {
        for (size_t i = 0; i < n; i++) {
            const double value = i % 7 == 2 ? force * (k + 1) : 0.0;
            const int first = 1;
            const double rate = 10.0;
            if (i + 1 < n && fmi2SetReal(c, inputs + i, 1, &value) != STATUS_OK)
                return STATUS_ERROR;
            if (i == 0 && fmi2SetRealInputDerivatives(c, inputs, 1, &first, &rate) != STATUS_OK)
                return STATUS_ERROR;
        }
        const enum status status = fmi2DoStep(c, t + k * h, h, STATUS_OK);
        if (status != STATUS_OK)
            return status;
    }
    return STATUS_OK;
}

static void *started(const char *resources, const char *token, const struct callbacks *calls,
                     int integrator)
{
    const unsigned int choice = (unsigned)KIND_INTEGRATOR << INDEX_BITS;
    void *c = fmi2Instantiate("one", CO_SIMULATION, token, resources, calls, 0, 0);
    if (!c || fmi2SetupExperiment(c, 0, 0.0, 1.0, 0, 0.0) != STATUS_OK
        || fmi2SetInteger(c, &choice, 1, &integrator) != STATUS_OK
        || fmi2EnterInitializationMode(c) != STATUS_OK || fmi2ExitInitializationMode(c) != STATUS_OK)
        return NULL;
    return c;
}

int main(int argc, char **argv)
{
    CHECK(1, argc == 5);
    const size_t n = (size_t)atoi(argv[3]), n_out = (size_t)atoi(argv[4]);
    unsigned int inputs[MOST_VARIABLES], outputs[MOST_VARIABLES];
    double first[MOST_VARIABLES], second[MOST_VARIABLES];
    CHECK(2, n < MOST_VARIABLES && n_out < MOST_VARIABLES);
    for (size_t i = 0; i < n; i++)
        CHECK(3, scanf("%u", inputs + i) == 1);
    for (size_t i = 0; i < n_out; i++)
        CHECK(3, scanf("%u", outputs + i) == 1);

    int complaints = 0;
    const struct callbacks calls = {quiet, NULL, NULL, NULL, &complaints};
    CHECK(4, !fmi2Instantiate("x", CO_SIMULATION, "{wrong}", argv[1], &calls, 0, 0));
    CHECK(5, !fmi2Instantiate("x", CO_SIMULATION, argv[2], "file:///nowhere", &calls, 0, 0));
    CHECK(6, !fmi2Instantiate("x", MODEL_EXCHANGE, argv[2], argv[1], &calls, 0, 0));
    CHECK(7, !fmi2Instantiate("x", CO_SIMULATION, argv[2], NULL, NULL, 0, 0));
    CHECK(8, complaints == 3);

    for (int integrator = 0; integrator < 3; integrator++) {
        const double h = 1e-5;
        void *a = started(argv[1], argv[2], &calls, integrator);
        void *b = started(argv[1], argv[2], &calls, integrator);
        CHECK(10, a && b);
        CHECK(11, run(a, inputs, n, -100.0, 1.0, 10, h) == STATUS_OK);
        CHECK(12, run(b, inputs, n, -100.0, 1.0, 5, h) == STATUS_OK);

        /* save, serialize, go on, go back */
        void *state = NULL, *copy = NULL;
        size_t size = 0;
        CHECK(20, fmi2GetFMUstate(a, &state) == STATUS_OK);
        CHECK(21, fmi2SerializedFMUstateSize(a, state, &size) == STATUS_OK);
        unsigned char *bytes = malloc(size);
        CHECK(22, bytes && fmi2SerializeFMUstate(a, state, bytes, size) == STATUS_OK);
        CHECK(23, fmi2SerializeFMUstate(a, state, bytes, size - 1) == STATUS_ERROR);
        CHECK(24, run(a, inputs, n, 300.0, 1.0 + 10 * h, 7, 2.6 * h) == STATUS_OK);
        CHECK(25, fmi2GetReal(a, outputs, n_out, first) == STATUS_OK);
        CHECK(26, fmi2DeSerializeFMUstate(b, bytes, size, &copy) == STATUS_OK);
        CHECK(27, fmi2SetFMUstate(b, copy) == STATUS_OK);
        CHECK(28, run(b, inputs, n, 300.0, 1.0 + 10 * h, 7, 2.6 * h) == STATUS_OK);
        CHECK(29, fmi2GetReal(b, outputs, n_out, second) == STATUS_OK);
        CHECK(30, memcmp(first, second, n_out * sizeof *first) == 0);
        CHECK(31, fmi2GetFMUstate(b, &copy) == STATUS_OK); /* into the former one */
        bytes[0] ^= 1;
        CHECK(32, fmi2DeSerializeFMUstate(b, bytes, size, &copy) == STATUS_ERROR);
        CHECK(33, fmi2DeSerializeFMUstate(b, bytes, 5, &copy) == STATUS_ERROR);
        free(bytes);

        /* what must be refused, and leaves the state as it was */
        const double nan_force = NAN;
        const unsigned int nothing = 4000000000U;
        double value;
        CHECK(40, fmi2GetReal(a, &nothing, 1, &value) == STATUS_ERROR);
        CHECK(41, fmi2SetReal(a, &nothing, 1, &nan_force) == STATUS_ERROR);
        CHECK(42, fmi2SetReal(a, outputs, 1, &nan_force) == STATUS_ERROR);
        CHECK(43, fmi2DoStep(a, 7.0, h, 0) == STATUS_ERROR);
        CHECK(44, fmi2DoStep(a, 1.0 + 10 * h + 7 * 2.6 * h, 0.0, 0) == STATUS_ERROR);
        CHECK(45, fmi2SetReal(a, inputs + 2, 1, &nan_force) == STATUS_OK);
        CHECK(46, fmi2DoStep(a, 1.0 + 10 * h + 7 * 2.6 * h, h, 0) == STATUS_ERROR);
        CHECK(47, fmi2GetReal(a, outputs, n_out, second) == STATUS_OK);
        CHECK(48, memcmp(first, second, n_out * sizeof *first) == 0);

        CHECK(50, fmi2Reset(a) == STATUS_OK);
        CHECK(51, fmi2DoStep(a, 0.0, h, 0) == STATUS_ERROR);
        CHECK(52, fmi2EnterInitializationMode(a) == STATUS_OK);
        CHECK(53, fmi2GetReal(a, outputs, n_out, first) == STATUS_OK);
        CHECK(54, fmi2ExitInitializationMode(a) == STATUS_OK);
        CHECK(55, run(a, inputs, n, -100.0, 0.0, 3, h) == STATUS_OK);
        CHECK(56, fmi2Terminate(a) == STATUS_OK);
        fmi2FreeFMUstate(a, &state);
        fmi2FreeFMUstate(b, &copy);
        fmi2FreeInstance(a);
        fmi2FreeInstance(b);
    }
    fmi2FreeInstance(NULL);
    return 0;
}
