"""What other programs call a solid element, and how they number its nodes."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices


@dataclass(frozen=True, kw_only=True)
class Elsewhere:
    """A solid element in the files of other programs.

    Attributes
    ----------
    nastran
        Card, whose number of nodes tells the kind.
    nastran_scheme
        IN and ISOP of PSOLID for which Nastran's element is ours; None leaves them blank.
    nastran_lacks
        What Nastran's element has for the blank PSOLID and ours has not; empty if nothing.
    abaqus
        Types of Abaqus and CalculiX that are read as the element, the one that is written first,
        and what differs from each; empty if nothing does. No types where these programs have none.
    meshio
        Name of the cell.
    places
        Place of each of our nodes in the order of Abaqus and meshio; empty where it is ours.
        We number mid-side nodes as Nastran does: bottom, upright, top.
    """

    nastran: str
    nastran_scheme: tuple[str | None, str | None] = (None, None)
    nastran_lacks: str = ""
    abaqus: Mapping[str, str]
    meshio: str
    places: tuple[int, ...] = ()

    def ours(self, nodes: Indices) -> Indices:
        """Return cells (n_cell, n_node) of Abaqus or meshio in our order."""
        return nodes[:, self.places] if self.places else nodes

    def theirs(self, nodes: Indices) -> Indices:
        """Return cells (n_cell, n_node) of ours in the order of Abaqus and meshio."""
        return nodes[:, np.argsort(self.places)] if self.places else nodes
