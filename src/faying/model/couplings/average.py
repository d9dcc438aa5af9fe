"""RBE3: a reference node that moves as the weighted average of other nodes."""

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.digits import ROUND_OFF, SOLVED
from faying.exceptions import refuse_model
from faying.model.assembly import Assembly, AverageCoupling
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.model.couplings.rows import Rows, lever_arms, sparse_rows


def average_rows(assembly: Assembly, existing: Mask) -> Rows:
    """Return each reference node as the weighted least-squares rigid motion of its nodes.

    The motion minimizes Σ w_i |u_i - (u_c + θ × r_i)|² over the averaged components, r_i from the
    weighted centre; the reference moves as u_c + θ × (x_ref - x_c). Forces on the reference are
    thus distributed as by Nastran's RBE3: F w_i / Σw, and the moment about the weighted centre by
    the weighted second moments. The weight of rotations is w_i L² with L the mean distance of the
    nodes from the reference, independent of the unit of length. Components outside ``existing``
    (6 n_node,) are left out: rotations of solid nodes, which decks often list; a free rotation
    would follow the reference without resistance.

    Raises
    ------
    ModelError
        If weights are not positive, or the nodes leave a tied component of the reference
        undetermined (for example a rotation about the line on which all of them lie).

    Notes
    -----
    Cost: one 6 x 6 eigenproblem per coupling.
    """
    couplings = assembly.average_couplings
    n_dof = 6 * len(assembly.mesh.nodes)
    dependent, columns, values, owner = [], [], [], []
    for number, coupling in enumerate(couplings):
        tied = np.unique(np.asarray(coupling.reference_components, dtype=np.int64))
        averaged, weights = _average(assembly, coupling, tied, existing)
        dependent.append(6 * coupling.reference + tied)
        columns.append(np.tile(averaged, len(tied)))
        values.append(weights.ravel())
        owner.append(np.full(len(tied), number))
    sizes = [len(c) // len(d) for c, d in zip(columns, dependent, strict=True) for _ in d]
    rows = np.repeat(np.arange(len(sizes)), np.array(sizes, dtype=np.int64))
    return Rows(
        dependent=_join(dependent),
        matrix=sparse_rows(
            (len(sizes), n_dof), rows, _join(columns), np.concatenate([np.empty(0), *values])
        ),
        owner=_join(owner),
        labels=tuple(f"average coupling {coupling.id}" for coupling in couplings),
    )


def _join(parts: list[Indices]) -> Indices:
    return np.concatenate([np.empty(0, dtype=np.int64), *parts])


def _average(
    assembly: Assembly, coupling: AverageCoupling, tied: Indices, existing: Mask
) -> tuple[Indices, Matrix]:
    """Return averaged degrees of freedom, and their weights in each tied reference component."""
    _check(assembly, coupling)
    nodes, weights = assembly.mesh.nodes[coupling.nodes], coupling.weights
    centre = weights @ nodes / weights.sum()
    arms, to_reference = nodes - centre, assembly.mesh.nodes[coupling.reference] - centre
    # Rotations count as displacements at this distance.
    # Corners of quadratic faces have negative weights.
    size = float(np.sqrt(np.abs(weights) @ np.sum(arms**2, axis=1) / weights.sum())) or 1.0
    distance = float(np.linalg.norm(arms - to_reference, axis=1).mean()) or 1.0
    components = np.unique(np.asarray(coupling.components, dtype=np.int64))
    motions = _motions(arms, size)[:, components].reshape(-1, 6)
    importance = np.where(components < 3, 1.0, distance**2)
    dofs = (6 * coupling.nodes[:, None] + components).ravel()
    counted = existing[dofs] | (dofs % 6 < 3)
    weight = np.outer(weights, importance).ravel() * counted
    if coupling.entering is not None:
        weight = weight * coupling.entering[:, components].ravel()
    inverse, loose = _inverse(motions.T @ (weight[:, None] * motions))
    reference = _motions(to_reference[None], size)[0, tied]
    _check_determined(assembly, coupling, tied[np.abs(reference @ loose).max(1, initial=0) > 1e-6])
    result = reference @ inverse @ (motions.T * weight)
    result[np.abs(result) <= ROUND_OFF * np.abs(result).max(axis=1, keepdims=True)] = 0.0
    return dofs, result


def _motions(arms: Matrix, size: float) -> Matrix:
    """Return displacements (n, 6, 6) of points in the rigid motions u_c and θ · size."""
    matrices = np.tile(np.eye(6), (len(arms), 1, 1))
    matrices[:, :3, 3:] = lever_arms(arms)
    matrices[:, :, 3:] /= size
    return matrices


def _inverse(gram: Matrix) -> tuple[Matrix, Matrix]:
    """Return the pseudo-inverse of a symmetric matrix, and its null vectors as columns."""
    values, vectors = np.linalg.eigh(gram)
    # Squared extents across a line: round-off of a deck is 1e-14, any real part far more.
    firm = values > SOLVED * values[-1]
    return (vectors[:, firm] / values[firm]) @ vectors[:, firm].T, vectors[:, ~firm]


def _check(assembly: Assembly, coupling: AverageCoupling) -> None:
    label = f"average coupling {coupling.id}"
    weights: Vector = coupling.weights
    matching = len(coupling.nodes) and weights.shape == coupling.nodes.shape
    if not matching or not np.all(weights != 0) or not weights.sum() > 0:
        refuse_model(
            f"{label}: needs at least one node and one positive weight for each node; negative "
            "ones stand only beside larger positive ones"
        )
    if np.any(coupling.nodes == coupling.reference):
        refuse_model(
            f"{label}: its reference node {assembly.mesh.node_ids[coupling.reference]} is also "
            "one of its averaged nodes; remove it from the list"
        )


def _check_determined(assembly: Assembly, coupling: AverageCoupling, loose: Indices) -> None:
    if len(loose):
        names = ", ".join(DISPLACEMENT_NAMES[c] for c in loose.tolist())
        refuse_model(
            f"average coupling {coupling.id}: the motion of its {len(coupling.nodes)} nodes does "
            f"not determine {names} of reference node "
            f"{assembly.mesh.node_ids[coupling.reference]} (do they lie on one line?); average "
            "over nodes that span a plane, or tie fewer components of the reference"
        )
