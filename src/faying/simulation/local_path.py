"""Load paths of points that may leave their springs, with all others stuck; and derivatives.

With displacements w = G δ at the points (G from the pairs, or the identity where points are fewer),
w₀ those due to loads with all points stuck, T₀ the compliance between them, and g = Gᵀ μ the forces
of the points beyond their springs B (F10), an increment is

    w = w₀ + G T₀ g,   g = Gᵀ (λ(z₀ + w − s) − λ₀ + B w),                                   (F12)

with the slip s since the joint was at rest. This is (F8) for a structure with the stiffness T₀⁻¹
and the forces of points beyond their springs. The steps dg of :mod:`~faying.contact.newton_descent`
take solutions with I + A T₀, A = Gᵀ Δ G, Δ = K − B, of which only the nonzero rows a of A matter,
those of points that slip or are open. For the residual ρ of g

    x_a = (I + A_a T_a)⁻¹ (ρ_a − A_a T_o ρ_o),  x_o = ρ_o.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.contact.held_pairs import change_from, symmetric_product
from faying.contact.newton_descent import State, descend
from faying.contact.pair_factors import LU
from faying.contact.point_springs import PointSprings
from faying.contact.stuck_points import LocalContact

SOLVED = 1e-11
"""Residual at which an increment is solved, over the largest force at rest, or over that of the
springs along the path if smaller: 3e-13 of the residual of a motion is left, and a hundredth of it
took a quarter more steps."""

NEGLIGIBLE = 1e-4
"""Remaining forces over the largest one whose effect on other points a step may neglect."""

FAST_CONVERGENCE = 0.2
"""Largest relative residual of a step's system with earlier factors."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LocalPath:
    """Displacements and forces of the points after each increment.

    Attributes
    ----------
    moved : (n_increment, components n_point) [length]
        w.
    forces : (n_increment, components, n_point)
        λ.
    slipped : (n_increment, 2, n_point) [length]
        s.
    slack : (n_increment, 2, n_point) [length]
        Slip in each increment.
    dissipation : (n_increment,) [force·length]
    factors : (n_increment,)
        Factors with which the increments were solved.
    """

    moved: Matrix
    forces: Matrix
    slipped: Matrix
    slack: Matrix
    dissipation: Vector
    factors: "tuple[OffSprings | None, ...]" = ()

    def excess(self, local: LocalContact) -> Matrix:
        """Return μ (components n_point, n_increment)."""
        n = len(self.moved)
        change = (self.forces - local.forces).reshape(n, -1) + local.springs.ravel() * self.moved
        return np.asarray(change.T)


def follow_local(
    local: LocalContact,
    linear: Matrix,
    period: int,
    guesses: Sequence[Matrix] = (),
    kept: "Sequence[OffSprings | None]" = (),
) -> LocalPath:
    """Return the path of the points under a sequence of loads.

    Linear displacements w₀ are (n_increment, components n_point) [length]. Guesses are μ
    (n_increment, components n_point), to begin the first ``period`` increments with, or what they
    add to the increment before; those after them add to what came a period before or in the
    increment before. Factors kept from another path serve as long as they make steps converge.

    Raises
    ------
    ConvergenceError
        If an increment is not solved.
    """
    n, (k, m) = len(linear), local.springs.shape
    moved, forces = np.zeros((n, k * m)), np.zeros((n, k, m))
    slipped, slack = np.zeros((n, 2, m)), np.zeros((n, 2, m))
    dissipation, factors = np.zeros(n), list[OffSprings | None]()
    felt, pairs = local.shares.transposed, _Coordinates(local)
    excess, slip = np.zeros(felt.shape[0]), np.zeros((2, m))
    begun, springs = [guess @ felt.T for guess in guesses], local.springs.ravel()
    solved = np.zeros((n, felt.shape[0]))
    off: OffSprings | None = None
    rest, sprung = (np.abs(part).max(initial=0.0) for part in (local.forces, linear * springs))
    enough = SOLVED * float(min(sprung / max(rest, np.finfo(float).tiny), 1.0))
    for number in range(n):
        before = number - period
        if before >= 0:
            # Periods are alike, except for their guesses.
            starts = [solved[before] + guess[number] - guess[before] for guess in begun]
            starts, off = starts or [solved[before]], factors[before] or off
        else:
            starts = [guess[number] for guess in begun] or [excess]
            off = (kept[number] if kept else None) or off
        if number:
            starts += [excess + guess[number] - guess[number - 1] for guess in begun]
        anchor = local.at_rest.copy()
        anchor[1:] -= slip[: k - 1]
        laws = _BesideSprings(local, anchor)
        begins = (pairs.state(laws, linear[number], start) for start in starts)
        state = min(begins, key=lambda state: state.left)
        state, _, off = descend(laws, pairs, state, factors=off, solved=enough)
        factors.append(off)
        moved[number], excess = (state.z - anchor).ravel(), state.p
        forces[number], solved[number] = local.laws.respond(state.z)[0], excess
        if k > 1:
            slack[number] = (state.z + local.laws.yielded(forces[number]))[1:]
            dissipation[number] = -(forces[number][1:] * slack[number]).sum()
        slip = slip + slack[number]
        slipped[number] = slip
    return LocalPath(
        moved=moved,
        forces=forces,
        slipped=slipped,
        slack=slack,
        dissipation=dissipation,
        factors=tuple(factors),
    )


@dataclass(frozen=True, eq=False)
class _BesideSprings:
    """Forces of points beyond their springs, from an anchor (components, n_point) on."""

    local: LocalContact
    anchor: Matrix

    def respond(self, moved: Matrix) -> tuple[Matrix, Matrix]:
        """Return λ − λ₀ + B w, and K."""
        forces, K = self.local.laws.respond(moved)
        return forces - self.local.forces + self.local.springs * (moved - self.anchor), K


@dataclass(frozen=True, eq=False)
class _Coordinates:
    """The structure between the coordinates, with the springs of the points."""

    local: LocalContact

    @property
    def points(self) -> PointSprings:
        """G."""
        return self.local.shares

    def state(self, laws: _BesideSprings, linear: Vector, excess: Vector) -> State:
        """Return the state of Newton's method for some g (n_coordinate,)."""
        y = symmetric_product(self.local.compliance, excess)
        z = laws.anchor + (linear + self.points.G @ y).reshape(laws.anchor.shape)
        least = float(np.abs(self.local.forces).max(initial=np.finfo(float).tiny))
        return State(y, excess, z, *laws.respond(z), self.points.transposed, least)

    def step(
        self, K: Matrix, right: Vector, _: float, factors: "OffSprings | None" = None
    ) -> tuple[Vector, Vector, "OffSprings"]:
        """Return T₀ dg, dg, and the factors; earlier ones where these leave little."""
        springs = self.local.springs
        if factors is not None:
            dg = factors.step(self.local, right)
            d = symmetric_product(self.local.compliance, dg)
            along = (self.points.G @ d).reshape(springs.shape)
            answered = (K @ along.T[:, :, None])[:, :, 0].T - springs * along
            left = right - dg - self.points.transposed @ answered.ravel()
            if np.linalg.norm(left) <= FAST_CONVERGENCE * np.linalg.norm(right):
                return d, dg, factors
        factors = OffSprings.of(self.local, change_from(springs, K), self.local.for_steps)
        dg = factors.step(self.local, right)
        return symmetric_product(self.local.compliance, dg), dg, factors


@dataclass(frozen=True, eq=False, kw_only=True)
class OffSprings:
    """The stiffness of points off their springs, between the coordinates, and its factors.

    Attributes
    ----------
    acting : (n_acting,)
        a; slip does not change the forces along normals.
    block : (n_acting, n_coordinate)
        A_a.
    lu
        Of I + A_a T_a.
    """

    acting: Indices
    block: SparseMatrix
    lu: LU | None

    @classmethod
    def of(cls, local: LocalContact, change: Matrix, T: npt.NDArray[Any]) -> "OffSprings":
        """Return the stiffness off the springs for Δ (n_point, components, components)."""
        acting, _ = local.shares.touched(change)
        block = local.shares.between_pairs(change)[acting]
        block.data = block.data.astype(T.dtype)
        lu = None
        if len(acting):
            core = block @ T.take(acting, axis=1)
            core.flat[:: len(core) + 1] += 1.0
            lu = LU.of(core)
        return cls(acting=acting, block=block, lu=lu)

    def step(self, local: LocalContact, left: Vector) -> Vector:
        """Return (I + A T)⁻¹ times residual forces (n_coordinate,)."""
        result = left.copy()
        if self.lu is None:
            return result
        right = left[self.acting]
        result[self.acting] = 0.0
        if np.abs(result).max() > NEGLIGIBLE * np.abs(left).max():
            T = local.for_steps
            right = right - self.block @ symmetric_product(T, result.astype(T.dtype))
        result[self.acting] = self.lu.solve(right)
        return result

    def moved(self, T: npt.NDArray[Any], left: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return T (I + A T)⁻¹ times residual forces (n_coordinate, x), which are overwritten."""
        if self.lu is None:
            return _moved(T, left)
        right = left[self.acting]
        left[self.acting] = 0.0
        left[self.acting] = self.lu.solve(right - self.block @ _moved(T, left))
        return _moved(T, left)


def by_component(blocks: Matrix, chosen: Mask | slice = slice(None)) -> SparseMatrix:
    """Return chosen rows of the sparse matrix with blocks (n, components, components) at points."""
    n, k, _ = blocks.shape
    columns = np.tile(n * np.arange(k) + np.arange(n)[:, None], (k, 1))[chosen]
    values = blocks.transpose(1, 0, 2).reshape(k * n, k)[chosen]
    starts = np.arange(0, k * len(values) + 1, k)
    return sp.csr_array((values.ravel(), columns.ravel(), starts), shape=(len(values), k * n))


Excess = Sequence[tuple[Indices, Matrix]]
"""For each increment, rows of μ (n_active,) that depend on unknowns, and slopes (n_active, x)."""


def local_derivatives(
    local: LocalContact, path: LocalPath, shapes: Matrix, columns: Matrix
) -> Excess:
    """Return derivatives of forces beyond the springs by the unknowns, along a path.

    They are exact but for T in the precision of steps. ``shapes`` (components n_point, n_column)
    [length] are displacements of the points per load column with all stuck. ``columns`` (N,
    n_column, x) are derivatives of the column factors, the same in every period of N increments.
    """
    (k, m), N, count = local.springs.shape, len(columns), columns.shape[2]
    s = np.zeros((k, m, count))
    excess = list[tuple[Indices, Matrix]]()
    slip, rubs = np.zeros((2, m)), local.contact.coefficients > 0
    slid, T = np.zeros(m, dtype=bool), local.for_steps
    G = local.shares.G
    for number, w in enumerate(path.moved):
        anchor = local.at_rest.copy()
        anchor[1:] -= slip[: k - 1]
        K = local.laws.respond(anchor + w.reshape(k, m))[1]
        change = change_from(local.springs, K)
        # Open points move with the motion, also those that were open at rest.
        points = np.flatnonzero(change.any(axis=(1, 2)) | ~K.any(axis=(1, 2)))
        off = OffSprings.of(local, change, T)
        # μ changes by K s − Δ w where points slid before, or are off their springs.
        active = slid.copy()
        active[points] = True
        chosen = np.flatnonzero(active)
        every = (m * np.arange(k)[:, None] + chosen).ravel()
        at, changed = G[every], by_component(change[chosen])
        pulled = by_component(K[chosen]) @ s[:, chosen].reshape(len(every), count)
        along = shapes[every] @ columns[number % N]
        forced = off.moved(T, (at.T @ (pulled - changed @ along)).astype(T.dtype))
        along += at @ forced
        excess.append((every, pulled - changed @ along))
        if k > 1 and len(points):
            forces = np.pad(path.forces[number], ((0, 3 - k), (0, 0)))
            yields = local.laws.closure(forces)[1][1:, points, None]
            relative = along.reshape(k, len(chosen), count)[:, np.searchsorted(chosen, points)]
            stretched = (relative - s[:, points]).reshape(k * len(points), count)
            answered = -(by_component(K[points]) @ stretched)
            part = answered.reshape(k, len(points), count)[1:]
            s[1:, points] = relative[1:] + yields * part
            s[1:, ~rubs] = 0.0
            slid[points] = rubs[points]
        slip = path.slipped[number]
    return excess


def _moved(T: npt.NDArray[Any], forces: Matrix) -> npt.NDArray[Any]:
    """Return T times forces (n_coordinate, x), many of whose rows vanish."""
    rows = np.flatnonzero(forces.any(axis=1))
    return np.asarray(T[rows].T @ forces[rows])


def changed_by(path: LocalPath, local: LocalContact, excess: Excess, change: Vector) -> Matrix:
    """Return μ of a path (n_increment, components n_point) after a change of the unknowns (x,)."""
    forces = path.excess(local).T.copy()
    for row, (rows, per_unknown) in zip(forces, excess, strict=True):
        row[rows] += per_unknown @ change
    return forces
