"""The active set of contact points, for any representation of H.

(M3) of ``docs/theory/method.md``: with the gap flexibility H = S + D, (M2), and the gap without
contact forces g_free,

    s = H λ + g_free ≥ 0,   λ ≥ 0,   λᵀ s = 0

is Eq. (15.7) regularized by Eq. (15.12), or Eq. (15.7) itself where D vanishes (hard contact).
With springs that are known by their forces (T1a) their initial forces N₀ are unknown too,

    s = H λ − b N₀ + g_free,   bᵀ λ + M N₀ = t.                                             (T1b)
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import scipy.linalg as la

from faying._typing import Indices, Mask, Matrix, Vector
from faying.exceptions import ConvergenceError


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactForces:
    """Solution of one contact problem.

    Attributes
    ----------
    forces : (n_point,) [force]
        λ = w ∘ p ≥ 0.
    slack : (n_point,) [length]
        s = H λ + g_free ≥ 0: the gap plus the penetration that the law admits.
    active : (n_point,)
        Points in contact; a warm start for a neighbouring problem.
    iterations
        Linear systems solved.
    initial : (n_spring,) [force]
        N₀ of springs that are known by their forces.
    """

    forces: Vector
    slack: Vector
    active: Mask
    iterations: int
    initial: Vector


@dataclass(frozen=True, eq=False, kw_only=True)
class Balance:
    """Equilibrium of the springs whose forces are prescribed: the second equation of (T1b).

    Attributes
    ----------
    closing : (n_point, n_spring) [length/force]
        b.
    yields : (n_spring, n_spring) [length/force]
        M.
    elongations : (n_spring,) [length]
        t.
    about : (n_spring,) [force]
        Initial guess of N₀.
    """

    closing: Matrix
    yields: Matrix
    elongations: Vector
    about: Vector

    @classmethod
    def of_nothing(cls, n_points: int) -> "Balance":
        """Return the empty balance of a structure without springs of prescribed force."""
        none = np.zeros(0)
        return cls(
            closing=np.zeros((n_points, 0)),
            yields=np.zeros((0, 0)),
            elongations=none,
            about=none,
        )

    def solve(
        self, close: Callable[[Matrix], Matrix], points: Indices, gaps: Vector, missed: Vector
    ) -> tuple[Vector, Vector]:
        """Return forces (n,) that close gaps of points and meet the balance, and N₀ (n_spring,)."""
        b = self.closing[points]
        answers = close(np.column_stack([gaps, -b]))
        core = self.yields + b.T @ answers[:, 1:]
        np.linalg.cholesky(core)  # refuses springs without resistance
        initial = np.asarray(np.linalg.solve(core, missed - b.T @ answers[:, 0]), dtype=float)
        return np.asarray(answers[:, 0] + answers[:, 1:] @ initial), initial


BLOCK_ATTEMPTS = 5
"""Exchanges of the whole active set without progress before interior points take over."""

MOST_INTERIOR = 100
"""Newton steps through interior points; 15 to 45 are usual."""

INSIDE = 0.995
"""Largest share of the distance to the bounds in a step through interior points."""

ROUND_OFF = 1e-13
"""Sign violations below this fraction of the largest |g_free| are noise of the factorization."""

EPSILON = float(np.finfo(float).eps)
"""Round-off of a sum over the sum of its magnitudes; of n terms √n times that is rare."""

PROXIMAL_FRACTION = 1e-7
"""Proximal term over the largest diagonal of H; keeps the regularized pivots above the limit."""


class ActiveSetSpace(Protocol):
    """A representation of H that can solve with the active blocks of H."""

    @property
    def noise(self) -> float:
        """Sign violations below this fraction of the largest |g_free| are ignored."""

    @property
    def diagonal(self) -> Vector:
        """Diagonal of H (n_point,) [length/force]."""

    def product(self, forces: Vector) -> Vector:
        """Return H λ."""

    def closing(self, points: Indices, added: Vector) -> Callable[[Matrix], Matrix]:
        """Return a function from gaps (n, k) at points to the forces (n, k) that close them.

        ``added`` (n,) [length/force] is a compliance added to each point. Raises ``LinAlgError``
        where the block of H with this compliance is singular to working precision.
        """


def solve_complementarity(
    space: ActiveSetSpace,
    g_free: Vector,
    active: Mask | None = None,
    balance: Balance | None = None,
) -> ContactForces:
    """Solve s ≥ 0, λ ≥ 0, λᵀ s = 0 with s of (T1b) by a primal-dual active set method.

    All points with a wrong sign change sides at once, which is the semismooth Newton method
    (Hintermüller, Ito & Kunisch 2002, doi:10.1137/S1052623401383558). Where the number of wrong
    signs no longer falls, an interior point method takes over, whose number of steps does not grow
    with the number of points. Where an active block of H is singular, the proximal point iteration
    from λ = 0 takes over (Rockafellar 1976, doi:10.1137/0314056), which selects contact forces near
    those of a very stiff penalty. If H is singular but no active block on the way is, the result is
    one of several solutions. The iteration starts with the points ``active`` (n_point,) in contact;
    by default those that overlap without contact forces.

    Raises
    ------
    LinAlgError
        If nothing resists a spring of prescribed force.
    ConvergenceError
        If the problem has no solution.
    """
    balance = balance or Balance.of_nothing(len(g_free))
    if active is None:
        active = g_free < balance.closing @ balance.about
    try:
        return _exchange(space, g_free, active, balance)
    except la.LinAlgError:
        pass
    # Closed points are linearly dependent, or do not resist the springs.
    try:
        return _proximal_point(space, g_free, active, balance)
    except la.LinAlgError:
        if len(balance.about):
            return _through_interior(space, g_free, balance, balance.about, 0.0, 1)
        message = (
            "the contact flexibility is zero or not positive semidefinite at the points in "
            "contact; check that the stiffness matrix is symmetric and that no pressed "
            "contact point is held on both sides"
        )
        raise ConvergenceError(message) from None


def _exchange(
    space: ActiveSetSpace, g_free: Vector, active: Mask, balance: Balance, delta: float = 0.0
) -> ContactForces:
    """Exchange all points of a wrong sign at once, with H + δ I, while their number falls."""
    diagonal = np.maximum(space.diagonal, np.finfo(float).tiny)
    fewest, attempts, iterations = len(g_free) + 1, BLOCK_ATTEMPTS, 0
    initial = balance.about
    while attempts >= 0:
        points, forces = np.flatnonzero(active), np.zeros_like(g_free)
        close = space.closing(points, np.full(len(points), delta))
        forces[points], initial = balance.solve(close, points, g_free[points], balance.elongations)
        pulled = g_free - balance.closing @ initial
        slack = space.product(forces) + pulled
        slack[points] = 0.0
        iterations += 1
        noise = _round_off(space, pulled, forces)
        wrong = np.where(active, diagonal * forces < -noise, slack < -noise)
        count = int(np.count_nonzero(wrong))
        if count == 0:
            return ContactForces(
                forces=np.maximum(forces, 0.0),
                slack=np.maximum(slack, 0.0),
                active=active,
                iterations=iterations,
                initial=initial,
            )
        attempts = BLOCK_ATTEMPTS if count < fewest else attempts - 1
        fewest = min(count, fewest)
        active = active ^ wrong
    return _through_interior(space, g_free, balance, initial, delta, iterations)


def _through_interior(
    space: ActiveSetSpace,
    g_free: Vector,
    balance: Balance,
    initial: Vector,
    delta: float,
    iterations: int,
) -> ContactForces:
    """Solve by an interior point method: from λ > 0 and s > 0 to one of them zero at each point.

    This is a primal-dual method with predictor and corrector (Mehrotra 1992,
    doi:10.1137/0802028): Newton's method for λ s = σ μ at each point. σ is small where the
    predictor step to σ = 0 reduces the mean μ of λ s much. ``initial`` is the first guess of N₀.
    """
    every, b = np.arange(len(g_free)), balance.closing
    root = np.sqrt(np.maximum(space.diagonal, EPSILON * space.diagonal.max()))
    scale = float((np.abs(g_free - b @ initial) / root).max())
    forces, slack = scale / root, scale * root
    for _ in range(MOST_INTERIOR):
        pulled = g_free - b @ initial
        wrong = space.product(forces) + delta * forces + pulled - slack
        missed = balance.elongations - b.T @ forces - balance.yields @ initial
        noise = _round_off(space, pulled, forces)
        either = np.minimum(root**2 * forces, slack)
        unsolved = np.abs(missed).max(initial=0.0) > noise.max()
        if not unsolved and (np.maximum(either, np.abs(wrong)) <= noise).all():
            active = root**2 * forces > slack
            return ContactForces(
                forces=np.where(active, forces, 0.0),
                slack=np.where(active, 0.0, slack),
                active=active,
                iterations=iterations,
                initial=initial,
            )
        # A compliance of the size of round-off makes linearly dependent points solvable.
        close = space.closing(every, slack / forces + delta + ROUND_OFF * root**2)
        mean, aim = forces @ slack / len(forces), np.zeros_like(forces)
        for share in (1.0, INSIDE):
            gaps = wrong + slack - aim / forces
            pressed, pulled = balance.solve(close, every, gaps, missed)
            parted = (aim - slack * (forces + pressed)) / forces
            outward = np.minimum(pressed / forces, parted / slack).min()
            length = min(1.0, share / max(-outward, np.finfo(float).tiny))
            left = (forces + length * pressed) @ (slack + length * parted) / len(forces)
            aim = (left / mean) ** 3 * mean - pressed * parted
        forces, slack = forces + length * pressed, slack + length * parted
        initial, iterations = initial + length * pulled, iterations + 1
    message = (
        f"the contact problem of {len(g_free)} points did not settle: its flexibility matrix is "
        "not positive semidefinite, or round-off hides that it is; check that the stiffness matrix "
        "is symmetric and the structure held by more than weak springs, or take a penalty"
    )
    raise ConvergenceError(message)


def _round_off(space: ActiveSetSpace, g_free: Vector, forces: Vector) -> Vector:
    """Return the round-off error of vanishing gaps (n_point,), from |H_ij|² ≤ H_ii H_jj.

    Where only weak springs hold a part, H contains its rigid motion. Each of the forces in balance
    then moves the part by far more than |g_free|.
    """
    root = np.sqrt(np.maximum(space.diagonal, 0.0))
    summed = EPSILON * float(root @ np.abs(forces)) * root
    return np.maximum(summed, space.noise * largest(g_free))


def largest(values: Vector) -> float:
    """Return the largest magnitude, zero if there are no values."""
    return float(np.abs(values).max()) if values.size else 0.0


def _proximal_point(
    space: ActiveSetSpace, g_free: Vector, active: Mask, balance: Balance
) -> ContactForces:
    """Solve with H + δ I repeatedly; δ λ of the last solution is fed back into the gap."""
    delta = PROXIMAL_FRACTION * float(space.diagonal.max())
    forces = np.zeros_like(g_free)
    iterations = 0
    for _ in range(200):
        step = _exchange(space, g_free - delta * forces, active, balance, delta)
        iterations += step.iterations
        residual = delta * np.abs(step.forces - forces).max()
        forces, active = step.forces, step.active
        pulled = g_free - balance.closing @ step.initial
        if residual <= _round_off(space, pulled, forces).max():
            slack = np.maximum(space.product(forces) + pulled, 0.0)
            return replace(step, slack=slack, iterations=iterations)
    message = (
        f"hard contact at {len(g_free)} points was not closed to round-off (remaining gap "
        f"{residual:.1e}); use nodal quadrature or a penalty"
    )
    raise ConvergenceError(message)
