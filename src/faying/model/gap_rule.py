"""What a deck says of the gap its contact starts with, where that is not the gap of the mesh."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False, kw_only=True)
class GapRule:
    """Initial gap of an interface as its deck wants it.

    Attributes
    ----------
    value : [length]
        The gap everywhere, whatever the mesh has; None leaves it to the mesh.
    closed_up_to : [length]
        Minus nodes whose gap is at most this start in contact, without strain, as if they had been
        moved onto the plus side: 0 for those that penetrate, ``inf`` for all.
    closed_nodes
        Ids of minus nodes that start in contact whatever their gap.
    """

    value: float | None = None
    closed_up_to: float = -np.inf
    closed_nodes: tuple[int, ...] = ()
