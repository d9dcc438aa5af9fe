"""GMRES for systems near one whose factors are at hand."""

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import solve_triangular

Array = npt.NDArray[Any]


def corrected(
    product: Callable[[Array], Array], right: Array, enough: float, limit: int
) -> Array | None:
    """Return v with |b − A v| ≤ enough for the product A v, None where that takes too many.

    One product is taken in any case: b may be small beside what it moves. The product is near the
    identity, as a matrix times what factors of a similar one make of v. The precision of b (n,) is
    kept; the limit is that of products.
    """
    size = float(np.linalg.norm(right))
    if size == 0.0:
        return np.zeros_like(right)
    basis = np.empty((limit + 1, len(right)), dtype=right.dtype)
    basis[0] = right / size
    seen, shares = np.zeros((limit, limit)), np.zeros(limit + 1)
    shares[0] = size
    turns: list[tuple[float, float]] = []
    for k in range(limit):
        u = product(basis[k])
        projections = basis[: k + 1] @ u
        u = u - projections @ basis[: k + 1]
        remainder, column = float(np.linalg.norm(u)), projections.tolist()
        for i, (cosine, sine) in enumerate(turns):
            column[i : i + 2] = (
                cosine * column[i] + sine * column[i + 1],
                cosine * column[i + 1] - sine * column[i],
            )
        length = max(float(np.hypot(column[k], remainder)), np.finfo(float).tiny)
        cosine, sine = column[k] / length, remainder / length
        column[k] = length
        seen[: k + 1, k] = column
        turns.append((cosine, sine))
        shares[k : k + 2] = cosine * shares[k], -sine * shares[k]
        if not np.isfinite(length):
            return None
        if abs(shares[k + 1]) <= enough:
            weights = solve_triangular(seen[: k + 1, : k + 1], shares[: k + 1])
            return np.asarray(weights.astype(right.dtype) @ basis[: k + 1])
        basis[k + 1] = u / max(remainder, np.finfo(right.dtype).tiny)
    return None
