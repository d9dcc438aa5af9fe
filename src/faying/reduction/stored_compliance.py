"""A compliance by sparse factors in files: the sparse matrix to factorize, and its shapes."""

from dataclasses import dataclass

import h5py
import numpy as np

from faying._typing import Matrix, SparseMatrix
from faying.exceptions import refuse_value
from faying.files.described import numbers, sparse_matrix
from faying.linalg.sparse_compliance import Compliance, SparseCompliance
from faying.linalg.sparse_stiffness import SparseStiffness


@dataclass(frozen=True, eq=False, kw_only=True)
class StoredCompliance:
    """S = Q A⁻¹ Qᵀ + X C Xᵀ.

    Attributes
    ----------
    matrix : (n, n) [force/length]
        A (CSR), the stiffness of the full model with its boundary held.
    ports : (n_relative, n) [1]
        Q (CSR), relative displacements of its degrees of freedom.
    shapes : (n_relative, n_shape) [1]
        X.
    core : (n_shape, n_shape) [length/force]
        C.
    """

    matrix: SparseMatrix
    ports: SparseMatrix
    shapes: Matrix
    core: Matrix


def stored(compliance: Compliance | None) -> Matrix | StoredCompliance | None:
    """Return a compliance as a file stores it."""
    if not isinstance(compliance, SparseCompliance):
        return compliance
    return StoredCompliance(
        matrix=compliance.stiffness.matrix,
        ports=compliance.stiffness.ports,
        shapes=compliance.shapes,
        core=compliance.core,
    )


def read_compliance(group: h5py.Group, n_relative: int) -> SparseCompliance:
    """Read a compliance by sparse factors.

    Raises
    ------
    ValueError
        If its parts do not fit together, or are of a version that compressed it.
    """
    if "diagonal" in group:
        refuse_value(
            f"'{group.name}' is compressed, as versions before sparse factors did; reduce the full "
            "model again"
        )
    matrix, ports = (sparse_matrix(group, name) for name in ("matrix", "ports"))
    shapes, core = numbers(group, "shapes"), numbers(group, "core")
    n = matrix.shape[0]
    fits = (
        matrix.shape == (n, n)
        and ports.shape == (n_relative, n)
        and shapes.shape == (n_relative, len(core))
        and core.shape == (len(core), len(core))
    )
    parts = (matrix.data, ports.data, shapes, core)
    if not fits or not all(np.isfinite(part).all() for part in parts):
        refuse_value(f"the parts of '{group.name}' do not fit together, or are not finite")
    return SparseCompliance(stiffness=SparseStiffness.of(matrix, ports), shapes=shapes, core=core)
