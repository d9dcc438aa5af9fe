"""The condensed contact problem: convex, dense, the same for every model.

(M3) of ``docs/theory/method.md``: with the gap flexibility H = S + D, (M2), and the gap without
contact forces g_free,

    s = H λ + g_free ≥ 0,   λ ≥ 0,   λᵀ s = 0

is Eq. (15.7) regularized by Eq. (15.12), or Eq. (15.7) itself where D vanishes (hard contact).
"""

from dataclasses import dataclass

import numpy as np

from faying._typing import Mask, Matrix, Vector, frozen
from faying.contact.dense_points import DensePoints
from faying.contact.forces import ContactForces
from faying.exceptions import ModelError

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
        if not np.isfinite(self.g_free).all():
            message = "the gap without contact forces holds NaN or infinity; check loads and model"
            raise ModelError(message)
        if not np.isfinite(self.H).all():
            message = "the contact flexibility holds NaN or infinity; check the model's matrices"
            raise ModelError(message)

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
        return DensePoints(H=self.H).solve(self.g_free, active)


def contact_problem(H: Matrix, g_free: Vector) -> ContactProblem:
    """Return the contact problem of a flexibility matrix and a free gap, for bare matrices."""
    return ContactProblem(H=H, g_free=g_free)
