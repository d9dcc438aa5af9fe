"""Increments of frictional contact: a semismooth Newton method on forces, exact at any penalty.

With x = (λ_n, λ_t) at the points, y the relative displacement that contact forces make, the slack
z = y + D x + z_free (z_free holds the gap, the loads and minus the slip so far) and any r > 0, an
increment solves F(x) = 0 (Alart & Curnier 1991, doi:10.1016/0045-7825(91)90022-X):

    F_n = λ_n − ⟨λ_n − r_n z_n⟩,  F_t = λ_t − proj_{|·| ≤ μ ⟨λ_n − r_n z_n⟩} (λ_t − r_t z_t),  (F1)

and z_t is then the slip of the increment. A Newton step is linear in x and local but for y:

    A x + E y = c at every closed point, x = 0 at every open one,                              (F2)

with unsymmetric blocks A, E of three rows. Where the law yields everywhere, A can be inverted point
by point, and with y = G S Gᵀ x the step is a system between the pairs that are touched,

    (I + B S) r = Gᵀ A⁻¹ c,   B = Gᵀ A⁻¹ E G,   x = A⁻¹ (c − E G S r);                         (F3)

otherwise it is solved between closed points. Without friction this is the primal-dual active set.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.contact.contact import Contact
from faying.exceptions import ConvergenceError

ROUND_OFF = 1e-13
"""Natural residual over the largest force at which an increment is solved."""

SOLVED = 1e-9
"""Natural residual over the largest force that is accepted where round-off allows no less."""

MOST_STEPS = 60
"""Newton steps of an increment; 5 to 20 are usual from the increment before."""

MOST_HALVINGS = 12
"""Halvings of a Newton step."""

WATCHED = 5
"""Steps among which the residual must fall where it cannot fall in every one.

A residual that may rise between takes twice the steps in easy increments (42 for 17 at μ = 0.3 and
c_n = 1e6 N/mm³), but arrives where the other stops (μ = 1 at 1e7), as in Grippo, Lampariello &
Lucidi 1986, doi:10.1137/0723046.
"""

MOST_BOUNDS = 100
"""Fixed friction bounds tried where Newton's method on Coulomb's law stalls."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class Increment:
    """Where contact stands after an increment.

    Attributes
    ----------
    forces : (3, n_point) [force]
        λ_n and both tangential components, zero where there is no friction.
    slack : (3, n_point) [length]
        z: the gap plus what the law yields, and the slip of the increment.
    iterations
        Newton steps.
    residual
        Largest natural residual over the largest force.
    """

    forces: Matrix
    slack: Matrix
    iterations: int
    residual: float

    @property
    def dissipation(self) -> float:
        """Energy that friction took in the increment, −Σ λ_t · z_t [force·length]."""
        return float(-(self.forces[1:] * self.slack[1:]).sum())


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class FrictionalContact:
    """Solver of increments of a system with friction.

    Attributes
    ----------
    contact
        Gaps, tangential displacements and laws.
    S : (n_relative, n_relative) [length/force]
        Compliance between pairs.
    """

    contact: Contact
    S: Matrix

    @cached_property
    def G(self) -> SparseMatrix:
        """Rows (3 n_point, n_relative): all normal ones, first tangents, second tangents."""
        contact, n = self.contact, self.contact.n_points
        shear = sp.csr_array((0, self.S.shape[0])) if contact.shear is None else contact.shear
        half = shear.shape[0] // 2
        place = sp.csr_array((np.ones(half), (contact.rubbing, np.arange(half))), shape=(n, half))
        parts = [contact.interpolation, place @ shear[:half], place @ shear[half:]]
        return sp.vstack(parts).tocsr()

    @cached_property
    def D(self) -> Matrix:
        """What the law yields per force (3, n_point) [length/force]."""
        D = np.zeros((3, self.contact.n_points))
        D[0] = self.contact.flexibility
        D[1:, self.contact.rubbing] = self.contact.tangential_flexibility
        return D

    @cached_property
    def friction(self) -> Vector:
        """Coefficients of friction (n_point,)."""
        friction = np.zeros(self.contact.n_points)
        friction[self.contact.rubbing] = self.contact.friction
        return friction

    @cached_property
    def scale(self) -> Matrix:
        """One over the diagonal of H (3, n_point) [force/length], r of (F1).

        Both tangents have one r, by the mean of their diagonals, which no turn of them changes.
        """
        own = np.asarray((self.G @ self.S * self.G.toarray()).sum(axis=1)).reshape(3, -1)
        own[1:] = own[1:].mean(axis=0)
        total = own + self.D
        return np.asarray(np.where(total > 0, 1.0 / np.where(total > 0, total, 1.0), 1.0))

    @cached_property
    def yields(self) -> Mask:
        """Whether the law yields in every component that carries force (n_point,)."""
        rubbing = np.zeros(self.contact.n_points, dtype=bool)
        rubbing[self.contact.rubbing] = True
        return np.asarray((self.D[0] > 0) & ((self.D[1] > 0) | ~rubbing))

    def solve(self, z_free: Matrix, start: Matrix | None = None) -> Increment:
        """Solve one increment.

        Parameters
        ----------
        z_free : (3, n_point) [length]
            Slack without contact forces.
        start : (3, n_point) [force]
            Forces to begin with, those of the increment before; by default all points that are
            pressed together close and stick.

        Raises
        ------
        ConvergenceError
            If neither Newton's method nor a sequence of fixed friction bounds converges.

        Notes
        -----
        Coulomb's law is not associated: there is no energy to minimize, and for large coefficients
        neither existence nor uniqueness is certain. What is returned solves (F1) to its residual.
        """
        x = np.zeros_like(z_free) if start is None else start
        x, steps, left = self._newton(z_free, x, None)
        if left > SOLVED:
            x, more, left = self._newton(z_free, x, None, watched=WATCHED)
            steps += more
        if left > SOLVED:
            x, more, left = self._with_fixed_bounds(z_free, x)
            steps += more
        if left > SOLVED:
            message = (
                f"an increment with friction was not solved in {steps} Newton steps (natural "
                f"residual {left:.1e} of the largest force); take smaller increments, or a smaller "
                "coefficient of friction: with large ones solutions need not exist"
            )
            raise ConvergenceError(message)
        return Increment(forces=x, slack=self._slack(x, z_free), iterations=steps, residual=left)

    def _slack(self, x: Matrix, z_free: Matrix) -> Matrix:
        moved = self.G @ (self.S @ (self.G.T @ x.ravel()))
        slack: Matrix = moved.reshape(x.shape) + self.D * x + z_free
        return slack

    def _residual(self, x: Matrix, z: Matrix, bound: Vector | None) -> Matrix:
        """F of (F1), with fixed friction bounds where they are given."""
        trial = x - self.scale * z
        normal = np.maximum(trial[0], 0.0)
        limit = self.friction * normal if bound is None else np.where(normal > 0, bound, 0.0)
        size = np.hypot(trial[1], trial[2])
        cut = np.minimum(1.0, limit / np.where(size > 0, size, 1.0))
        admissible: Matrix = np.stack([normal, cut * trial[1], cut * trial[2]])
        return np.asarray(x - admissible)

    def _newton(
        self, z_free: Matrix, x: Matrix, bound: Vector | None, watched: int = 1
    ) -> tuple[Matrix, int, float]:
        """Return forces, Newton steps, and the residual that is left over the largest force.

        Steps are halved until the residual is below the largest of those of the last ``watched``.
        """
        z, step = self._slack(x, z_free), 0
        wrong = self._residual(x, z, bound)
        norms = [float(np.linalg.norm(wrong))]
        while step < MOST_STEPS:
            step += 1
            try:
                target = self._step(x, z, z_free, bound)
            except la.LinAlgError:
                break
            size = max(float(np.abs(target).max(initial=0.0)), np.finfo(float).tiny)
            fraction, found = 1.0, None
            for _ in range(MOST_HALVINGS):
                tried = x + fraction * (target - x)
                slack = self._slack(tried, z_free)
                residual = self._residual(tried, slack, bound)
                if np.linalg.norm(residual) < (1 - 1e-4 * fraction) * max(norms[-watched:]):
                    found = tried, slack, residual
                    break
                fraction /= 2
            if found is None:
                break
            x, z, wrong = found
            norms.append(float(np.linalg.norm(wrong)))
            if np.abs(wrong).max(initial=0.0) <= ROUND_OFF * size:
                break
        largest = max(float(np.abs(x).max(initial=0.0)), np.finfo(float).tiny)
        return x, step, float(np.abs(wrong).max(initial=0.0)) / largest

    def _with_fixed_bounds(self, z_free: Matrix, x: Matrix) -> tuple[Matrix, int, float]:
        """Solve for fixed friction bounds, a convex problem, and renew the bounds (Tresca)."""
        steps, left = 0, np.inf
        for _ in range(MOST_BOUNDS):
            bound = self.friction * np.maximum(x[0], 0.0)
            x, more, _ = self._newton(z_free, x, bound)
            steps += more
            wrong = self._residual(x, self._slack(x, z_free), None)
            largest = max(float(np.abs(x).max(initial=0.0)), np.finfo(float).tiny)
            before, left = left, float(np.abs(wrong).max(initial=0.0)) / largest
            if left <= SOLVED or left > 0.999 * before:
                break
        return x, steps, left

    def _step(self, x: Matrix, z: Matrix, z_free: Matrix, bound: Vector | None) -> Matrix:
        """Return the forces (3, n_point) that the linearized problem (F2) has."""
        points, A, E, c = self._linearized(x, z, z_free, bound)
        forces = np.zeros_like(x)
        if not len(points):
            return forces
        n = self.contact.n_points
        rows = self.G[(points[:, None] + n * np.arange(3)).ravel()]
        if self.yields[points].all():
            inner = self._between_pairs(rows, A, E, c)
        else:
            inner = self._between_points(rows, A, E, c)
        forces[:, points] = inner.T
        return forces

    def _between_pairs(self, rows: SparseMatrix, A: Matrix, E: Matrix, c: Matrix) -> Matrix:
        """Solve (F3) at the pairs that closed points touch."""
        solved = np.linalg.solve(A, np.concatenate([E, c[..., None]], axis=2))
        K, alone = solved[..., :3], solved[..., 3]
        touched = np.unique(rows.indices)
        own = rows[:, touched]
        blocks = sp.bsr_array((K, np.arange(len(K)), np.arange(len(K) + 1)))
        B = (own.T @ (blocks @ own)).tocsr()
        S = self.S[np.ix_(touched, touched)]
        system = B @ S
        system[np.diag_indices_from(system)] += 1.0
        pairs = la.solve(system, own.T @ alone.ravel(), overwrite_a=True, check_finite=False)
        moved = (own @ (S @ pairs)).reshape(-1, 3)
        return np.asarray(alone - np.einsum("pij,pj->pi", K, moved))

    def _between_points(self, rows: SparseMatrix, A: Matrix, E: Matrix, c: Matrix) -> Matrix:
        """Solve (F2) at the closed points."""
        H = rows @ (rows @ self.S).T
        n = len(A)
        system = np.einsum("pij,pjk->pik", E, H.reshape(n, 3, 3 * n))
        at = np.arange(n)
        system.reshape(n, 3, n, 3)[at, :, at] += A
        flat = system.reshape(3 * n, 3 * n)
        return np.asarray(la.solve(flat, c.ravel(), check_finite=False)).reshape(n, 3)

    def _linearized(
        self, x: Matrix, z: Matrix, z_free: Matrix, bound: Vector | None
    ) -> tuple[Indices, Matrix, Matrix, Matrix]:
        """Return the closed points, and A, E (n_closed, 3, 3) and c (n_closed, 3) of (F2)."""
        trial = x - self.scale * z
        points = np.flatnonzero(trial[0] > 0)
        trial, r, D, free = (array[:, points] for array in (trial, self.scale, self.D, z_free))
        friction = self.friction[points]
        limit = friction * trial[0] if bound is None else bound[points]
        size = np.hypot(trial[1], trial[2])
        # Without friction nothing sticks, not even where nothing moves.
        slips = (size > limit) | (friction == 0)
        n = len(points)
        A, E, c = np.zeros((n, 3, 3)), np.zeros((n, 3, 3)), np.zeros((n, 3))
        A[:, 0, 0], E[:, 0, 0], c[:, 0] = D[0], 1.0, -free[0]
        along = (trial[1:] / np.where(size > 0, size, 1.0)).T
        share = np.where(slips, limit / np.where(size > 0, size, 1.0), 0.0)
        across = share[:, None, None] * (np.eye(2) - along[:, :, None] * along[:, None, :])
        stuck = np.eye(2) * (~slips)[:, None, None]
        # Where a point sticks z_t = 0; where it slips the derivative of the projection.
        A[:, 1:, 1:] = stuck * D[1][:, None, None] + slips[:, None, None] * (
            np.eye(2) - across * (1 - r[1] * D[1])[:, None, None]
        )
        E[:, 1:, 1:] = stuck + across * r[1][:, None, None]
        c[:, 1:] = -np.einsum("pij,jp->pi", E[:, 1:, 1:], free[1:])
        if bound is None:
            pull = (friction * slips)[:, None] * along
            A[:, 1:, 0] = pull * (r[0] * D[0] - 1.0)[:, None]
            E[:, 1:, 0] = pull * r[0][:, None]
            c[:, 1:] -= pull * (r[0] * free[0])[:, None]
        else:
            c[:, 1:] += (slips * limit)[:, None] * along
        return points, A, E, c
