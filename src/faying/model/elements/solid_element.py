"""Kinds of solid elements: nodes, shape functions, quadrature, faces."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np

from faying._typing import Frozen, Matrix, frozen
from faying.model.elements.elsewhere import Elsewhere
from faying.model.elements.face_kind import QUAD8, TRI6, FaceKind
from faying.model.elements.quadrature import Quadrature

Face = tuple[FaceKind, tuple[int, ...]]
ShapeFunctions = Callable[[Matrix], tuple[Matrix, Matrix]]


@dataclass(frozen=True, eq=False, kw_only=True)
class SolidElement(Frozen):
    """An isoparametric solid element with three displacements per node.

    Attributes
    ----------
    kind
        Kind of the mesh cell, as in ``"hex8"``.
    formulation
        ``"standard"``, or the name of the enhanced formulation.
    reference_nodes : (n_node, 3)
        Reference coordinates of the nodes in Nastran order, corners first.
    n_corners
        Number of corner nodes.
    shape_functions
        Name of the scikit-fem element whose shape functions are used or, where it has none, the
        function itself: points (n_point, 3) to values (n_point, n_node) and gradients
        (n_point, 3, n_node).
    stiffness_quadrature, mass_quadrature
        Functions that return the rules, so that scikit-fem is imported only when needed.
    faces
        Kind and local node indices of each face, in the order of :class:`FaceKind`.
    elsewhere
        Names of the element in the files of other programs.
    brick_cells
        Corners of a brick for each cell into which it is divided; empty where bricks are not
        divided into this kind.
    internal_gradients
        Reference gradients of internal displacement modes that are condensed out of the
        stiffness: points (n_quad, 3) to (n_quad, 3, n_mode); None if there are none.
    hourglass_patterns : (n_node, n_pattern)
        Hourglass motions that springs resist; None for elements that do not need them.
    hourglass_share
        Stiffness of these springs over E V Σ |b_i|², b_i the mean gradient of shape function i.
    """

    kind: str
    reference_nodes: Matrix
    n_corners: int
    shape_functions: str | ShapeFunctions
    stiffness_quadrature: Callable[[], Quadrature]
    mass_quadrature: Callable[[], Quadrature]
    faces: tuple[Face, ...]
    elsewhere: Elsewhere
    brick_cells: tuple[tuple[int, ...], ...]
    formulation: str = "standard"
    internal_gradients: Callable[[Matrix], Matrix] | None = None
    hourglass_patterns: Matrix | None = None
    hourglass_share: float = 5e-4

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.reference_nodes)


_CURVED = {"tri3": TRI6, "quad4": QUAD8}


def mid_sided(linear: SolidElement, edges: str) -> tuple[Matrix, tuple[Face, ...]]:
    """Return nodes and faces of an element with a node in the middle of each edge.

    Edges are given by the two digits of their corners, in the order of their middle nodes.
    """
    ends = [(int(edge[0]), int(edge[1])) for edge in edges.split()]
    corners = linear.reference_nodes
    middle = {frozenset(pair): len(corners) + k for k, pair in enumerate(ends)}
    faces = tuple(
        (
            _CURVED[face.name],
            (*local, *(middle[frozenset(pair)] for pair in pairwise((*local, local[0])))),
        )
        for face, local in linear.faces
    )
    return np.vstack([corners, corners[np.array(ends)].mean(axis=1)]), faces


def shape_values(element: SolidElement, points: Matrix) -> Matrix:
    """Return shape functions at reference points: (n_point, 3) to (n_point, n_node)."""
    if not isinstance(element.shape_functions, str):
        return element.shape_functions(points)[0]
    return np.stack([value for value, _ in _local_basis(element, points)], axis=-1)


def shape_gradients(element: SolidElement, points: Matrix) -> Matrix:
    """Return reference gradients of the shape functions: (n_point, 3) to (n_point, 3, n_node)."""
    if not isinstance(element.shape_functions, str):
        return element.shape_functions(points)[1]
    return np.stack([gradient.T for _, gradient in _local_basis(element, points)], axis=-1)


@cache
def stiffness_gradients(element: SolidElement) -> Matrix:
    """Return reference gradients at the stiffness points (n_quad, 3, n_node)."""
    return frozen(shape_gradients(element, element.stiffness_quadrature().points))


@cache
def corner_gradients(element: SolidElement) -> Matrix:
    """Return reference gradients at the corners (n_corner, 3, n_node)."""
    corners = element.reference_nodes[: element.n_corners]
    return frozen(shape_gradients(element, corners))


@cache
def centre_gradients(element: SolidElement) -> Matrix:
    """Return reference gradients at the centre of the cell (1, 3, n_node)."""
    corners = element.reference_nodes[: element.n_corners]
    return frozen(shape_gradients(element, corners.mean(axis=0, keepdims=True)))


@cache
def mass_tables(element: SolidElement) -> tuple[Matrix, Matrix]:
    """Return shape functions (n_quad, n_node) and their reference gradients at the mass points."""
    points = element.mass_quadrature().points
    return frozen(shape_values(element, points)), frozen(shape_gradients(element, points))


def _local_basis(element: SolidElement, points: Matrix) -> list[tuple[Matrix, Matrix]]:
    basis = _skfem_element(element)
    transposed = np.asarray(points, dtype=float).T
    pairs = [basis.lbasis(transposed, int(i)) for i in _nastran_order(element)]
    shape = (transposed.shape[1],)
    return [(np.broadcast_to(v, shape), np.asarray(g, dtype=float)) for v, g in pairs]


@cache
def _nastran_order(element: SolidElement) -> tuple[int, ...]:
    """Return the index in scikit-fem's nodes of each Nastran node, by reference coordinates."""
    theirs = np.asarray(_skfem_element(element).doflocs)
    distance = np.abs(element.reference_nodes[:, None, :] - theirs[None, :, :]).max(axis=2)
    return tuple(distance.argmin(axis=1).tolist())


@cache
def _skfem_element(element: SolidElement):  # type: ignore[no-untyped-def]  # skfem ships no types
    import skfem

    return getattr(skfem, str(element.shape_functions))()
