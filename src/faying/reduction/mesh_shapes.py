"""How generalized coordinates move the nodes of the mesh: for pictures and for floating frames."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import final

import numpy as np

from faying._typing import Indices, Matrix, SparseMatrix
from faying.model.cells import CellBlock


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class MeshShapes:
    """The mesh of a reduced model, and its trial vectors as displacements of all nodes.

    Attributes
    ----------
    nodes : (n_node, 3) [length]
    node_ids : (n_node,)
    blocks
        Solid elements.
    vectors : (n_row, n_shape) or None
        Shapes of this model and perhaps of others; None where they were left out.
    columns : (n_mode,)
        Which of them are this model's.
    translations : (3 n_node, n_row) sparse, or None
        What takes the rows of ``vectors`` to the nodes; None where they are the nodes' own.
    """

    nodes: Matrix
    node_ids: Indices
    blocks: Sequence[CellBlock]
    vectors: Matrix | None = None
    columns: Indices = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    translations: SparseMatrix | None = None

    @property
    def modes(self) -> Matrix | None:
        """Displacement of every node per coordinate (n_mode, n_node, 3)."""
        if self.vectors is None:
            return None
        chosen = self.vectors[:, self.columns]
        moved = chosen if self.translations is None else self.translations @ chosen
        return np.ascontiguousarray(moved.T).reshape(len(self.columns), len(self.nodes), 3)
