"""CONM2: concentrated mass."""

from collections.abc import Mapping

import numpy as np

from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.grids import Grids
from faying.model.assembly import PointMass


def read_masses(cards: Mapping[str, Cards], grids: Grids, mass_factor: float) -> list[PointMass]:
    """Read concentrated masses; inertias are turned into the basic frame.

    Raises
    ------
    FormatError
        If a mass has an offset from its node, or a coordinate system is missing.
    """
    return [_mass(card, grids, mass_factor) for card in cards.get("CONM2", ())]


def _mass(card: Card, grids: Grids, factor: float) -> PointMass:
    system = card.integer(2, 0)
    node = grids.one(card, 1)
    if system == -1:
        offset = np.array([card.real(j, 0.0) for j in (4, 5, 6)]) - grids.nodes[node]
        if np.abs(offset).max() > 1e-9 * max(float(np.abs(grids.nodes[node]).max()), 1.0):
            text = "an offset from the node is not supported; put a GRID there and tie it by RBE2"
            raise card.error(text, 4)
    else:
        remedy = "put a GRID there and tie it by RBE2"
        card.refuse_non_zero((4, 5, 6), "an offset from the node", remedy)
    # Off-diagonal fields hold ∫ x y dm; the inertia tensor carries them with a minus sign.
    i11, i21, i22, i31, i32, i33 = (card.real(j, 0.0) for j in range(8, 14))
    inertia = np.array([[i11, -i21, -i31], [-i21, i22, -i32], [-i31, -i32, i33]])
    if system > 0:
        if system not in grids.systems.frames:
            text = f"coordinate system {system} is not in the deck; define it (CORD2R, ...)"
            raise card.error(text, 2)
        axes = grids.systems.frames[system].directions(grids.nodes[node][None])[0]
        inertia = axes.T @ inertia @ axes
    # Adding zero turns -0.0 into 0.0.
    rows = tuple(tuple(row) for row in (factor * inertia + 0.0).tolist())
    return PointMass(
        id=card.integer(0),
        node=node,
        mass=card.real(3) * factor,
        inertia=rows,
    )
