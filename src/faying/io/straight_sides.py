"""Straight sides of elements without a mid-side node; a new node follows the ends."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from faying._typing import Indices, Matrix
from faying.model.assembly import Equation

Side = tuple[int, int]


@dataclass(kw_only=True)
class StraightSides:
    """Sides without a mid-side node; elements that share a side share its new node.

    Attributes
    ----------
    places : (n_node, 3) [length]
        Coordinates of the nodes of the file.
    ids : (n_node,)
    ends
        Node indices of both ends to the index of the new node.
    turning
        Sides of shells, whose nodes have rotations.
    """

    places: Matrix
    ids: Indices
    ends: dict[Side, int] = field(default_factory=dict)
    turning: set[Side] = field(default_factory=set)

    def between(self, starts: Indices, ends: Indices, *, turns: bool) -> Indices:
        """Return the indices (n,) of the new nodes between pairs of nodes (n,)."""
        first = len(self.ids)
        pairs = np.sort(np.column_stack([starts, ends]), axis=1)
        unique, which = np.unique(pairs, axis=0, return_inverse=True)
        sides: list[Side] = [(start, end) for start, end in unique.tolist()]
        if turns:
            self.turning.update(sides)
        middle = [self.ends.setdefault(side, first + len(self.ends)) for side in sides]
        return np.array(middle, dtype=np.int64)[which.ravel()]

    @property
    def nodes(self) -> Matrix:
        """Coordinates (n, 3) of the new nodes."""
        ends = np.array(list(self.ends), dtype=np.int64).reshape(-1, 2)
        return np.asarray(self.places[ends].mean(axis=1))

    @property
    def node_ids(self) -> Indices:
        """Ids (n,) of the new nodes, above all others."""
        return int(self.ids.max()) + 1 + np.arange(len(self.ends))

    def equations(self) -> Iterator[Equation]:
        """Yield equations that make each new node the mean of the ends."""
        for side, node in self.ends.items():
            for c in range(6 if side in self.turning else 3):
                yield Equation(id=0, terms=((node, c, 1.0), *((end, c, -0.5) for end in side)))
