"""Weak springs for bodies that only contact and friction hold, across their contact.

The compliance between ports exists for structures that are held without contact. Relatively weak
springs make it exist for all. They connect a body to those it touches and move with them: where
contact and friction hold the body, the springs hardly stretch, and their forces are negligible.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Mask, Matrix, SparseMatrix
from faying.digits import SHORT_DIGITS
from faying.exceptions import ModelError, refuse_model
from faying.joint.diagnosis import REMEDY_BESIDE_SPRINGS, model_motions, unconstrained
from faying.joint.model import Model
from faying.joint.weak_support import WeakSupport
from faying.model.assembly import Assembly, Spring
from faying.model.bodies import body_names
from faying.model.local_stiffness import stiffness_at

AUTOMATIC_STIFFNESS = 1e-5
"""Automatic stiffness over the stiffness at the nodes of the springs.

They carry 1e-5 of a load instead of friction. Weaker ones carry less, but increments with friction
then need more Newton steps; with 1e-7 one was not solved (``docs/how-to/get_a_model_in.md``).
"""

NOTHING_ELASTIC = (
    "weak springs: the bodies are rigid, or fixed, at the contact, so that there is no elastic "
    "stiffness to scale the springs by; give the stiffness of a spring [force/length] as a number, "
    "far below that of contact and the rest of the structure"
)


def with_weak_springs(model: Model, stiffness: float | Literal["auto"] = "auto") -> Model:
    """Connect every body that only contact holds to the bodies it touches, by weak springs.

    Motions of the structure as a whole get no springs: inertia balances its loads.

    Between two bodies in contact, one of which moves freely, three pairs of nodes that lie far from
    one another get springs in three directions.

    Parameters
    ----------
    stiffness : [force/length]
        Stiffness of each spring; ``"auto"`` is 1e-5 of the stiffness at these nodes.

    Returns
    -------
    Model
        With ``weak_supports`` by the names of both bodies, whose forces
        :meth:`Solution.weak_force` returns; the model itself where no body in contact is free.

    Raises
    ------
    ModelError
        If the stiffness is not a positive number, ``"auto"`` finds nothing elastic, or there are
        too many parts to search for free ones.

    Notes
    -----
    Where neither contact nor friction resists, the springs carry the load and displacements mean
    nothing: check their forces. They are part of K, and of C by its Rayleigh factor.

    Examples
    --------
    >>> import faying as fy
    >>> loose = fy.lap_joint(
    ...     element_size=10.0,
    ...     plates=3,
    ...     hole_radius=0.0,
    ...     washer_radius=11.0,
    ...     tip_suspension=(0.0, 0.0),
    ... )
    >>> sorted(fy.with_weak_springs(loose).weak_supports)
    ['lower-middle', 'middle-upper']
    """
    if stiffness != "auto" and not 0 < stiffness < np.inf:
        message = f"weak springs: the stiffness is {stiffness:g}; give a positive number or 'auto'"
        raise ModelError(message)
    assembly, dofs = model.assembly, model.dofs
    pairs_held = _held_pairs(model)
    if not pairs_held:
        return model
    pairs = np.concatenate(list(pairs_held.values()))
    firm = _median_stiffness(model, np.unique(pairs))
    if stiffness == "auto":
        if not firm:
            raise ModelError(NOTHING_ELASTIC)
        stiffness = AUTOMATIC_STIFFNESS * firm
    supports = {
        name: WeakSupport(
            nodes=assembly.mesh.node_ids[pair_rows],
            stiffness=stiffness,
            forces=stiffness * _relative(dofs.transformation, pair_rows),
        )
        for name, pair_rows in pairs_held.items()
    }
    rows = sp.vstack([support.forces for support in supports.values()]).tocsr()
    said = ", ".join(
        f"{name} (nodes {_pairs_text(support.nodes)})" for name, support in supports.items()
    )
    note = f"weak springs of {stiffness:.3g} hold what nothing but contact does: {said}"
    supported = replace(
        assembly,
        springs=(*assembly.springs, *_springs(assembly, pairs, stiffness)),
        ignored=(*assembly.ignored, note),
    )
    stiffened = model.with_stiffness((rows.T @ rows) / stiffness, stuck={})
    return replace(
        stiffened,
        assembly=supported,
        structure=replace(
            stiffened.structure,
            diagnose=partial(unconstrained, supported, dofs, remedy=REMEDY_BESIDE_SPRINGS),
            firm_rows=rows * (np.sqrt(firm) / stiffness) if firm else None,
        ),
        weak_supports={**model.weak_supports, **supports},
    )


def _median_stiffness(model: Model, nodes: Indices) -> float:
    """Return the median stiffness of some nodes, each moved alone [force/length], or 0."""
    rows = _translations(model.dofs.transformation, nodes)
    K = stiffness_at(model.assembly, model.dofs, nodes)
    return max(float(np.median((rows @ K @ rows.T).diagonal())), 0.0)


def _held_pairs(model: Model) -> Mapping[str, Indices]:
    """Return three pairs of nodes for each two bodies in contact, one of them free, by names."""
    free = _free_nodes(model)
    touching = [interface.pairs for interface in model.interfaces.values()]
    pairs = np.concatenate([np.empty((0, 2), np.int64), *touching])
    pairs = pairs[free[pairs].any(axis=1)]
    labels = model.assembly.mesh.bodies[pairs]
    names = [*body_names(model.assembly.mesh), "other parts"]  # label -1 is no solid
    return {
        "-".join(names[label] for label in both): _distant_pairs(
            model.assembly.mesh.nodes, pairs[(labels == both).all(axis=1)]
        )
        for both in np.unique(labels, axis=0).tolist()
    }


def _free_nodes(model: Model) -> Mask:
    """Return the nodes (n_node,) that belong to freely moving parts."""
    mechanisms = model_motions(model)
    if not mechanisms.searched:
        refuse_model(
            "there are too many parts to find those that weak springs would hold; support them, "
            "or tie them to one another"
        )
    size = np.zeros(len(model.assembly.mesh.nodes))
    if mechanisms.motions.size:
        nodal = np.moveaxis(model.dofs.nodal(mechanisms.motions.T), 0, -1)
        size = np.linalg.norm(nodal[:, :3], axis=(1, 2))
    # Nodes at rest in all motions belong to no free body.
    return np.asarray(size > SHORT_DIGITS * size.max(initial=0.0))


def _distant_pairs(points: Matrix, pairs: Indices) -> Indices:
    """Return three pairs far from one another and not in line; all pairs of three or less."""
    if len(pairs) <= 3:
        return pairs
    places = points[pairs[:, 0]]
    first = np.linalg.norm(places - places.mean(axis=0), axis=1).argmax()
    away = places - places[first]
    second = np.linalg.norm(away, axis=1).argmax()
    along = away[second] / np.linalg.norm(away[second])
    third = np.linalg.norm(away - np.outer(away @ along, along), axis=1).argmax()
    return pairs[[first, second, third]]


def _relative(transformation: SparseMatrix, pairs: Indices) -> SparseMatrix:
    """Return the rows (3 n_pair, n_dof) of the displacements between the nodes of each pair."""
    minus, plus = (_translations(transformation, nodes) for nodes in pairs.T)
    rows: SparseMatrix = (plus - minus).tocsr()
    return rows


def _translations(transformation: SparseMatrix, nodes: Indices) -> SparseMatrix:
    rows: SparseMatrix = transformation.tocsr()[(6 * nodes[:, None] + np.arange(3)).ravel()]
    return rows


def _springs(assembly: Assembly, pairs: Indices, stiffness: float) -> tuple[Spring, ...]:
    first = assembly.largest_id + 1
    return tuple(
        Spring(id=first + number, ends=((minus, component), (plus, component)), stiffness=stiffness)
        for number, (minus, plus, component) in enumerate(
            (minus, plus, component) for minus, plus in pairs.tolist() for component in range(3)
        )
    )


def _pairs_text(pairs: Indices) -> str:
    return ", ".join(f"{minus}-{plus}" for minus, plus in pairs.tolist())
