"""Increments with friction, compiled: what :mod:`.frictional` solves, with fewer factorizations.

Steps are those of :mod:`.newton_steps`. Factors of one state serve the next ones: with V the rows
of G at points where J is another by more than a little, U = S (I + B S)⁻¹ Vᵀ and ΔK what changed,
S q is that of the factors less U m, (I + ΔK V U) m = ΔK V S q. At all other points J stays that of
the factors, and steps are extrapolated from those before (Anderson 1965,
doi:10.1145/321296.321305). What this does not solve is left to the solver in Python.

Importing this module compiles it, or reads what was compiled before.
"""

from typing import Any

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
from faying.contact.frictional import AT_BOUND, FEW_BACK, MOST_HALVINGS, MOST_STEPS
from faying.contact.newton_steps import PROXIMAL

ENOUGH = 1e-11
"""Natural residual over the largest force at which an increment is solved."""

NEARLY = 1e-7
"""Residual from which displacements are those of the forces, no longer added up."""

CHANGED = 0.1
"""Difference of an entry of J from which a point counts as changed."""

MOST_CHANGED = 40
"""Changed points that factors are kept for."""

SLOW = 0.5
"""Residual over the one before from which a step with older factors is followed by new ones."""

MIXED = 5
"""Differences of steps that one is extrapolated from."""

SUMS = {"reassoc", "contract"}
"""Sums may be taken in any order, so that the processor adds several terms at once."""


@numba.njit(cache=True, fastmath=SUMS)
def assembled(
    columns: Indices, values: Matrix, S: Matrix, K: Matrix, slope: Matrix, place: Indices, size: int
) -> Matrix:
    """Return I + B S at the touched pairs (size, size); ``place`` tells where they are in it."""
    n, result = len(K), np.zeros((size, size))
    at = np.flatnonzero(place >= 0)
    here = np.ascontiguousarray(S[at][:, at])
    moved, forces = np.empty((3, size)), np.empty(size)
    for p in range(n):
        if slope[p, 0] == 0.0:
            continue
        for a in range(3):
            moved[a] = 0.0
            for j in range(columns.shape[1]):
                share, row = values[a * n + p, j], place[columns[a * n + p, j]]
                if share != 0.0:
                    for i in range(size):
                        moved[a, i] += share * here[row, i]
        for a in range(3):
            k0, k1, k2 = K[p, 3 * a], K[p, 3 * a + 1], K[p, 3 * a + 2]
            for i in range(size):
                forces[i] = k0 * moved[0, i] + k1 * moved[1, i] + k2 * moved[2, i]
            for j in range(columns.shape[1]):
                share, row = values[a * n + p, j], place[columns[a * n + p, j]]
                if share != 0.0:
                    for i in range(size):
                        result[row, i] += share * forces[i]
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
def moved_by(
    getrs: int,
    transposed: Matrix,
    lu: Matrix,
    pivots: Any,
    touched: Indices,
    here: Matrix,
    S: Matrix,
    columns: Indices,
    values: Matrix,
    K: Matrix,
    pairs: Matrix,
) -> Matrix:
    """Return S (I + B S)⁻¹ b (m, n_relative) for forces between pairs b (m, n_relative)."""
    m, n = len(pairs), len(K)
    right = np.empty((m, len(touched)))
    result = np.zeros((m, len(S)))
    points, forces = np.empty((3, n)), np.empty((3, n))
    moved = np.empty(len(S))
    for i in range(m):
        right[i] = pairs[i][touched]
        beside = pairs[i].copy()
        beside[touched] = 0.0
        # Forces between pairs that no closed point touches are known, and move the others.
        if beside.any():
            for j in np.flatnonzero(beside):
                result[i] += beside[j] * S[j]
            interpolate(columns, values, result[i], points)
            forces[:] = 0.0
            blockwise(K, points, 1.0, forces)
            share_out(columns, values, forces, moved)
            right[i] -= moved[touched]
    substitute(getrs, transposed, lu, pivots, right)
    result += np.dot(right, here)
    return result


SIGNATURE = (
    "UniTuple(float64, 2)(uint64, uint64, uint8[::1], int64[:,::1], float64[:,::1],"
    " float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[::1],"
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
    own: Matrix,
    closure: Matrix,
    scale: Matrix,
    friction: Vector,
    z_free: Matrix,
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
    S : (n_relative, n_relative)
    own, closure, scale : (3, n_point)
        Diagonal of G S Gᵀ, c′ and r.
    friction : (n_point,)
    z_free : (3, n_point)
    x : (3, n_point)
        Forces of the increment before, admissible; those of this one.
    z : (3, n_point)
        Slack to be written.
    """
    n, n_pair = x.shape[1], len(S)
    yielding = np.maximum(closure, PROXIMAL * own)
    slope, K, inverse = np.zeros((n, 9)), np.zeros((n, 9)), np.zeros((n, 9))
    slope0, stiff0, inverse0 = np.zeros((n, 9)), np.zeros((n, 9)), np.zeros((n, 9))
    y, wrong, alone = np.empty((3, n)), np.empty((3, n)), np.empty((3, n))
    trial, slack, tried = np.empty((3, n)), np.empty((3, n)), np.empty((3, n))
    dx, dy, moved = np.empty((3, n)), np.empty((3, n)), np.empty((3, n))
    lu, pivots = np.empty((0, 0)), np.empty(0, dtype=np.int32)
    touched, here = np.empty(0, dtype=np.int64), np.empty((0, 0))
    place = np.empty(n_pair, dtype=np.int64)
    pairs, between = np.empty(n_pair), np.empty((1, n_pair))
    known, n_known = np.full(n, -1), 0
    answers, seen = np.empty((0, n_pair)), np.empty((0, 0))
    met, changed = np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    past = np.empty((MIXED + 1, 2, 6 * n))
    step_of = np.empty(6 * n)
    stuck = np.zeros(n, dtype=np.bool_)
    share_out(columns, values, x, pairs)
    interpolate(columns, values, np.dot(S, pairs), y)
    z[:] = y + closure * x + z_free
    start, count, n_past, last_changed = x.copy(), 0.0, 0, -1
    norm, left = np.inf, np.inf
    renew, exact, predicting = True, False, 2
    while count < MOST_STEPS:
        # The first two are no Newton steps: they say where forces go if no point changes sides.
        if predicting:
            for p in range(n):
                outward = 1.0 - AT_BOUND if stuck[p] else 1.0 + AT_BOUND
                trial[0, p] = start[0, p]
                trial[1, p], trial[2, p] = outward * start[1, p], outward * start[2, p]
        else:
            count += 1
            trial[:] = x - scale * z
        slopes(trial, friction, slope)
        if not renew:
            changed = np.flatnonzero(
                np.array([np.abs(slope[p] - slope0[p]).max() > CHANGED for p in range(n)])
            )
            renew = len(changed) > MOST_CHANGED
        fresh = renew
        if renew:
            renew = False
            changed, met, n_known = changed[:0], met[:0], 0
            known[:] = -1
            slope0[:] = slope
            stiff0[:], inverse0[:] = 0.0, 0.0
            place[:] = -1
            for p in range(n):
                if slope[p, 0] == 0.0:
                    inverse0[p, 0] = inverse0[p, 4] = inverse0[p, 8] = 1.0
                    continue
                local(slope[p], p, scale, yielding, inverse0[p], stiff0[p])
                for a in range(3):
                    for j in range(columns.shape[1]):
                        if values[a * n + p, j] != 0.0:
                            place[columns[a * n + p, j]] = 0
            touched = np.flatnonzero(place == 0)
            for i in range(len(touched)):
                place[touched[i]] = i
            if not len(touched):
                return count, np.inf
            here = S[touched]
            lu = assembled(columns, values, S, stiff0, slope0, place, len(touched))
            pivots = np.empty(len(touched), dtype=np.int32)
            if not factorize(getrf, lu, pivots) or not np.isfinite(lu).all():
                return count, np.inf
        K[:], inverse[:] = stiff0, inverse0
        for other in changed:
            if slope[other, 0] == 0.0:
                K[other], inverse[other] = 0.0, 0.0
                inverse[other, 0] = inverse[other, 4] = inverse[other, 8] = 1.0
            else:
                local(slope[other], int(other), scale, yielding, inverse[other], K[other])
        alone[:] = 0.0
        if predicting:
            blockwise(K, z, -1.0, alone)
        else:
            blockwise(inverse, wrong, -1.0, alone)
        share_out(columns, values, alone, between[0])
        went = moved_by(
            getrs, transposed, lu, pivots, touched, here, S, columns, values, stiff0, between
        )[0]
        if len(changed):
            new = np.array([p for p in changed if known[p] < 0], dtype=np.int64)
            if len(new):
                right = np.zeros((3 * len(new), n_pair))
                for i in range(len(new)):
                    known[new[i]] = n_known
                    n_known += 1
                    for a in range(3):
                        row = a * n + new[i]
                        for j in range(columns.shape[1]):
                            right[3 * i + a, columns[row, j]] += values[row, j]
                more = moved_by(
                    getrs,
                    transposed,
                    lu,
                    pivots,
                    touched,
                    here,
                    S,
                    columns,
                    values,
                    stiff0,
                    right,
                )
                answers = np.concatenate((answers[: 3 * len(met)], more))
                met = np.concatenate((met, new))
                seen = np.empty((3 * n_known, 3 * n_known))
                for i in range(n_known):
                    for a in range(3):
                        row = a * n + met[i]
                        for k in range(3 * n_known):
                            total = 0.0
                            for j in range(columns.shape[1]):
                                total += values[row, j] * answers[k, columns[row, j]]
                            seen[3 * i + a, k] = total
            m = len(changed)
            core, rest, view = np.zeros((3 * m, 3 * m)), np.zeros(3 * m), np.empty(3)
            for i in range(m):
                p = changed[i]
                for a in range(3):
                    row, view[a] = a * n + p, 0.0
                    for j in range(columns.shape[1]):
                        view[a] += values[row, j] * went[columns[row, j]]
                for a in range(3):
                    core[3 * i + a, 3 * i + a] = 1.0
                    for b in range(3):
                        more_stiff = K[p, 3 * a + b] - stiff0[p, 3 * a + b]
                        rest[3 * i + a] += more_stiff * view[b]
                        own_row = seen[3 * known[p] + b]
                        for k in range(m):
                            at = 3 * known[changed[k]]
                            for c in range(3):
                                core[3 * i + a, 3 * k + c] += more_stiff * own_row[at + c]
            try:
                shares = np.linalg.solve(core, rest)
            except Exception:  # all that numba can tell
                renew = True
                continue
            for i in range(m):
                for a in range(3):
                    went -= shares[3 * i + a] * answers[3 * known[changed[i]] + a]
        interpolate(columns, values, went, dy)
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
        if fresh or len(changed) != last_changed:
            n_past = 0
        last_changed = len(changed)
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
        for _ in range(MOST_HALVINGS if fresh else 1):
            tried[:] = x + fraction * dx
            moved[:] = y + fraction * dy
            slack[:] = moved + closure * tried + z_free
            size, largest = residual(tried - scale * slack, tried, friction, wrong)
            if size < (1.0 - 1e-4 * fraction) * norm:
                found = True
                break
            fraction /= 2.0
        renew = not fresh and size >= SLOW * norm
        if not found:
            if fresh:
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
