"""Similar frictionless load cases side by side: a Newton step of all of them is two products.

With U = (Σ + B₀)⁻¹, where B₀ has the points closed that start closed in most cases, R of (F8), and
ΔK the springs of the points c that differ from this in some case, a step is

    (1 + U_cc ΔK) z_c = −(G U R)_c,   d = −U (R + G_cᵀ ΔK z_c),   U_cc = G_c U G_cᵀ.          (F13)
"""

from dataclasses import dataclass
from typing import TypeGuard, cast

import numpy as np
from scipy.linalg import LinAlgError, lapack

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.contact.glued_pairs import GluedPairs
from faying.contact.increment import IncrementSolver
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.newton_descent import (
    FLAT,
    LARGEST_REMAINDER,
    MOST_TRIALS,
    SMALLEST_FORCE_SHARE,
    steps_ended,
)
from faying.contact.yielding import YieldingContact
from faying.digits import SOLVED
from faying.iterations import MOST_STEPS


def side_by_side(solver: IncrementSolver, count: int) -> TypeGuard[YieldingContact]:
    """Return whether :func:`solve_similar` solves this number of cases."""
    if not isinstance(solver, YieldingContact) or solver.shapes is not None:
        return False
    if count < solver.pairs.fewest_alike:
        return False
    return solver.contact.unilateral


def solve_similar(
    solver: YieldingContact, free: Matrix, moved: Matrix
) -> tuple[Matrix, Matrix, Indices]:
    """Solve (F8) for cases with pressures proportional to closure.

    ``free`` (n_case, n_relative) [length] are displacements of the pairs without contact forces;
    ``moved`` (n_case, n_relative) are those of similar cases, to start from. Returns forces and
    gaps (n_case, n_point), and the Newton steps of each case.

    Raises
    ------
    ConvergenceError
        If a case is solved neither side by side nor alone.
    """
    whole = cast("GluedPairs", solver.pairs)
    laws, G, S, y_f = solver.laws, whole.points.G, solver.S, free.T
    initial = solver.contact.initial_gap[:, None]
    z = G @ moved.T + initial
    springs = laws.springs * (np.count_nonzero(z <= 0, axis=1) > len(free) / 2)
    try:
        pairs = whole.glued_by(springs)
    except LinAlgError:  # these points hold nothing
        springs = laws.springs
        pairs = whole.glued_by(springs)
    p, pressed = whole.structure @ (moved.T - y_f), np.zeros_like(z)
    floor = np.maximum(
        SMALLEST_FORCE_SHARE * np.abs(p).max(axis=0, initial=0.0), np.finfo(float).tiny
    )
    steps, previous = np.zeros(len(free), dtype=np.int64), np.full(len(free), np.inf)
    formed, lost = np.zeros((2, len(free)), dtype=bool)
    changed = _ChangedPoints.of(G, pairs.glued.compliance, np.empty(0, dtype=np.int64))
    going = np.arange(len(free))
    while len(going):
        pressed[:, going], K = laws.side_by_side(z[:, going])
        residual = p[:, going] - pairs.points.transposed @ pressed[:, going]
        largest = np.maximum(pressed[:, going].max(axis=0, initial=0.0), floor[going])
        left = np.abs(residual).max(axis=0, initial=0.0) / largest
        solved = left <= SOLVED
        # The displacements, sums of all steps, are formed once more by S.
        forming = solved & ~formed[going]
        ended = steps_ended(left, previous[going]) & ~forming
        stuck = ~solved & ((steps[going] >= MOST_STEPS) | ~np.isfinite(left))
        previous[going] = np.where(forming, np.inf, left)
        again = going[forming]
        p[:, again] = pairs.points.transposed @ pressed[:, again]
        z[:, again] = G @ (y_f[:, again] + S @ p[:, again]) + initial
        formed[again], lost[going[stuck]] = True, True
        walking = ~(forming | ended | stuck)
        cases, residual, K = going[walking], residual[:, walking], K[:, walking]
        if len(cases):
            changed = changed.with_all(G, K - springs.T)
            d = changed.step(residual, K - springs.T)
            along = G @ d
            resisted = -residual - pairs.points.transposed @ (K * along)
            length = _lengths(laws, z[:, cases], pressed[:, cases], along, residual, d, resisted)
            p[:, cases] += length * resisted
            z[:, cases] += length * along
            steps[cases] += 1
        going = going[~(ended | stuck)]
    for case in np.flatnonzero(lost):
        alone = solver.solve(free[case], solver.contact.offset())
        pressed[:, case], z[:, case] = alone.forces[0], alone.gap(laws)
        steps[case] += alone.iterations
    return pressed.T, z.T, steps


@dataclass(frozen=True, eq=False)
class _ChangedPoints:
    """U at the points that differ from the reference in some case.

    Attributes
    ----------
    U : (n_relative, n_relative) [length/force]
    points : (n_changed,)
        c.
    rows : (n_changed, n_relative)
        G_c.
    between : (n_changed, n_changed) [length/force]
        U_cc.
    """

    U: Matrix
    points: Indices
    rows: SparseMatrix | Matrix
    between: Matrix

    @classmethod
    def of(cls, G: SparseMatrix | Matrix, compliance: Matrix, points: Indices) -> "_ChangedPoints":
        """Return U at some points."""
        rows = G[points]
        return cls(compliance, points, rows, np.asarray(rows @ np.asarray(rows @ compliance).T))

    def with_all(self, G: SparseMatrix | Matrix, change: Matrix) -> "_ChangedPoints":
        """Return U with all points added where K changes (n_point, n_case)."""
        points = np.union1d(self.points, np.flatnonzero(change.any(axis=1)))
        return self if len(points) == len(self.points) else self.of(G, self.U, points)

    def step(self, residual: Matrix, change: Matrix) -> Matrix:
        """Return d (n_relative, n_case) of (F13) for R and ΔK."""
        d = -(self.U @ residual)
        alone, springs = self.rows @ d, change[self.points]
        opposed = np.zeros_like(springs)
        for case, spring in enumerate(springs.T):
            turned = np.flatnonzero(spring)
            system = self.between[turned].take(turned, axis=1) * spring[turned]
            system.flat[:: len(turned) + 1] += 1.0
            if len(turned):
                opposed[turned, case] = (
                    spring[turned] * lapack.dgesv(system, alone[turned, case])[2]
                )
        return np.asarray(d - self.U @ (self.rows.T @ opposed))


def _lengths(
    laws: LawsAtPoints,
    z: Matrix,
    forces: Matrix,
    along: Matrix,
    residual: Matrix,
    d: Matrix,
    resisted: Matrix,
) -> Vector:
    """Return the length of the step of each case (n_case,): whole, or where dᵀR vanishes."""
    at_first, curvature = (d * residual).sum(axis=0), (d * resisted).sum(axis=0)

    def slope(cases: Indices, length: Vector) -> Vector:
        moved = along[:, cases]
        answers = laws.side_by_side(z[:, cases] + length * moved)[0]
        left = (moved * (forces[:, cases] - answers)).sum(axis=0)
        return np.asarray(at_first[cases] + length * curvature[cases] + left)

    lengths = np.ones(len(at_first))
    above = slope(np.arange(len(lengths)), lengths)
    cases = np.flatnonzero(np.abs(above) > LARGEST_REMAINDER * np.abs(at_first))
    low, high, below, above = np.zeros(len(cases)), lengths[cases], at_first[cases], above[cases]
    for _ in range(MOST_TRIALS):
        if not len(cases):
            break
        # A chord that ends at a jump of the slope would stay there: keep away from both ends.
        chord = low - below * (high - low) / (above - below)
        middle = np.clip(chord, low + 0.1 * (high - low), high - 0.1 * (high - low))
        value, lengths[cases] = slope(cases, middle), middle
        beyond = value > 0
        high, above = np.where(beyond, (middle, value), (high, above))
        low, below = np.where(beyond, (low, below), (middle, value))
        steep = np.abs(value) > FLAT * np.abs(at_first[cases])
        cases, low, high, below, above = (part[steep] for part in (cases, low, high, below, above))
    return lengths
