/* The reduced joint: matrices as the exporter wrote them to resources/joint.bin.
 *
 * The file is a header of 8-byte words, the instantiation token, and the arrays in the order of
 * struct joint: first all numbers (IEEE double), then all indices (unsigned, 8 bytes), in the byte
 * order of the machine that wrote it, which a mark tells. */

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define JOINT_MAGIC UINT64_C(0x31544e494f4a5946) /* "FYJOINT1", lowest byte first */
#define TOKEN_LENGTH 64
#define N_HEADER 16
/* Larger counts than any joint has; keeps sums and products of damaged headers below 2^64. */
#define MOST (UINT64_C(1) << 20)

struct joint {
    char token[TOKEN_LENGTH];
    size_t n_mode, n_boundary, n_bolt, n_interface, n_point, n_relative, n_entry, has_residual;
    size_t n_pattern, n_shear; /* n_shear is zero where there is no friction */
    double *payload;

    const double *M, *C, *K;         /* (n_mode, n_mode) */
    const double *relative;          /* (n_relative, n_mode) relative displacements of the pairs */
    const double *elongations;       /* (n_bolt, n_mode) */
    const double *bolt_stiffness;    /* (n_bolt) */
    const double *initial_forces;    /* (n_bolt) */
    const double *initial_gap;       /* (n_point) */
    const double *weights;           /* (n_point) */
    const double *penalty;           /* (n_interface) infinite where contact is hard */
    const double *friction;          /* (n_interface) coefficients, zero without friction */
    const double *tangential;        /* (n_interface) tangential penalties, maybe infinite */
    const double *defaults;          /* step size, rho at infinity, integrator, start loaded */
    const double *interpolation;     /* (n_entry) gaps at points from relative displacements */
    const double *shear;             /* (n_shear) tangential displacements from relative ones */
    const double *residual;          /* (n_relative, n_relative) or nothing */
    const double *patterns;          /* (n_pattern, n_mode) forces of deck loads, factor one */
    const uint64_t *boundary;        /* (n_boundary) coordinate of each boundary displacement */
    const uint64_t *interface_start; /* (n_interface + 1) points of each interface */
    const uint64_t *row_start;       /* (n_point + 1) entries of each row of the interpolation */
    const uint64_t *column;          /* (n_entry) */
    const uint64_t *shear_start;     /* (2 n_point + 1) entries of each row of shear, all along the
                                      * first tangents, then all along the second ones */
    const uint64_t *shear_column;    /* (n_shear) */
};

enum { N_DEFAULT = 4 };

/* Words times odd numbers: no change of a single word leaves the sum as it was. */
static uint64_t checksum(const uint64_t *words, size_t n)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += words[i] * (2 * (uint64_t)i + 1);
    return sum;
}

static const double *take(const double **place, size_t n)
{
    const double *here = *place;
    *place += n;
    return here;
}

/* Lay the arrays out over the payload. */
static void lay_out(struct joint *j)
{
    const size_t m = j->n_mode, r = j->n_relative;
    const double *place = j->payload;
    j->M = take(&place, m * m);
    j->C = take(&place, m * m);
    j->K = take(&place, m * m);
    j->relative = take(&place, r * m);
    j->elongations = take(&place, j->n_bolt * m);
    j->bolt_stiffness = take(&place, j->n_bolt);
    j->initial_forces = take(&place, j->n_bolt);
    j->initial_gap = take(&place, j->n_point);
    j->weights = take(&place, j->n_point);
    j->penalty = take(&place, j->n_interface);
    j->friction = take(&place, j->n_interface);
    j->tangential = take(&place, j->n_interface);
    j->defaults = take(&place, N_DEFAULT);
    j->interpolation = take(&place, j->n_entry);
    j->shear = take(&place, j->n_shear);
    j->residual = take(&place, j->has_residual ? r * r : 0);
    j->patterns = take(&place, j->n_pattern * m);
    /* Indices and numbers are both read as they stand in the file. */
    j->boundary = (const uint64_t *)(const void *)take(&place, j->n_boundary);
    j->interface_start = (const uint64_t *)(const void *)take(&place, j->n_interface + 1);
    j->row_start = (const uint64_t *)(const void *)take(&place, j->n_point + 1);
    j->column = (const uint64_t *)(const void *)take(&place, j->n_entry);
    j->shear_start = (const uint64_t *)(const void *)take(&place, 2 * j->n_point + 1);
    j->shear_column = (const uint64_t *)(const void *)take(&place, j->n_shear);
}

/* Length of the payload in words, which may be more than there are addresses. */
static uint64_t payload_length(const struct joint *j)
{
    const uint64_t m = j->n_mode, r = j->n_relative;
    return 3 * m * m + r * m + j->n_bolt * (m + 2) + 2 * j->n_point + 3 * j->n_interface + N_DEFAULT
           + 2 * (j->n_entry + j->n_shear) + (j->has_residual ? r * r : 0) + j->n_pattern * m
           + j->n_boundary + (j->n_interface + 1) + (j->n_point + 1) + (2 * j->n_point + 1);
}

/* Whether all indices stay inside the arrays they point into. */
static int indices_fit(const struct joint *j)
{
    for (size_t i = 0; i < j->n_boundary; i++)
        if (j->boundary[i] >= j->n_mode)
            return 0;
    for (size_t i = 0; i < j->n_entry; i++)
        if (j->column[i] >= j->n_relative)
            return 0;
    for (size_t i = 0; i < j->n_shear; i++)
        if (j->shear_column[i] >= j->n_relative)
            return 0;
    for (size_t i = 0; i < j->n_point; i++)
        if (j->row_start[i] > j->row_start[i + 1])
            return 0;
    for (size_t i = 0; i < 2 * j->n_point; i++)
        if (j->shear_start[i] > j->shear_start[i + 1])
            return 0;
    for (size_t i = 0; i < j->n_interface; i++)
        if (j->interface_start[i] > j->interface_start[i + 1])
            return 0;
    return j->row_start[0] == 0 && j->row_start[j->n_point] == j->n_entry
           && j->shear_start[0] == 0 && j->shear_start[2 * j->n_point] == j->n_shear
           && j->interface_start[0] == 0 && j->interface_start[j->n_interface] == j->n_point;
}

static const char *read_counts(struct joint *j, const uint64_t header[N_HEADER])
{
    size_t *counts[] = {&j->n_mode,  &j->n_boundary, &j->n_bolt,  &j->n_interface,
                        &j->n_point, &j->n_relative, &j->n_entry, &j->has_residual,
                        &j->n_pattern, &j->n_shear};
    if (header[0] != JOINT_MAGIC)
        return "is no joint of faying, or of a machine with another byte order";
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        if (header[i + 1] >= MOST * (counts[i] == &j->n_entry || counts[i] == &j->n_shear ? 64 : 1))
            return "has a damaged header";
        *counts[i] = (size_t)header[i + 1];
    }
    return j->n_mode == 0 ? "has a damaged header" : NULL;
}

static const char *read_stream(struct joint *j, FILE *file)
{
    uint64_t header[N_HEADER];
    if (fread(header, sizeof header, 1, file) != 1 || fread(j->token, TOKEN_LENGTH, 1, file) != 1)
        return "ends too early";
    const char *problem = read_counts(j, header);
    if (problem)
        return problem;
    j->token[TOKEN_LENGTH - 1] = '\0';
    const uint64_t words = payload_length(j);
    if (words > SIZE_MAX / sizeof(double))
        return "needs more memory than there is";
    const size_t length = (size_t)words;
    j->payload = malloc(length * sizeof(double));
    if (!j->payload)
        return "needs more memory than there is";
    if (fread(j->payload, sizeof(double), length, file) != length)
        return "ends too early";
    if (checksum((const uint64_t *)(const void *)j->payload, length) != header[N_HEADER - 1])
        return "is damaged: its checksum is wrong";
    lay_out(j);
    return indices_fit(j) ? NULL : "is damaged: an index is out of range";
}

/* Read a joint; returns NULL or what is wrong with the file. */
static const char *read_joint(struct joint *j, const char *path)
{
    memset(j, 0, sizeof *j);
    FILE *file = fopen(path, "rb");
    if (!file)
        return "cannot be opened";
    const char *problem = read_stream(j, file);
    fclose(file);
    return problem;
}

/* Whether tangential forces act. */
static int has_friction(const struct joint *j)
{
    return j->n_shear > 0;
}

/* Components of the force at a point. */
static size_t n_component(const struct joint *j)
{
    return has_friction(j) ? 3 : 1;
}

static void free_joint(struct joint *j)
{
    free(j->payload);
    j->payload = NULL;
}
