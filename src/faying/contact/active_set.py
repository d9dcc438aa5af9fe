"""Which contact points are closed, for any form of H.

(M3) of ``docs/theory/method.md``: with the gap flexibility H = S + D, (M2), and the gap without
contact forces g_free,

    s = H λ + g_free ≥ 0,   λ ≥ 0,   λᵀ s = 0

is Eq. (15.7) regularized by Eq. (15.12), or Eq. (15.7) itself where D vanishes (hard contact).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np
import scipy.linalg as la

from faying._typing import Mask, Vector
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
    """

    forces: Vector
    slack: Vector
    active: Mask
    iterations: int


BLOCK_ATTEMPTS = 5
"""Exchanges of the whole active set without progress before interior points take over."""

MOST_INTERIOR = 100
"""Newton steps through interior points; 15 to 45 are usual."""

INSIDE = 0.995
"""Share of the way to the bounds that a step through interior points goes at most."""

ROUND_OFF = 1e-13
"""Sign violations below this fraction of the largest |g_free| are noise of the factorization."""

EPSILON = float(np.finfo(float).eps)
"""Round-off of a sum over the sum of its magnitudes; of n terms √n times that is rare."""

PROXIMAL_FRACTION = 1e-7
"""Proximal term over the largest diagonal of H; keeps the regularized pivots above the limit."""


class ActiveSetSpace(Protocol):
    """A flexibility H in the form in which its active blocks are solved."""

    @property
    def noise(self) -> float:
        """Sign violations below this fraction of the largest |g_free| do not count."""
        ...

    @property
    def diagonal(self) -> Vector:
        """Diagonal of H (n_point,) [length/force]."""
        ...

    def equilibrate(self, g_free: Vector, active: Mask) -> tuple[Vector, Vector]:
        """Return the forces that close the active gaps, and the slack of all points.

        Raises ``LinAlgError`` where the active block is singular to working precision.
        """
        ...

    def product(self, forces: Vector) -> Vector:
        """Return H λ."""
        ...

    def yielding(self, added: Vector) -> Callable[[Vector], Vector]:
        """Return what returns the forces under which gaps (n_point,) are (H + diag(added)) λ.

        Raises ``LinAlgError`` where that matrix is not positive definite.
        """
        ...

    def shifted(self, delta: float) -> Self:
        """Return the space of H + δ I."""
        ...


def solve_complementarity(
    space: ActiveSetSpace, g_free: Vector, active: Mask | None = None
) -> ContactForces:
    """Solve s = H λ + g_free ≥ 0, λ ≥ 0, λᵀ s = 0 by a primal-dual active set.

    All points with a wrong sign change sides at once, which is the semismooth Newton method
    (Hintermüller, Ito & Kunisch 2002, doi:10.1137/S1052623401383558). Where that stops reducing the
    number of wrong signs, an interior point method takes over, whose steps do not grow in number
    with the points. Where exchanges meet a singular block of H, the proximal point iteration from
    λ = 0 takes over (Rockafellar 1976, doi:10.1137/0314056), which selects contact
    forces near those of a very stiff penalty. A singular H without such a block on the way gives
    one of its solutions. Active points (n_point,) are assumed in contact at the start; by default
    those with g_free < 0.
    """
    start = g_free < 0 if active is None else np.array(active, dtype=bool)
    try:
        return _pivot(space, g_free, start)
    except la.LinAlgError:
        pass
    try:
        return _proximal_point(space, g_free, start)
    except la.LinAlgError:
        message = (
            "the contact flexibility is zero or not positive semidefinite at the points in "
            "contact; check that the stiffness matrix is symmetric and that no pressed "
            "contact point is held on both sides"
        )
        raise ConvergenceError(message) from None


def _pivot(space: ActiveSetSpace, g_free: Vector, active: Mask) -> ContactForces:
    """Exchange all points of a wrong sign at once, as long as that gains."""
    diagonal = np.maximum(space.diagonal, np.finfo(float).tiny)
    fewest, attempts, iterations = len(g_free) + 1, BLOCK_ATTEMPTS, 0
    while attempts >= 0:
        forces, slack = space.equilibrate(g_free, active)
        iterations += 1
        noise = _noise(space, g_free, forces)
        wrong = np.where(active, diagonal * forces < -noise, slack < -noise)
        count = int(np.count_nonzero(wrong))
        if count == 0:
            forces = np.maximum(forces, 0.0)
            return ContactForces(
                forces=forces, slack=np.maximum(slack, 0.0), active=active, iterations=iterations
            )
        attempts = BLOCK_ATTEMPTS if count < fewest else attempts - 1
        fewest = min(count, fewest)
        active = active ^ wrong
    return _through_interior(space, g_free, iterations)


def _through_interior(space: ActiveSetSpace, g_free: Vector, iterations: int) -> ContactForces:
    """Go between λ > 0 and s > 0 to where either vanishes at each point, after some iterations.

    A primal-dual interior point method with predictor and corrector (Mehrotra 1992,
    doi:10.1137/0802028): Newton's method on λ s = σ μ at each point, whose σ falls with what the
    step to σ = 0 leaves of the mean μ.
    """
    root = np.sqrt(np.maximum(space.diagonal, EPSILON * space.diagonal.max()))
    scale = float((np.abs(g_free) / root).max())
    forces, slack = scale / root, scale * root
    for _ in range(MOST_INTERIOR):
        wrong = space.product(forces) + g_free - slack
        noise = _noise(space, g_free, forces)
        either = np.minimum(root**2 * forces, slack)
        if (np.maximum(either, np.abs(wrong)) <= noise).all():
            active = root**2 * forces > slack
            return ContactForces(
                forces=np.where(active, forces, 0.0),
                slack=np.where(active, 0.0, slack),
                active=active,
                iterations=iterations,
            )
        solve = space.yielding(slack / forces)
        mean, aim = forces @ slack / len(forces), np.zeros_like(forces)
        for share in (1.0, INSIDE):
            pressed = solve(aim / forces - slack - wrong)
            parted = (aim - slack * (forces + pressed)) / forces
            outward = np.minimum(pressed / forces, parted / slack).min()
            length = min(1.0, share / max(-outward, np.finfo(float).tiny))
            left = (forces + length * pressed) @ (slack + length * parted) / len(forces)
            aim = (left / mean) ** 3 * mean - pressed * parted
        forces, slack = forces + length * pressed, slack + length * parted
        iterations += 1
    message = (
        f"the contact problem of {len(g_free)} points did not settle: its flexibility matrix is "
        "not positive semidefinite, or round-off hides that it is; check that the stiffness matrix "
        "is symmetric and the structure held by more than weak springs, or take a penalty"
    )
    raise ConvergenceError(message)


def _noise(space: ActiveSetSpace, g_free: Vector, forces: Vector) -> Vector:
    """Return what round-off makes of gaps that vanish (n_point,), as |H_ij|² ≤ H_ii H_jj.

    Where weak springs alone hold a part, H holds its rigid motion, and forces that balance move it
    by far more than |g_free| in sum.
    """
    root = np.sqrt(np.maximum(space.diagonal, 0.0))
    summed = EPSILON * float(root @ np.abs(forces)) * root
    return np.maximum(summed, space.noise * largest(g_free))


def largest(values: Vector) -> float:
    """Return the largest magnitude, zero if there are no values."""
    return float(np.abs(values).max()) if values.size else 0.0


def _proximal_point(space: ActiveSetSpace, g_free: Vector, active: Mask) -> ContactForces:
    """Solve with H + δ I, feeding δ times the last forces back into the gap until it is closed."""
    delta = PROXIMAL_FRACTION * float(space.diagonal.max())
    regular = space.shifted(delta)
    forces = np.zeros_like(g_free)
    iterations = 0
    for _ in range(200):
        step = _pivot(regular, g_free - delta * forces, active)
        iterations += step.iterations
        residual = delta * np.abs(step.forces - forces).max()
        forces, active = step.forces, step.active
        if residual <= _noise(space, g_free, forces).max():
            slack = np.maximum(space.product(forces) + g_free, 0.0)
            return ContactForces(forces=forces, slack=slack, active=active, iterations=iterations)
    message = (
        f"hard contact at {len(g_free)} points was not closed to round-off (remaining gap "
        f"{residual:.1e}); use nodal quadrature or a penalty"
    )
    raise ConvergenceError(message)
