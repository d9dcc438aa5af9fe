"""The map from the six degrees of freedom of every node to the free ones of the model."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from faying._typing import Frozen, Indices, Matrix, SparseMatrix, read_only
from faying.exceptions import refuse_model


@dataclass(frozen=True, eq=False, kw_only=True)
class DofMap(Frozen):
    """Linear constraints in the form u_node = T u_free.

    Attributes
    ----------
    transformation : (6 n_node, n_dof) sparse
        T; row 6 i + c belongs to component c of node index i. Rows of supported and of unused
        components are empty.
    free : (n_dof,)
        Row of T in which each free degree of freedom appears: with factor one, but where many nodes
        have a loaded mean, of which some are means of groups, equal to the row in rigid motions.
    """

    transformation: SparseMatrix
    free: Indices

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return int(self.transformation.shape[0]) // 6

    @cached_property
    def translations(self) -> SparseMatrix:
        """Rows of T that move the nodes in x, y, z (3 n_node, n_dof)."""
        rows = 6 * np.arange(self.n_nodes)[:, None] + np.arange(3)
        return read_only(self.transformation[rows.ravel()].tocsr())

    def nodal(self, displacement: Matrix) -> Matrix:
        """Return nodal displacements (..., n_node, 6) from free displacements (..., n_dof)."""
        rows = (self.transformation @ np.asarray(displacement).T).T
        return np.asarray(rows).reshape(*np.shape(displacement)[:-1], self.n_nodes, 6)

    def projected(self, matrix: SparseMatrix) -> SparseMatrix:
        """Return Tᵀ A T (n_dof, n_dof) for a symmetric nodal matrix (6 n_node, 6 n_node)."""
        projected = (self.transformation.T @ matrix @ self.transformation).tocsr()
        return ((projected + projected.T) * 0.5).tocsr()

    def index(self, nodes: Indices, components: Indices) -> Indices:
        """Return the free indices of pairs of node index and component."""
        full = 6 * np.asarray(nodes, dtype=np.int64) + np.asarray(components, dtype=np.int64)
        position = np.full(6 * self.n_nodes, -1, dtype=np.int64)
        position[self.free] = np.arange(len(self.free))
        rows: Indices = position[full]
        if np.any(rows < 0):
            refuse_model("a degree of freedom is supported, dependent or unused")
        return rows
