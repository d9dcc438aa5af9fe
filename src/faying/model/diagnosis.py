"""Why a stiffness matrix is singular, in the words of the model."""

import numpy as np

from faying._typing import Indices, Vector
from faying.exceptions import ModelError
from faying.linalg.factorization import SingularMatrixError
from faying.model.bodies import bodies
from faying.model.model import Model


def unconstrained(model: Model, error: SingularMatrixError) -> ModelError:
    """Name the body that can move freely, and how.

    Parameters
    ----------
    error
        Raised while the model was factorized; carries the free motion.
    """
    nodal = model.dofs.nodal(error.motion)
    size = np.linalg.norm(nodal[:, :3], axis=1)
    if size.max() < 0.1 * np.abs(nodal[:, 3:]).max():
        node = int(np.abs(nodal[:, 3:]).max(axis=1).argmax())
        where = f"node {model.assembly.mesh.node_ids[node]} can rotate freely"
    else:
        node = int(size.argmax())
        where = _moving_body(model, node, size)
    return ModelError(
        f"unconstrained body: {where}, moving along {_direction(nodal[node, :3])} there; "
        "support it, or tie it to a held body with a bolt (contact alone holds nothing)"
    )


def _moving_body(model: Model, node: int, size: Vector) -> str:
    mesh, body = model.assembly.mesh, bodies(model.assembly.mesh)
    moving = body == body[node]
    if body[node] < 0:
        return f"node {mesh.node_ids[node]}"
    names = [
        f"'{name}'"
        for name, ids in mesh.element_sets.items()
        if np.array_equal(np.unique(_element_nodes(model, ids)), np.flatnonzero(moving))
    ]
    named = f" {names[0]}" if names else ""
    ids = mesh.node_ids[moving & (size > 0.1 * size.max())]
    return f"the body{named} with nodes {ids.min()} to {ids.max()}"


def _element_nodes(model: Model, ids: Indices) -> Indices:
    blocks = model.assembly.mesh.blocks
    return np.concatenate([block.nodes[np.isin(block.ids, ids)].ravel() for block in blocks])


def _direction(motion: Vector) -> str:
    unit = motion / max(float(np.linalg.norm(motion)), np.finfo(float).tiny)
    return "(" + ", ".join(f"{component + 0.0:.2f}" for component in unit) + ")"
