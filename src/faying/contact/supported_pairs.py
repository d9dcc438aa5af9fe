"""Pairs supported by the penalty springs of the closed points: contact solved from a similar one.

Forces r between the pairs are those of the springs that touch them, so with the springs
B = N_Aᵀ D_A⁻¹ N_A of the closed points A the pairs move, relative to the free gap, by

    y = −E N_Aᵀ D_A⁻¹ g_A,   E = (S⁻¹ + B)⁻¹,   λ_A = −D_A⁻¹ (g_A + N_A y).

E is the compliance between the pairs while they are supported by A. From one linear system to the
next few points change sides. What the changed springs add is a force μ at each of them, with their
rows V of N, and + where a point has closed, − where it has opened:

    y = y₀ + E Vᵀ μ,   (±D + V E Vᵀ) μ = −(g + V y₀).

A system costs one product with E instead of a factorization, and one with S that proves it.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import final

import numpy as np
import scipy.linalg as la
from scipy.linalg import blas, lapack

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.contact.active_set import ROUND_OFF, largest
from faying.contact.forces import ContactForces
from faying.contact.padded_rows import PaddedRows
from faying.contact.state import ContactState

MOST_CHANGED = 0.5
"""Changed points over pairs up to which E is good for a linear system.

A new one takes n³ operations for n pairs, k changed points k³. Of 0.35 to 0.65, steps of 798 pairs
took least with 0.5, of 442 with 0.35 (15 % less), and of 148 with any.
"""

NEAR = 0.3
"""Changed points over pairs up to which a contact problem begins with the E at hand."""

MOST_RENEWALS = 3
"""New E of one contact problem."""

WELL_CONDITIONED = 1e-4
"""Smallest over largest Cholesky pivot (condition 1e8) from which S is inverted.

Lap joints have 0.1; the compliance that a basis alone gives its contact is singular.
"""

MOST_SYSTEMS = 20
"""Linear systems after which exchanges of all wrong points are taken to lead nowhere."""

LOOSE = 1e-11
"""Wrong gaps below this fraction of the largest |g_free| do not count before the refinement."""

MOST_REFINEMENTS = 3
"""Corrections of the forces; one is usual."""

TINY = np.finfo(float).tiny

CLOSED = 1e-11
"""Force that an unclosed gap stands for, over the largest one, up to which a system is solved."""


class InaccurateError(Exception):
    """Round-off, amplified by a stiff penalty, is too large for forces made this way."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class SupportedCompliance:
    """E of one set of closed points, and what it says of points that change sides.

    Attributes
    ----------
    closed : (n_point,)
        Points whose springs support the pairs.
    springs : (n_point,) [force/length]
        Stiffness of these springs, zero at the other points.
    E : (n_pair, n_pair) [length/force]
    at_points : (n_point, n_pair) [length/force]
        N E: how the pairs move under a force at each point.
    """

    closed: Mask
    springs: Vector
    E: Matrix
    at_points: Matrix


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class SupportedPairs:
    """Solver of contact problems of elastic contact from similar ones.

    Attributes
    ----------
    N : (n_point, n_pair) sparse
    S : (n_pair, n_pair) [length/force]
        Symmetric positive semidefinite.
    D : (n_point,) [length/force]
        Positive.
    own : (n_point,) [length/force]
        Diagonal of H.
    """

    N: SparseMatrix
    S: Matrix
    D: Vector
    own: Vector
    rows: PaddedRows = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "N", self.N.tocsr())
        object.__setattr__(self, "S", np.array(self.S, order="F"))
        # Compiled loops take arrays that may be written, whether or not they write them.
        object.__setattr__(self, "D", np.array(self.D))
        object.__setattr__(self, "own", np.array(self.own))
        object.__setattr__(self, "rows", PaddedRows.of(self.N))

    @cached_property
    def _springs(self) -> Vector:
        """D⁻¹ (n_point,) [force/length]."""
        return np.asarray(1.0 / self.D)

    @cached_property
    def _transposed(self) -> SparseMatrix:
        return self.N.T.tocsr()

    @cached_property
    def _stiffness(self) -> Matrix | None:
        """S⁻¹, or None where S is too near to a singular matrix."""
        factor, failed = lapack.dpotrf(self.S.T, lower=1)
        pivots = np.diag(factor)
        if failed or pivots.min() < WELL_CONDITIONED * pivots.max():
            return None
        return _inverse(factor)

    @cached_property
    def _shapes(self) -> Matrix:
        """Y (n_pair, rank) with S = Y Yᵀ, of a singular S."""
        factor, order, rank, _ = lapack.dpstrf(self.S, lower=1)
        shapes = np.zeros_like(factor)
        shapes[order - 1] = np.tril(factor)
        return np.asarray(shapes[:, :rank])

    @cached_property
    def _shapes_at_points(self) -> Matrix:
        """N Y (n_point, rank)."""
        result: Matrix = self.N @ self._shapes
        return result

    def near(self, closed: Mask, active: Mask) -> bool:
        """Say whether few enough points have changed sides for the E of a closed set."""
        return bool(np.count_nonzero(active ^ closed) <= NEAR * len(self.S))

    def supported(self, closed: Mask) -> SupportedCompliance:
        """Form E of these closed points; about n³ operations for n pairs.

        Raises
        ------
        scipy.linalg.LinAlgError
            If S is not positive semidefinite.
        """
        points = closed.nonzero()[0]
        if self._stiffness is not None:
            E = _inverse(_factor(self._stiffness + self.rows.gram(points, self._springs)))
        else:
            moved = self._shapes_at_points.take(points, axis=0)
            held = (moved.T * self._springs[points]) @ moved
            held[np.diag_indices_from(held)] += 1.0
            half = la.solve_triangular(_factor(held), self._shapes.T, lower=True)
            E = np.asarray(blas.dsyrk(1.0, half, trans=1, lower=1))
            E = np.asfortranarray(E + np.tril(E, -1).T)
        acting = np.where(closed, self._springs, 0.0)
        return SupportedCompliance(closed=closed.copy(), springs=acting, E=E, at_points=self.N @ E)

    def at_hand(self, state: ContactState) -> SupportedCompliance | None:
        """Return the E that a state comes with, formed again where it was stored as its points."""
        if state.supported is None:
            return None
        support: SupportedCompliance | None = state.factor
        return self.supported(state.supported) if support is None else support

    def arrays(self, support: SupportedCompliance) -> dict[str, Matrix | Mask | Indices]:
        """Return what a compiled solver needs, row by row."""
        return {
            "E": support.E.T,
            "S": self.S.T,
            "inside": support.closed,
            "columns": self.rows.columns,
            "values": self.rows.values,
            "D": self.D,
            "own": self.own,
        }

    def solve(
        self, g_free: Vector, active: Mask, support: SupportedCompliance
    ) -> tuple[ContactForces, ContactState] | None:
        """Solve the contact problem from a guess of the closed points and the E of similar ones.

        None where points change sides in large numbers again and again.

        Raises
        ------
        InaccurateError
            If the forces cannot be made exact with this E.
        """
        scale, systems, renewals = largest(g_free), 0, 0
        loose, noise = LOOSE * scale, ROUND_OFF * scale
        alone = self._alone(g_free, support)
        while systems < MOST_SYSTEMS:
            systems += 1
            points = (active ^ support.closed).nonzero()[0]
            if len(points) > MOST_CHANGED * len(self.S):
                if renewals == MOST_RENEWALS:
                    return None
                support, renewals, points = self.supported(active), renewals + 1, points[:0]
                alone = self._alone(g_free, support)
            changed = self._changed(points, active, support)
            gap = g_free + self.N @ changed.moved(alone, g_free)
            wrong = np.where(active, gap > loose, gap < -loose)
            if not wrong.any():
                forces, slack = self._refined(gap, g_free, changed, active, support)
                wrong = np.where(active, forces * self.own < -noise, slack < -noise)
                if not wrong.any():
                    slack[active] = 0.0
                    found = ContactForces(
                        forces=np.maximum(forces, 0.0),
                        slack=np.maximum(slack, 0.0),
                        active=active,
                        iterations=systems,
                    )
                    return found, ContactState(
                        active=active, supported=support.closed, steady=True, factor=support
                    )
            active = active ^ wrong
        return None

    def _refined(
        self,
        gap: Vector,
        g_free: Vector,
        changed: "_Changed",
        active: Mask,
        support: SupportedCompliance,
    ) -> tuple[Vector, Vector]:
        """Return the forces of the springs at these gaps, and close what S says is still open.

        What one correction leaves is in proportion to what it corrects as that is to all.
        """
        springs = np.where(active, self._springs, 0.0)
        forces, left = -springs * gap, 1.0
        for _ in range(MOST_REFINEMENTS):
            slack = self._product(forces) + g_free
            missing = largest(springs * slack)
            before, left = left, missing / max(largest(forces), missing, TINY)
            if left <= CLOSED:
                return forces, slack
            moved = self.N @ changed.moved(self._alone(slack, support), slack)
            slack += moved
            forces -= springs * slack
            if left**2 / before <= CLOSED:
                return forces, slack
        raise InaccurateError

    def _product(self, forces: Vector) -> Vector:
        """Return H λ."""
        moved = blas.dsymv(1.0, self.S, self._transposed @ forces, lower=1)
        result: Vector = self.N @ moved + self.D * forces
        return result

    def _alone(self, gap: Vector, support: SupportedCompliance) -> Vector:
        """Return y for gaps without contact forces, with the springs that E was made with."""
        pressed = self._transposed @ (support.springs * gap)
        moved: Vector = blas.dsymv(-1.0, support.E, pressed, lower=1)
        return moved

    def _changed(self, points: Indices, active: Mask, support: SupportedCompliance) -> "_Changed":
        """Factorize what the points that changed sides add to E."""
        if not len(points):
            return _Changed(points, self.rows, np.empty((0, len(self.S))), None)
        seen = support.at_points.take(points, axis=0)
        core = self.rows.combined(points, seen)
        own = self.D[points]
        core.flat[:: len(points) + 1] += np.where(active[points], own, -own)
        return _Changed(points, self.rows, seen, lapack.dgetrf(core)[:2])


@dataclass(frozen=True, eq=False)
class _Changed:
    """Points on the other side than E has them.

    Attributes
    ----------
    points : (k,)
    rows
        Rows of N.
    seen : (k, n_pair)
        V E.
    core
        Factors of ±D + V E Vᵀ; None where no point has changed.
    """

    points: Indices
    rows: PaddedRows
    seen: Matrix
    core: tuple[Matrix, Indices] | None

    def moved(self, alone: Vector, gap: Vector) -> Vector:
        """Return y with the springs of the points that are closed now."""
        if self.core is None:
            return alone
        missing = gap[self.points] + self.rows.product(self.points, alone)
        forces = lapack.dgetrs(*self.core, -missing)[0]
        result: Vector = alone + forces @ self.seen
        return result


def _factor(matrix: Matrix) -> Matrix:
    factor, failed = lapack.dpotrf(matrix.T, lower=1, overwrite_a=1)
    if failed:
        message = "singular active block"
        raise la.LinAlgError(message)
    return np.asarray(factor)


def _inverse(factor: Matrix) -> Matrix:
    """Return the symmetric inverse, given (and overwriting) the lower factor, zero elsewhere."""
    inverse = lapack.dpotri(factor, lower=1, overwrite_c=1)[0]
    result: Matrix = np.add(inverse, inverse.T, order="F")
    result[np.diag_indices_from(result)] /= 2
    return result
