"""Cycles in a history by rainflow counting, ASTM E1049-85 section 5.4.4."""

import numpy as np

from faying._typing import Matrix, Vector


def rainflow(values: Vector) -> Matrix:
    """Return the cycles of a history: ranges and how many of each (n_cycle, 2).

    A count of a half is a range that is not closed.

    Notes
    -----
    One pass over the reversals, by the package ``rainflow``.
    """
    from rainflow import extract_cycles

    cycles = [(size, count) for size, _, count, _, _ in extract_cycles(values.tolist()) if size > 0]
    return np.array(cycles).reshape(-1, 2)
