"""Increments with friction, compiled: what :mod:`.frictional` solves, about a state beforehand.

Steps are those of :mod:`.newton_steps`, made on U = S (I + B₀ S)⁻¹, what pairs yield on the springs
B₀ of a state that is given: with ΔB what points add to B₀ where J is another, S q = U m, where
(I + ΔB U) m = b for a right-hand side b is a system between the pairs of those points alone.
Where most points are others, U is S and B₀ nothing. Systems serve as long as J does not differ by
more than a little, and steps are extrapolated from those before (Anderson 1965,
doi:10.1145/321296.321305). What this does not solve is left to the solver in Python.

Importing this module compiles it, or reads what was compiled before.
"""

import numba
import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.contact.compiled_points import (
    blockwise,
    factorize,
    interpolate,
    local,
    residual,
    share_out,
    slopes,
    substitute,
)
from faying.contact.frictional import MOST_HALVINGS, MOST_STEPS
from faying.contact.predictor import AT_BOUND, FEW_BACK

ENOUGH = 1e-11
"""Natural residual over the largest force at which an increment is solved."""

NEARLY = 1e-7
"""Residual from which displacements are those of the forces, no longer added up."""

CHANGED, COUNTED = 0.1, 0.01
"""Difference of an entry of J at a point from which a system is made anew, and that from which a
point counts as another than it was beforehand."""

MOST_OTHERS = 0.8
"""Pairs of other points, over those of closed ones, up to which U is taken in place of S."""

SLOW = 0.5
"""Residual over the one before from which the next step takes J as it is at every point."""

MIXED = 5
"""Differences of steps that one is extrapolated from."""

SUMS = {"reassoc", "contract"}
"""Sums may be taken in any order, so that the processor adds several terms at once."""


@numba.njit(cache=True, fastmath=SUMS)
def assembled(
    columns: Indices,
    values: Matrix,
    supported: Matrix,
    more: Matrix,
    changed: Indices,
    pairs: Indices,
) -> Matrix:
    """Return I + ΔB U at the pairs of changed points (size, size); ``more`` is ΔK."""
    n, size = len(more), len(pairs)
    result, here = np.zeros((size, size)), np.empty((size, size))
    place = np.empty(len(supported), dtype=np.int64)
    for i in range(size):
        place[pairs[i]] = i
        row = supported[pairs[i]]
        for j in range(size):
            here[i, j] = row[pairs[j]]
    moved, forces = np.empty((3, size)), np.empty(size)
    for p in changed:
        for a in range(3):
            moved[a] = 0.0
            for j in range(columns.shape[1]):
                share = values[a * n + p, j]
                if share != 0.0:
                    row = here[place[columns[a * n + p, j]]]
                    for i in range(size):
                        moved[a, i] += share * row[i]
        for a in range(3):
            k0, k1, k2 = more[p, 3 * a], more[p, 3 * a + 1], more[p, 3 * a + 2]
            for i in range(size):
                forces[i] = k0 * moved[0, i] + k1 * moved[1, i] + k2 * moved[2, i]
            for j in range(columns.shape[1]):
                share = values[a * n + p, j]
                if share != 0.0:
                    row = result[place[columns[a * n + p, j]]]
                    for i in range(size):
                        row[i] += share * forces[i]
    for i in range(size):
        result[i, i] += 1.0
    return result


@numba.njit(cache=True)
def extrapolated(past: Matrix, count: int, step: Matrix) -> None:
    """Take from a step (x, y; 6 n_point) what those before say; states and steps in ``past``."""
    m = count - 1
    change = past[1:count] - past[:m]
    n = change.shape[2] // 2
    core, right = np.empty((m, m)), np.empty(m)
    for i in range(m):
        for j in range(i + 1):
            core[i, j] = core[j, i] = np.dot(change[i, 1, :n], change[j, 1, :n])
        right[i] = np.dot(change[i, 1, :n], past[m, 1, :n])
    largest = 0.0
    for i in range(m):
        largest = max(largest, core[i, i])
    for i in range(m):
        core[i, i] += 1e-14 * largest + 1e-300
    shares = np.linalg.solve(core, right)
    for i in range(m):
        for k in range(2 * n):
            step[k] -= shares[i] * (change[i, 0, k] + change[i, 1, k])


@numba.njit(cache=True)
def touched(columns: Indices, values: Matrix, points: Indices, n_pair: int) -> Indices:
    """Return the pairs that points touch."""
    n = len(columns) // 3
    met = np.zeros(n_pair, dtype=np.bool_)
    for p in points:
        for a in range(3):
            for j in range(columns.shape[1]):
                if values[a * n + p, j] != 0.0:
                    met[columns[a * n + p, j]] = True
    return np.flatnonzero(met)


@numba.njit(cache=True, fastmath=SUMS)
def moved_at(
    points: Indices,
    pairs: Indices,
    columns: Indices,
    values: Matrix,
    matrix: Matrix,
    forces: Vector,
    moved: Matrix,
) -> None:
    """Write G times a matrix times forces between pairs, at points and the pairs they touch."""
    n, there = moved.shape[1], np.zeros(len(forces))
    for i in pairs:
        row, total = matrix[i], 0.0
        for j in range(len(forces)):
            total += row[j] * forces[j]
        there[i] = total
    for p in points:
        for a in range(3):
            for j in range(columns.shape[1]):
                moved[a, p] += values[a * n + p, j] * there[columns[a * n + p, j]]


@numba.njit(cache=True)
def differing(slope: Matrix, other: Matrix, least: float) -> Indices:
    """Return the points where J (n_point, 9) differs from another by more than ``least``."""
    found = np.zeros(len(slope), dtype=np.bool_)
    for p in range(len(slope)):
        for i in range(9):
            if abs(slope[p, i] - other[p, i]) > least:
                found[p] = True
    return np.flatnonzero(found)


@numba.njit(cache=True, error_model="numpy")
def springs_at(
    p: int, slope: Matrix, scale: Matrix, yielding: Matrix, K: Matrix, inverse: Matrix
) -> None:
    """Write K and A⁻¹ of a point, zero and one where it is open."""
    if slope[p, 0] == 0.0:
        K[p], inverse[p] = 0.0, 0.0
        inverse[p, 0] = inverse[p, 4] = inverse[p, 8] = 1.0
    else:
        local(slope[p], p, scale, yielding, inverse[p], K[p])


@numba.njit(cache=True, error_model="numpy")
def linearized(
    forces: Matrix, friction: Vector, scale: Matrix, yielding: Matrix
) -> tuple[Matrix, Matrix, Matrix]:
    """Return J, K and A⁻¹ (n_point, 9) each where forces act; points at their bound slip."""
    n = forces.shape[1]
    slope, K, inverse = np.zeros((n, 9)), np.zeros((n, 9)), np.zeros((n, 9))
    trial = forces.copy()
    trial[1:] *= 1.0 + AT_BOUND
    slopes(trial, friction, slope)
    for p in range(n):
        springs_at(p, slope, scale, yielding, K, inverse)
    return slope, K, inverse


@numba.njit(cache=True)
def unsupported(n: int) -> tuple[Matrix, Matrix, Matrix]:
    """Return J, K and A⁻¹ (n, 9) each where all points are open."""
    inverse = np.zeros((n, 9))
    inverse[:, 0] = inverse[:, 4] = inverse[:, 8] = 1.0
    return np.zeros((n, 9)), np.zeros((n, 9)), inverse


SIGNATURE = (
    "UniTuple(float64, 2)(uint64, uint64, uint8[::1], int64[:,::1], float64[:,::1],"
    " float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[::1],"
    " float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1],"
    " float64[:,::1], float64[:,::1], float64[:,::1])"
)


@numba.njit(SIGNATURE, cache=True, error_model="numpy")
def solve(
    getrf: int,
    getrs: int,
    transposed: Vector,
    columns: Indices,
    values: Matrix,
    S: Matrix,
    yielding: Matrix,
    closure: Matrix,
    scale: Matrix,
    friction: Vector,
    supported: Matrix,
    slope0: Matrix,
    stiff0: Matrix,
    inverse0: Matrix,
    z_free: Matrix,
    expected: Matrix,
    x: Matrix,
    z: Matrix,
) -> tuple[float, float]:
    """Solve an increment; return Newton steps and the natural residual over the largest force.

    Parameters
    ----------
    getrf, getrs
        Addresses of LAPACK's ``dgetrf`` and ``dgetrs``.
    columns, values : (3 n_point, n)
        G by rows.
    S, supported : (n_relative, n_relative)
        Compliance, and U.
    yielding, closure, scale : (3, n_point)
        c′ in A, c′ and r.
    friction : (n_point,)
    slope0, stiff0, inverse0 : (n_point, 9)
        J, K and A⁻¹ of the state of U.
    z_free : (3, n_point)
    expected : (3, n_point) or (0, n_point)
        What x − r z is expected to be, if anything is.
    x : (3, n_point)
        Forces of the increment before, admissible; those of this one.
    z : (3, n_point)
        Slack to be written.
    """
    n, n_pair = x.shape[1], len(S)
    slope = np.zeros((n, 9))
    taken, K, inverse, more = slope0.copy(), stiff0.copy(), inverse0.copy(), np.zeros((n, 9))
    y, wrong, alone = np.empty((3, n)), np.empty((3, n)), np.empty((3, n))
    trial, slack, tried = np.empty((3, n)), np.empty((3, n)), np.empty((3, n))
    dx, dy, moved = np.empty((3, n)), np.empty((3, n)), np.empty((3, n))
    lu, pivots = np.empty((0, 0)), np.empty(0, dtype=np.int32)
    changed, at = np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    pairs, between, seen = np.empty(n_pair), np.empty(n_pair), np.empty(n_pair)
    past, step_of = np.empty((MIXED + 1, 2, 6 * n)), np.empty(6 * n)
    stuck = np.zeros(n, dtype=np.bool_)
    share_out(columns, values, x, pairs)
    interpolate(columns, values, np.dot(S, pairs), y)
    z[:] = y + closure * x + z_free
    start, count, n_past = x.copy(), 0.0, 0
    norm, left = np.inf, np.inf
    renew, exact, first, based = False, False, True, True
    predicting = 2 if len(expected) == 0 else 1
    while count < MOST_STEPS:
        # The first one or two are no Newton steps: they say where forces go if no point changes
        # sides, or if all are on those expected.
        if predicting and len(expected):
            trial[:] = expected
        elif predicting:
            for p in range(n):
                outward = 1.0 - AT_BOUND if stuck[p] else 1.0 + AT_BOUND
                trial[0, p] = start[0, p]
                trial[1, p], trial[2, p] = outward * start[1, p], outward * start[2, p]
        else:
            count += 1
            trial[:] = x - scale * z
        slopes(trial, friction, slope)
        if first:
            first = False
            others = touched(columns, values, differing(slope, slope0, COUNTED), n_pair)
            closed = touched(columns, values, np.flatnonzero(slope[:, 0]), n_pair)
            based = len(others) <= MOST_OTHERS * len(closed)
            if not based:
                supported, slope0, stiff0, inverse0 = S, *unsupported(n)
                taken[:], K[:], inverse[:] = slope0, stiff0, inverse0
        fresh = renew or len(differing(slope, taken, CHANGED)) > 0
        whole = renew
        if fresh:
            renew = False
            changed = differing(slope, slope0, 0.0 if whole else COUNTED)
            taken[:], K[:], inverse[:], more[:] = slope0, stiff0, inverse0, 0.0
            for other in changed:
                taken[other] = slope[other]
                springs_at(int(other), slope, scale, yielding, K, inverse)
                more[other] = K[other] - stiff0[other]
            at = touched(columns, values, changed, n_pair)
            lu = assembled(columns, values, supported, more, changed, at)
            pivots = np.empty(len(at), dtype=np.int32)
            if len(at) and (not factorize(getrf, lu, pivots) or not np.isfinite(lu).all()):
                return count, np.inf
        if predicting:
            residual(trial, start, friction, wrong)
            tried[:] = trial - start + scale * z
            blockwise(slope, tried, 1.0, wrong)
        alone[:] = 0.0
        blockwise(inverse, wrong, -1.0, alone)
        share_out(columns, values, alone, between)
        if len(at):
            # m is b at all other pairs. Its difference from b instead would lose as many digits as
            # points are stiffer than the structure.
            right = np.empty((1, len(at)))
            right[0] = between[at]
            between[at] = 0.0
            dx[:], dy[:] = 0.0, 0.0
            moved_at(changed, at, columns, values, supported, between, dy)
            blockwise(more, dy, 1.0, dx)
            share_out(columns, values, dx, seen)
            right[0] -= seen[at]
            substitute(getrs, transposed, lu, pivots, right)
            between[at] = right[0]
        interpolate(columns, values, np.dot(supported, between), dy)
        dx[:] = alone
        blockwise(K, dy, -1.0, dx)
        if predicting:
            predicting -= 1
            slipping, backward = 0, 0
            for p in range(n):
                if slope[p, 0] > 0.0 and (slope[p, 4] < 1.0 or slope[p, 8] < 1.0):
                    slipping += 1
                    slip = 0.0
                    for a in range(1, 3):
                        now = z[a, p] + dy[a, p] + closure[a, p] * dx[a, p]
                        slip += now * start[a, p]
                    if slip > 0.0:
                        backward += 1
                        stuck[p] = True
            if predicting and backward > FEW_BACK * slipping:
                continue
            predicting = 0
            x[:] = start + dx
            share_out(columns, values, x, pairs)
            interpolate(columns, values, np.dot(S, pairs), y)
            z[:] = y + closure * x + z_free
            norm, left = residual(x - scale * z, x, friction, wrong)
            if left <= ENOUGH:
                break
            continue
        if fresh:
            n_past = 0
        if n_past == len(past):
            past[:MIXED] = past[1:].copy()
            n_past = MIXED
        past[n_past, 0, : 3 * n], past[n_past, 0, 3 * n :] = x.ravel(), y.ravel()
        past[n_past, 1, : 3 * n], past[n_past, 1, 3 * n :] = dx.ravel(), dy.ravel()
        n_past += 1
        if n_past > 1:
            step_of[:] = past[n_past - 1, 1]
            extrapolated(past, n_past, step_of)
            dx[:] = step_of[: 3 * n].reshape((3, n))
            dy[:] = step_of[3 * n :].reshape((3, n))
        fraction, found, size, largest = 1.0, False, norm, left
        for _ in range(MOST_HALVINGS if whole else 1):
            tried[:] = x + fraction * dx
            moved[:] = y + fraction * dy
            slack[:] = moved + closure * tried + z_free
            size, largest = residual(tried - scale * slack, tried, friction, wrong)
            if size < (1.0 - 1e-4 * fraction) * norm:
                found = True
                break
            fraction /= 2.0
        renew = not whole and size >= SLOW * norm
        if not found:
            if whole:
                break
            residual(x - scale * z, x, friction, wrong)
            continue
        x[:], y[:], z[:] = tried, moved, slack
        norm, left = size, largest
        if left <= (ENOUGH if exact else NEARLY):
            # Displacements were added up; those of the forces say whether it is solved.
            share_out(columns, values, x, pairs)
            interpolate(columns, values, np.dot(S, pairs), y)
            z[:] = y + closure * x + z_free
            norm, left = residual(x - scale * z, x, friction, wrong)
            n_past = 0 if not exact else n_past
            exact = True
        if left <= ENOUGH:
            break
    return max(count, 1.0), left
