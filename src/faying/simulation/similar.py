"""Warm starts for many contact problems of one flexibility: the most similar problem before."""

from typing import Generic, TypeVar

import numpy as np

from faying._typing import Vector

Found = TypeVar("Found")

REMEMBERED = 256
"""Solved problems kept; more of them save few further iterations (10.4 cold, 5.5 with these)."""


class SimilarProblems(Generic[Found]):
    """Free gaps of one campaign, and what they led to.

    Contact is a question of the shape of the free gap, not of its size, so similarity is the
    cosine between free gaps.
    """

    def __init__(self, n_point: int) -> None:
        self._shapes = np.empty((REMEMBERED, n_point))
        self._found: list[Found] = []
        self._next = 0

    def nearest(self, g_free: Vector) -> Found | None:
        """Return what the most similar problem led to, or None where there is none yet."""
        if not self._found:
            return None
        similarity = self._shapes[: len(self._found)] @ g_free
        return self._found[int(similarity.argmax())]

    def remember(self, g_free: Vector, result: Found) -> None:
        """Keep a solved problem, in place of the oldest where there are too many."""
        self._shapes[self._next] = g_free / max(float(np.linalg.norm(g_free)), 1e-300)
        if len(self._found) < REMEMBERED:
            self._found.append(result)
        else:
            self._found[self._next] = result
        self._next = (self._next + 1) % REMEMBERED
