"""Which of many problems are similar."""

import numpy as np

from faying._typing import Indices, Matrix


def similar_groups(vectors: Matrix, size: int) -> list[Indices]:
    """Divide vectors (n, k) into groups of at most a size, similar groups after each other.

    They are halved again and again across the line between two that are far from each other.
    """

    def divided(rows: Indices) -> list[Indices]:
        count = -(-len(rows) // size)
        if count <= 1:
            return [rows] if len(rows) else []
        inside = vectors[rows]
        end = inside[((inside - inside.mean(axis=0)) ** 2).sum(axis=1).argmax()]
        opposite = inside[((inside - end) ** 2).sum(axis=1).argmax()]
        order = rows[np.argsort(inside @ (opposite - end), kind="stable")]
        middle = len(rows) * (count // 2) // count
        return divided(order[:middle]) + divided(order[middle:])

    return divided(np.arange(len(vectors)))
