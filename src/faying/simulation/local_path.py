"""Paths of points that may leave their springs, all others being stuck; and their derivatives.

With w = G_c δ at the points, w₀ what loads move there with all points stuck, T = G_c T₀ G_cᵀ and
the forces μ that the points exert beside their springs B (F10), an increment is

    w = w₀ + T μ,   μ = λ(z₀ + w − s) − λ₀ + B w,                                           (F12)

with the slip s since the joint was at rest. Newton's method for μ has I + Δ T to solve with,
Δ = K − B, in which only the rows a of Δ take part that do not vanish, of points that slip or are
open. Of forces ρ that the law leaves, and of displacements b, these make

    x_a = (I + Δ_a T_·a)⁻¹ (ρ_a − Δ_a T_·o ρ_o),  x_o = ρ_o,  and  f = (I + Δ_a T_·a)⁻¹ Δ_a b.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, final

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.contact.held_pairs import change_from, symmetric_product
from faying.contact.pair_factors import LU
from faying.contact.stuck_points import LocalContact

SOLVED = 1e-13
"""Residual over the largest displacement at which an increment is solved."""

MOST_STEPS = 20
"""Newton steps of (F12); 1 to 5 are usual. What takes more goes the way of other paths."""

WHOLE_STEPS, LEAST_PART = 5, 1 / 8
"""Steps that are taken whole, after which those are halved that leave as much, down to a part: what
has points stick and slip by turns ends there."""

NEGLIGIBLE = 1e-4
"""Forces that are left, over the largest, whose motion elsewhere a step may forget."""

FAST_CONVERGENCE = 0.2
"""What a step may leave of the residual, over itself, for its factors to serve once more."""


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
    guess: Matrix | None = None,
) -> LocalPath:
    """Follow the points along a path of loads.

    Linear displacements w₀ are (n_increment, components n_point) [length]; with all points stuck
    the loads move the pairs by ``restrained`` (n_increment, n_touched) [length]. A guess is μ
    (n_increment, components n_point) of increments to begin with.

    Raises
    ------
    ConvergenceError
        If an increment is not solved.
    """
    n, (k, m) = len(linear), local.springs.shape
    moved, forces = np.zeros((n, k * m)), np.zeros((n, k, m))
    slipped, slack = np.zeros((n, 2, m)), np.zeros((n, 2, m))
    dissipation = np.zeros(n)
    excess, slip = np.zeros(k * m), np.zeros((2, m))
    off: OffSprings | None = None
    for number in range(n):
        starts = [excess] if guess is None else [guess[number], excess]
        solution = _increment(local, linear[number], slip, starts, off)
        if solution is None:
            solution = *_otherwise(local, restrained[number], slip), off
        w, forces[number], slack[number], off = solution
        excess = (forces[number] - local.forces).ravel() + local.springs.ravel() * w
        if k > 1:
            dissipation[number] = -(forces[number][1:] * slack[number]).sum()
        slip = slip + slack[number]
        moved[number], slipped[number] = w, slip
    return LocalPath(
        moved=moved, forces=forces, slipped=slipped, slack=slack, dissipation=dissipation
    )


def _increment(
    local: LocalContact,
    linear: Vector,
    slip: Matrix,
    starts: Sequence[Vector],
    off: "OffSprings | None",
) -> tuple[Vector, Matrix, Matrix, "OffSprings | None"] | None:
    """Return w, λ, slip and factors of an increment by Newton's steps; None where they go astray.

    It begins with the start μ that leaves the smallest residual, and with the factors of the
    increment before: what slipped slips on. Where points stick and slip by turns, steps are halved.
    """
    springs, (k, m) = local.springs.ravel(), local.springs.shape
    anchor = local.at_rest.copy()
    anchor[1:] -= slip[: k - 1]

    def reached(excess: Vector) -> _Reached:
        w = linear + symmetric_product(local.compliance, excess)
        z = anchor + w.reshape(k, m)
        forces, K = local.laws.respond(z)
        left = (forces - local.forces).ravel() + springs * w - excess
        size = float(np.abs(left * local.give).max(initial=0.0))
        return _Reached(excess, w, z, forces, K, left, size)

    state = min((reached(start) for start in starts), key=lambda state: state.size)
    size = max(float(np.abs(linear).max(initial=0.0)), float(np.abs(state.w).max(initial=0.0)))
    last = np.inf
    for count in range(MOST_STEPS):
        if not np.isfinite(state.size):
            return None
        if state.size <= SOLVED * size or last / 2 <= state.size <= 1e2 * SOLVED * size:
            slack = (state.z + local.laws.yielded(state.forces))[1:]
            return state.w, state.forces, slack if k > 1 else np.zeros((2, m)), off
        anew = off is None or state.size > FAST_CONVERGENCE * last
        if anew or off is None:
            off = OffSprings.of(local, state.K, local.for_steps)
        last, step = state.size, off.step(local, state.left)
        trial, part = reached(state.excess + step), 1.0
        while anew and count >= WHOLE_STEPS and not trial.size < last and part > LEAST_PART:
            part /= 2
            trial = reached(state.excess + part * step)
        if anew or trial.size < last:
            state = trial
        size = max(size, float(np.abs(state.w).max(initial=0.0)))
    return None


class _Reached(NamedTuple):
    """Where steps are: μ, w, displacements from the slip, λ, K, what λ leaves of μ, its size."""

    excess: Vector
    w: Vector
    z: Matrix
    forces: Matrix
    K: Matrix
    left: Vector
    size: float


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class OffSprings:
    """Points off their springs, and the factors between their rows.

    Attributes
    ----------
    points : (n_off,)
    rows : (components n_off,)
        Of these points, component by component.
    acting : (n_acting,)
        a: slip leaves the row of the normal force as it is.
    change : (n_acting, components n_off)
        Δ_a.
    lu
        Of I + Δ_a T_·a.
    """

    points: Indices
    rows: Indices
    acting: Indices
    change: SparseMatrix
    lu: LU | None

    @classmethod
    def of(cls, local: LocalContact, K: Matrix, T: npt.NDArray[Any]) -> "OffSprings":
        """Return them for K (n_point, components, components), in the precision of T."""
        k, m = local.springs.shape
        change = change_from(local.springs, K)
        # What is open goes with the motion, also where it was open at rest.
        points = np.flatnonzero(change.any(axis=(1, 2)) | ~K.any(axis=(1, 2)))
        rows = (m * np.arange(k)[:, None] + points).ravel()
        acts = change[points].any(axis=2).T.ravel()
        acting = rows[acts]
        block = by_component(change[points].astype(T.dtype), acts)
        lu = None
        if len(acting):
            core = block @ T[np.ix_(rows, acting)]
            core.flat[:: len(core) + 1] += 1.0
            lu = LU.of(core)
        return cls(points=points, rows=rows, acting=acting, change=block, lu=lu)

    def step(self, local: LocalContact, left: Vector) -> Vector:
        """Return what (I + Δ T)⁻¹ makes of forces that are left (components n_point,)."""
        result = left.copy()
        if self.lu is None:
            return result
        result[self.acting] = 0.0
        others = np.flatnonzero(np.abs(result) > NEGLIGIBLE * np.abs(left).max())
        T = local.for_steps
        moved = T[np.ix_(self.rows, others)] @ result[others].astype(T.dtype)
        result[self.acting] = self.lu.solve(left[self.acting] - self.change @ moved)
        return result

    def resisted(self, right: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return f (n_acting, …) of b at the rows."""
        felt = self.change @ right
        return felt if self.lu is None else self.lu.solve(felt)


def by_component(blocks: Matrix, chosen: Mask | slice = slice(None)) -> SparseMatrix:
    """Return rows of the matrix with blocks (n, components, components) at points."""
    n, k, _ = blocks.shape
    columns = np.tile(n * np.arange(k) + np.arange(n)[:, None], (k, 1))[chosen]
    values = blocks.transpose(1, 0, 2).reshape(k * n, k)[chosen]
    starts = np.arange(0, k * len(values) + 1, k)
    return sp.csr_array((values.ravel(), columns.ravel(), starts), shape=(len(values), k * n))


def _otherwise(
    local: LocalContact, restrained: Vector, slip: Matrix
) -> tuple[Vector, Matrix, Matrix]:
    """Return w, λ and the slip of an increment by the solver of all paths, between the pairs."""
    at_rest, released = local.whole.moved[local.pairs], local.released
    pressed = local.block @ restrained - local.rows.T @ local.forces.ravel()
    free = at_rest + restrained + np.asarray(released.compliance) @ pressed
    solved = released.increments.solve(free, local.contact.offset(local.slip + slip))
    w = np.asarray(local.rows @ (solved.moved - at_rest))
    return w, solved.forces[: local.components], solved.slack[1:]


Excess = Sequence[tuple[Indices, Matrix]]
"""Of each increment, rows of μ (n_active,) that change with unknowns, and how (n_active, x)."""


def local_derivatives(
    local: LocalContact, path: LocalPath, shapes: Matrix, columns: Matrix
) -> Excess:
    """Return how forces beside those of springs change with unknowns along a path.

    Exact along it but for T in the precision of steps. Shapes (components n_point, n_column)
    [length] are what the load columns move the points with all stuck; columns (N, n_column, x) the
    derivatives of their factors, the same in every period of N increments.
    """
    (k, m), N, count = local.springs.shape, len(columns), columns.shape[2]
    s = np.zeros((k, m, count))
    excess = list[tuple[Indices, Matrix]]()
    slip, rubs = np.zeros((2, m)), local.contact.coefficients > 0
    slid = np.zeros(m, dtype=bool)
    for number, w in enumerate(path.moved):
        anchor = local.at_rest.copy()
        anchor[1:] -= slip[: k - 1]
        K = local.laws.respond(anchor + w.reshape(k, m))[1]
        off = OffSprings.of(local, K, local.compliance)
        points, rows = off.points, off.rows
        # Where points slid before, or are off their springs, μ changes: by K s − Δ w.
        active = slid.copy()
        active[points] = True
        chosen = np.flatnonzero(active)
        every = (m * np.arange(k)[:, None] + chosen).ravel()
        pulled = by_component(K[chosen]) @ s[:, chosen].reshape(len(every), count)
        between = local.for_steps[np.ix_(rows, every)]
        along = shapes[rows] @ columns[number % N] + between @ pulled.astype(between.dtype)
        resisted, acting = off.resisted(along), np.searchsorted(every, off.acting)
        pulled[acting] -= resisted
        excess.append((every, pulled))
        if k > 1 and len(points):
            inner = along - between[:, acting] @ resisted.astype(between.dtype)
            forces = np.pad(path.forces[number], ((0, 3 - k), (0, 0)))
            yields = local.laws.closure(forces)[1][1:, points, None]
            relative = inner.reshape(k, len(points), count)
            stretched = (relative - s[:, points]).reshape(len(rows), count)
            answered = -(by_component(K[points]) @ stretched)
            part = answered.reshape(k, len(points), count)[1:]
            s[1:, points] = relative[1:] + yields * part
            s[1:, ~rubs] = 0.0
            slid[points] = rubs[points]
        slip = path.slipped[number]
    return excess


def changed_by(path: LocalPath, local: LocalContact, excess: Excess, change: Vector) -> Matrix:
    """Return μ of a path (n_increment, components n_point) as unknowns change (x,)."""
    forces = path.excess(local).T.copy()
    for row, (rows, per_unknown) in zip(forces, excess, strict=True):
        row[rows] += per_unknown @ change
    return forces
