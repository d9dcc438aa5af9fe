"""GMRES for systems near one whose factors are at hand."""

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
    """Return x with |b − A x| ≤ enough, None where that takes too many products.

    One product A x is taken in any case: b may be small beside what it moves. x is a sum of what
    factors of a similar matrix answer in any precision, whose products are known, so that it loses
    nothing to them (Y. Saad, SIAM J. Sci. Comput. 14 (1993) 461, doi:10.1137/0914028). The
    precision of b (n,) is kept; the limit is that of products.
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
