/* Dense symmetric positive definite systems: A = U'U.
 *
 * Matrices are stored by rows, only the upper triangle of symmetric ones is used. Inner loops run
 * along rows without reductions, so that compilers vectorize them as they stand. */

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

/* Loops over rows in a second version for processors with vectors of four numbers, chosen when the
 * library is loaded. No sum is taken in another order, so that both find the same bits. */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
#define WIDE __attribute__((target_clones("avx2", "default")))
#else
#define WIDE
#endif

static void add_row(double *restrict y, const double *restrict x, double factor, size_t n)
{
    for (size_t i = 0; i < n; i++)
        y[i] += factor * x[i];
}

static void subtract_four_rows(double *restrict y, const double *restrict a, const double *restrict b,
                               const double *restrict c, const double *restrict d, const double f[4],
                               size_t n)
{
    const double fa = f[0], fb = f[1], fc = f[2], fd = f[3];
    for (size_t i = 0; i < n; i++)
        y[i] -= fa * a[i] + fb * b[i] + fc * c[i] + fd * d[i];
}

static double dot(const double *x, const double *y, size_t n)
{
    double sums[4] = {0.0, 0.0, 0.0, 0.0};
    size_t i = 0;
    for (; i + 4 <= n; i += 4)
        for (size_t k = 0; k < 4; k++)
            sums[k] += x[i + k] * y[i + k];
    for (; i < n; i++)
        sums[0] += x[i] * y[i];
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/* Replace the upper triangle of A by U. Four rows at a time: each pass over the rest of the matrix
 * then does four times the work. Returns 0, or -1 where a pivot is not positive. */
WIDE static int cholesky(double *A, size_t n)
{
    for (size_t start = 0; start < n; start += 4) {
        const size_t stop = start + 4 < n ? start + 4 : n;
        for (size_t k = start; k < stop; k++) {
            double *row = A + k * n;
            for (size_t p = start; p < k; p++)
                add_row(row + k, A + p * n + k, -A[p * n + k], n - k);
            if (!(row[k] > 0.0) || !isfinite(row[k]))
                return -1;
            const double pivot = sqrt(row[k]);
            for (size_t j = k; j < n; j++)
                row[j] /= pivot;
        }
        if (stop - start < 4)
            break;
        const double *a = A + start * n, *b = a + n, *c = b + n, *d = c + n;
        for (size_t i = stop; i < n; i++) {
            const double f[4] = {a[i], b[i], c[i], d[i]};
            if (f[0] != 0.0 || f[1] != 0.0 || f[2] != 0.0 || f[3] != 0.0)
                subtract_four_rows(A + i * n + i, a + i, b + i, c + i, d + i, f, n - i);
        }
    }
    return 0;
}

/* Solve U'y = b in place. */
static void solve_lower(const double *U, size_t n, double *b)
{
    for (size_t k = 0; k < n; k++) {
        const double *row = U + k * n;
        b[k] /= row[k];
        add_row(b + k + 1, row + k + 1, -b[k], n - k - 1);
    }
}

/* Solve U x = y in place. */
static void solve_upper(const double *U, size_t n, double *y)
{
    for (size_t k = n; k-- > 0;) {
        const double *row = U + k * n;
        y[k] = (y[k] - dot(row + k + 1, y + k + 1, n - k - 1)) / row[k];
    }
}

/* Solve U'U x = b in place. */
static void solve_cholesky(const double *U, size_t n, double *b)
{
    solve_lower(U, n, b);
    solve_upper(U, n, b);
}

static void swap_rows(double *restrict a, double *restrict b, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const double swapped = a[i];
        a[i] = b[i];
        b[i] = swapped;
    }
}

/* Replace A (n, n) by its LU factors with rows exchanged as in ``order``, four columns at a time as
 * above; -1 where it is singular. */
WIDE static int factorize_lu(double *A, size_t n, size_t *order)
{
    for (size_t start = 0; start < n; start += 4) {
        const size_t stop = start + 4 < n ? start + 4 : n;
        for (size_t k = start; k < stop; k++) {
            size_t best = k;
            for (size_t i = k + 1; i < n; i++)
                if (fabs(A[i * n + k]) > fabs(A[best * n + k]))
                    best = i;
            order[k] = best;
            if (best != k)
                swap_rows(A + k * n, A + best * n, n);
            const double pivot = A[k * n + k];
            if (!(fabs(pivot) > 0.0) || !isfinite(pivot))
                return -1;
            for (size_t i = k + 1; i < n; i++) {
                double *row = A + i * n;
                row[k] /= pivot;
                add_row(row + k + 1, A + k * n + k + 1, -row[k], stop - k - 1);
            }
        }
        if (stop - start < 4)
            break;
        const double *a = A + start * n, *b = a + n, *c = b + n, *d = c + n;
        for (size_t k = start + 1; k < stop; k++)
            for (size_t p = start; p < k; p++)
                add_row(A + k * n + stop, A + p * n + stop, -A[k * n + p], n - stop);
        for (size_t i = stop; i < n; i++) {
            double *row = A + i * n;
            subtract_four_rows(row + stop, a + stop, b + stop, c + stop, d + stop, row + start,
                               n - stop);
        }
    }
    return 0;
}

/* Solve L U x = b in place. */
WIDE static void solve_lu(const double *A, size_t n, const size_t *order, double *b)
{
    for (size_t k = 0; k < n; k++) {
        const double swapped = b[k];
        b[k] = b[order[k]];
        b[order[k]] = swapped;
    }
    for (size_t i = 0; i < n; i++)
        b[i] -= dot(A + i * n, b, i);
    solve_upper(A, n, b);
}

/* Solve U'Y = B in place for B (n, k). */
WIDE static void solve_lower_many(const double *U, size_t n, double *B, size_t k)
{
    for (size_t i = 0; i < n; i++) {
        double *row = B + i * k;
        const double pivot = U[i * n + i];
        for (size_t j = 0; j < k; j++)
            row[j] /= pivot;
        for (size_t r = i + 1; r < n; r++)
            if (U[i * n + r] != 0.0)
                add_row(B + r * k, row, -U[i * n + r], k);
    }
}

/* y += factor A x for A (rows, columns). */
WIDE static void add_product(double *y, double factor, const double *A, const double *x, size_t rows,
                        size_t columns)
{
    for (size_t i = 0; i < rows; i++)
        y[i] += factor * dot(A + i * columns, x, columns);
}

/* y += A'x for A (rows, columns). */
static void add_transposed_product(double *y, const double *A, const double *x, size_t rows,
                                   size_t columns)
{
    for (size_t i = 0; i < rows; i++)
        if (x[i] != 0.0)
            add_row(y, A + i * columns, x[i], columns);
}

static int are_finite(const double *x, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!isfinite(x[i]))
            return 0;
    return 1;
}
