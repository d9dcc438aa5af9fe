"""Checks of a stored reduced model beyond the shapes of its arrays."""

from collections.abc import Mapping

import h5py
import numpy as np

from faying._typing import Indices, Matrix
from faying.digits import DECK_DIGITS
from faying.exceptions import refuse_value
from faying.interface.surface import ContactSurface
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.reduction.model_data import MeshShapes


def check_definite(matrix: Matrix, entry: str) -> None:
    """Refuse a symmetric matrix with negative eigenvalues: contact would not converge."""
    largest = np.abs(matrix).max(initial=0.0)
    if largest == 0:
        return
    if np.abs(matrix - matrix.T).max() > DECK_DIGITS * largest:
        refuse_value(f"'{entry}' is not symmetric")
    diagonal = np.diag(matrix)
    # Scaled, because coordinates have different units, which do not change signs.
    scale = 1 / np.sqrt(np.where(diagonal > np.finfo(float).eps * largest, diagonal, largest))
    try:
        np.linalg.cholesky(matrix * scale * scale[:, None] + DECK_DIGITS * np.eye(len(matrix)))
    except np.linalg.LinAlgError:
        message = f"'{entry}' has negative eigenvalues"
        raise ValueError(message) from None


def check_finite(group: h5py.Group) -> None:
    """Refuse numbers that are not finite; a penalty may be infinite, which is hard contact."""

    def look(name: str, node: h5py.Group | h5py.Dataset) -> None:
        if isinstance(node, h5py.Dataset) and node.dtype.kind == "f":
            values = node[()]
            wrong = np.isnan(values) if name.endswith("penalty") else ~np.isfinite(values)
            if np.any(wrong):
                refuse_value(f"'{node.name}' holds numbers that are not finite")

    group.visititems(look)


def check_distinct(indices: Indices, length: int, entry: str) -> None:
    """Refuse indices beyond a length, and one that occurs twice."""
    if len(indices) and not 0 <= indices.min() <= indices.max() < length:
        refuse_value(f"'{entry}' points beyond the {length} coordinates")
    if len(np.unique(indices)) < len(indices):
        refuse_value(f"'{entry}' names a coordinate twice")


def check_nodes(nodes: Indices, components: Indices, mesh: MeshShapes, entry: str) -> None:
    """Refuse degrees of freedom of unknown nodes or components, and repeated ones."""
    missing = nodes[~np.isin(nodes, mesh.node_ids)]
    if len(missing):
        refuse_value(f"'{entry}/nodes' names node {missing[0]}, which is not among the nodes")
    if len(components) and not 0 <= components.min() <= components.max() < len(DISPLACEMENT_NAMES):
        refuse_value(f"'{entry}/components' holds others than 0 to {len(DISPLACEMENT_NAMES) - 1}")
    if len(np.unique(np.stack([nodes, components]), axis=1).T) < len(nodes):
        refuse_value(f"'{entry}' names a degree of freedom twice")


def check_surfaces(interfaces: Mapping[str, ContactSurface], mesh: MeshShapes) -> None:
    """Refuse interfaces with arrays of other lengths than points and pairs, or unknown nodes."""
    for interface, surface in interfaces.items():
        n_point, n_pair = len(surface.weights), len(surface.pairs)
        shapes = {
            "points": (n_point, 3),
            "normals": (n_point, 3),
            "weights": (n_point,),
            "initial_gap": (n_point,),
            "pairs": (n_pair, 2),
            "pair_points": (n_pair, 3),
            "averaging": (n_pair, n_point),
            "stuck": (n_pair,),
        }
        for name, shape in shapes.items():
            present = np.shape(getattr(surface, name))
            if present != shape:
                message = f"'/interfaces/{interface}/{name}' has shape {present}, expected {shape}"
                raise ValueError(message)
        nodes = surface.pairs
        if len(nodes) and not 0 <= nodes.min() <= nodes.max() < len(mesh.nodes):
            refuse_value(f"'/interfaces/{interface}/pairs' points beyond {len(mesh.nodes)} nodes")
