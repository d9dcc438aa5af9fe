"""Compiled time steps of a reduced model: the loop of :mod:`.stepping` without Python in between.

Elastic contact without friction, in the smallest form of Newton's method. With the pairs on the
springs k of closed points, E = (Σ + Nᵀ k N)⁻¹, and N_c the rows of the points that have changed
sides since E was formed, + where one has closed, − where one has opened,

    y = y₀ + E N_cᵀ μ,   y₀ = −E Nᵀ k g,   (±k_c⁻¹ + N_c E N_cᵀ) μ = −(g_c + N_c y₀).

The loop ends, and the solver in Python takes over, where many points change sides or round-off is
too large.

The first call compiles, or reads the result of an earlier compilation. Everything is in one file
because numba caches by file: a result is valid as long as that file does not change.
"""

from typing import NamedTuple

import numba
import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.iterations import RETRIES

MOST_SYSTEMS = 20
"""Most linear systems for exchanges of all wrong points."""

LOOSE, ROUND_OFF = 1e-11, 1e-13
"""Ignored wrong gaps over the largest free gap, before and after forces are corrected.

The first also for the force equivalent to a remaining gap, over the largest force.
"""

RENEWAL = 1_000_000
"""Cost of a new E in addition to n³ multiplications, in multiplications."""


class Model(NamedTuple):
    """Data of a reduced model for all steps.

    Attributes
    ----------
    start, applied_to_free : (n, 4 n), (n, n)
        Free displacement per motion (u, v, a, f) at the start of a step and per external force.
    to_pairs, from_pairs : (n_pair, n), (n, n_pair)
        Relative displacements P, and displacements per relative force.
    pairs_to_states : (n, n_pair)
        Pᵀ.
    newmark : (2, 6)
        Velocity and acceleration per u, v, a, f at the start and u, f at the end of a step.
    S : (n_pair, n_pair)
        Compliance between pairs.
    columns, values : (n_point, 4)
        Rows of N.
    springs, initial_gap : (n_point,)
        k and the gap of the unloaded joint.
    """

    start: Matrix
    applied_to_free: Matrix
    to_pairs: Matrix
    from_pairs: Matrix
    pairs_to_states: Matrix
    newmark: Matrix
    S: Matrix
    columns: Indices
    values: Matrix
    springs: Vector
    initial_gap: Vector


class Held(NamedTuple):
    """Compliance E (n_pair, n_pair) of the pairs on the springs of points ``inside``."""

    E: Matrix
    inside: Mask


class Histories(NamedTuple):
    """Output arrays, one row a step."""

    states: Matrix
    velocities: Matrix
    accelerations: Matrix
    contact_forces: Matrix
    slacks: Matrix
    systems: Indices


class Met(NamedTuple):
    """Points that changed sides since E was formed: their slots, N_c E and N_c E N_cᵀ."""

    slots: Indices
    points: Indices
    seen: Matrix
    corner: Matrix


@numba.njit(cache=True)
def interpolate(columns: Indices, values: Matrix, pairs: Vector, points: Vector) -> None:
    """Write N y, displacements of pairs interpolated to points."""
    for i in range(columns.shape[0]):
        total = 0.0
        for j in range(columns.shape[1]):
            total += values[i, j] * pairs[columns[i, j]]
        points[i] = total


@numba.njit(cache=True)
def share_out(columns: Indices, values: Matrix, points: Vector, pairs: Vector) -> None:
    """Write Nᵀ λ, forces of points distributed to pairs."""
    pairs[:] = 0.0
    for i in range(columns.shape[0]):
        force = points[i]
        if force != 0.0:
            for j in range(columns.shape[1]):
                pairs[columns[i, j]] += values[i, j] * force


@numba.njit(cache=True)
def meet(model: Model, held: Held, point: int, known: int, met: Met) -> None:
    """Add a point that has changed sides to those known, when it does so for the first time."""
    columns, values = model.columns, model.values
    met.slots[point] = known
    met.points[known] = point
    row = met.seen[known]
    row[:] = 0.0
    for j in range(columns.shape[1]):
        if values[point, j] != 0.0:
            row += values[point, j] * held.E[columns[point, j]]
    for a in range(known + 1):
        point_met, total = met.points[a], 0.0
        for j in range(columns.shape[1]):
            total += values[point_met, j] * row[columns[point_met, j]]
        met.corner[a, known] = met.corner[known, a] = total


@numba.njit(cache=True)
def move(
    model: Model,
    held: Held,
    gap: Vector,
    changed: Indices,
    active: Mask,
    met: Met,
    moved: Vector,
) -> bool:
    """Write y for gaps without contact to ``moved``; return whether the system is regular."""
    columns, values, k = model.columns, model.values, model.springs
    pressed, pairs = np.empty(len(gap)), np.empty(len(moved))
    for i in range(len(gap)):
        pressed[i] = -gap[i] * k[i] if held.inside[i] else 0.0
    share_out(columns, values, pressed, pairs)
    np.dot(held.E, pairs, moved)
    n = len(changed)
    if n == 0:
        return True
    missing, core = np.empty(n), np.empty((n, n))
    for a in range(n):
        p = changed[a]
        for b in range(n):
            core[a, b] = met.corner[met.slots[p], met.slots[changed[b]]]
        core[a, a] += 1.0 / k[p] if active[p] else -1.0 / k[p]
        missing[a] = -gap[p]
        for j in range(columns.shape[1]):
            missing[a] -= values[p, j] * moved[columns[p, j]]
    try:
        forces = np.linalg.solve(core, missing)
    except Exception:  # the only check in numba
        return False
    for a in range(n):
        moved += forces[a] * met.seen[met.slots[changed[a]]]
    return True


@numba.njit(cache=True)
def advance(
    model: Model,
    held: Held,
    applied: Matrix,
    most_changed: int,
    motion: Vector,
    guess: Mask,
    histories: Histories,
) -> int:
    """Advance a transient until a step does not converge, or a new E pays; return the steps done.

    Parameters
    ----------
    applied : (n_step, n)
        External forces.
    most_changed
        Largest number of changed points for this E.
    motion : (4 n,)
        Motion at the start, updated in place.
    guess : (n_point,)
        Points in contact, updated in place; after more changes than E allows, the points that
        were tried last.
    """
    columns, values, springs, S = model.columns, model.values, model.springs, model.S
    inside = held.inside
    n_step, n = applied.shape
    n_point, n_pair = len(springs), len(S)
    pairs, moved, relative = np.empty(n_pair), np.empty(n_pair), np.empty(n_pair)
    gap, at_points = np.empty(n_point), np.empty(n_point)
    forces, slack = np.empty(n_point), np.empty(n_point)
    active, ends, last = guess.copy(), np.empty((2, n)), np.empty(n_point)
    spent, renewal = 0, n_pair**3 + RENEWAL
    most_met, n_known = 2 * most_changed + 2, 0
    met = Met(
        np.full(n_point, -1),
        np.empty(most_met, dtype=np.int64),
        np.empty((most_met, n_pair)),
        np.empty((most_met, most_met)),
    )
    for step in range(n_step):
        free = model.start @ motion + model.applied_to_free @ applied[step]
        np.dot(model.to_pairs, free, relative)
        interpolate(columns, values, relative, gap)
        gap += model.initial_gap
        size = np.abs(gap).max()
        if not size < np.inf:
            return step
        noise, loose = ROUND_OFF * size, LOOSE * size
        active[:] = guess
        count, settled = 0, False
        while count < MOST_SYSTEMS and not settled:
            count += 1
            changed = (active != inside).nonzero()[0]
            if len(changed) > most_changed:
                guess[:] = active
                return step
            if n_known + len(changed) > most_met:
                met.slots[:] = -1
                n_known = 0
            for p in changed:
                if met.slots[p] < 0:
                    meet(model, held, p, n_known, met)
                    n_known += 1
            if not move(model, held, gap, changed, active, met, moved):
                return step
            interpolate(columns, values, moved, at_points)
            settled = True
            for i in range(n_point):
                gap_now = gap[i] + at_points[i]
                forces[i] = -gap_now * springs[i] if active[i] else 0.0
                if gap_now > loose if active[i] else gap_now < -loose:
                    active[i] = not active[i]
                    settled = False
            if not settled:
                continue
            left, exact = 1.0, False
            for _ in range(RETRIES):
                share_out(columns, values, forces, pairs)
                np.dot(S, pairs, moved)
                interpolate(columns, values, moved, slack)
                missing, strongest = 0.0, 0.0
                for i in range(n_point):
                    slack[i] += gap[i] + forces[i] / springs[i]
                    if active[i]:
                        missing = max(missing, abs(slack[i]) * springs[i])
                    strongest = max(strongest, abs(forces[i]))
                previous = left
                left = missing / max(strongest, missing) if missing > 0.0 else 0.0
                if left > LOOSE:
                    if not move(model, held, slack, changed, active, met, moved):
                        return step
                    interpolate(columns, values, moved, at_points)
                    for i in range(n_point):
                        slack[i] += at_points[i]
                        if active[i]:
                            forces[i] -= slack[i] * springs[i]
                if left <= LOOSE or left * left / previous <= LOOSE:
                    exact = True
                    break
            if not exact:
                return step
            for i in range(n_point):
                if forces[i] < -noise * springs[i] if active[i] else slack[i] < -noise:
                    active[i] = not active[i]
                    settled = False
        if not settled:
            return step
        for i in range(n_point):
            histories.contact_forces[step, i] = forces[i] = max(forces[i], 0.0)
            histories.slacks[step, i] = slack[i] = 0.0 if active[i] else max(slack[i], 0.0)
        share_out(columns, values, forces, pairs)
        u = free + model.from_pairs @ pairs
        f = applied[step] + model.pairs_to_states @ pairs
        before_it = motion.reshape(4, n)
        for order in range(2):
            share = model.newmark[order]
            ends[order] = share[4] * u + share[5] * f
            for part in range(4):
                ends[order] += share[part] * before_it[part]
        histories.states[step] = u
        histories.velocities[step], histories.accelerations[step] = ends[0], ends[1]
        before_it[0], before_it[1], before_it[2], before_it[3] = u, ends[0], ends[1], f
        for i in range(n_point):
            now = slack[i] - forces[i] / springs[i]
            # Points whose gaps close or open at this rate are predicted; a jump costs a system.
            guess[i] = 2 * now - (last[i] if step else now) < 0
            last[i] = now
        histories.systems[step] = count
        # Cost of the changed points of this step, which may stay changed for long.
        spent += len(changed) * (len(changed) ** 2 + 2 * n_pair)
        if spent > renewal:
            return step + 1
    return int(n_step)


def compile_steps() -> None:
    """Compile the loop, or read it from the cache, by a call with an empty model."""
    nothing, none, inside = np.zeros((0, 0)), np.zeros(0), np.zeros(0, dtype=np.bool_)
    columns, counts = np.zeros((0, 0), dtype=np.int64), np.zeros(0, dtype=np.int64)
    newmark = np.zeros((2, 6))
    matrices = (nothing, nothing, nothing, nothing, nothing, newmark, nothing)
    advance(
        Model(*matrices, columns, nothing, none, none),
        Held(nothing, inside),
        nothing,
        0,
        none,
        inside,
        Histories(nothing, nothing, nothing, nothing, nothing, counts),
    )
