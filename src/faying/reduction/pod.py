"""Proper orthogonal decomposition, Eqs. (15.20) to (15.22)."""

from dataclasses import dataclass

import numpy as np
import scipy.linalg as la

from faying._typing import Matrix, SparseMatrix, Vector
from faying.digits import ROUND_OFF
from faying.exceptions import ModelError, refuse_model
from faying.linalg.sparse_compliance import Compliance


@dataclass(frozen=True, eq=False, kw_only=True)
class Pod:
    """Proper orthogonal modes.

    Attributes
    ----------
    vectors : (n, n_mode)
        Orthonormal in the inner product W, most energetic first.
    singular_values : (n_mode,)
        √λ_i of Eq. (15.22a).
    discarded : float
        Fraction of Σ‖y_j‖²_W outside the span of the modes.
    """

    vectors: Matrix
    singular_values: Vector
    discarded: float


def pod(
    snapshots: Matrix, *, inner: SparseMatrix | Compliance | None = None, count: int | None = None
) -> Pod:
    """Return the modes that represent a collection of snapshots best, Eq. (15.20).

    Parameters
    ----------
    snapshots : (n, n_snapshot)
        Y, one snapshot a column.
    inner : (n, n), optional
        W of Eq. (15.21), symmetric positive definite; by default the identity.
    count
        Largest number of modes; fewer are returned when the snapshots have lower rank.

    Raises
    ------
    ModelError
        If the snapshots are not finite or all zero, or W is not positive definite on them.

    Notes
    -----
    QR of the snapshots, Cholesky of W projected on Q, SVD of a small matrix: this resolves
    singular values down to round-off, the eigenproblem (15.22) only to its square root.

    Examples
    --------
    >>> import numpy as np
    >>> pod(np.array([[3.0, 0.0], [0.0, 2.0], [0.0, 0.0]])).singular_values
    array([3., 2.])
    """
    Y = np.asarray(snapshots, dtype=float)
    if Y.ndim != 2 or not np.isfinite(Y).all() or not Y.any():
        refuse_model(
            f"POD needs a finite, nonzero matrix with one snapshot a column; got shape {Y.shape}"
        )
    basis, triangle = la.qr(Y, mode="economic")
    if inner is not None:
        try:
            factor = la.cholesky(basis.T @ (inner @ basis), lower=True)
        except la.LinAlgError:
            message = "the inner product of the POD is not positive definite on the snapshots"
            raise ModelError(message) from None
        basis = la.solve_triangular(factor, basis.T, lower=True).T
        triangle = factor.T @ triangle
    left, values, _ = la.svd(triangle, full_matrices=False)
    significant = int(np.count_nonzero(values > ROUND_OFF * values[0]))
    n_kept = significant if count is None else min(count, significant)
    return Pod(
        vectors=(basis @ left)[:, :n_kept],
        singular_values=values[:n_kept],
        discarded=float((values[n_kept:] ** 2).sum() / (values**2).sum()),
    )
