"""Compliance S or stiffness Σ = S⁻¹ of the structure between its node pairs.

Reduced models store S. For a full model Σ is a Schur complement, and S is its inverse, which is
formed on demand. Where dense matrices would not fit into memory, sparse factors give products
with both.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, TypeAlias

import numpy as np
from scipy.linalg import lapack

from faying._typing import Matrix, SparseMatrix, Vector, frozen
from faying.contact.glued_pairs import GluedPairs
from faying.contact.latest import Latest
from faying.contact.sparse_pairs import SparsePairs
from faying.linalg.cholesky import inverse
from faying.linalg.sparse_compliance import Compliance, SparseCompliance
from faying.linalg.sparse_stiffness import refuse_dense

REGULAR = 1e-11
"""Smallest over largest squared pivot of S above which its inverse is used.

With weak springs of 1 N/mm it is 1e-7, for a basis of fewer modes than pairs 1e-16.
"""

Pressed: TypeAlias = Callable[[], Vector | None] | None
"""Function that returns the points (n_point,) under the bolts, for :meth:`.GluedPairs.of`."""


class BetweenPairs(Protocol):
    """Compliance and stiffness of a structure between its node pairs."""

    @property
    def compliance(self) -> Matrix:
        """S (n_relative, n_relative) [length/force] as a dense matrix.

        Raises
        ------
        ModelError
            If the matrix exceeds the memory for it.
        """

    @property
    def stiffness(self) -> Matrix:
        """Σ (n_relative, n_relative) [force/length] as a dense matrix.

        Raises
        ------
        ModelError
            If the matrix exceeds the memory for it.
        LinAlgError
            If S is not positive definite beyond round-off.
        """

    @property
    def own_stiffness(self) -> Vector:
        """Diagonal of Σ (n_relative,) [force/length], or an upper bound of it.

        Raises
        ------
        LinAlgError
            If S is not positive definite beyond round-off.
        """

    def __matmul__(self, forces: Matrix) -> Matrix:
        """Return S P (n_relative, k) [length] for k columns of forces between the pairs."""

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p (n_relative,) [length] for forces p between the pairs."""

    def softened(self, residual: Compliance) -> "BetweenPairs":
        """Return the structure with a residual compliance added."""

    def alone(self) -> "BetweenPairs":
        """Return the structure without the matrices from which it was condensed."""

    def spanned(self) -> Matrix:
        """Return a factor Y (n_relative, rank) with S = Y Yᵀ."""

    def on_springs(
        self, G: SparseMatrix, springs: Matrix, pressed: Pressed
    ) -> GluedPairs | SparsePairs:
        """Return the solver of Newton steps; arguments as in :meth:`.GluedPairs.of`.

        Raises
        ------
        LinAlgError
            If S is not positive definite beyond round-off.
        """


@dataclass(frozen=True, eq=False)
class _Shared:
    """Pairs on springs, with the arguments from which they were formed."""

    G: SparseMatrix
    springs: Matrix
    held: Vector | None
    pairs: GluedPairs

    def is_formed_from(self, G: SparseMatrix, springs: Matrix, held: Vector | None) -> bool:
        """Return whether these pairs were formed from the same rows, springs and pressed points."""
        mine = self.G.shape, self.G.indptr, self.G.indices, self.G.data, self.springs, self.held
        theirs = G.shape, G.indptr, G.indices, G.data, springs, held
        return all(map(np.array_equal, mine, theirs))


@dataclass(frozen=True, eq=False)
class Stiffness:
    """Σ of a structure; all its models share the pairs on springs formed from it.

    Attributes
    ----------
    stiffness : (n_relative, n_relative) [force/length]
        Σ.
    """

    stiffness: Matrix

    @property
    def compliance_for_steps(self) -> Matrix:
        """S without the digits that weak springs cost, in a third of the time."""
        return inverse(self.stiffness)

    @cached_property
    def _latest(self) -> Latest[_Shared]:
        return Latest()

    def on_springs(self, G: SparseMatrix, springs: Matrix, pressed: Pressed) -> GluedPairs:
        """Return the solver of Newton steps; its inverses are formed once for all callers."""
        held, latest = None if pressed is None else pressed(), self._latest
        with latest.turn:
            shared = latest.formed
            if shared is None or not shared.is_formed_from(G, springs, held):
                shared = latest.formed = None  # before new ones take as much memory
                # Without a reference to self: a cycle would hold memory until garbage collection.
                apart = Stiffness(self.stiffness)
                pairs = GluedPairs.of(G, springs, apart, lambda: held)
                shared = latest.formed = _Shared(G, springs, held, pairs)
            return shared.pairs


@dataclass(frozen=True, eq=False)
class ByCompliance:
    """A structure given by its compliance.

    Attributes
    ----------
    compliance : (n_relative, n_relative) [length/force]
        S.
    known
        Σ, where it is known already.
    """

    compliance: Matrix
    known: Stiffness | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "compliance", frozen(self.compliance))

    def __matmul__(self, forces: Matrix) -> Matrix:
        """Return S P."""
        return self.compliance @ forces

    @property
    def compliance_for_steps(self) -> Matrix:
        """S."""
        return self.compliance

    @cached_property
    def stiffness(self) -> Matrix:
        """Σ."""
        if self.known is not None:
            return self.known.stiffness
        return inverse(self.compliance, REGULAR)

    @property
    def own_stiffness(self) -> Vector:
        """Diagonal of Σ."""
        return np.diag(self.stiffness)

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p."""
        return self.compliance @ forces

    def softened(self, residual: Compliance) -> "ByCompliance":
        """Return the structure with a residual compliance added."""
        return ByCompliance(np.asarray(self.compliance + np.asarray(residual)))

    def alone(self) -> "ByCompliance":
        """Return the structure itself."""
        return self

    def spanned(self) -> Matrix:
        """Return Y (n_relative, rank), by Cholesky with pivots."""
        factor, order, rank, _ = lapack.dpstrf(self.compliance, lower=1)
        shapes = np.zeros_like(factor)
        shapes[order - 1] = np.tril(factor)
        return np.ascontiguousarray(shapes[:, :rank])

    def on_springs(self, G: SparseMatrix, springs: Matrix, pressed: Pressed) -> GluedPairs:
        """Return the solver of Newton steps, by dense inverses."""
        if self.known is not None:
            return self.known.on_springs(G, springs, pressed)
        return GluedPairs.of(G, springs, self, pressed)


@dataclass(frozen=True, eq=False)
class ByStiffness:
    """A structure given by its stiffness, so that weak springs cost no digits.

    Attributes
    ----------
    known
        Σ.
    moved_by
        Function from forces between the pairs to S p (n_relative,) [length].
    form_compliance
        Function that returns S.
    """

    known: Stiffness
    moved_by: Callable[[Vector], Vector]
    form_compliance: Callable[[], Matrix]

    @property
    def stiffness(self) -> Matrix:
        """Σ."""
        return self.known.stiffness

    @cached_property
    def compliance(self) -> Matrix:
        """S."""
        return self.form_compliance()

    @property
    def own_stiffness(self) -> Vector:
        """Diagonal of Σ."""
        return np.diag(self.stiffness)

    def __matmul__(self, forces: Matrix) -> Matrix:
        """Return S P."""
        return self.compliance @ forces

    def softened(self, residual: Compliance) -> ByCompliance:
        """Return the structure with a residual compliance added."""
        return ByCompliance(self.compliance).softened(residual)

    def alone(self) -> ByCompliance:
        """Return the structure as compliance and stiffness alone."""
        return ByCompliance(self.compliance, self.known)

    def spanned(self) -> Matrix:
        """Return Y (n_relative, rank)."""
        return ByCompliance(self.compliance).spanned()

    def on_springs(self, G: SparseMatrix, springs: Matrix, pressed: Pressed) -> GluedPairs:
        """Return the solver of Newton steps, by dense inverses."""
        return self.known.on_springs(G, springs, pressed)


@dataclass(frozen=True, eq=False)
class BySubstitution:
    """A structure with too many pairs for dense matrices between them.

    Attributes
    ----------
    total
        S, by sparse factors.
    """

    total: SparseCompliance

    def __matmul__(self, forces: Matrix) -> Matrix:
        """Return S P."""
        return self.total @ forces

    @property
    def compliance(self) -> Matrix:
        """Refuse: the dense matrix is too large."""
        refuse_dense(self.total.shape[0])

    @property
    def stiffness(self) -> Matrix:
        """Refuse: the dense matrix is too large."""
        refuse_dense(self.total.shape[0])

    @property
    def own_stiffness(self) -> Vector:
        """Diagonal of Σ, or an upper bound of it."""
        return self.total.stiffness.diagonal

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p."""
        return self.total @ forces

    def softened(self, residual: Compliance) -> ByCompliance:
        """Refuse: full models have no residual compliance."""
        return ByCompliance(self.compliance).softened(residual)

    def alone(self) -> "BySubstitution":
        """Return the structure itself."""
        return self

    def spanned(self) -> Matrix:
        """Refuse: the dense matrix is too large."""
        return self.compliance

    def on_springs(
        self,
        G: SparseMatrix,
        springs: Matrix,
        _: Pressed = None,
    ) -> SparsePairs:
        """Return the solver of Newton steps, by sparse factors."""
        return SparsePairs.of(G, springs, self.total)


def between(compliance: Compliance) -> ByCompliance | BySubstitution:
    """Return the structure with a given compliance between its pairs."""
    if isinstance(compliance, SparseCompliance):
        return BySubstitution(compliance)
    return ByCompliance(compliance)
