"""Contact forces sampled at a few points and interpolated to all others (DEIM).

The discrete empirical interpolation method of Chaturantabut & Sorensen 2010
(doi:10.1137/090766498), which the seed's reference 2 (Breitfuss, Irschik, Holl & Witteveen 2014)
applies to contact interfaces: with modes U of the contact forces and as many sampling points z,

    λ = E λ_z,   E = U (Zᵀ U)⁻¹,

and only λ_z is evaluated by the contact law. The matrix of the condensed problem, Zᵀ(S E) + D_z, is
not symmetric: there is no energy to minimize, solutions may not exist or not be unique, and
interpolated forces may pull.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg as la

from faying._typing import Frozen, Indices, Mask, Matrix, Vector
from faying.exceptions import ConvergenceError, refuse_model
from faying.iterations import MOST_STEPS
from faying.reduction.contact_reduction import AnyModel, ReducedContact, with_static_contact
from faying.reduction.pod import pod


@dataclass(frozen=True, eq=False, kw_only=True)
class Deim(Frozen):
    """Sampling points of the contact forces and the interpolation from them.

    Attributes
    ----------
    points : (n_sample,)
        Contact points whose forces are evaluated.
    interpolation : (n_point, n_sample)
        E; the identity in the rows of the sampling points.
    """

    points: Indices
    interpolation: Matrix

    def __len__(self) -> int:
        return len(self.points)


@dataclass(frozen=True, eq=False, kw_only=True)
class DeimContact(ReducedContact):
    """The contact problem at the sampling points only.

    Attributes
    ----------
    deim
        Sampling points and interpolation.
    """

    deim: Deim

    @cached_property
    def sampled_flexibility(self) -> Matrix:
        """Gap at the sampling points per force there (n_sample, n_sample), not symmetric."""
        points, law = self.deim.points, self.contact.flexibility
        compliance = self.flexibility[points].copy()
        compliance[np.arange(len(points)), points] -= law[points]
        return compliance @ self.deim.interpolation + np.diag(law[points])

    def pressed(self, free_gap: Vector, active: Mask | None) -> tuple[Vector, int]:
        """Exchange sampling points in contact until all signs are right.

        Raises
        ------
        ConvergenceError
            If that does not end, which DEIM cannot rule out.
        """
        points = self.deim.points
        closed = free_gap[points] < 0 if active is None else active[points]
        sampled, iterations = _exchange(self.sampled_flexibility, free_gap[points], closed)
        return self.deim.interpolation @ sampled, iterations


def deim(contact_forces: Matrix, *, count: int) -> Deim:
    """Choose sampling points by empirical interpolation of contact-force modes.

    Contact forces (n_point, n_snapshot) are λ of training runs, see
    :mod:`faying.reduction.snapshots`. There are ``count`` modes and sampling points, fewer when the
    snapshots have lower rank.

    Raises
    ------
    ModelError
        If the snapshots are not finite or all zero.

    Notes
    -----
    Greedy: each mode is interpolated by the modes before it, and the point of the largest error is
    the next sampling point (Chaturantabut & Sorensen 2010, algorithm 1).
    """
    modes = pod(contact_forces, count=count).vectors
    points = [int(np.abs(modes[:, 0]).argmax())]
    for size in range(1, modes.shape[1]):
        weights = la.solve(modes[points, :size], modes[points, size])
        residual = modes[:, size] - modes[:, :size] @ weights
        points.append(int(np.abs(residual).argmax()))
    interpolation = la.solve(modes[points].T, modes.T).T
    interpolation[points] = np.eye(len(points))
    return Deim(points=np.array(points), interpolation=interpolation)


def with_deim(system: AnyModel, sampling: Deim) -> AnyModel:
    """Return a system whose contact law is evaluated at the sampling points only.

    ``system`` is the full model, or a reduced one with residual compliance, exact in statics.

    Raises
    ------
    ModelError
        If sampling and system have different contact points.

    Notes
    -----
    Static cases only. Pressures between the sampling points may be negative; see the module.
    """
    if len(sampling.interpolation) != system.contact.n_points:
        refuse_model(
            f"the sampling interpolates to {len(sampling.interpolation)} contact points but the "
            f"model has {system.contact.n_points}; build it from this model's contact forces"
        )
    return with_static_contact(system, DeimContact(whole=system.static_contact, deim=sampling))


def _exchange(matrix: Matrix, gap: Vector, closed: Mask) -> tuple[Vector, int]:
    """Solve λ ≥ 0, matrix λ + gap ≥ 0, complementary, by a semismooth Newton method."""
    for iteration in range(1, MOST_STEPS + 1):
        index = np.flatnonzero(closed)
        forces = np.zeros_like(gap)
        if len(index):
            forces[index] = np.linalg.solve(matrix[np.ix_(index, index)], -gap[index])
        slack = matrix @ forces + gap
        next_closed = np.where(closed, forces > 0, slack < 0)
        if (next_closed == closed).all():
            return forces, iteration
        closed = next_closed
    message = (
        f"contact sampled by DEIM at {len(gap)} points did not settle; its matrix is not "
        "symmetric and a solution need not exist: use another number of points, or a force basis"
    )
    raise ConvergenceError(message)
