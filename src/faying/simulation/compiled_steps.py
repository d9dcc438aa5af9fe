"""Time steps of a reduced model, compiled: what :mod:`.stepping` does, without Python in between.

Contact is solved from a similar problem, as :mod:`~faying.contact.supported_pairs` does it, whose
docstring has the equations. What that cannot settle ends the loop and is left to the
solvers in Python: points that change sides in large numbers, and what round-off spoils.

Importing this module compiles it, or reads what was compiled before. Everything is in one file
because numba keeps what it compiled as long as that file does not change.
"""

import numba
import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.active_set import ROUND_OFF
from faying.contact.supported_pairs import CLOSED, LOOSE, MOST_REFINEMENTS, MOST_SYSTEMS

SUMS = {"reassoc", "contract"}
"""Sums may be taken in any order, so that the processor adds several terms at once."""

RENEWAL = 1_000_000
"""What a new E costs beside its n³ multiplications, in multiplications."""

SIGNATURE = (
    "int64(float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1],"
    " float64[:,::1], float64[:,::1], float64[:,::1], boolean[::1], int64[:,::1], float64[:,::1],"
    " float64[::1], float64[::1], float64[::1], float64[:,::1], int64,"
    " float64[::1], boolean[::1], float64[::1],"
    " float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], int64[::1])"
)


@numba.njit(cache=True, fastmath=SUMS)
def symmetric_product(matrix: Matrix, vector: Vector, result: Vector) -> None:
    """Write A x, reading one triangle."""
    for i in range(len(vector)):
        row, own, total = matrix[i], vector[i], 0.0
        for j in range(i):
            total += row[j] * vector[j]
            result[j] += row[j] * own
        result[i] = total + row[i] * own


@numba.njit(cache=True, fastmath=SUMS)
def product(matrix: Matrix, vector: Vector, result: Vector) -> None:
    """Write A x."""
    for i in range(matrix.shape[0]):
        row, total = matrix[i], 0.0
        for j in range(len(vector)):
            total += row[j] * vector[j]
        result[i] = total


@numba.njit(cache=True)
def interpolate(columns: Indices, values: Matrix, pairs: Vector, points: Vector) -> None:
    """Write N y, from pairs to points."""
    for i in range(columns.shape[0]):
        total = 0.0
        for j in range(columns.shape[1]):
            total += values[i, j] * pairs[columns[i, j]]
        points[i] = total


@numba.njit(cache=True)
def share_out(columns: Indices, values: Matrix, points: Vector, pairs: Vector) -> None:
    """Write Nᵀ λ, from points to pairs."""
    pairs[:] = 0.0
    for i in range(columns.shape[0]):
        force = points[i]
        if force != 0.0:
            for j in range(columns.shape[1]):
                pairs[columns[i, j]] += values[i, j] * force


@numba.njit(cache=True)
def move_alone(
    E: Matrix,
    inside: Mask,
    columns: Indices,
    values: Matrix,
    D: Vector,
    gap: Vector,
    pressed: Vector,
    pairs: Vector,
    moved: Vector,
) -> None:
    """Write y for gaps without contact forces, with the springs that E was made with."""
    for i in range(len(gap)):
        pressed[i] = -gap[i] / D[i] if inside[i] else 0.0
    share_out(columns, values, pressed, pairs)
    symmetric_product(E, pairs, moved)


@numba.njit(cache=True)
def meet(
    E: Matrix,
    columns: Indices,
    values: Matrix,
    point: int,
    slots: Indices,
    known: Indices,
    seen: Matrix,
    corner: Matrix,
) -> None:
    """Note V E and V E Vᵀ of a point that changes sides for the first time since E was made."""
    place = len(known)
    slots[point] = place
    row = seen[place]
    row[:] = 0.0
    for j in range(columns.shape[1]):
        share, own = values[point, j], E[columns[point, j]]
        if share != 0.0:
            for k in range(len(row)):
                row[k] += share * own[k]
    for a in range(place + 1):
        other = known[a] if a < place else point
        total = 0.0
        for j in range(columns.shape[1]):
            total += values[other, j] * row[columns[other, j]]
        corner[a, place] = total
        corner[place, a] = total


@numba.njit(cache=True)
def move_with_changed(
    columns: Indices,
    values: Matrix,
    D: Vector,
    gap: Vector,
    alone: Vector,
    changed: Indices,
    active: Mask,
    slots: Indices,
    seen: Matrix,
    corner: Matrix,
    moved: Vector,
) -> bool:
    """Write y with the springs of the points that are closed now; say whether that is regular."""
    moved[:] = alone
    n = len(changed)
    if n == 0:
        return True
    core, missing = np.empty((n, n)), np.empty(n)
    for a in range(n):
        p = changed[a]
        total = gap[p]
        for j in range(columns.shape[1]):
            total += values[p, j] * alone[columns[p, j]]
        missing[a] = -total
        row = corner[slots[p]]
        for b in range(n):
            core[a, b] = row[slots[changed[b]]]
        core[a, a] += D[p] if active[p] else -D[p]
    try:
        forces = np.linalg.solve(core, missing)
    except Exception:  # all that numba can tell
        return False
    for a in range(n):
        force, row = forces[a], seen[slots[changed[a]]]
        for k in range(len(moved)):
            moved[k] += force * row[k]
    return True


@numba.njit(cache=True)
def largest(values: Vector) -> float:
    """Return the largest magnitude; infinity if there is a NaN."""
    result = 0.0
    for value in values:
        if not abs(value) <= result:
            result = abs(value) if value == value else np.inf
    return result


@numba.njit(SIGNATURE, cache=True)
def advance(
    start: Matrix,
    applied_to_free: Matrix,
    to_pairs: Matrix,
    from_pairs: Matrix,
    pairs_to_states: Matrix,
    newmark: Matrix,
    E: Matrix,
    S: Matrix,
    inside: Mask,
    columns: Indices,
    values: Matrix,
    D: Vector,
    own: Vector,
    initial_gap: Vector,
    applied: Matrix,
    most_changed: int,
    motion: Vector,
    guess: Mask,
    trend: Vector,
    states: Matrix,
    velocities: Matrix,
    accelerations: Matrix,
    contact_forces: Matrix,
    slacks: Matrix,
    systems: Indices,
) -> int:
    """Advance a transient until a step does not settle, or a new E pays; return the steps done.

    Parameters
    ----------
    start, applied_to_free : (n, 4 n), (n, n)
        Free displacement per motion (u, v, a, f) at the start of a step and per external force.
    to_pairs, from_pairs : (n_pair, n), (n, n_pair)
        Relative displacements P, and displacements per relative force.
    pairs_to_states : (n, n_pair)
        Pᵀ.
    newmark : (2, 6)
        Velocity and acceleration per u, v, a, f at the start and u, f at the end of a step.
    E, S, inside, columns, values, D, own
        Of the pairs on springs.
    initial_gap : (n_point,)
    applied : (n_step, n)
        External forces.
    most_changed
        Changed points that E is good for.
    motion : (4 n,)
        Where the transient stands; moved on.
    guess, trend : (n_point,)
        Points expected in contact, and forces as lengths minus slacks one step ago (NaN if there
        is none); moved on. Where points have changed sides in larger numbers than E is good for,
        those that were tried last.
    states, velocities, accelerations, contact_forces, slacks, systems
        Histories to be written, one row a step.
    """
    n_step, n = applied.shape
    n_point, n_pair = len(D), len(S)
    free, pairs, alone = np.empty(n), np.empty(n_pair), np.empty(n_pair)
    moved, force_pairs = np.empty(n_pair), np.empty(n_pair)
    relative, response = np.empty(n_pair), np.empty(n)
    gap, at_points, pressed = np.empty(n_point), np.empty(n_point), np.empty(n_point)
    forces, slack = np.empty(n_point), np.empty(n_point)
    active, changes = guess.copy(), np.empty(n_point, dtype=np.int64)
    from_motion = np.empty(n)
    room, n_known = 2 * most_changed + 2, 0
    spent, renewal = 0, n_pair**3 + RENEWAL
    slots, known = np.full(n_point, -1), np.empty(room, dtype=np.int64)
    seen, corner = np.empty((room, n_pair)), np.empty((room, room))
    for step in range(n_step):
        product(start, motion, from_motion)
        product(applied_to_free, applied[step], free)
        for i in range(n):
            free[i] += from_motion[i]
        product(to_pairs, free, relative)
        interpolate(columns, values, relative, gap)
        for i in range(n_point):
            gap[i] += initial_gap[i]
        size = largest(gap)
        if not size < np.inf:
            return step
        noise, loose = ROUND_OFF * size, LOOSE * size
        active[:] = guess
        move_alone(E, inside, columns, values, D, gap, pressed, pairs, alone)
        count, settled = 0, False
        while count < MOST_SYSTEMS and not settled:
            count += 1
            n_changed = 0
            for i in range(n_point):
                if active[i] != inside[i]:
                    changes[n_changed] = i
                    n_changed += 1
            if n_changed > most_changed:
                guess[:] = active
                return step
            changed = changes[:n_changed]
            n_new = 0
            for p in changed:
                n_new += slots[p] < 0
            if n_known + n_new > room:
                slots[:] = -1
                n_known = 0
            for p in changed:
                if slots[p] < 0:
                    meet(E, columns, values, p, slots, known[:n_known], seen, corner)
                    known[n_known] = p
                    n_known += 1
            if not move_with_changed(
                columns, values, D, gap, alone, changed, active, slots, seen, corner, moved
            ):
                return step
            interpolate(columns, values, moved, at_points)
            settled = True
            for i in range(n_point):
                here = gap[i] + at_points[i]
                forces[i] = -here / D[i] if active[i] else 0.0
                if here > loose if active[i] else here < -loose:
                    active[i] = not active[i]
                    settled = False
            if not settled:
                continue
            left, exact = 1.0, False
            for _ in range(MOST_REFINEMENTS):
                share_out(columns, values, forces, force_pairs)
                symmetric_product(S, force_pairs, moved)
                interpolate(columns, values, moved, slack)
                missing, strongest = 0.0, 0.0
                for i in range(n_point):
                    slack[i] += gap[i] + D[i] * forces[i]
                    if active[i]:
                        missing = max(missing, abs(slack[i]) / D[i])
                    strongest = max(strongest, abs(forces[i]))
                before = left
                left = missing / max(strongest, missing) if missing > 0.0 else 0.0
                if left <= CLOSED:
                    exact = True
                    break
                move_alone(E, inside, columns, values, D, slack, pressed, pairs, relative)
                if not move_with_changed(
                    columns, values, D, slack, relative, changed, active, slots, seen, corner, moved
                ):
                    return step
                interpolate(columns, values, moved, at_points)
                for i in range(n_point):
                    slack[i] += at_points[i]
                    if active[i]:
                        forces[i] -= slack[i] / D[i]
                if left * left / before <= CLOSED:
                    exact = True
                    break
            if not exact:
                return step
            for i in range(n_point):
                if forces[i] * own[i] < -noise if active[i] else slack[i] < -noise:
                    active[i] = not active[i]
                    settled = False
        if not settled:
            return step
        for i in range(n_point):
            if active[i]:
                slack[i] = 0.0
            forces[i] = max(forces[i], 0.0)
            slack[i] = max(slack[i], 0.0)
        share_out(columns, values, forces, force_pairs)
        product(from_pairs, force_pairs, response)
        product(pairs_to_states, force_pairs, from_motion)
        for i in range(n):
            u = free[i] + response[i]
            force = applied[step, i] + from_motion[i]
            u0, v0, a0, f0 = motion[i], motion[n + i], motion[2 * n + i], motion[3 * n + i]
            v, a = newmark[0], newmark[1]
            states[step, i] = u
            velocities[step, i] = (
                v[0] * u0 + v[1] * v0 + v[2] * a0 + v[3] * f0 + v[4] * u + v[5] * force
            )
            accelerations[step, i] = (
                a[0] * u0 + a[1] * v0 + a[2] * a0 + a[3] * f0 + a[4] * u + a[5] * force
            )
            motion[i] = u
            motion[n + i] = velocities[step, i]
            motion[2 * n + i] = accelerations[step, i]
            motion[3 * n + i] = force
        for i in range(n_point):
            contact_forces[step, i] = forces[i]
            slacks[step, i] = slack[i]
            now = own[i] * forces[i] - slack[i]
            before = trend[i] if trend[i] == trend[i] else now
            guess[i] = 2 * now - before > 0
            trend[i] = now
        systems[step] = count
        # What the changed points of this step cost; they may stay what they are for long.
        spent += n_changed * (n_changed**2 + 2 * n_pair)
        if spent > renewal:
            return step + 1
    return int(n_step)
