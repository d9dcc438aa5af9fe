"""Offsets and pins of CBAR and CBEAM: nodes of their own at the ends of beams.

MSC Nastran Quick Reference Guide, CBAR: offset vectors lead from the grids to the ends, along the
displacement components of the grids, or (O of OFFT) along the axes of an element between the grids;
pin flags name the components of the element (x along it, y
towards the orientation vector) in which an end is not joined to its grid.
"""

from dataclasses import dataclass, field

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.exceptions import FormatError
from faying.io.nastran.cards import Card
from faying.io.nastran.components import components
from faying.io.nastran.grids import Grids
from faying.model.assembly import Equation, RigidCoupling

PINS = (8, 9)
OFFSETS = (10, 13)


@dataclass(kw_only=True)
class BeamEnds:
    """Nodes at the ends of beams that are not those of the deck, and what joins them to those.

    Attributes
    ----------
    first
        Index of the first one.
    grids
        Node of the deck that each of them belongs to.
    """

    first: int
    places: list[Vector] = field(default_factory=list)
    couplings: list[RigidCoupling] = field(default_factory=list)
    equations: list[Equation] = field(default_factory=list)
    grids: list[int] = field(default_factory=list)

    @property
    def nodes(self) -> Matrix:
        """Places (n, 3) of the new nodes."""
        return np.array(self.places, dtype=float).reshape(-1, 3)

    def offset(
        self, card: Card, grids: Grids, end: int, node: int, along: Matrix
    ) -> tuple[int, Vector]:
        """Return the node of an end (0 or 1) and its place, a new one where there is an offset.

        ``along`` (3, 3) are the axes of the element between its grids, for offsets given along
        them.
        """
        vector = np.array([card.real(OFFSETS[end] + j, 0.0) for j in range(3)])
        position = grids.nodes[node]
        if not vector.any():
            return node, position
        of_element = card.text(7)[1 + end : 2 + end] == "O"
        axes = along if of_element else grids.systems.axes(node)
        position = position + (vector if axes is None else vector @ axes)
        if not np.isfinite(position).all():
            card.refuse("the offset is too large for a number", OFFSETS[end])
        new = self._added(position, node)
        coupling = RigidCoupling(
            id=card.integer(0), reference=node, nodes=np.array([new]), components=tuple(range(6))
        )
        self.couplings.append(coupling)
        return new, position

    def pinned(
        self, card: Card, nodes: tuple[int, int], places: tuple[Vector, Vector], axes: Matrix
    ) -> tuple[int, int]:
        """Return the nodes of a beam, new ones where an end has pins.

        What is free to move along or turn about the element at both ends carries nothing: the
        second end keeps it, so that the element does not move by itself.
        """
        first, second = (_released(card, field) for field in PINS)
        released = [c for c in second if not (c in first and c in (0, 3))]
        a = self._hinge(card, nodes[0], places[0], first, axes)
        return a, self._hinge(card, nodes[1], places[1], released, axes)

    def _hinge(
        self, card: Card, node: int, position: Vector, released: list[int], axes: Matrix
    ) -> int:
        if not released:
            return node
        new = self._added(position, node)
        for first in (0, 3):
            rows = np.eye(3)
            if any(first <= c < first + 3 for c in released):
                rows = axes[[c for c in range(3) if first + c not in released]]
            for row in rows:
                terms = []
                for c in np.argsort(-np.abs(row), kind="stable").tolist():
                    if row[c] != 0.0:
                        factor = float(row[c])
                        terms += [(new, first + c, factor), (node, first + c, -factor)]
                self.equations.append(Equation(id=card.integer(0), terms=tuple(terms)))
        return new

    def _added(self, position: Vector, node: int) -> int:
        self.places.append(position)
        self.grids.append(node if node < self.first else self.grids[node - self.first])
        return self.first + len(self.places) - 1

    def ids_behind(self, ids: Indices) -> Indices:
        """Return ids (n,) of the new nodes, behind all others."""
        return int(ids.max(initial=0)) + 1 + np.arange(len(self.places))


def _released(card: Card, field: int) -> list[int]:
    """Return the components 0..5 of a pin flag, none where it is blank or 0."""
    text = card.text(field)
    if text in ("", "0"):
        return []

    def wrong(said: str) -> FormatError:
        return card.error(f"pin flag: {said}", field)

    return list(components(text, wrong))
