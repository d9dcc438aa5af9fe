"""Bolts contained in given matrices: an axial spring between two of their nodes."""

import numpy as np
import scipy.sparse as sp

from faying._typing import SparseMatrix, Vector
from faying.digits import DECK_DIGITS
from faying.exceptions import naming, refuse_model
from faying.model.assembly import Assembly
from faying.model.specs import BoltSpec


def elongation_factors(assembly: Assembly, spec: BoltSpec) -> SparseMatrix:
    """Return the row (1, 6 n_node) of elongation = direction · (u_head − u_nut).

    The bolt has ``nodes`` (head, nut), ``stiffness``, and ``direction`` where the nodes coincide.
    """
    ids = list(spec.nodes or ())
    if len(ids) != 2 or ids[0] == ids[1]:
        refuse_model(
            f"bolt '{spec.name}': nodes are {ids}; give two different node ids, the head's "
            "and the nut's side of the cut"
        )
    if spec.stiffness is None or not 0 < spec.stiffness < np.inf:
        refuse_model(
            f"bolt '{spec.name}': stiffness is {spec.stiffness}; give the axial stiffness EA/L "
            "between its nodes that K contains"
        )
    with naming(f"bolt '{spec.name}'"):
        head, nut = assembly.mesh.node_index(np.array(ids)).tolist()
    direction = _direction(spec, assembly.mesh.nodes[head] - assembly.mesh.nodes[nut])
    columns = np.concatenate([6 * head + np.arange(3), 6 * nut + np.arange(3)])
    data = np.concatenate([direction, -direction])
    shape = (1, 6 * len(assembly.mesh.nodes))
    return sp.csr_array((data, (np.zeros(6, dtype=np.int64), columns)), shape=shape)


def check_contained(K: SparseMatrix, elongation: Vector, spec: BoltSpec) -> None:
    """Refuse a bolt whose spring k eᵀe exceeds the stiffness K there.

    A necessary condition, from the rows of K at the bolt's nodes alone: any motion of them costs at
    least the energy of the bolt. Tightening checks the sufficient one.
    """
    nonzero = np.flatnonzero(elongation)
    if not len(nonzero):
        refuse_model(
            f"bolt '{spec.name}': neither of its nodes {list(spec.nodes or ())} can move along its "
            "axis; give nodes that have rows in the matrices"
        )
    local = K[nonzero][:, nonzero].toarray()
    declared = spec.stiffness or 0.0
    softest = np.linalg.eigvalsh(
        local - declared * np.outer(elongation[nonzero], elongation[nonzero])
    )[0]
    if softest < -DECK_DIGITS * declared:
        refuse_model(
            f"bolt '{spec.name}': K does not contain a spring of {declared:g} between nodes "
            f"{' and '.join(map(str, spec.nodes or ()))}: part of it would be left over; check "
            "the nodes, the direction and the stiffness EA/L"
        )


def _direction(spec: BoltSpec, apart: Vector) -> Vector:
    """Return the unit vector from the nut's side to the head's."""
    distance = float(np.linalg.norm(apart))
    if spec.direction is None:
        if distance == 0:
            refuse_model(
                f"bolt '{spec.name}': its two nodes coincide, so its axis is unknown; add "
                "direction = [x, y, z] from the nut to the head"
            )
        return apart / distance
    vector = np.asarray(spec.direction, dtype=float)
    length = float(np.linalg.norm(vector))
    if vector.shape != (3,) or not 0 < length < np.inf:
        refuse_model(
            f"bolt '{spec.name}': direction is {spec.direction}; give a vector (x, y, z) from the "
            "nut to the head"
        )
    unit: Vector = vector / length
    if distance > 0 and not unit @ apart > 0:
        refuse_model(
            f"bolt '{spec.name}': direction {spec.direction} does not point from the nut to the "
            f"head (nodes are [head, nut] = {list(spec.nodes or ())}); turn it round, or leave it "
            "out"
        )
    return unit
