"""Weak supports: springs between two bodies, one of which contact and friction alone would hold."""

from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Frozen, Indices, Matrix, SparseMatrix, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class WeakSupport(Frozen):
    """Springs across the contact of two bodies, in all three directions at three pairs of nodes.

    Attributes
    ----------
    nodes : (n_pair, 2)
        Ids of the nodes, one of each body.
    stiffness : [force/length]
        Stiffness of each spring.
    forces : (3 n_pair, n_dof) [force/length]
        Rows of the spring forces per displacement.
    """

    nodes: Indices
    stiffness: float
    forces: Matrix | SparseMatrix

    def projected(self, vectors: Matrix) -> "WeakSupport":
        """Return the springs in coordinates q of u = vectors q."""
        return replace(self, forces=frozen(np.asarray(self.forces @ vectors)))
