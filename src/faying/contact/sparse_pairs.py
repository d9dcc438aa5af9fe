"""Pairs on the springs of closed, sticking points, too many for dense matrices.

A Newton step (Σ + B) d = b is solved with sparse factors (F15) for springs B₀ of an earlier step,
U = (Σ + B₀)⁻¹, and GMRES for the changes since,

    (I + (B − B₀) U) m = (B − B₀) U b,   d = U (b − m),                                    (F7)

until that takes as long as factors for the springs of this step. Factors have symmetric springs:
GMRES treats the dependence of tangential forces on pressure.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NoReturn

import numpy as np
from scipy.linalg import block_diag

from faying._typing import Matrix, SparseMatrix, Vector
from faying.contact.latest import Latest
from faying.contact.point_springs import PointSprings
from faying.exceptions import ConvergenceError
from faying.linalg.gmres import corrected
from faying.linalg.interface import MatrixFactorization
from faying.linalg.singular import NotDefiniteError
from faying.linalg.sparse_compliance import SparseCompliance
from faying.linalg.sparse_stiffness import SparseStiffness, refuse_dense

ACCURATE = 1e-8
"""Smallest required relative residual of a step's system."""

MOST_CORRECTIONS = 20
"""Most products of GMRES; 70 take as long as a factorization, which also speeds up later steps.

A cold case of 3228 points on a cylinder took 4.6 factorizations with 20, 6.2 with 60.
"""


@dataclass(frozen=True, eq=False)
class SparseFactors:
    """Factors of the structure on springs at its points.

    Attributes
    ----------
    K : (n_point, components, components) [force/length]
    springs : (n_relative, n_relative) [force/length]
        B.
    factor
        Of A + Qᵀ B Q (F15).
    across
        z and M of :meth:`SparsePairs.loosened`.
    moved_across : (n_relative, n_spring)
        (Σ + B)⁻¹ zᵀ.
    """

    K: Matrix
    springs: SparseMatrix
    factor: MatrixFactorization
    across: tuple[Matrix, Matrix]
    moved_across: Matrix


@dataclass(frozen=True, eq=False, kw_only=True)
class SparsePairs:
    """Solves (Σ + Gᵀ K G) d = b.

    Attributes
    ----------
    points
        G, displacements at the points (components n_point, n_relative).
    structure
        Σ.
    springs : (components, n_point) [force/length]
        Of points that are closed and stick.
    across : (n_spring, n_relative), (n_spring, n_spring)
        z and M of :meth:`loosened`.
    """

    points: PointSprings
    structure: SparseStiffness
    springs: Matrix
    across: tuple[Matrix, Matrix]
    _latest: Latest[SparseFactors] = field(default_factory=Latest)

    @classmethod
    def of(cls, G: SparseMatrix, springs: Matrix, S: SparseCompliance) -> "SparsePairs":
        """Return the pairs of a structure; arguments as in :meth:`.GluedPairs.of`."""
        points = PointSprings(G=G, components=len(springs))
        return cls(points=points, structure=S.stiffness, springs=springs, across=S.across)

    @property
    def glued(self) -> "SparsePairs":
        """The pairs with all points closed and stuck, by their springs."""
        return self

    @property
    def normal(self) -> None:
        """None: dense matrices along normals would not fit into memory."""

    @property
    def fewest_alike(self) -> float:
        """Infinity: an inverse for cases side by side would not fit into memory."""
        return np.inf

    @property
    def own_stiffness(self) -> Vector:
        """Diagonal of Σ (n_relative,) [force/length], or an upper bound of it."""
        return self.structure.diagonal

    def resisted(self, displacements: Vector) -> Vector:
        """Return Σ w of displacements w (n_relative,)."""
        shapes, yields = self.across
        taken = shapes.T @ np.linalg.solve(yields, shapes @ displacements)
        return np.asarray(self.structure.times(displacements) - taken)

    def about(self, springs: Matrix) -> "SparsePairs":  # noqa: ARG002
        """Return the pairs themselves: factors follow the springs of the steps."""
        return self

    def loosened(self, shapes: Matrix, yields: Matrix) -> "SparsePairs":
        """Return the pairs without some springs across them, as :meth:`.GluedPairs.loosened`."""
        z, M = self.across
        both = np.vstack([z, shapes]), np.asarray(block_diag(M, yields))
        return replace(self, across=both)

    def glued_by(self, springs: Matrix) -> NoReturn:  # noqa: ARG002
        """Refuse: an inverse would not fit into memory."""
        refuse_dense(self.points.G.shape[1])

    def moved_by(self, forces: Vector) -> Vector:
        """Return displacements of pairs with closed, sticking points under forces (n_relative,)."""
        with self._latest.turn:
            return self._moved_by(self._factors(self._stuck), forces)

    def step(
        self, K: Matrix, right: Vector, enough: float, factors: Matrix | None = None
    ) -> tuple[Vector, Vector, Matrix]:
        """Return d, Σ d, and the springs of the factors used, for the next step to start with.

        Factors stay here alone, for memory holds few. Arguments are as in :meth:`.GluedPairs.step`.
        Where GMRES fails with factors of these springs, d is the solution with symmetric springs,
        in which friction bounds are constant.
        """
        enough = max(enough, ACCURATE) * float(np.linalg.norm(right))
        with self._latest.turn:
            moved = None if factors is None else self._corrected(factors, K, right, enough)
            if factors is None or moved is None:
                factors = _symmetric(K)
                moved = self._corrected(factors, K, right, enough)
            if moved is None:
                moved = self._moved_by(self._factors(factors), right)
        return moved, self.resisted(moved), factors

    def _corrected(
        self, factorized: Matrix, K: Matrix, right: Vector, enough: float
    ) -> Vector | None:
        """Return d by (F7), to a residual [force]; None where that takes too many products.

        ``factorized`` are the springs of the factors.
        """
        factors = self._factors(factorized)
        moved = self._moved_by(factors, right)
        change = self.points.between_pairs(K) - factors.springs
        taken = corrected(
            lambda forces: forces + change @ self._moved_by(factors, forces),
            lambda forces: forces,
            np.asarray(change @ moved),
            enough,
            MOST_CORRECTIONS,
        )
        if taken is None or not taken.any():
            return None if taken is None else moved
        return self._moved_by(factors, right - taken)

    def _moved_by(self, factors: SparseFactors, forces: Vector) -> Vector:
        """Return U b for forces (n_relative,), without the springs across the pairs."""
        moved, more = self.structure.moved_by(factors.factor, forces), factors.moved_across
        shapes, yields = self.across
        shared = np.linalg.solve(yields - shapes @ more, shapes @ moved)
        return np.asarray(moved + more @ shared)

    def _factors(self, K: Matrix) -> SparseFactors:
        """Return factors for springs K, formed anew unless they are the latest."""
        latest = self._latest.formed
        if latest is None or not np.array_equal(latest.K, K):
            latest = self._latest.formed = None  # before new ones take as much memory
            springs = self.points.between_pairs(K)
            factor = self._factorized(springs)
        elif latest.across is self.across:
            return latest
        else:
            springs, factor = latest.springs, latest.factor
        moved = self.structure.moved_by(factor, self.across[0].T)
        self._latest.formed = SparseFactors(K, springs, factor, self.across, moved)
        return self._latest.formed

    def _factorized(self, springs: SparseMatrix) -> MatrixFactorization:
        """Return factors of B, in single precision where that serves.

        Newton's method corrects what they lack: on a saddle of 1100 points in as many steps, 0.6 to
        0.7 of the time and half of the memory.
        """
        try:
            return self.structure.on_springs(springs, np.float32)
        except NotDefiniteError:  # up to round-off
            pass
        try:
            return self.structure.on_springs(springs)
        except NotDefiniteError as error:
            message = f"a Newton step cannot be solved: {error}"
            raise ConvergenceError(message) from None

    @cached_property
    def _stuck(self) -> Matrix:
        """K of closed, sticking points."""
        return np.asarray(self.springs.T[:, :, None] * np.eye(len(self.springs)))


def _symmetric(K: Matrix) -> Matrix:
    """Return springs without the dependence of tangential forces on pressure."""
    symmetric = K.copy()
    symmetric[:, 1:, 0] = symmetric[:, 0, 1:] = 0.0
    return np.asarray((symmetric + symmetric.transpose(0, 2, 1)) / 2)
