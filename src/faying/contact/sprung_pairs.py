"""The pairs of an interface on the penalty springs of its closed points, and of similar sets.

Forces r between the pairs are those of the springs that touch them, so with the springs
B = N_Aᵀ D_A⁻¹ N_A of the closed points A the pairs move, relative to the free gap, by

    y = −E N_Aᵀ D_A⁻¹ g_A,   E = (S⁻¹ + B)⁻¹,   λ_A = −D_A⁻¹ (g_A + N_A y).

From one linear system to the next few points change sides. What the changed springs add is a force
μ at each of them, with their rows V of N, and + where a point has closed, − where it has opened:

    y = y₀ + E Vᵀ μ,   (±D + V E Vᵀ) μ = −(g + V y₀).

A system costs one product with E instead of a factorization, and one with S that proves it.
"""

import numpy as np
import scipy.linalg as la
from scipy.linalg import blas, lapack

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.contact.padded_rows import PaddedRows
from faying.contact.pivoting import ROUND_OFF, ContactForces, largest

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


class SprungPairs:
    """E of one set of closed points, renewed when another set is too far from it.

    What it returns depends on the closed points alone, up to round-off; what it remembers only
    decides how fast.

    Parameters
    ----------
    N : (n_point, n_pair) sparse
    S : (n_pair, n_pair) [length/force]
        Symmetric positive definite.
    D : (n_point,) [length/force]
        Positive.
    own : (n_point,) [length/force]
        Diagonal of H.

    Raises
    ------
    scipy.linalg.LinAlgError
        If S is too near to a singular matrix.
    """

    def __init__(self, *, N: SparseMatrix, S: Matrix, D: Vector, own: Vector) -> None:
        self._rows = PaddedRows.of(N)
        self._N, self._NT = N.tocsr(), N.T.tocsr()
        self._S, self._D, self._own = np.array(S, order="F"), np.array(D), np.array(own)
        factor, failed = lapack.dpotrf(S.T, lower=1)
        pivots = np.diag(factor)
        if failed or pivots.min() < WELL_CONDITIONED * pivots.max():
            message = "singular compliance between pairs"
            raise la.LinAlgError(message)
        self._stiffness = _inverse(factor)
        self._inside: Mask = np.zeros(len(D), dtype=bool)
        self._E = self._S
        self._forget()

    def near(self, active: Mask) -> bool:
        """Say whether few enough points have changed sides since E was made."""
        return bool(np.count_nonzero(active ^ self._inside) <= NEAR * len(self._S))

    def renew(self, active: Mask) -> None:
        """Form E of these closed points; n³ operations for n pairs."""
        rows = self._N[active.nonzero()[0]]
        springs = rows.T @ (rows / self._D[active][:, None])
        held = self._stiffness + springs.toarray()
        factor, failed = lapack.dpotrf(held.T, lower=1, overwrite_a=1)
        if failed:
            message = "singular active block"
            raise la.LinAlgError(message)
        self._E, self._inside = _inverse(factor), active.copy()
        self._forget()

    def arrays(self) -> dict[str, Matrix | Mask | Indices]:
        """Return what a compiled solver needs, row by row."""
        return {
            "E": self._E.T,
            "S": self._S.T,
            "inside": self._inside,
            "columns": self._rows.columns,
            "values": self._rows.values,
            "D": self._D,
            "own": self._own,
        }

    def solve(self, g_free: Vector, active: Mask) -> ContactForces | None:
        """Solve the contact problem from a guess of the closed points.

        None where points change sides in large numbers again and again.

        Raises
        ------
        InaccurateError
            If the forces cannot be made exact with this E.
        """
        D, noise = self._D, ROUND_OFF * largest(g_free)
        loose, systems, renewals = LOOSE * largest(g_free), 0, 0
        alone = self._alone(g_free)
        while systems < MOST_SYSTEMS:
            systems += 1
            changed = (active ^ self._inside).nonzero()[0]
            if len(changed) > MOST_CHANGED * len(self._S):
                if renewals == MOST_RENEWALS:
                    return None
                self.renew(active)
                alone, changed, renewals = self._alone(g_free), changed[:0], renewals + 1
            gap = g_free + self._N @ self._with_changed(alone, g_free, changed, active)
            wrong = np.where(active, gap > loose, gap < -loose)
            if not wrong.any():
                pressed = np.where(active, -gap / D, 0.0)
                forces, slack = self._refined(pressed, g_free, changed, active)
                wrong = np.where(active, forces * self._own < -noise, slack < -noise)
                if not wrong.any():
                    slack[active] = 0.0
                    return ContactForces(
                        forces=np.maximum(forces, 0.0),
                        slack=np.maximum(slack, 0.0),
                        active=active,
                        iterations=systems,
                    )
            active = active ^ wrong
        return None

    def _refined(
        self, forces: Vector, g_free: Vector, changed: Indices, active: Mask
    ) -> tuple[Vector, Vector]:
        """Close what S says is still open.

        What one correction leaves is in proportion to what it corrects as that is to all.
        """
        left = 1.0
        for _ in range(MOST_REFINEMENTS):
            slack = self._product(forces) + g_free
            missing = largest(np.where(active, slack / self._D, 0.0))
            before, left = left, missing / max(largest(forces), missing, TINY)
            if left <= CLOSED:
                return forces, slack
            moved = self._N @ self._with_changed(self._alone(slack), slack, changed, active)
            change = np.where(active, -(slack + moved) / self._D, 0.0)
            forces = forces + change
            if left**2 / before <= CLOSED:
                return forces, slack + moved
        raise InaccurateError

    def _product(self, forces: Vector) -> Vector:
        """Return H λ."""
        moved = blas.dsymv(1.0, self._S, self._NT @ forces, lower=1)
        result: Vector = self._N @ moved + self._D * forces
        return result

    def _alone(self, gap: Vector) -> Vector:
        """Return y for gaps without contact forces, with the springs that E was made with."""
        pressed = np.where(self._inside, -gap / self._D, 0.0)
        moved: Vector = blas.dsymv(1.0, self._E, self._NT @ pressed, lower=1)
        return moved

    def _with_changed(self, alone: Vector, gap: Vector, changed: Indices, active: Mask) -> Vector:
        """Return y with the springs of the points that are closed now."""
        if not len(changed):
            return alone
        slots = self._slots(changed)
        core = self._corner[slots[:, None], slots]
        own = self._D[changed]
        core.flat[:: len(changed) + 1] += np.where(active[changed], own, -own)
        missing = gap[changed] + self._rows.product(changed, alone)
        forces = lapack.dgesv(core, -missing)[2]
        present = np.zeros(len(self._known))
        present[slots] = forces
        result: Vector = alone + present @ self._seen[: len(self._known)]
        return result

    def _forget(self) -> None:
        room = 2 * (int(MOST_CHANGED * len(self._S)) + 1)
        self._known: Indices = np.empty(0, dtype=np.int64)
        self._slot = np.full(len(self._D), -1)
        self._seen = np.empty((room, len(self._S)))
        self._corner = np.empty((room, room))

    def _slots(self, changed: Indices) -> Indices:
        """Return the places of changed points among those whose rows V E are known."""
        slots = self._slot[changed]
        if slots.min() >= 0:
            return slots
        new = changed[slots < 0]
        if len(self._known) + len(new) > len(self._seen):
            self._forget()
            new = changed
        start, end = len(self._known), len(self._known) + len(new)
        self._slot[new] = np.arange(start, end)
        self._known = np.concatenate([self._known, new])
        self._seen[start:end] = self._rows.combined(new, self._E)
        corner = self._rows.combined(self._known, self._seen[start:end].T)
        self._corner[:end, start:end] = corner
        self._corner[start:end, :end] = corner.T
        return self._slot[changed]


def _inverse(factor: Matrix) -> Matrix:
    """Return the symmetric inverse, given (and overwriting) the lower factor, zero elsewhere."""
    inverse = lapack.dpotri(factor, lower=1, overwrite_c=1)[0]
    result: Matrix = np.add(inverse, inverse.T, order="F")
    result[np.diag_indices_from(result)] /= 2
    return result
