"""The surface of the solids: facets that belong to one element only."""

from collections import defaultdict

import numpy as np

from faying._typing import Indices, Matrix
from faying.model.assembly import FaceSet
from faying.model.elements import SOLIDS
from faying.model.mesh import Mesh

N_CORNERS = {"tri3": 3, "tri6": 3, "quad4": 4, "quad8": 4}


def exterior_faces(mesh: Mesh) -> tuple[FaceSet, ...]:
    """Find the facets no two elements share.

    Facets that touch another body count as exterior, for they have nodes of their own.

    Parameters
    ----------
    mesh
        Solids of any kind.

    Returns
    -------
    tuple of FaceSet
        One entry per facet kind present; nodes run counter-clockwise seen from outside.

    Notes
    -----
    One sort of all facets of the mesh.
    """
    facets = _facets(mesh)
    if not facets:
        return ()
    keys = np.concatenate([_corner_key(kind, nodes) for kind, nodes in facets.items()])
    _, inverse, counts = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    single = counts[inverse.ravel()] == 1
    split = np.split(single, np.cumsum([len(nodes) for nodes in facets.values()])[:-1])
    return tuple(
        FaceSet(kind=kind, nodes=nodes[keep])
        for (kind, nodes), keep in zip(facets.items(), split, strict=True)
        if keep.any()
    )


def face_normals(mesh: Mesh, faces: FaceSet) -> Matrix:
    """Return the unit outward normals (n_face, 3) of facets, taken from their corners."""
    corners = mesh.nodes[faces.nodes[:, : N_CORNERS[faces.kind]]]
    # The diagonals of a quadrilateral; two edges of a triangle.
    across = corners[:, -1] - corners[:, 1], corners[:, 2] - corners[:, 0]
    normal = np.cross(across[1], across[0])
    unit: Matrix = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    return unit


def _facets(mesh: Mesh) -> dict[str, Indices]:
    """Collect all facets of all elements by kind."""
    found: dict[str, list[Indices]] = defaultdict(list)
    for block in mesh.blocks:
        for kind, local in SOLIDS[block.kind].faces:
            found[kind].append(block.nodes[:, list(local)])
    return {kind: np.concatenate(parts) for kind, parts in found.items()}


def _corner_key(kind: str, nodes: Indices) -> Indices:
    """Sort the corners so that the two elements of an inner facet agree; triangles pad with -1."""
    corners = np.full((len(nodes), 4), -1, dtype=np.int64)
    corners[:, : N_CORNERS[kind]] = nodes[:, : N_CORNERS[kind]]
    return np.sort(corners, axis=1)
