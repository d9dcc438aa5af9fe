"""Degrees of freedom of an assembly in a deck with three translations per node.

Nodes of CalculiX have no rotations. A node whose rotations the structure uses gets a
second node, whose translations 1, 2, 3 are these rotations; couplings become equations.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Mask, Vector
from faying.exceptions import refuse
from faying.model.assembly import Assembly
from faying.model.constraints import all_rows
from faying.model.couplings.rows import Rows
from faying.model.couplings.support import fixed_components
from faying.model.matrices import used_components

Term = tuple[int, int, float]
"""Node id of the deck, degree of freedom 1, 2 or 3, coefficient."""


@dataclass(frozen=True, eq=False, kw_only=True)
class WrittenNodes:
    """Nodes of a deck for the degrees of freedom of an assembly.

    Attributes
    ----------
    ids : (n_node,)
        Node ids of translations.
    rotations : (n_node,)
        Node ids of rotations; 0 where the structure uses none.
    """

    ids: Indices
    rotations: Indices

    @property
    def largest(self) -> int:
        """The largest node id in use."""
        return int(max(self.ids.max(initial=0), self.rotations.max(initial=0)))

    def place(self, dof: int) -> tuple[int, int]:
        """Return node id and degree of freedom of ``dof`` = 6 · node index + component."""
        node, component = divmod(dof, 6)
        if component < 3:
            return int(self.ids[node]), component + 1
        if not self.rotations[node]:
            refuse(
                f"node {self.ids[node]} has no rotations, but a load or spring acts on one; "
                "move it to a node that a coupling or beam holds"
            )
        return int(self.rotations[node]), component - 2


def written_equations(assembly: Assembly) -> tuple[Rows, Mask]:
    """Return couplings, equations and inclined supports as rows, and the held dofs (6 n_node,).

    Rows are as :func:`faying.model.constraints.constrain` eliminates them.
    """
    fixed = fixed_components(assembly)
    return all_rows(assembly, used_components(assembly), fixed, np.zeros_like(fixed)), fixed


def written_nodes(assembly: Assembly, rows: Rows) -> WrittenNodes:
    """Return nodes of the deck, with a second one for each node whose rotations are used."""
    n_node = len(assembly.mesh.nodes)
    rotating = used_components(assembly).copy()
    rotating[rows.dependent] = True
    rotating[rows.matrix.indices[rows.matrix.data != 0]] = True
    which = np.flatnonzero(rotating.reshape(n_node, 6)[:, 3:].any(axis=1))
    ids = assembly.mesh.node_ids
    rotations = np.zeros(n_node, dtype=np.int64)
    rotations[which] = ids.max(initial=0) + 1 + np.arange(len(which))
    return WrittenNodes(ids=ids, rotations=rotations)


def equation_terms(rows: Rows, nodes: WrittenNodes, fixed: Mask) -> Iterator[list[Term]]:
    """Yield the terms of each equation, the dependent one first.

    Held degrees of freedom drop out; those that depend on nothing else are held.
    """
    matrix = rows.matrix.tocsr()
    for row, dependent in enumerate(rows.dependent.tolist()):
        part = slice(matrix.indptr[row], matrix.indptr[row + 1])
        terms: list[Term] = [(*nodes.place(dependent), 1.0)]
        for dof, value in zip(
            matrix.indices[part].tolist(), matrix.data[part].tolist(), strict=True
        ):
            if value != 0 and not fixed[dof]:
                terms.append((*nodes.place(dof), -value))
        yield terms


def held(nodes: WrittenNodes, fixed: Mask) -> list[tuple[int, int]]:
    """Return node and direction of held degrees of freedom, without rotations of solids."""
    return sorted(
        nodes.place(dof)
        for dof in np.flatnonzero(fixed).tolist()
        if dof % 6 < 3 or nodes.rotations[dof // 6]
    )


def rotation_coordinates(assembly: Assembly, nodes: WrittenNodes) -> list[tuple[int, Vector]]:
    """Return id and coordinates of the nodes added for rotations."""
    which = np.flatnonzero(nodes.rotations)
    return [(int(nodes.rotations[i]), assembly.mesh.nodes[i]) for i in which.tolist()]


def real_text(value: float) -> str:
    """Return a number with thirteen digits and a point, which *SPRING needs for reals.

    It has at most twenty columns, the width that CalculiX reads.
    """
    mantissa, e, exponent = f"{value:.13g}".partition("e")
    return mantissa + ("" if "." in mantissa else ".") + e + exponent
