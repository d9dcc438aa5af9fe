"""Kinds of element faces and their properties."""

from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class FaceKind:
    """Properties of one kind of faces of solids, for contact, pressures and pictures.

    Nodes run corners first, then mid-sides, counter-clockwise seen from outside; mid-side k lies
    between corners k and k + 1. A node at the centre comes last.

    Attributes
    ----------
    name
        As in ``"quad8"``.
    n_nodes, n_corners
        Numbers of nodes, which differ between kinds, and of corners.
    shape_functions
        Name of the scikit-fem element whose shape functions are used.
    degree, total_degree
        Polynomial degree of the shape functions: along each coordinate, and of all together on a
        parallelogram.
    nodal_weights
        Weights of the quadrature at the nodes and, if there is one more, at the centre; their sum
        is the area of the reference face. Nodes without weight are not quadrature points.
    cells
        Local nodes of the linear cells of a face; ``n_nodes`` is its centre.
    meshio
        Name of the cell.
    """

    name: str
    n_nodes: int
    n_corners: int
    shape_functions: str
    degree: int
    total_degree: int
    nodal_weights: tuple[float, ...]
    cells: tuple[tuple[int, ...], ...]
    meshio: str

    @property
    def linear(self) -> str:
        """Kind of the corners alone, for relative displacements between non-matching meshes."""
        return TRI3.name if self.n_corners == 3 else QUAD4.name

    @property
    def gauss_order(self) -> int:
        """Gauss order exact for ∫ N_i N_j dA on flat faces with straight, evenly divided sides.

        As in :func:`faying.interface.facets.gauss_rule`: a degree on triangles, points in each
        direction on quadrilaterals. Pressure is interpolated like displacement.
        """
        return 2 * self.degree if self.n_corners == 3 else self.degree + 1

    @property
    def pressure_order(self) -> int:
        """Gauss order exact for N times linear pressure times the area vector of curved faces.

        Degree 3d - 1 in all on triangles, 3d in each direction on quadrilaterals.
        """
        return 3 * self.degree - 1 if self.n_corners == 3 else (3 * self.degree + 2) // 2

    @property
    def ring(self) -> tuple[int, ...]:
        """Local nodes around the edge."""
        corners = range(self.n_corners)
        if self.n_nodes == self.n_corners:
            return tuple(corners)
        return tuple(node for k in corners for node in (k, self.n_corners + k))

    @property
    def triangles(self) -> tuple[tuple[int, ...], ...]:
        """Triangles of its nodes that cover the face, with the same orientation."""
        cells = [tuple(node for node in cell if node < self.n_nodes) for cell in self.cells]
        if cells != list(self.cells):
            cells.append(tuple(range(self.n_corners, self.n_nodes)))
        return tuple(triangle for cell in cells for triangle in _fan(cell))


def _fan(cell: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    return ((cell[0], *cell[k : k + 2]) for k in range(1, len(cell) - 1))


TRI3 = FaceKind(
    name="tri3",
    n_nodes=3,
    n_corners=3,
    shape_functions="ElementTriP1",
    degree=1,
    total_degree=1,
    nodal_weights=(1 / 6,) * 3,
    cells=((0, 1, 2),),
    meshio="triangle",
)

QUAD4 = FaceKind(
    name="quad4",
    n_nodes=4,
    n_corners=4,
    shape_functions="ElementQuad1",
    degree=1,
    total_degree=2,
    nodal_weights=(1 / 4,) * 4,
    cells=((0, 1, 2, 3),),
    meshio="quad",
)

TRI6 = FaceKind(
    name="tri6",
    n_nodes=6,
    n_corners=3,
    shape_functions="ElementTriP2",
    degree=2,
    total_degree=2,
    # ∫ N dA of a vertex is zero.
    nodal_weights=(0.0,) * 3 + (1 / 6,) * 3,
    cells=((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    meshio="triangle6",
)

QUAD8 = FaceKind(
    name="quad8",
    n_nodes=8,
    n_corners=4,
    shape_functions="ElementQuadS2",
    degree=2,
    total_degree=3,
    # 3 x 3 Lobatto with the centre: the rule of the eight nodes alone has -A/12 at the corners.
    nodal_weights=(1 / 36,) * 4 + (4 / 36,) * 4 + (16 / 36,),
    cells=((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
    meshio="quad8",
)
