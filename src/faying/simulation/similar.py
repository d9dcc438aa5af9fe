"""Warm starts for many contact problems of one flexibility: the most similar problem before."""

from dataclasses import replace

import numpy as np

from faying._typing import Mask, Vector
from faying.contact.state import ContactState

REMEMBERED = 256
"""Solved problems kept; more of them save few further iterations (10.4 cold, 5.5 with these)."""


class SimilarProblems:
    """Free gaps of one campaign, and the points in contact they led to.

    Contact is a question of the shape of the free gap, not of its size, so similarity is the
    cosine between free gaps.
    """

    def __init__(self, n_point: int) -> None:
        self._shapes = np.empty((REMEMBERED, n_point))
        self._active: list[Mask] = []
        self._next = 0

    def start(self, g_free: Vector, state: ContactState | None) -> ContactState | None:
        """Return the last state with the points in contact of the most similar problem."""
        if state is None:
            return None
        similarity = self._shapes[: len(self._active)] @ g_free
        return replace(state, active=self._active[int(similarity.argmax())])

    def remember(self, g_free: Vector, active: Mask) -> None:
        """Keep a solved problem, in place of the oldest where there are too many."""
        self._shapes[self._next] = g_free / max(float(np.linalg.norm(g_free)), 1e-300)
        if len(self._active) < REMEMBERED:
            self._active.append(active)
        else:
            self._active[self._next] = active
        self._next = (self._next + 1) % REMEMBERED
