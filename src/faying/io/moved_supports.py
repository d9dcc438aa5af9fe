"""Supports with prescribed displacements: stiff springs to ground, pulled by loads.

A support with displacement w is a spring of stiffness k under the force k w. A load case moves it
by w times the factor of the deck's load, and not at all where the load is not applied.
"""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
import scipy.sparse as sp

from faying._typing import Matrix
from faying.digits import DECK_DIGITS
from faying.exceptions import refuse_model
from faying.model.assembly import Assembly, Bush, Spring
from faying.model.constraints import constrain
from faying.model.matrices import assemble_matrices, used_components

Place = tuple[int, int]
"""Node and component 0..5."""

_BASIC: Mapping[int, Matrix] = MappingProxyType({})


def with_moved_supports(
    assembly: Assembly,
    moved: Mapping[Place, tuple[float, ...]],
    n_load: int,
    axes: Mapping[int, Matrix] = _BASIC,
) -> tuple[Assembly, list[Matrix]]:
    """Return the assembly with the springs, and the forces (n_node, 6) of each load.

    Each place has displacements (n_load,). Nodes with axes, rows of (3, 3), have components
    along them.

    Notes
    -----
    Forms the stiffness matrix once.
    """
    forces = np.zeros((n_load, len(assembly.mesh.nodes), 6))
    if not moved:
        return assembly, list(forces)
    directions = np.array([_direction(dof, axes) for dof in moved])
    columns = 6 * np.array([node for node, _ in moved])[:, None] + np.arange(6)
    n_dof = 6 * len(assembly.mesh.nodes)
    select = sp.csr_array(
        (directions.ravel(), columns.ravel(), 6 * np.arange(len(moved) + 1)),
        shape=(len(moved), n_dof),
    )
    used = used_components(assembly)
    T = constrain(assembly, used).transformation
    diagonal = np.asarray(T.multiply(assemble_matrices(assembly).K @ T).sum(axis=0)).ravel()
    rows = sp.csr_array(select @ T)
    rows.eliminate_zeros()
    there = np.diff(rows.indptr) > 0
    fixed = np.flatnonzero(~there & (abs(select) @ used > 0))
    if fixed.size:
        node, component = [*moved][int(fixed[0])]
        refuse_model(
            f"node {assembly.mesh.node_ids[node]} is moved along component {component + 1}, "
            "which a support or coupling holds too; remove one"
        )
    if not there.any():
        return assembly, list(forces)
    # A place without stiffness moves nothing.
    places = [dof for dof, is_free in zip(moved, there.tolist(), strict=True) if is_free]
    # Along an equation: the smallest stiffness of what moves with it, all else held.
    stiffnesses = diagonal[rows.indices] / rows.data**2
    softest = np.minimum.reduceat(stiffnesses, rows.indptr[:-1][there])
    stiffness = np.where(softest > 0, softest, diagonal.max()) / DECK_DIGITS
    amounts = stiffness * np.array([moved[dof] for dof in places]).T
    nodes = np.array([node for node, _ in places])
    for load, amount in zip(forces, amounts, strict=True):
        np.add.at(load, nodes, amount[:, None] * directions[there])
    first = assembly.largest_id + 1
    springs, bushes = [], []
    for number, (dof, value) in enumerate(
        zip(places, stiffness.tolist(), strict=True), start=first
    ):
        if dof[0] in axes:
            node, component = dof
            place = assembly.mesh.nodes[node]
            bushes.append(Bush.of_arrays(number, [node], {component: value}, axes[node], place))
        else:
            springs.append(Spring(id=number, ends=(dof,), stiffness=value))
    assembly = replace(
        assembly,
        springs=(*assembly.springs, *springs),
        bushes=(*assembly.bushes, *bushes),
    )
    return assembly, list(forces)


def _direction(dof: Place, axes: Mapping[int, Matrix]) -> Matrix:
    node, component = dof
    result = np.zeros(6)
    first = component - component % 3
    result[first : first + 3] = axes.get(node, np.eye(3))[component % 3]
    return result


def moved_note(count: int, cause: str, loads: str) -> str:
    """Return the note on nonzero displacements and the loads that apply them."""
    return (
        f"{count} nonzero displacements by {cause}: springs of {1 / DECK_DIGITS:g} times "
        f"the stiffness there, moved by {loads} (deck_load) and at zero without them"
    )
