"""Checks of a stored reduced model beyond the shapes of its arrays."""

from collections.abc import Collection, Mapping
from dataclasses import is_dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix
from faying.digits import DECK_DIGITS
from faying.exceptions import refuse_value
from faying.files.shapes import Axes
from faying.interface.interface import FacePairs
from faying.interface.surface import ContactSurface
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.model.cells import CellBlock
from faying.model.elements import FACES, SOLIDS
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


def check_finite(value: Any, entry: str = "") -> None:
    """Refuse numbers that are not finite; a penalty may be infinite, which is hard contact."""
    if is_dataclass(value):
        value = vars(value)
    if isinstance(value, Mapping):
        for name, member in value.items():
            check_finite(member, f"{entry}/{name}")
    elif isinstance(value, tuple):
        for number, member in enumerate(value):
            check_finite(member, f"{entry}/{number}")
    else:
        numbers = value.data if sp.issparse(value) else np.asarray(value)
        if numbers.dtype.kind == "f":
            hard = entry.endswith("penalty")
            if (np.isnan(numbers) if hard else ~np.isfinite(numbers)).any():
                refuse_value(f"'{entry}' holds numbers that are not finite")


def check_distinct(indices: Indices, entry: str) -> None:
    """Refuse indices of which one occurs twice."""
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


OWN = ("n_point", "n_pair", "n_face")
"""Axes whose lengths each interface has for itself."""


def without_own(axes: Axes) -> Axes:
    """Return the known axes without those that each interface has for itself."""
    return {name: length for name, length in axes.items() if name not in OWN}


def check_geometry(value: Any, entry: str, axes: Axes) -> None:
    """Refuse solids, facets or an interface whose parts do not fit each other."""
    if isinstance(value, CellBlock):
        _check_known(value.kind, SOLIDS, f"{entry}/kind")
        _check_width(value.nodes, len(SOLIDS[value.kind].reference_nodes), f"{entry}/nodes")
    elif isinstance(value, FacePairs):
        _check_known(value.kind, FACES, f"{entry}/kind")
        _check_width(value.minus, FACES[value.kind].n_nodes, f"{entry}/minus")
    elif isinstance(value, ContactSurface):
        _check_surface(value, axes["n_node"], entry)


def _check_surface(record: ContactSurface, n_node: int, entry: str) -> None:
    n_face = sum(len(faces.minus) for faces in record.faces)
    if record.face_coverage is not None and len(record.face_coverage) != n_face:
        message = f"'{entry}/face_coverage' has {len(record.face_coverage)} entries, not {n_face}"
        raise ValueError(message)
    if (record.weights < 0).any() or not ((record.penalty or 0) > 0 or record.closure):
        refuse_value(f"'{entry}' has a negative weight or no positive penalty")
    pairs = record.pairs[:, 0] * n_node + record.pairs[:, 1]
    for faces in record.faces:
        if not np.isin(faces.minus * n_node + faces.plus, pairs).all():
            refuse_value(f"'{entry}/faces' has nodes that are not a pair of the interface")


def _check_width(nodes: np.ndarray[Any, Any], width: int, entry: str) -> None:
    if nodes.shape[1] != width:
        refuse_value(f"'{entry}' has {nodes.shape[1]} nodes each, expected {width}")


def _check_known(name: str, names: Collection[str], entry: str) -> None:
    if name not in names:
        refuse_value(f"'{entry}' is '{name}', expected one of {', '.join(names)}")
