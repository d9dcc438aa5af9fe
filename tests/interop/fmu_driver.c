/* Drives an FMI 2.0 joint through all that masters do, right and wrong; for sanitizers.
 *
 *     fmu_driver RESOURCES TOKEN N_INPUT N_OUTPUT     with the references of both on standard input
 *
 * Exits with the number of the check that failed. */

#include "fmi2.c"

#define MOST_VARIABLES 256

static void quiet(void *environment, const char *name, fmi2Status status, const char *category,
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

static fmi2Status run(void *c, const unsigned int *inputs, size_t n, double force, double t,
                      int steps, double h)
{
    for (int k = 0; k < steps; k++) {
        for (size_t i = 0; i < n; i++) {
            const double value = i % 7 == 2 ? force * (k + 1) : 0.0;
            const int first = 1;
            const double rate = 10.0;
            if (i + 1 < n && fmi2SetReal(c, inputs + i, 1, &value) != fmi2OK)
                return fmi2Error;
            if (i == 0 && fmi2SetRealInputDerivatives(c, inputs, 1, &first, &rate) != fmi2OK)
                return fmi2Error;
        }
        const fmi2Status status = fmi2DoStep(c, t + k * h, h, fmi2OK);
        if (status != fmi2OK)
            return status;
    }
    return fmi2OK;
}

static void *started(const char *resources, const char *token, const fmi2CallbackFunctions *calls,
                     int integrator)
{
    const unsigned int choice = (unsigned)KIND_INTEGRATOR << INDEX_BITS;
    void *c = fmi2Instantiate("one", fmi2CoSimulation, token, resources, calls, 0, 0);
    if (!c || fmi2SetupExperiment(c, 0, 0.0, 1.0, 0, 0.0) != fmi2OK
        || fmi2SetInteger(c, &choice, 1, &integrator) != fmi2OK
        || fmi2EnterInitializationMode(c) != fmi2OK || fmi2ExitInitializationMode(c) != fmi2OK)
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
    const fmi2CallbackFunctions calls = {quiet, NULL, NULL, NULL, &complaints};
    CHECK(4, !fmi2Instantiate("x", fmi2CoSimulation, "{wrong}", argv[1], &calls, 0, 0));
    CHECK(5, !fmi2Instantiate("x", fmi2CoSimulation, argv[2], "file:///nowhere", &calls, 0, 0));
    CHECK(6, !fmi2Instantiate("x", fmi2ModelExchange, argv[2], argv[1], &calls, 0, 0));
    CHECK(7, !fmi2Instantiate("x", fmi2CoSimulation, argv[2], NULL, NULL, 0, 0));
    CHECK(8, complaints == 3);

    for (int integrator = 0; integrator < 2; integrator++) {
        const double h = 1e-5;
        void *a = started(argv[1], argv[2], &calls, integrator);
        void *b = started(argv[1], argv[2], &calls, integrator);
        CHECK(10, a && b);
        CHECK(11, run(a, inputs, n, -100.0, 1.0, 10, h) == fmi2OK);
        CHECK(12, run(b, inputs, n, -100.0, 1.0, 5, h) == fmi2OK);

        /* save, serialize, go on, go back */
        void *state = NULL, *copy = NULL;
        size_t size = 0;
        CHECK(20, fmi2GetFMUstate(a, &state) == fmi2OK);
        CHECK(21, fmi2SerializedFMUstateSize(a, state, &size) == fmi2OK);
        char *bytes = malloc(size);
        CHECK(22, bytes && fmi2SerializeFMUstate(a, state, bytes, size) == fmi2OK);
        CHECK(23, fmi2SerializeFMUstate(a, state, bytes, size - 1) == fmi2Error);
        CHECK(24, run(a, inputs, n, 300.0, 1.0 + 10 * h, 7, 2.6 * h) == fmi2OK);
        CHECK(25, fmi2GetReal(a, outputs, n_out, first) == fmi2OK);
        CHECK(26, fmi2DeSerializeFMUstate(b, bytes, size, &copy) == fmi2OK);
        CHECK(27, fmi2SetFMUstate(b, copy) == fmi2OK);
        CHECK(28, run(b, inputs, n, 300.0, 1.0 + 10 * h, 7, 2.6 * h) == fmi2OK);
        CHECK(29, fmi2GetReal(b, outputs, n_out, second) == fmi2OK);
        CHECK(30, memcmp(first, second, n_out * sizeof *first) == 0);
        CHECK(31, fmi2GetFMUstate(b, &copy) == fmi2OK); /* into the former one */
        bytes[0] ^= 1;
        CHECK(32, fmi2DeSerializeFMUstate(b, bytes, size, &copy) == fmi2Error);
        CHECK(33, fmi2DeSerializeFMUstate(b, bytes, 5, &copy) == fmi2Error);
        free(bytes);

        /* what must be refused, and leaves the state as it was */
        const double nan_force = NAN;
        const unsigned int nothing = 4000000000U;
        double value;
        CHECK(40, fmi2GetReal(a, &nothing, 1, &value) == fmi2Error);
        CHECK(41, fmi2SetReal(a, &nothing, 1, &nan_force) == fmi2Error);
        CHECK(42, fmi2SetReal(a, outputs, 1, &nan_force) == fmi2Error);
        CHECK(43, fmi2DoStep(a, 7.0, h, 0) == fmi2Error);
        CHECK(44, fmi2DoStep(a, 1.0 + 10 * h + 7 * 2.6 * h, 0.0, 0) == fmi2Error);
        CHECK(45, fmi2SetReal(a, inputs + 2, 1, &nan_force) == fmi2OK);
        CHECK(46, fmi2DoStep(a, 1.0 + 10 * h + 7 * 2.6 * h, h, 0) == fmi2Error);
        CHECK(47, fmi2GetReal(a, outputs, n_out, second) == fmi2OK);
        CHECK(48, memcmp(first, second, n_out * sizeof *first) == 0);

        CHECK(50, fmi2Reset(a) == fmi2OK);
        CHECK(51, fmi2DoStep(a, 0.0, h, 0) == fmi2Error);
        CHECK(52, fmi2EnterInitializationMode(a) == fmi2OK);
        CHECK(53, fmi2GetReal(a, outputs, n_out, first) == fmi2OK);
        CHECK(54, fmi2ExitInitializationMode(a) == fmi2OK);
        CHECK(55, run(a, inputs, n, -100.0, 0.0, 3, h) == fmi2OK);
        CHECK(56, fmi2Terminate(a) == fmi2OK);
        fmi2FreeFMUstate(a, &state);
        fmi2FreeFMUstate(b, &copy);
        fmi2FreeInstance(a);
        fmi2FreeInstance(b);
    }
    fmi2FreeInstance(NULL);
    return 0;
}
