"""Contact forces as nonnegative combinations of nonnegative vectors, with exact compliance.

λ = W μ with μ ≥ 0 keeps the reduced forces inside the cone of admissible forces: no tension under
any load. The condensed problem (M4) of ``docs/theory/method.md`` keeps its form and has the size
of the basis,

    min ½ μᵀ (Wᵀ H W) μ + (Wᵀ g_free)ᵀ μ   over μ ≥ 0,

the Galerkin reduction of the dual problem on a cone (Balajewicz, Amsallem & Farhat 2016,
arXiv:1503.01000; Benaceur, Ern & Ehrlacher 2020, doi:10.1002/nme.6261).
"""

import heapq
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import nnls

from faying._typing import Indices, Mask, Matrix, Vector, frozen
from faying.contact.dense_points import contact_problem
from faying.digits import SOLVED
from faying.exceptions import refuse_model
from faying.iterations import MOST_STEPS
from faying.reduction.contact_reduction import AnyModel, ReducedContact, with_static_contact


@dataclass(frozen=True, eq=False, kw_only=True)
class ForceBasis:
    """Nonnegative contact force vectors W.

    Attributes
    ----------
    vectors : (n_point, n_force)
        The sum of each is one, so that its coefficient μ is a contact force [force].
    """

    vectors: Matrix

    def __post_init__(self) -> None:
        vectors = np.asarray(self.vectors, dtype=float)
        total = vectors.sum(axis=0)
        if not (vectors >= 0).all() or not (total > 0).all():
            refuse_model("the vectors of a force basis must be nonnegative and none may vanish")
        object.__setattr__(self, "vectors", frozen(vectors / total))

    def __len__(self) -> int:
        return int(self.vectors.shape[1])

    def first(self, count: int) -> "ForceBasis":
        """Return the first ``count`` vectors, a basis of that size if this one is greedy."""
        return replace(self, vectors=self.vectors[:, :count])


@dataclass(frozen=True, eq=False, kw_only=True)
class ForceBasisContact(ReducedContact):
    """The condensed contact problem on the cone of a force basis.

    Attributes
    ----------
    basis
        W.
    """

    basis: ForceBasis

    @cached_property
    def reduced_flexibility(self) -> Matrix:
        """Wᵀ H W (n_force, n_force)."""
        product: Matrix = self.basis.vectors.T @ (self.flexibility @ self.basis.vectors)
        return (product + product.T) / 2

    def pressed(
        self,
        free_gap: Vector,
        active: Mask | None,  # noqa: ARG002  says nothing about the coefficients
    ) -> tuple[Vector, int]:
        """Return contact forces (n_point,) for a free gap, and the linear systems solved."""
        W = self.basis.vectors
        solution = contact_problem(self.reduced_flexibility, W.T @ free_gap).solve()
        return W @ solution.forces, solution.iterations


def with_force_basis(system: AnyModel, basis: ForceBasis) -> AnyModel:
    """Return a system whose contact forces are nonnegative combinations of a force basis.

    ``system`` is the full model, or a reduced one with residual compliance, exact in statics.

    Notes
    -----
    Static cases only. Forms Wᵀ H W once; a case then costs a contact problem of the size of the
    basis and one product with H for the gaps.
    """
    if len(basis.vectors) != system.contact.n_points:
        refuse_model(
            f"the force basis has {len(basis.vectors)} rows but the model "
            f"{system.contact.n_points} contact points; build it from this model's contact forces"
        )
    return with_static_contact(system, ForceBasisContact(whole=system.static_contact, basis=basis))


def cone_projected_greedy(contact_forces: Matrix, *, count: int) -> ForceBasis:
    """Select the snapshots whose cone comes closest to all others.

    The snapshot farthest from the cone of the selected ones is selected next, until there are
    enough or all lie in the cone (cone-projected greedy, Benaceur et al. 2020). Distances are
    relative to the norm of the snapshot, so that weak preloads count like strong ones. Contact
    forces (n_point, n_snapshot) are λ of training runs, see :mod:`faying.reduction.snapshots`.

    Raises
    ------
    ModelError
        If there is no contact force in the snapshots, or a negative one.

    Notes
    -----
    A snapshot's distance can only shrink as the cone grows, so only the largest distances are
    computed again: a few nonnegative least-squares problems per vector.
    """
    unit = _unit_snapshots(contact_forces)
    # Negative upper bound of the distance, the snapshot, and the size of the cone of this bound.
    queue: list[tuple[float, int, int]] = [(-1.0, column, 0) for column in range(unit.shape[1])]
    picked: list[int] = []
    while queue and len(picked) < count:
        bound, column, measured = heapq.heappop(queue)
        if measured == len(picked):
            if -bound <= SOLVED:
                break
            picked.append(column)
            continue
        distance = float(nnls(unit[:, picked], unit[:, column])[1])
        heapq.heappush(queue, (-distance, column, len(picked)))
    return ForceBasis(vectors=unit[:, picked])


def nonnegative_factors(contact_forces: Matrix, *, count: int) -> ForceBasis:
    """Factorize snapshots into nonnegative vectors and nonnegative coefficients.

    Minimizes ‖Y − W V‖ over W, V ≥ 0 (the basis of Balajewicz, Amsallem & Farhat 2016,
    arXiv:1503.01000) by hierarchical alternating least squares (Cichocki & Phan 2009), started from
    the cone-projected greedy vectors. Bases of different size are not nested. Contact forces
    (n_point, n_snapshot) are λ of training runs.

    Raises
    ------
    ModelError
        As :func:`cone_projected_greedy`.
    """
    Y = _unit_snapshots(contact_forces)
    W = cone_projected_greedy(contact_forces, count=count).vectors.copy()
    W /= np.linalg.norm(W, axis=0)
    weights = np.maximum(np.linalg.lstsq(W, Y, rcond=None)[0], 0.0)
    for _ in range(MOST_STEPS):
        weights = _sweep(weights.T, W.T @ W, Y.T @ W).T
        W = _sweep(W, weights @ weights.T, Y @ weights.T)
    return ForceBasis(vectors=W[:, W.any(axis=0)])


def _sweep(factor: Matrix, gram: Matrix, target: Matrix) -> Matrix:
    """Minimize over the columns in turn, with nonnegative entries."""
    factor = factor.copy()
    for column in range(factor.shape[1]):
        if gram[column, column] <= 0:
            continue
        residual = target[:, column] - factor @ gram[:, column]
        factor[:, column] += residual / gram[column, column]
        np.maximum(factor[:, column], 0.0, out=factor[:, column])
    return factor


def _unit_snapshots(contact_forces: Matrix) -> Matrix:
    """Return the snapshots that are not zero, normalized."""
    snapshots = np.asarray(contact_forces, dtype=float)
    if snapshots.ndim != 2 or not np.isfinite(snapshots).all() or (snapshots < 0).any():
        refuse_model(
            f"a force basis needs finite contact forces ≥ 0, one snapshot a column; got shape "
            f"{snapshots.shape}"
        )
    norms = np.linalg.norm(snapshots, axis=0)
    pressed: Indices = np.flatnonzero(norms > 0)
    if not len(pressed):
        refuse_model("no snapshot has any contact force; train with loads that press the interface")
    return np.asarray(snapshots[:, pressed] / norms[pressed])
