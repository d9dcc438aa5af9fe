"""RBE2: nodes that follow a reference node as one rigid body."""

import numpy as np

from faying._typing import Indices, Matrix
from faying.digits import ROUND_OFF
from faying.exceptions import refuse_model
from faying.model.assembly import Assembly, RigidCoupling
from faying.model.couplings.rows import Rows, lever_arms, sparse_rows


def rigid_rows(assembly: Assembly) -> Rows:
    """Return u_i = u_ref + θ_ref × (x_i - x_ref), and θ_i = θ_ref where rotations are tied.

    Raises
    ------
    ModelError
        If a reference node is one of its dependent nodes.
    """
    couplings = assembly.rigid_couplings
    parts = [_tied_table(assembly, number, coupling) for number, coupling in enumerate(couplings)]
    table = np.concatenate([np.empty((0, 4), dtype=np.int64), *parts])
    node, component, reference, owner = table.T
    kinematics = _kinematics(assembly.mesh.nodes, node, reference)
    n_row, n_dof = len(table), 6 * len(assembly.mesh.nodes)
    columns = 6 * reference[:, None] + np.arange(6)
    values = kinematics[np.arange(n_row), component]
    rows = np.repeat(np.arange(n_row), 6)
    return Rows(
        dependent=6 * node + component,
        matrix=sparse_rows((n_row, n_dof), rows, columns.ravel(), values.ravel()),
        owner=owner,
        labels=tuple(f"rigid coupling {coupling.id}" for coupling in couplings),
    )


def _tied_table(assembly: Assembly, number: int, coupling: RigidCoupling) -> Indices:
    """Return the table (n_row, 4) of node, component, reference, number of the coupling."""
    nodes = np.unique(coupling.nodes)
    if np.any(nodes == coupling.reference):
        refuse_model(
            f"rigid coupling {coupling.id}: its reference node "
            f"{assembly.mesh.node_ids[coupling.reference]} is also one of its dependent nodes; "
            "remove it from the list"
        )
    components = np.unique(np.asarray(coupling.components, dtype=np.int64))
    table = np.empty((len(nodes), len(components), 4), dtype=np.int64)
    table[:, :, 0] = nodes[:, None]
    table[:, :, 1] = components
    table[:, :, 2:] = coupling.reference, number
    return table.reshape(-1, 4)


def _kinematics(nodes: Matrix, node: Indices, reference: Indices) -> Matrix:
    """Return displacements of each node per displacements of its reference (n_row, 6, 6)."""
    arms = nodes[node] - nodes[reference]
    arms[np.abs(arms) <= ROUND_OFF * np.abs(nodes).max(initial=0.0)] = 0.0
    matrices = np.tile(np.eye(6), (len(node), 1, 1))
    matrices[:, :3, 3:] = lever_arms(arms)
    return matrices
