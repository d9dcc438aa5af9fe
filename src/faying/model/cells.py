"""Cells of solid elements."""

from dataclasses import dataclass, replace

from faying._typing import Frozen, Indices, Mask


@dataclass(frozen=True, eq=False, kw_only=True)
class CellBlock(Frozen):
    """Solid elements of one kind.

    Attributes
    ----------
    kind
        A key of :data:`faying.model.elements.SOLIDS`, as in ``"hex8"``.
    nodes : (n_cell, n_node_per_cell) [into n_node]
        Node indices, in the Nastran order of the element.
    ids : (n_cell,) [1]
        Element ids of the user; unique over all blocks of a mesh.
    properties : (n_cell,) [1]
        Property ids; they name the material through ``Assembly.materials``.
    formulation
        Formulation of these elements, as in ``"reduced"``; empty for that of the assembly.
    """

    kind: str
    nodes: Indices
    ids: Indices
    properties: Indices
    formulation: str = ""

    def taken(self, which: Indices | Mask) -> "CellBlock":
        """Return some of the elements."""
        arrays = {name: getattr(self, name)[which] for name in ("nodes", "ids", "properties")}
        return replace(self, **arrays)
