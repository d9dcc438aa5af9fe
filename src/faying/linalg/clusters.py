"""Clusters of neighbouring places, by geometric bisection."""

import numpy as np

from faying._typing import Indices, Matrix

CLUSTER = 192
"""Places per cluster at most; near the optimum of a few thousand to some ten thousand places."""


def geometric_clusters(places: Matrix, largest: int = CLUSTER) -> tuple[Indices, ...]:
    """Split places (n, 3) at the median of their longest extent until clusters are small enough.

    Notes
    -----
    O(n log n); clusters of equal size within one, in an order in which neighbours are close.
    """
    done: list[Indices] = []
    waiting = [np.arange(len(places))]
    while waiting:
        members = waiting.pop()
        if len(members) <= largest:
            done.append(members)
            continue
        extent = np.ptp(places[members], axis=0)
        order = np.argsort(places[members, int(extent.argmax())], kind="stable")
        half = len(members) // 2
        waiting += [np.sort(members[order[half:]]), np.sort(members[order[:half]])]
    return tuple(done)
