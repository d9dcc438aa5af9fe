"""Paths of points that may leave their springs, all others being stuck; and their derivatives.

With w = G_c δ at the points, w₀ what loads move there with all points stuck, T = G_c T₀ G_cᵀ and
the forces μ that the points exert beside their springs B (F10), an increment is

    w = w₀ + T μ,   μ = λ(z₀ + w − s) − λ₀ + B w,                                           (F12)

with the slip s since the joint was at rest. Newton's method has I + T Δ to solve with, Δ = K − B,
in which only the points take part that slip or are open: those on their springs have no Δ.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
import scipy.linalg as la

from faying._typing import Indices, Mask, Matrix, Vector
from faying.contact.increment import Increment
from faying.contact.stuck_points import LocalContact
from faying.simulation.path import PathStep, follow

SOLVED = 1e-13
"""Residual over the largest displacement at which an increment is solved."""

MOST_STEPS = 15
"""Newton steps of (F12); 1 to 3 are usual. What takes more goes the way of other paths."""

UNCHANGED = 1e-12
"""Change of K at a point, over the stiffest spring, that is round-off."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class LocalPath:
    """Where points were after each increment.

    Attributes
    ----------
    moved : (n_increment, components n_point) [length]
        w.
    forces : (n_increment, components, n_point)
        λ.
    slipped : (n_increment, 2, n_point) [length]
        s.
    slack : (n_increment, 2, n_point) [length]
        What each increment added to it.
    dissipation : (n_increment,) [force·length]
    """

    moved: Matrix
    forces: Matrix
    slipped: Matrix
    slack: Matrix
    dissipation: Vector

    def excess(self, local: LocalContact) -> Matrix:
        """Return μ (components n_point, n_increment)."""
        n = len(self.moved)
        change = (self.forces - local.forces).reshape(n, -1) + local.springs.ravel() * self.moved
        return np.asarray(change.T)


def follow_local(
    local: LocalContact,
    linear: Matrix,
    restrained: Matrix,
    guess: Sequence[Vector] | None = None,
) -> LocalPath:
    """Follow the points along a path of loads.

    Linear displacements w₀ are (n_increment, components n_point) [length]; with all points stuck
    the loads move the pairs by ``restrained`` (n_increment, n_touched) [length]. A guess of
    increments is w (components n_point,) to begin with.

    Raises
    ------
    ConvergenceError
        If an increment is not solved.
    """
    n, (k, m) = len(linear), local.springs.shape
    moved, forces = np.zeros((n, k * m)), np.zeros((n, k, m))
    slipped, slack = np.zeros((n, 2, m)), np.zeros((n, 2, m))
    dissipation = np.zeros(n)
    w, slip, excess = np.zeros(k * m), np.zeros((2, m)), np.zeros(k * m)
    previous = np.zeros(len(local.pairs))
    for number in range(n):
        begun = w if guess is None else guess[number]
        solution = _increment(local, linear[number], slip, begun)
        if solution is None:
            step = _otherwise(local, previous, restrained[number], excess, slip)
            slack[number] = step.slip - local.slip - slip
            dissipation[number] = step.dissipation
            forces[number] = step.increment.forces[:k]
            w = local.rows @ (step.increment.moved - local.whole.moved[local.pairs])
        else:
            w, forces[number], slack[number] = solution
            if k > 1:
                dissipation[number] = -(forces[number][1:] * slack[number]).sum()
        slip = slip + slack[number]
        moved[number], slipped[number] = w, slip
        excess = (forces[number] - local.forces).ravel() + local.springs.ravel() * w
        previous = restrained[number]
    return LocalPath(
        moved=moved, forces=forces, slipped=slipped, slack=slack, dissipation=dissipation
    )


def _increment(
    local: LocalContact, linear: Vector, slip: Matrix, w: Vector
) -> tuple[Vector, Matrix, Matrix] | None:
    """Return w, λ and the slip of an increment by Newton's method; None where it goes astray."""
    springs, T, (k, m) = local.springs.ravel(), local.compliance, local.springs.shape
    anchor = local.at_rest.copy()
    anchor[1:] -= slip[: k - 1]
    size = max(float(np.abs(linear).max(initial=0.0)), float(np.abs(w).max(initial=0.0)))
    last = np.inf
    for _ in range(MOST_STEPS):
        z = anchor + w.reshape(k, m)
        forces, K = local.laws.respond(z)
        excess = (forces - local.forces).ravel() + springs * w
        residual = linear - w + T @ excess
        left = float(np.abs(residual).max(initial=0.0))
        if not np.isfinite(left):
            return None
        if left <= SOLVED * size or (left <= 1e2 * SOLVED * size and left >= last / 2):
            slack = (z + local.laws.yielded(forces))[1:]
            return w, forces, slack if k > 1 else np.zeros((2, m))
        last = left
        w = w + _solved(local, K, residual)
        size = max(size, float(np.abs(w).max(initial=0.0)))
    return None


def _changed(local: LocalContact, K: Matrix) -> tuple[Indices, Indices, Matrix, Mask]:
    """Return points off their springs, their rows, Δ (n, components, components) and its rows.

    Those are the rows in which Δ is not zero: slip leaves that of the normal force as it is.
    """
    k, m = local.springs.shape
    change = K.copy()
    diagonal = np.arange(k)
    change[:, diagonal, diagonal] -= local.springs.T
    round_off = UNCHANGED * float(local.springs.max(initial=0.0))
    by_row = np.abs(change).max(axis=2)
    points = np.flatnonzero(by_row.max(axis=1) > round_off)
    rows = (m * np.arange(k)[:, None] + points).ravel()
    return points, rows, change[points], (round_off < by_row[points].T).ravel()


def _blocks(change: Matrix, values: Matrix) -> Matrix:
    """Return Δ times values (components n, x), component by component."""
    n, k, _ = change.shape
    shaped = values.reshape(k, n, values.shape[1])
    return np.asarray(np.einsum("nij,jnx->inx", change, shaped).reshape(values.shape))


def _resisted(T: Matrix, change: Matrix, acting: Mask, right: Matrix) -> Matrix:
    """Return Δ x of (I + T Δ) x = right between the points that are off their springs.

    Between its rows alone: (I + Δ T) Δ x = Δ right.
    """
    result = np.zeros_like(right)
    if acting.any():
        core = _blocks(change, T[:, acting])[acting]
        core.flat[:: len(core) + 1] += 1.0
        result[acting] = la.solve(
            core, _blocks(change, right)[acting], overwrite_a=True, check_finite=False
        )
    return result


def _solved(local: LocalContact, K: Matrix, right: Vector) -> Vector:
    """Solve (I + T Δ) x = right (components n_point,)."""
    _, rows, change, acting = _changed(local, K)
    T = local.compliance[rows]
    resisted = _resisted(T[:, rows], change, acting, right[rows, None])
    return np.asarray(right - resisted[:, 0] @ T)


def _otherwise(
    local: LocalContact, previous: Vector, ahead: Vector, excess: Vector, slip: Matrix
) -> PathStep:
    """Return where an increment leads by the solver of all paths, between the pairs."""
    solver, k = local.released.increments, local.components
    S, whole = np.asarray(local.released.compliance), local.whole
    forces = whole.forces[:, local.points].copy()
    y = local.moved(previous, excess)
    w = local.rows @ (y - whole.moved[local.pairs])
    forces[:k] = local.forces + (excess - local.springs.ravel() * w).reshape(k, -1)
    unloaded = whole.moved[local.pairs] - S @ (local.rows.T @ local.forces.ravel())

    def target(restrained: Vector) -> Vector:
        return np.asarray(unloaded + restrained + S @ (local.block @ restrained))

    start = PathStep(
        relative=target(previous),
        increment=Increment(
            forces=forces, slack=np.zeros_like(forces), moved=y, iterations=0, residual=0.0
        ),
        slip=local.slip + slip,
    )
    return next(follow(solver, target(ahead)[None], start))


Excess = Sequence[tuple[Indices, Matrix]]
"""Of each increment, rows of μ (n_active,) that change with unknowns, and how (n_active, x)."""


def local_derivatives(
    local: LocalContact, path: LocalPath, shapes: Matrix, columns: Matrix
) -> Excess:
    """Return how forces beside those of springs change with unknowns along a path.

    Exact along it but for single precision. Shapes (components n_point, n_column) [length] are what
    the load columns move the points with all stuck; columns (N, n_column, x) the derivatives of
    their factors, the same in every period of N increments.
    """
    (k, m), N, count = local.springs.shape, len(columns), columns.shape[2]
    single = local.compliance.astype(np.float32)
    s = np.zeros((k, m, count))
    excess = list[tuple[Indices, Matrix]]()
    slip, rubs = np.zeros((2, m)), local.contact.coefficients > 0
    slid = np.zeros(m, dtype=bool)
    for number, w in enumerate(path.moved):
        anchor = local.at_rest.copy()
        anchor[1:] -= slip[: k - 1]
        K = local.laws.respond(anchor + w.reshape(k, m))[1]
        points, rows, change, acting = _changed(local, K)
        # Where points slid before, or are off their springs, μ changes: by K s − Δ w.
        active = slid.copy()
        active[points] = True
        chosen = np.flatnonzero(active)
        every = (m * np.arange(k)[:, None] + chosen).ravel()
        pulled = _blocks(K[chosen], s[:, chosen].reshape(k * len(chosen), count))
        along = shapes[rows] @ columns[number % N]
        along += single[np.ix_(rows, every)] @ pulled.astype(np.float32)
        T = local.compliance[np.ix_(rows, rows)]
        resisted = _resisted(T, change, acting, along)
        pulled[np.isin(every, rows)] -= resisted
        excess.append((every, pulled))
        if k > 1 and len(points):
            inner = along - T[:, acting] @ resisted[acting]
            yields = local.laws.closure(_whole(path.forces[number]))[1][1:, points, None]
            relative = inner.reshape(k, len(points), count)
            answered = -_blocks(K[points], (relative - s[:, points]).reshape(len(rows), count))
            part = answered.reshape(k, len(points), count)[1:]
            s[1:, points] = relative[1:] + yields * part
            s[1:, ~rubs] = 0.0
            slid[points] = rubs[points]
        slip = path.slipped[number]
    return excess


def moved_by(local: LocalContact, linear: Matrix, excess: Excess, change: Vector) -> Matrix:
    """Return how far points move (n_increment, components n_point) as unknowns change (x,).

    Linear displacements [length] are with all of them stuck.
    """
    forces = np.zeros_like(linear)
    for row, (rows, per_unknown) in zip(forces, excess, strict=True):
        row[rows] = per_unknown @ change
    return np.asarray(linear + forces @ local.compliance)


def _whole(forces: Matrix) -> Matrix:
    """Return forces with all three components."""
    return np.concatenate([forces, np.zeros((3 - len(forces), forces.shape[1]))])
