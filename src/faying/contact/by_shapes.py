"""A structure with too many pairs for dense matrices, given by the few shapes of its basis."""

from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from scipy.linalg import LinAlgError

from faying._typing import Matrix, Vector
from faying.contact.between_pairs import BetweenPairs, between
from faying.linalg.sparse_compliance import Compliance, plus
from faying.linalg.sparse_stiffness import refuse_dense


@dataclass(frozen=True, eq=False)
class ByShapes:
    """A structure S = X C Xᵀ with fewer shapes than pairs and too many pairs for dense matrices.

    Attributes
    ----------
    shapes : (n_relative, k)
        X.
    core : (k, k) [length/force]
        C, positive definite.
    """

    shapes: Matrix
    core: Matrix

    def __matmul__(self, forces: Matrix) -> Matrix:
        """Return S P."""
        return self.moved_by(forces)

    @property
    def compliance(self) -> Matrix:
        """Refuse: the dense matrix is too large."""
        refuse_dense(len(self.shapes))

    @property
    def stiffness(self) -> Matrix:
        """Refuse: the dense matrix is too large."""
        refuse_dense(len(self.shapes))

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p."""
        return np.asarray(self.shapes @ (self.core @ (self.shapes.T @ forces)))

    def softened(self, residual: Compliance) -> BetweenPairs:
        """Return the structure with a residual compliance added."""
        return between(plus(residual, self.shapes, self.core))

    def alone(self) -> "ByShapes":
        """Return the structure itself."""
        return self

    def spanned(self) -> Matrix:
        """Return Y (n_relative, k)."""
        return np.asarray(self.shapes @ np.linalg.cholesky(self.core))

    @property
    def own_stiffness(self) -> NoReturn:
        """Refuse: S is singular."""
        self.on_springs()

    def on_springs(self, *_: object) -> NoReturn:
        """Refuse: S is singular."""
        message = "fewer shapes than pairs"
        raise LinAlgError(message)
