"""A compliance by sparse factors in files: the sparse matrix to factorize, and its shapes."""

from dataclasses import dataclass

from faying._typing import Matrix, SparseMatrix
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


def restored(compliance: Matrix | StoredCompliance | None) -> Compliance | None:
    """Return a compliance that a file stored."""
    if not isinstance(compliance, StoredCompliance):
        return compliance
    return SparseCompliance(
        stiffness=SparseStiffness.of(compliance.matrix, compliance.ports),
        shapes=compliance.shapes,
        core=compliance.core,
    )
