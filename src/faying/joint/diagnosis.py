"""Why a stiffness matrix is singular, in terms of the model."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg as la

from faying._typing import Indices, Mask, Matrix, SparseMatrix, Vector
from faying.digits import DECK_DIGITS
from faying.display.facts import listed
from faying.exceptions import ModelError
from faying.joint.model import Model
from faying.model.assembly import Assembly
from faying.model.bodies import body_names
from faying.model.dofs import DofMap
from faying.model.local_stiffness import rigid_stiffness
from faying.model.rigid_motion import (
    FreeMotions,
    free_motions,
    rigid_motions,
    whole_motions,
)

REMEDY = (
    "support it, tie it to a held body with a bolt, or have weak springs hold it beside contact "
    'and friction (weak_springs = "auto" under [model] of a study, faying.with_weak_springs in '
    "Python): contact alone holds nothing"
)

REMEDY_BESIDE_SPRINGS = (
    "support it, or tie it to a held body with a bolt: weak springs hold nothing but what touches "
    "another body, and those of a stiffness below round-off nothing at all"
)
"""Remedy after weak springs were requested."""


def check_held(model: Model, remedy: str = REMEDY) -> None:
    """Refuse a model in which a part can move freely, without factorizing it.

    The structure as a whole may move freely if it has mass.

    Notes
    -----
    Finds the motions of :func:`faying.model.rigid_motion.free_motions`; a hinge inside a body
    appears when the stiffness is factorized.
    """
    free = model_motions(model)
    if free.motions.shape[1]:
        raise ModelError(_message(model.assembly, model.dofs, free.labels, free.motions, remedy))


AS_A_WHOLE = (
    "no support holds {count} motion(s) of the joint as a whole: inertia balances loads in them, "
    "and modes are counted without them"
)
"""Message for every free joint, which may be intended."""


@dataclass(frozen=True, kw_only=True)
class FreeParts:
    """Parts that only contact can hold.

    Attributes
    ----------
    count
        Number of independent motions; None where there are too many parts to search.
    parts
        Body, or node, to a description of its motion.
    whole
        Number of motions of the structure as a whole, in addition.
    """

    count: int | None
    parts: Mapping[str, str]
    whole: int = 0


def free_parts(model: Model) -> FreeParts:
    """Return the parts that can move without strain energy, apart from contact.

    Notes
    -----
    As :func:`check_held`, which refuses such a model.
    """
    free, whole = _motions(model)
    count = free.motions.shape[1] if free.searched else None
    if not count:
        return FreeParts(count=count, parts={}, whole=whole.shape[1])
    nodal = np.moveaxis(model.dofs.nodal(free.motions.T), 0, -1)
    size = np.linalg.norm(nodal, axis=2)
    # Rotations of the nodes of a body that moves are part of its motion.
    moving = size.max(axis=1) > 0.01 * size.max()
    parts = {}
    for label in np.unique(free.labels[moving & (free.labels >= 0)]).tolist():
        members = np.flatnonzero(free.labels == label)
        ways = _motion_text(model.assembly.mesh.nodes[members], nodal[members])
        parts[_body_text(model.assembly, members)] = ways
    loose = model.assembly.mesh.node_ids[moving & (free.labels < 0)].tolist()
    if loose:
        parts[f"node {listed(loose)}"] = "of beams, springs or couplings, can move"
    return FreeParts(count=count, parts=parts, whole=whole.shape[1])


def model_motions(model: Model) -> FreeMotions:
    """Return free motions within the structure, without its motions as a whole.

    Notes
    -----
    For models without sticking pairs, the stiffness is not formed.
    """
    return _motions(model)[0]


def _motions(model: Model) -> tuple[FreeMotions, Matrix]:
    """Return free motions within the structure, and those of it as a whole."""
    K = _stiffness_of_motions(model)
    free, whole = free_motions(model.assembly, model.dofs, K), _rigid_motions(model, K)
    if not whole.shape[1]:
        return free, whole
    within = free.motions - whole @ (whole.T @ free.motions)
    left, size, _ = np.linalg.svd(within, full_matrices=False)
    return replace(free, motions=left[:, size > 0.5]), whole


def _stiffness_of_motions(model: Model) -> SparseMatrix:
    return model.K if model.stuck else rigid_stiffness(model.assembly, model.dofs)


def _rigid_motions(model: Model, K: SparseMatrix) -> Matrix:
    """Return the free motions (n_dof, n) as one rigid body, orthonormal.

    Empty for a structure without mass, in which no inertia balances forces.
    """
    motions = whole_motions(model.assembly.mesh.nodes, model.dofs.free, K)
    if motions.shape[1] and not model.structure.has_mass:
        return motions[:, :0]
    return motions


def suspension(model: Model) -> str:
    """Return a message on motions that springs to ground alone hold, with their frequencies.

    Empty without such motions. Assembles the matrices where there are springs to ground.
    """
    assembly = model.assembly
    springs = tuple(element for element in assembly.springs if len(element.ends) == 2)
    bushes = tuple(element for element in assembly.bushes if len(element.nodes) == 2)
    if len(springs) + len(bushes) == len(assembly.springs) + len(assembly.bushes):
        return ""
    loose = replace(assembly, springs=springs, bushes=bushes)
    K = rigid_stiffness(loose, model.dofs)
    motions = whole_motions(assembly.mesh.nodes, model.dofs.free, K)
    if (
        motions.shape[1] <= _rigid_motions(model, _stiffness_of_motions(model)).shape[1]
        or not model.structure.has_mass
    ):
        return ""
    pulled, moved = (motions.T @ (matrix @ motions) for matrix in (model.K, model.M))
    squares = la.eigh(pulled, moved, eigvals_only=True)
    frequencies = np.sqrt(squares[squares > DECK_DIGITS * squares[-1]]) / (2 * np.pi)
    return (
        f"springs to ground alone hold {len(frequencies)} motion(s) of the joint as a whole, in "
        f"which it swings at {frequencies[0]:.3g} to {frequencies[-1]:.3g}; numbers of modes count "
        "them"
    )


def unconstrained(
    assembly: Assembly, dofs: DofMap, K: SparseMatrix, motion: Vector, *, remedy: str = REMEDY
) -> str:
    """Return a message on the free motions after a factorization of K found one.

    This motion (n_dof,) is one of possibly many.
    """
    free = free_motions(assembly, dofs, K)
    motions = free.motions if free.motions.shape[1] else motion[:, None]
    return _message(assembly, dofs, free.labels, motions, remedy)


def _message(
    assembly: Assembly, dofs: DofMap, labels: Indices, motions: Matrix, remedy: str
) -> str:
    """Return a message that names the part that moves most, and its motion."""
    nodal = np.moveaxis(dofs.nodal(motions.T), 0, -1)
    size = np.linalg.norm(nodal, axis=2)
    mesh = assembly.mesh
    moved = size[:, :3].max(axis=1)
    if moved.max() < 0.1 * size.max():
        node = int(size.max(axis=1).argmax())
        axes = "xyz"[int(size[node, 3:].argmax())]
        return (
            f"unconstrained node: node {mesh.node_ids[node]} can rotate freely about {axes}; "
            "support its rotation, or couple it to a body"
        )
    node = int(moved.argmax())
    if labels[node] < 0:
        unit = _vector_text(nodal[node, :3, int(np.linalg.norm(nodal[node, :3], axis=0).argmax())])
        return (
            f"unconstrained node: node {mesh.node_ids[node]} can move freely along {unit}; {remedy}"
        )
    members = np.flatnonzero(labels == labels[node])
    how = _motion_text(mesh.nodes[members], nodal[members])
    others = np.setdiff1d(labels[moved > 0.01 * moved.max()], [-1, labels[node]]).tolist()
    along = "".join(
        f", and with it {_body_text(assembly, labels == companion)}" for companion in others[:2]
    )
    more = f" and {len(others) - 2} other bodies" if len(others) > 2 else ""
    return f"unconstrained body: {_body_text(assembly, members)} {how}{along}{more}; {remedy}"


def _motion_text(points: Matrix, moved: Matrix) -> str:
    """Return a description of rigid motions from displacements of a body (n_node, 6, n_motion)."""
    centre, n_motion = points.mean(axis=0), moved.shape[2]
    components = np.tile(np.arange(3), len(points))
    basis = rigid_motions(np.repeat(points, 3, axis=0), components, centre)
    radius = float(np.linalg.norm(points - centre, axis=1).max()) or 1.0
    basis = basis / np.array([1.0] * 3 + [radius] * 3)
    shown = moved[:, :3].reshape(-1, n_motion)
    twists, *_ = np.linalg.lstsq(basis, shown, rcond=None)
    if np.linalg.norm(basis @ twists - shown) > 1e-3 * np.linalg.norm(shown):
        return f"contains a hinge: its nodes move along {_vector_text(shown[:3, 0])} and others"
    left, size, _ = np.linalg.svd(twists)
    ways = left[:, : int((size > DECK_DIGITS * size[0]).sum())]
    count = ways.shape[1]
    if count == 6:
        return "is held by nothing"
    simplest = _translation_in(ways)
    shifts = np.linalg.norm(simplest[3:]) < DECK_DIGITS
    turning = "" if shifts else f"can turn freely {_axis_text(simplest, centre, radius)}"
    text = turning or f"can move freely along {_vector_text(simplest[:3])}"
    return text if count == 1 else f"{text} (one of {count} free motions)"


def _translation_in(ways: Matrix) -> Vector:
    """Return a translation in the span of twists (6, n), if there is one."""
    _, size, right = np.linalg.svd(ways[3:])
    size = np.append(size, np.zeros(ways.shape[1]))[: ways.shape[1]]
    return ways @ right[-1] if size[-1] < DECK_DIGITS else ways[:, 0]


def _axis_text(twist: Vector, centre: Vector, radius: float) -> str:
    """Return a description of the axis of a twist."""
    rotation = twist[3:] / radius
    point = centre + np.cross(rotation, twist[:3]) / (rotation @ rotation)
    point = np.where(np.abs(point) < DECK_DIGITS * radius, 0.0, point)
    coordinates = ", ".join(f"{value + 0.0:.4g}" for value in point)
    return f"about the axis {_vector_text(rotation)} through ({coordinates})"


def _body_text(assembly: Assembly, chosen: Indices | Mask) -> str:
    """Return the name of an element set that covers a body, and its nodes."""
    mesh = assembly.mesh
    ids = mesh.node_ids[chosen]
    number = int(mesh.bodies[chosen][0])
    name = body_names(mesh)[number] if number >= 0 else ""
    named = f"body '{name}'" if name in mesh.element_sets else "body"
    return f"{named} (nodes {ids.min()} to {ids.max()})"


def _vector_text(motion: Vector) -> str:
    """Return the unit vector along a motion, its largest component positive."""
    unit = motion / max(float(np.linalg.norm(motion)), np.finfo(float).tiny)
    unit = unit * np.sign(unit[np.abs(unit).argmax()] or 1.0)
    return "(" + ", ".join(f"{value:.2f}" for value in np.round(unit, 2) + 0.0) + ")"
