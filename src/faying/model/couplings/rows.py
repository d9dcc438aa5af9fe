"""Equations for dependent degrees of freedom in terms of others."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from faying._typing import Frozen, Indices, Mask, Matrix, SparseMatrix, Vector
from faying.display.facts import listed
from faying.model.assembly import Assembly
from faying.model.boundary import DISPLACEMENT_NAMES


@dataclass(frozen=True, eq=False, kw_only=True)
class Rows(Frozen):
    """Equations u[dependent] = matrix · u over the 6 n_node degrees of freedom.

    Attributes
    ----------
    dependent : (n_row,)
        Dependent degree of freedom of each equation, 6 · node index + component.
    matrix : (n_row, 6 n_node) sparse
    owner : (n_row,)
        Index into ``labels`` of the coupling behind each equation.
    labels
        Name of each coupling in messages, e.g. ``"rigid coupling 12"``.
    """

    dependent: Indices
    matrix: SparseMatrix
    owner: Indices
    labels: tuple[str, ...]

    def taken(self, which: Mask) -> "Rows":
        """Return the equations where ``which`` (n_row,) holds."""
        return Rows(
            dependent=self.dependent[which],
            matrix=self.matrix[np.flatnonzero(which)],
            owner=self.owner[which],
            labels=self.labels,
        )

    def names(self, which: Mask | Indices) -> str:
        """Return the names of the couplings of some equations, a few of them."""
        return listed(dict.fromkeys(self.labels[i] for i in self.owner[which].tolist()))


def stacked(parts: Sequence[Rows]) -> Rows:
    """Return the equations of several families as one."""
    first = np.cumsum([0, *(len(part.labels) for part in parts)])[:-1]
    return Rows(
        dependent=np.concatenate([part.dependent for part in parts]),
        matrix=sp.vstack([part.matrix for part in parts], format="csr"),
        owner=np.concatenate([p.owner + n for p, n in zip(parts, first, strict=True)]),
        labels=tuple(label for part in parts for label in part.labels),
    )


def sparse_rows(
    shape: tuple[int, int], rows: Indices, columns: Indices, values: Vector
) -> SparseMatrix:
    """Return a CSR matrix from triplets, summed and without zeros."""
    triplets = (values, (rows, columns))
    matrix = sp.coo_array(triplets, shape=shape).tocsr()
    matrix.eliminate_zeros()
    return matrix


def lever_arms(arms: Matrix) -> Matrix:
    """Return matrices B (n, 3, 3) with B θ = θ × r for lever arms r (n, 3)."""
    x, y, z = arms.T
    zero = np.zeros_like(x)
    table = [[zero, z, -y], [-z, zero, x], [y, -x, zero]]
    return np.moveaxis(np.array(table), 2, 0)


def dof_name(assembly: Assembly, dof: int) -> str:
    """Return the name of a degree of freedom: node id and component."""
    node, component = divmod(int(dof), 6)
    return f"node {assembly.mesh.node_ids[node]}, component {DISPLACEMENT_NAMES[component]}"
