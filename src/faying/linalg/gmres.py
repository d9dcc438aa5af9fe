"""GMRES for linear systems close to one with known factors."""

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import solve_triangular

Array = npt.NDArray[Any]


def corrected(
    product: Callable[[Array], Array],
    answer: Callable[[Array], Array],
    right: Array,
    enough: float,
    limit: int,
) -> Array | None:
    """Return x with |b − A x| ≤ enough; None if that takes more than ``limit`` products.

    One product A x is always made, since b may be small beside the terms of A x. x is a sum of
    solutions with factors of a similar matrix, in any precision. Their products are known, so the
    precision of the factors does not limit that of x (Y. Saad, SIAM J. Sci. Comput. 14 (1993) 461,
    doi:10.1137/0914028). x has the precision of b (n,).
    """
    size = float(np.linalg.norm(right))
    if size == 0.0:
        return np.zeros_like(right)
    basis = np.empty((limit + 1, len(right)), dtype=right.dtype)
    answers = np.empty((limit, len(right)), dtype=right.dtype)
    basis[0] = right / size
    seen, shares = np.zeros((limit, limit)), np.zeros(limit + 1)
    shares[0] = size
    turns: list[tuple[float, float]] = []
    for k in range(limit):
        answers[k] = answer(basis[k])
        u = product(answers[k])
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
            return np.asarray(weights.astype(right.dtype) @ answers[: k + 1])
        basis[k + 1] = u / max(remainder, np.finfo(right.dtype).tiny)
    return None
