"""Entries of an inverse between a few ports: Q A⁻¹ Qᵀ."""

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix
from faying.linalg.compressed import CompressedCompliance, compress, symmetrized
from faying.linalg.factorization import Factorization

COLUMN_BLOCK = 256
"""Right-hand sides solved at once; bounds the memory of dense intermediates."""


def port_compliance(ports: SparseMatrix | Matrix, factor: Factorization) -> Matrix:
    """Compute Q A⁻¹ Qᵀ (n_port, n_port) for ports Q (n_port, n), sparse or dense.

    Notes
    -----
    One back-substitution per port, ``COLUMN_BLOCK`` at a time.
    """
    compliance = np.empty((ports.shape[0], ports.shape[0]))
    for start in range(0, ports.shape[0], COLUMN_BLOCK):
        rows = ports[start : start + COLUMN_BLOCK]
        dense = rows.toarray() if isinstance(rows, sp.sparray) else rows
        compliance[:, start : start + COLUMN_BLOCK] = ports @ factor.solve(dense.T)
    return symmetrized(compliance)


def compressed_port_compliance(
    ports: SparseMatrix, factor: Factorization, places: Matrix
) -> CompressedCompliance:
    """Compute Q A⁻¹ Qᵀ as :func:`port_compliance`, in compressed form.

    Parameters
    ----------
    places : (n_port, 3) [length]
        Where the ports are.

    Notes
    -----
    One back-substitution per port, a cluster at a time.
    """

    def columns(members: Indices) -> Matrix:
        column: Matrix = ports @ factor.solve(ports[members].toarray().T)
        return column

    return compress(columns, places)
