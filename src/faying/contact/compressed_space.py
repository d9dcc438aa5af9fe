"""Contact with a compressed compliance: direct for few pairs in contact, iterative for many.

The error is bounded, not hoped for. With violations v = s where λ > 0 and min(s, 0) elsewhere, the
duality gap bounds what the iteration leaves, ‖λ̂ − λ̃‖_D ≤ ‖v‖_{D⁻¹}; and because H ⪰ D the
solution λ̃ of a truncated compliance S̃ = S + E obeys

    ‖λ̃ − λ*‖_D ≤ ‖D^{-½} N E Nᵀ D^{-½}‖ ‖λ̃‖_D ≤ ‖E‖_F ‖Nᵀ D⁻¹ N‖_∞ ‖λ̃‖_D,

‖λ‖_D² = Σ λ²/(c_n w): the root mean square of the pressure where the penalty is uniform.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import final

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.contact.active_set import ContactForces, solve_complementarity
from faying.exceptions import ConvergenceError
from faying.linalg.compressed import CompressedCompliance
from faying.linalg.threads import threads_for

SIGN_NOISE = 1e-11
"""Sign violations below this fraction of the largest |g_free| do not count."""

SEARCH_TOLERANCE = 1e-6
"""The same while the points in contact are looked for."""

CLOSED = 0.1
"""Largest gap left at active points over such a violation, at which the iteration ends."""

DIRECT = 1500
"""Pairs in contact up to which a dense system of theirs is faster than an iteration; 18 MB."""

LARGEST_SHRINKAGE = 0.5
"""Pairs in contact over those whose dense compliance is at hand, below which it is formed anew."""

MOST_STEPS = 2000
"""Conjugate gradient steps per active set; some thirty are usual."""

RANK = 1e-12
"""Answers to smooth loads below this fraction of the largest are noise."""

REGULAR = 0.03
"""Least diagonal of the preconditioner over the mean one, where contact is hard."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class CompressedSpace:
    """H = N S Nᵀ + D with S in compressed form.

    Attributes
    ----------
    N : (n_point, n_relative) sparse
    S
    D : (n_point,) [length/force]
        May vanish (hard contact) where points are no more than pairs.
    direct
        Pairs in contact up to which their systems are solved directly.
    """

    N: SparseMatrix
    S: CompressedCompliance
    D: Vector
    noise: float = SIGN_NOISE
    direct: int = DIRECT

    @cached_property
    def members(self) -> tuple[Indices, ...]:
        """Contact points of each cluster: those that follow one of its pairs most."""
        owner = np.full(self.N.shape[1], -1)
        for number, pairs in enumerate(self.S.clusters):
            owner[pairs] = number
        strongest = np.asarray(abs(self.N).tocsr().argmax(axis=1)).ravel()
        order = np.argsort(owner[strongest], kind="stable")
        ends = np.searchsorted(owner[strongest][order], np.arange(len(self.S.clusters) + 1))
        return tuple(order[a:b] for a, b in pairwise(ends.tolist()))

    @cached_property
    def diagonal(self) -> Vector:
        """Diagonal of H, seen through the clusters."""
        result = self.D.copy()
        for number, points in enumerate(self.members):
            result[points] += np.diag(self._at_points(number, self.S.block(number)))
        return result

    @cached_property
    def stiff(self) -> Vector:
        """D, or where it vanishes the least eigenvalue of H within the cluster (an estimate)."""
        result = self.D.copy()
        for number, points in enumerate(self.members):
            if len(points) and not (self.D[points] > 0).all():
                block = self._at_points(number, self.S.block(number)) + np.diag(self.D[points])
                smallest = float(la.eigvalsh(block, subset_by_index=[0, 0])[0])
                result[points] = np.maximum(result[points], smallest)
        return result

    @cached_property
    def _smooth(self) -> Matrix:
        """V (n_relative, k) with S ≈ V Vᵀ + what is local: what linear loads on clusters do."""
        loads = np.hstack([_linear_loads(self.S.clusters, self.S.places), self.S.smooth])
        loads = np.linalg.qr(loads)[0]
        answers = self.S @ loads
        values, vectors = la.eigh(loads.T @ answers)
        significant = values > RANK * values[-1]
        result: Matrix = answers @ (vectors[:, significant] / np.sqrt(values[significant]))
        return result

    @cached_property
    def smooth_at_points(self) -> Matrix:
        """N V (n_point, k)."""
        result: Matrix = self.N @ self._smooth
        return result

    @cached_property
    def rest(self) -> tuple[Matrix, ...]:
        """H between the points of each cluster without what is smooth."""
        blocks = []
        for number, points in enumerate(self.members):
            smooth = self._smooth[self.S.clusters[number]]
            block = self.S.block(number)
            block -= smooth @ smooth.T
            local_block = self._at_points(number, block)
            # Hard contact: the local part of S alone is singular against linear loads.
            floor = REGULAR * np.trace(local_block) / max(len(points), 1)
            blocks.append(local_block + np.diag(np.maximum(self.D[points], floor)))
        return tuple(blocks)

    def _at_points(self, number: int, block: Matrix) -> Matrix:
        """Take a matrix between the pairs of a cluster to its points."""
        rows = self.N[self.members[number]][:, self.S.clusters[number]]
        result: Matrix = rows @ (rows @ block).T
        return result

    @cached_property
    def truncation(self) -> float:
        """Bound on the relative error of forces that the compression of S makes."""
        if self.S.error == 0.0:
            return 0.0
        size = abs(self.N)
        loads = size.T @ (size.sum(axis=1).ravel() / self.stiff)
        return self.S.error * float(loads.max(initial=0.0))

    def product(self, forces: Vector) -> Vector:
        """Return H λ."""
        result: Vector = self.N @ (self.S @ (self.N.T @ forces)) + self.D * forces
        return result

    def shifted(self, delta: float) -> "CompressedSpace":
        """Return the space of H + δ I."""
        return replace(self, D=self.D + delta)

    def equilibrate(self, g_free: Vector, active: Mask) -> tuple[Vector, Vector]:
        """Return the forces that close the active gaps, and the slack of all points."""
        return _Systems(space=self).equilibrate(g_free, active)

    def solve(self, g_free: Vector, active: Mask | None = None) -> ContactForces:
        """Solve the contact problem of a compressed compliance, with a bound on the error.

        The points in contact are found with loosely solved systems first.
        """
        systems = _Systems(space=self)
        if active is None:
            active = solve_complementarity(systems.loosened(), g_free).active
        return self.certified(solve_complementarity(systems, g_free, active))

    def certified(self, solution: ContactForces) -> ContactForces:
        """Return the solution with the bound on its error."""
        norm = np.sqrt(float((solution.forces**2) @ self.stiff))
        if norm == 0.0:
            return solution
        slack = solution.slack
        violation = np.where(solution.forces > 0, slack, np.minimum(slack, 0.0))
        left = np.sqrt(float((violation**2) @ (1 / self.stiff))) / norm
        return replace(solution, error=left + self.truncation)


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class _Systems:
    """The linear systems of one contact problem, which share what few of its points change.

    Attributes
    ----------
    space
        H.
    noise
        Sign violations below this fraction of the largest |g_free| do not count.
    few, local
        Dense compliance of the pairs in contact, and factors of the clusters, of the last system.
    """

    space: CompressedSpace
    noise: float = SIGN_NOISE
    few: dict[str, tuple[Mask, SparseMatrix, Matrix]] = field(default_factory=dict)
    local: dict[int, tuple[bytes, Matrix]] = field(default_factory=dict)

    def loosened(self) -> "_Systems":
        """Return the systems of the same problem in which small gaps do not matter."""
        return replace(self, noise=SEARCH_TOLERANCE)

    @property
    def diagonal(self) -> Vector:
        """Diagonal of H."""
        return self.space.diagonal

    def equilibrate(self, g_free: Vector, active: Mask) -> tuple[Vector, Vector]:
        """Return the forces that close the active gaps, and the slack of all points."""
        allowed = CLOSED * self.noise * float(np.abs(g_free).max(initial=0.0))
        with threads_for(self.space.direct):
            forces = self.solved(-g_free, active, allowed)
            slack = self.space.product(forces) + g_free
        return forces, slack

    def product(self, forces: Vector) -> Vector:
        """Return H λ."""
        return self.space.product(forces)

    def shifted(self, delta: float) -> "_Systems":
        """Return the systems of H + δ I."""
        return _Systems(space=self.space.shifted(delta), noise=self.noise)

    def solved(self, right: Vector, active: Mask, allowed: float) -> Vector:
        """Solve H_AA x = b; directly where few pairs carry force."""
        touched = np.zeros(self.space.N.shape[1], dtype=bool)
        touched[self.space.N[np.flatnonzero(active)].indices] = True
        count = int(touched.sum())
        if count == 0 or count > self.space.direct or not (self.space.D[active] > 0).all():
            return self._conjugate_gradients(right, active, allowed)
        last = self.few.get("pairs")
        if last is None or (touched & ~last[0]).any() or count < LARGEST_SHRINKAGE * last[0].sum():
            pairs = np.flatnonzero(touched)
            few = self.space.N[:, pairs].tocsr(), self.space.S.principal(pairs)
            last = self.few["pairs"] = (touched, *few)
        return self._directly(right, active, *last[1:])

    def _directly(self, right: Vector, active: Mask, N: SparseMatrix, S: Matrix) -> Vector:
        """Solve H_AA x = b between the pairs in contact: (I + S B) y = S N_Aᵀ D_A⁻¹ b."""
        springs = np.divide(active, self.space.D, out=np.zeros_like(right), where=active)
        system = S @ (N.T @ sp.diags_array(springs) @ N)
        system.flat[:: len(system) + 1] += 1.0
        moved = la.solve(system, S @ (N.T @ (springs * right)), overwrite_a=True)
        return np.asarray(springs * (right - N @ moved))

    def _conjugate_gradients(self, right: Vector, active: Mask, allowed: float) -> Vector:
        """Solve H_AA x = b to ‖r‖_∞ ≤ allowed; x vanishes off the active points."""
        x, r = np.zeros_like(right), np.where(active, right, 0.0)
        if np.abs(r).max(initial=0.0) <= allowed:
            return x
        inverse = self._preconditioner(active)
        z = inverse(r)
        p, rz = z, float(r @ z)
        for _ in range(MOST_STEPS):
            answer = np.where(active, self.space.product(p), 0.0)
            alpha = rz / float(p @ answer)
            x = x + alpha * p
            r = r - alpha * answer
            if np.abs(r).max() <= allowed:
                # Recurred residuals drift from true ones.
                r = np.where(active, right - self.space.product(x), 0.0)
                if np.abs(r).max() <= 2 * allowed:
                    return x
                rz = np.inf
            z = inverse(r)
            previous, rz = rz, float(r @ z)
            p = z + (rz / previous) * p
        message = (
            f"the compressed contact problem left a gap of {np.abs(r).max():.1e} after "
            f"{MOST_STEPS} steps; raise the dense budget of the model, or lower the penalty"
        )
        raise ConvergenceError(message)

    def _preconditioner(self, active: Mask) -> "_Preconditioner":
        """Local blocks of the active points, corrected for what is smooth (Woodbury)."""
        factors = self._factors(active)
        smooth = np.where(active[:, None], self.space.smooth_at_points, 0.0)
        shapes = _solve_blocks(factors, smooth)
        core = smooth.T @ shapes
        core[np.diag_indices_from(core)] += 1.0
        return _Preconditioner(factors=factors, shapes=shapes, core=la.cho_factor(core))

    def _factors(self, active: Mask) -> list[tuple[Indices, Matrix]]:
        """Cholesky factors of the active part of each block, kept until that part changes."""
        factors = []
        for number, points in enumerate(self.space.members):
            chosen = active[points]
            if not chosen.any():
                continue
            key = chosen.tobytes()
            last = self.local.get(number)
            if last is None or last[0] != key:
                part = self.space.rest[number][np.ix_(chosen, chosen)]
                last = self.local[number] = (key, la.cholesky(part, lower=True))
            factors.append((points[chosen], last[1]))
        return factors


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class _Preconditioner:
    """(blocks + W Wᵀ)⁻¹ r, with shapes = blocks⁻¹ W and core = I + Wᵀ shapes."""

    factors: list[tuple[Indices, Matrix]]
    shapes: Matrix
    core: tuple[Matrix, bool]

    def __call__(self, r: Vector) -> Vector:
        share = la.cho_solve(self.core, self.shapes.T @ r, check_finite=False)
        result: Vector = _solve_blocks(self.factors, r) - self.shapes @ share
        return result


def _solve_blocks(factors: list[tuple[Indices, Matrix]], right: Matrix) -> Matrix:
    result = np.zeros_like(right)
    for points, factor in factors:
        result[points] = la.cho_solve((factor, True), right[points], check_finite=False)
    return result


def _linear_loads(clusters: tuple[Indices, ...], places: Matrix) -> Matrix:
    """Return loads on one cluster each (n_relative, 3 n_cluster), even or linear across it."""
    loads = np.zeros((len(places), 3 * len(clusters)))
    for number, members in enumerate(clusters):
        centred = places[members] - places[members].mean(axis=0)
        directions = np.linalg.svd(centred, full_matrices=False)[2][:2]
        loads[members, 3 * number] = 1.0
        loads[members, 3 * number + 1 : 3 * number + 1 + len(directions)] = centred @ directions.T
    scale = np.linalg.norm(loads, axis=0)
    result: Matrix = loads[:, scale > 0] / scale[scale > 0]
    return result
