"""Linear cells of quadratic facets, for clipping."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Frozen, Indices, Matrix, Vector
from faying.interface.curved_surface import arc_heights
from faying.interface.facets import shape_functions
from faying.model.elements import FACES
from faying.model.surface import Facets, facet_centres, facet_normals, padded, rows_by_kind


@dataclass(frozen=True, eq=False, kw_only=True)
class Cells(Frozen):
    """Linear facets, each a part of one facet.

    Attributes
    ----------
    points : (n_point, 3) [length]
        Nodes of the mesh and centres of facets that have no node there.
    facets : (n_cell)
        Cells as indices into these points.
    parents : (n_cell,)
        Facet that contains each cell.
    """

    points: Matrix
    facets: Facets
    parents: Indices

    @property
    def corners(self) -> Matrix:
        """Corners in space (n_cell, 4, 3); triangles repeat their last one."""
        return self.points[self.facets.corners]

    @property
    def centres(self) -> Matrix:
        """Mean corner of each cell (n_cell, 3)."""
        return facet_centres(self.points, self.facets)

    @property
    def normals(self) -> Matrix:
        """Unit outward normal of each cell (n_cell, 3)."""
        return facet_normals(self.points, self.facets)

    @property
    def arcs(self) -> Vector:
        """Estimated height of the surface over each cell (n_cell,)."""
        return arc_heights(self.corners, self.facets, self.normals)


def divided(nodes: Matrix, facets: Facets) -> Cells:
    """Divide quadratic facets into four linear cells each; linear facets are one cell.

    With chords of half the length the cells follow curved sides four times as closely.
    """
    points = [nodes]
    tables: list[Indices] = [facets.nodes[:0]]
    parents: list[Indices] = [np.empty(0, dtype=np.int64)]
    for kind, rows in rows_by_kind(facets.nodes).items():
        face = FACES[kind]
        table, local = facets.nodes[rows, : face.n_nodes], np.array(face.cells)
        if local.max() == face.n_nodes:
            shape = shape_functions(kind, np.array([[0.5, 0.5]]))[0]
            centres = sum(map(len, points)) + np.arange(len(rows))
            points.append(np.einsum("a,fad->fd", shape, nodes[table]))
            table = np.column_stack([table, centres])
        tables.append(padded(table[:, local].reshape(-1, local.shape[1])))
        parents.append(np.repeat(rows, len(local)))
    parent = np.concatenate(parents)
    source = facets.taken(parent)
    order = np.argsort(parent, kind="stable")
    cells = Facets(
        nodes=np.concatenate(tables),
        elements=source.elements,
        properties=source.properties,
        bodies=source.bodies,
    )
    return Cells(points=np.concatenate(points), facets=cells.taken(order), parents=parent[order])
