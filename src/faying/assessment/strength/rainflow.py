"""Cycles in a history by rainflow counting, ASTM E1049-85 section 5.4.4."""

import numpy as np

from faying._typing import Matrix, Vector


def rainflow(values: Vector) -> Matrix:
    """Return the cycles of a history: ranges and how many of each (n_cycle, 2).

    A count of a half is a range that is not closed.

    Notes
    -----
    One pass over the reversals.
    """
    cycles: list[tuple[float, float]] = []
    stack: list[float] = []
    for value in reversals(values).tolist():
        stack.append(value)
        while len(stack) >= 3:
            last, before = abs(stack[-1] - stack[-2]), abs(stack[-2] - stack[-3])
            if last < before:
                break
            if len(stack) == 3:  # the range before holds the start of the history
                cycles.append((before, 0.5))
                del stack[0]
            else:
                cycles.append((before, 1.0))
                del stack[-3:-1]
    cycles += [(float(size), 0.5) for size in np.abs(np.diff(stack))]
    return np.array(cycles).reshape(-1, 2)


def reversals(values: Vector) -> Vector:
    """Return where a history turns, with its ends."""
    differing = np.append(True, np.diff(values) != 0)
    unequal: Vector = np.asarray(values)[differing]
    if len(unequal) < 3:
        return unequal
    turns = np.diff(np.sign(np.diff(unequal))) != 0
    turning: Vector = unequal[np.concatenate([[True], turns, [True]])]
    return turning
