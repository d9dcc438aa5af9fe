"""The flexibility between contact points as one dense matrix, for every law and penalty."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg as la
from scipy.linalg import blas, lapack

from faying._typing import Indices, Mask, Matrix, Vector, frozen
from faying.contact.active_set import ROUND_OFF, ContactForces, solve_complementarity
from faying.contact.increment import check_flexibility, check_gaps
from faying.exceptions import ModelError

SINGULAR_PIVOT = 1e-7
"""Smallest over largest Cholesky pivot (condition 1e14) below which a block counts as singular."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DensePoints:
    """H (n_point, n_point) [length/force]; each linear system factorizes an active block."""

    H: Matrix
    noise: float = ROUND_OFF

    @cached_property
    def diagonal(self) -> Vector:
        """Diagonal of H."""
        return np.diag(self.H).copy()

    def product(self, forces: Vector) -> Vector:
        """Return H λ."""
        return self.H @ forces

    def closing(self, points: Indices, added: Vector) -> Callable[[Matrix], Matrix]:
        """Return a function from gaps (n, k) at points to the forces (n, k) that close them."""
        # H is symmetric, so the transpose is the same block in the column order LAPACK works on.
        block = self.H.take(points, axis=0)[:, points].T
        block[np.diag_indices_from(block)] += added
        factor, failed = lapack.dpotrf(block, lower=1, overwrite_a=1, clean=0)
        pivots = np.diag(factor)
        rigid = pivots[added == 0.0].min(initial=np.inf)
        if failed or rigid < SINGULAR_PIVOT * pivots.max(initial=0.0):
            message = "singular active block"
            raise la.LinAlgError(message)

        def forces(gaps: Matrix) -> Matrix:
            if not len(points):
                return gaps
            half = blas.dtrsm(-1.0, factor, gaps, lower=1)
            return np.asarray(blas.dtrsm(1.0, factor, half, lower=1, trans_a=1, overwrite_b=1))

        return forces


__all__ = ["ContactForces", "ContactProblem", "contact_problem"]


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactProblem:
    """min ½ λᵀ H λ + g_freeᵀ λ over λ ≥ 0, (M4).

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
        check_gaps(self.g_free)
        check_flexibility(self.H)

    def solve(self, *, active: Mask | None = None) -> ContactForces:
        """Solve by the primal-dual active set of :func:`~.active_set.solve_complementarity`.

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
        return solve_complementarity(DensePoints(H=self.H), self.g_free, active)


def contact_problem(H: Matrix, g_free: Vector) -> ContactProblem:
    """Return the contact problem of a flexibility matrix and a free gap, for bare matrices.

    Examples
    --------
    >>> import faying as fy
    >>> import numpy as np
    >>> flexibility, gap = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-1.0, 1.0])
    >>> fy.contact_problem(flexibility, gap).solve().forces
    array([0.5, 0. ])
    """
    return ContactProblem(H=H, g_free=g_free)
