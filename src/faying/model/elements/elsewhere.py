"""Names and node order of a solid element in the files of other programs."""

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
        Card; its number of nodes determines the kind.
    nastran_scheme
        IN and ISOP of PSOLID for the same element in Nastran; None leaves them blank.
    nastran_lacks
        Difference from Nastran's element for a blank PSOLID; empty if there is none.
    abaqus
        Types of Abaqus and CalculiX that are read as the element, the written one first, and the
        difference from each; empty if there is none. No types where these programs have none.
    meshio
        Name of the cell.
    places
        Position of each node of faying in the order of Abaqus and meshio; empty for the same
        order. Faying numbers mid-side nodes as Nastran does: bottom, upright, top.
    """

    nastran: str
    nastran_scheme: tuple[str | None, str | None] = (None, None)
    nastran_lacks: str = ""
    abaqus: Mapping[str, str]
    meshio: str
    places: tuple[int, ...] = ()

    def ours(self, nodes: Indices) -> Indices:
        """Return cells (n_cell, n_node) of Abaqus or meshio in the order of faying."""
        return nodes[:, self.places] if self.places else nodes

    def theirs(self, nodes: Indices) -> Indices:
        """Return cells (n_cell, n_node) of faying in the order of Abaqus and meshio."""
        return nodes[:, np.argsort(self.places)] if self.places else nodes
