"""The condensed contact problem: convex, dense, the same for every model.

Design §3: with the gap flexibility H = S + D and the gap without contact forces g_free,

    s = H λ + g_free ≥ 0,   λ ≥ 0,   λᵀ s = 0

is Eq. (15.7) regularized by Eq. (15.12), or Eq. (15.7) itself where D vanishes (hard contact).
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la
from scipy.linalg import lapack

from faying._typing import Mask, Matrix, Vector, frozen
from faying.exceptions import ConvergenceError, ModelError

BLOCK_ATTEMPTS = 5
"""Exchanges of the whole active set without progress before single pivots take over."""

ROUND_OFF = 1e-13
"""Sign violations below this fraction of the largest |g_free| are noise of the factorization."""

SINGULAR_PIVOT = 1e-7
"""Smallest over largest Cholesky pivot (condition 1e14) below which H counts as singular."""

PROXIMAL_FRACTION = 1e-7
"""Proximal term over the largest diagonal of H; keeps the regularized pivots above the limit."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactForces:
    """Solution of one contact problem.

    Attributes
    ----------
    forces : (n_point,) [force]
        λ = w ∘ p ≥ 0.
    slack : (n_point,) [length]
        s = H λ + g_free ≥ 0: the gap plus the penetration that the penalty admits.
    active : (n_point,)
        Points in contact; a warm start for a neighbouring problem.
    iterations
        Linear systems solved.
    """

    forces: Vector
    slack: Vector
    active: Mask
    iterations: int


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactProblem:
    """min ½ λᵀ H λ + g_freeᵀ λ over λ ≥ 0.

    Attributes
    ----------
    H : (n_point, n_point) [length/force]
        Symmetric positive semidefinite. It is definite unless contact is hard and an interface
        has more contact points than normal displacements.
    g_free : (n_point,) [length]
        Gap that would result without contact forces.
    """

    H: Matrix
    g_free: Vector

    def __post_init__(self) -> None:
        object.__setattr__(self, "H", np.asarray(self.H, dtype=np.float64))
        object.__setattr__(self, "g_free", frozen(self.g_free))
        if self.H.shape != (len(self.g_free), len(self.g_free)):
            message = (
                f"the contact flexibility has shape {self.H.shape} but there are "
                f"{len(self.g_free)} gaps; give a square matrix with one row per gap"
            )
            raise ModelError(message)
        if not np.isfinite(self.g_free).all():
            message = "the gap without contact forces holds NaN or infinity; check loads and model"
            raise ModelError(message)
        if not np.isfinite(self.H).all():
            message = "the contact flexibility holds NaN or infinity; check the model's matrices"
            raise ModelError(message)

    def solve(self, *, active: Mask | None = None) -> ContactForces:
        """Solve by a primal-dual active set that cannot cycle.

        All points with a wrong sign change sides at once, which is the semismooth Newton method
        (Hintermüller, Ito & Kunisch 2002, doi:10.1137/S1052623401383558). Where that stops
        reducing the number of wrong signs, single exchanges by Murty's largest index take over
        until it does: block principal pivoting, finite for every positive definite H (Júdice &
        Pires 1994, doi:10.1016/0305-0548(94)90106-6). A singular H is solved by the proximal
        point iteration from λ = 0 (Rockafellar 1976, doi:10.1137/0314056), which selects the
        contact forces a very stiff penalty would give.

        Parameters
        ----------
        active : (n_point,), optional
            Points assumed in contact at the start; by default those with g_free < 0.

        Raises
        ------
        ConvergenceError
            If the exchanges do not end, or H is not positive semidefinite.

        Notes
        -----
        One Cholesky factorization of the active block per iteration; 4 to 8 cold, 1 or 2 warm.

        Examples
        --------
        A spring of flexibility 2 pressed 1 into its stop, beside one that stays open:

        >>> import numpy as np
        >>> problem = ContactProblem(H=np.diag([2.0, 2.0]), g_free=np.array([-1.0, 0.5]))
        >>> problem.solve().forces
        array([0.5, 0. ])
        """
        start = self.g_free < 0 if active is None else np.array(active, dtype=bool)
        try:
            return _pivot(self.H, self.g_free, start)
        except la.LinAlgError:
            pass
        try:
            return _proximal_point(self.H, self.g_free, start)
        except la.LinAlgError:
            message = (
                "the contact flexibility is zero or not positive semidefinite at the points in "
                "contact; check that the stiffness matrix is symmetric and that no pressed "
                "contact point is held on both sides"
            )
            raise ConvergenceError(message) from None


def contact_problem(H: Matrix, g_free: Vector) -> ContactProblem:
    """Return the contact problem of a flexibility matrix and a free gap, for bare matrices."""
    return ContactProblem(H=H, g_free=g_free)


def _pivot(H: Matrix, g_free: Vector, active: Mask) -> ContactForces:
    """Block principal pivoting with Murty's rule as backup."""
    n = len(g_free)
    noise = ROUND_OFF * np.abs(g_free).max(initial=0.0)
    force_noise = noise / np.maximum(np.diag(H), np.finfo(float).tiny)
    fewest, attempts = n + 1, BLOCK_ATTEMPTS
    for iteration in range(1, 50 * n + 200):
        forces, slack = _equilibrate(H, g_free, active)
        wrong = np.where(active, forces < -force_noise, slack < -noise)
        count = int(np.count_nonzero(wrong))
        if count == 0:
            forces = np.maximum(forces, 0.0)
            return ContactForces(
                forces=forces, slack=np.maximum(slack, 0.0), active=active, iterations=iteration
            )
        if count < fewest:
            fewest, attempts = count, BLOCK_ATTEMPTS
            active = active ^ wrong
        elif attempts > 0:
            attempts -= 1
            active = active ^ wrong
        else:
            active = active.copy()
            active[np.flatnonzero(wrong)[-1]] ^= True
    message = (
        f"the contact problem of {n} points did not settle; its flexibility matrix is not "
        "positive semidefinite: check that the stiffness matrix is symmetric and the structure held"
    )
    raise ConvergenceError(message)


def _equilibrate(H: Matrix, g_free: Vector, active: Mask) -> tuple[Vector, Vector]:
    """Contact forces that close the active gaps, and the slack of all points.

    Raises ``LinAlgError`` where the active block is singular to working precision.
    """
    index = np.flatnonzero(active)
    forces = np.zeros_like(g_free)
    if len(index) == 0:
        return forces, g_free.copy()
    # H is symmetric, so the transpose is the same block in the column order LAPACK works on.
    factor, failed = lapack.dpotrf(H[np.ix_(index, index)].T, lower=1, overwrite_a=1, clean=0)
    pivots = np.diag(factor)
    if failed or pivots.min() < SINGULAR_PIVOT * pivots.max():
        message = "singular active block"
        raise la.LinAlgError(message)
    forces[index] = lapack.dpotrs(factor, -g_free[index], lower=1)[0]
    # A product with all of H beats gathering its active columns.
    slack = H @ forces + g_free
    slack[index] = 0.0
    return forces, slack


def _proximal_point(H: Matrix, g_free: Vector, active: Mask) -> ContactForces:
    """Solve with H + δ I, feeding δ times the last forces back into the gap until it is closed."""
    delta = PROXIMAL_FRACTION * float(np.diag(H).max())
    regular = H + delta * np.eye(len(g_free))
    tolerance = ROUND_OFF * np.abs(g_free).max()
    forces = np.zeros_like(g_free)
    iterations = 0
    for _ in range(200):
        step = _pivot(regular, g_free - delta * forces, active)
        iterations += step.iterations
        residual = delta * np.abs(step.forces - forces).max()
        forces, active = step.forces, step.active
        if residual <= tolerance:
            slack = np.maximum(H @ forces + g_free, 0.0)
            return ContactForces(forces=forces, slack=slack, active=active, iterations=iterations)
    message = (
        f"hard contact at {len(g_free)} points was not closed to round-off (remaining gap "
        f"{residual:.1e}); use nodal quadrature or a penalty"
    )
    raise ConvergenceError(message)
