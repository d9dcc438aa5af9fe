"""Entries of an inverse between a few ports: Q A⁻¹ Qᵀ."""

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix, SparseMatrix
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
    return (compliance + compliance.T) / 2
