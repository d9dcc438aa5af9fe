"""Loads along beams as forces on their nodes.

A load does the same work at the nodes as along the beam, deflected as the ends' motions alone
deflect it. These shapes being exact (:mod:`faying.model.elements.beam`), so are the motions of the
nodes, and forces and moments at the ends are those of a clamped beam, shear included.
"""

from collections.abc import Sequence

import numpy as np

from faying._typing import Matrix
from faying.model.assembly import Beam
from faying.model.elements.beam import (
    beam_frames,
    beam_properties,
    bending_planes,
    bending_shapes,
)

_LOCAL_X = (0, 3)


def nodal_forces_of_beams(
    beams: Sequence[Beam], nodes: Matrix, stations: Matrix, vectors: Matrix
) -> Matrix:
    """Return the forces and moments (n_beam, 2, 6) on the ends of beams in the basic frame.

    Nodes (n_node, 3) [length] are all those of the mesh. Forces and moments (n_beam, n_station, 6)
    in the basic frame act at stations (n_beam, n_station): 0 at the first end, 1 at the second.

    Raises
    ------
    ModelError
        If a beam has no length or no orientation.
    """
    ends = np.array([beam.nodes for beam in beams], dtype=np.int64).reshape(-1, 2)
    frames, length = beam_frames(beams, nodes[ends[:, 1]] - nodes[ends[:, 0]])
    properties = beam_properties(beams, length)
    local = np.concatenate(
        [
            np.einsum("nij,nqj->nqi", frames, vectors[..., part])
            for part in np.split(np.arange(6), 2)
        ],
        axis=2,
    )
    result = np.zeros((len(beams), 12))
    straight = np.stack([1 - stations, stations], axis=1)
    for component in _LOCAL_X:
        result[:, [component, 6 + component]] = np.einsum(
            "nsq,nq->ns", straight, local[..., component]
        )
    for (dofs, signs), inertia, phi in bending_planes(properties):
        deflection, rotation = bending_shapes(length, phi)
        # Without bending stiffness there is no slope for the deflection to follow: a rod.
        rod = inertia == 0
        deflection[rod] = [[1, -1, 0, 0], [0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]]
        rotation[rod] = [[0, 0, 0], [1, -1, 0], [0, 0, 0], [0, 1, 0]]
        powers = stations[:, None, :] ** np.arange(4)[:, None]
        forces = np.einsum("nsp,npq,nq->ns", deflection, powers, local[..., dofs[0]])
        moments = np.einsum("nsp,npq,nq->ns", rotation, powers[:, :3], local[..., dofs[1]])
        # ``signs`` turns slopes into rotations, so moments of the load into work on slopes.
        result[:, dofs] = np.array(signs) * (forces + signs[1] * moments)
    return np.asarray(
        np.einsum("nij,nbi->nbj", frames, result.reshape(len(beams), 4, 3)).reshape(-1, 2, 6)
    )
