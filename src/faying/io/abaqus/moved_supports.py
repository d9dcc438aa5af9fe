"""Supports that move: stiff springs to ground, pulled by the loads of the steps.

A support moved by w is a spring of stiffness k under the force k w. It then stands wherever the
load case says: at w times the value of the deck's load, and at zero where that is not applied.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from faying._typing import Matrix
from faying.exceptions import ModelError
from faying.io.abaqus.supports import Place
from faying.model.assembly import Assembly, Spring
from faying.model.constraints import constrain
from faying.model.matrices import assemble_matrices, used_components

STIFFNESS_FACTOR = 1e6
"""Spring over the stiffness of what is moved, all else held: the displacement is off by a millionth
at most, and K loses no more than six digits."""


def with_moved_supports(
    assembly: Assembly, moved: Mapping[Place, tuple[float, ...]], n_step: int, ignored: list[str]
) -> tuple[Assembly, list[Matrix]]:
    """Return the assembly with the springs, and the forces (n_node, 6) at the end of each step.

    Parameters
    ----------
    moved
        Node and component to displacements at the end of all steps, from 0.

    Raises
    ------
    ModelError
        If something else holds what is to be moved.
    """
    forces = np.zeros((n_step + 1, len(assembly.mesh.nodes), 6))
    if not moved:
        return assembly, list(forces)
    used = used_components(assembly)
    T = constrain(assembly, used).transformation
    own = np.asarray(T.multiply(assemble_matrices(assembly).K @ T).sum(axis=0)).ravel()
    places = np.array([6 * node + component for node, component in moved])
    rows = T[places].tocsr()
    there = np.diff(rows.indptr) > 0
    held = np.flatnonzero(~there & used[places])
    if held.size:
        node, component = divmod(int(places[held[0]]), 6)
        message = (
            f"node {assembly.mesh.node_ids[node]} is moved along component {component + 1}, "
            "which something else holds; remove one of them"
        )
        raise ModelError(message)
    # Where nothing is, there is nothing to be moved.
    places, courses = places[there], np.array(list(moved.values()))[there]
    each = own[rows.indices] / rows.data**2
    stiffness = STIFFNESS_FACTOR * np.maximum.reduceat(each, rows.indptr[:-1][there])
    forces[:, places // 6, places % 6] = (stiffness[:, None] * courses).T
    first = assembly.largest_id + 1
    springs = [
        Spring(id=number, ends=((place // 6, place % 6),), stiffness=value)
        for number, (place, value) in enumerate(
            zip(places.tolist(), stiffness.tolist(), strict=True), start=first
        )
    ]
    ignored.append(
        f"{len(springs)} displacements other than zero by *BOUNDARY: springs of "
        f"{STIFFNESS_FACTOR:g} times the stiffness there, moved by the loads of the steps "
        "(deck_load) and at zero without them"
    )
    return replace(assembly, springs=(*assembly.springs, *springs)), list(forces)
