"""CONM1, CONM2: concentrated masses."""

from collections.abc import Mapping, Sequence

import numpy as np

from faying._typing import Matrix
from faying.digits import SOLVED
from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.grids import Grids
from faying.model.assembly import Assembly, PointMass

_TRANSLATIONS = 2


def read_masses(cards: Mapping[str, Cards], grids: Grids, mass_factor: float) -> list[PointMass]:
    """Read concentrated masses; inertias are turned into the basic frame."""
    whole = [_matrix(card, grids, mass_factor) for card in cards.get("CONM1", ())]
    return [*whole, *(_mass(card, grids, mass_factor) for card in cards.get("CONM2", ()))]


def _matrix(card: Card, grids: Grids, factor: float) -> PointMass:
    """CONM1, where its matrix is that of a mass with inertia about its grid."""
    values = [card.real(j, 0.0) for j in range(3, 24)]
    matrix = np.zeros((6, 6))
    matrix[np.tril_indices(6)] = values
    mass = matrix[0, 0]
    if not mass >= 0 or (matrix[3:, :3] != 0).any() or (matrix[:3, :3] != mass * np.eye(3)).any():
        card.refuse(
            "masses that differ between directions, or that couple translations and rotations, are "
            "not supported; use CONM2, or CMASS2 for single components",
            3,
        )
    inertia = matrix[3:, 3:] + np.tril(matrix[3:, 3:], -1).T
    axes = _axes(card, grids, grids.one(card, 1))
    a, b, c = (tuple(row) for row in (factor * axes.T @ inertia @ axes + 0.0).tolist())
    return PointMass(
        id=card.integer(0), node=grids.one(card, 1), mass=mass * factor, inertia=(a, b, c)
    )


def _axes(card: Card, grids: Grids, node: int) -> Matrix:
    if card.integer(2, 0) <= 0:
        return np.eye(3)
    return np.asarray(grids.systems.frame_of(card, 2).directions(grids.nodes[node][None])[0])


def _mass(card: Card, grids: Grids, factor: float) -> PointMass:
    system = card.integer(2, 0)
    node = grids.one(card, 1)
    offset = card.reals((4, 5, 6), 0.0)
    if system == -1:
        offset = offset - grids.nodes[node]
        if np.abs(offset).max() <= SOLVED * max(float(np.abs(grids.nodes[node]).max()), 1.0):
            offset = np.zeros(3)
    # Off-diagonal fields hold ∫ x y dm; the inertia tensor carries them with a minus sign.
    i11, i21, i22, i31, i32, i33 = (card.real(j, 0.0) for j in range(8, 14))
    inertia = np.array([[i11, -i21, -i31], [-i21, i22, -i32], [-i31, -i32, i33]])
    axes = _axes(card, grids, node)
    inertia, offset = axes.T @ inertia @ axes, offset @ axes
    # Adding zero turns -0.0 into 0.0.
    rows = tuple(tuple(row) for row in (factor * inertia + 0.0).tolist())
    x, y, z = (offset + 0.0).tolist()
    return PointMass(
        id=card.integer(0),
        node=node,
        mass=card.real(3) * factor,
        inertia=rows,
        offset=(x, y, z),
    )


def without_rotation(
    masses: Sequence[PointMass], assembly: Assembly, ignored: list[str]
) -> tuple[PointMass, ...]:
    """Take inertia and offsets from masses at nodes that nothing keeps from turning.

    Nastran holds such rotations (PARAM,AUTOSPC), so that the mass moves with its node alone.

    Parameters
    ----------
    assembly
        Without the masses.
    """
    turning = [item for item in masses if np.any(item.inertia) or any(item.offset)]
    if not turning:
        return tuple(masses)
    resisted = np.zeros(len(assembly.mesh.nodes), dtype=bool)
    for block in assembly.shells:
        resisted[block.nodes] = True
    ends = [item.nodes for item in assembly.beams] + [item.nodes for item in assembly.bushes]
    resisted[[node for nodes in ends for node in nodes]] = True
    for spring in assembly.springs:
        resisted[[node for node, c in spring.ends if c > _TRANSLATIONS]] = True
    resisted[[item.reference for item in assembly.rigid_couplings]] = True
    resisted[[item.reference for item in assembly.average_couplings]] = True
    for rigid in assembly.rigid_couplings:
        resisted[rigid.nodes] |= max(rigid.components) > _TRANSLATIONS
    for equation in assembly.equations:
        resisted[[node for node, c, _ in equation.terms if c > _TRANSLATIONS]] = True
    loose = {item.id for item in turning if not resisted[item.node]}
    if loose:
        ignored.append(
            f"inertia and offset of {len(loose)} CONM1 or CONM2 at grids that nothing keeps from "
            "turning, whose rotation Nastran holds (AUTOSPC)"
        )
    return tuple(
        PointMass(id=item.id, node=item.node, mass=item.mass) if item.id in loose else item
        for item in masses
    )
