"""SA, SB of CBEAM: scalar components that are the rate of twist at its ends, for CW of PBEAM."""

from collections.abc import Iterator, Mapping

import numpy as np

from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.general_elements import springs_between
from faying.io.nastran.grids import Grids
from faying.io.nastran.sections import Property
from faying.model.assembly import Beam, Spring

POINTS = (16, 17)


def read_warping(
    cards: Mapping[str, Cards],
    grids: Grids,
    sections: Mapping[int, Property],
    beams: Mapping[int, Beam],
) -> Iterator[Spring]:
    """Yield springs by which beams whose ends do not warp freely resist twist more than G J / L.

    The twist φ along the beam is cubic, φ' at the ends is the first component of SA and SB, and
    the energy is ∫ (G J φ'² + E C_w φ''²) dx / 2 (V. Z. Vlasov, Thin-walled elastic beams, 1961);
    what beams have of it themselves, G J / L, is taken off.

    Parameters
    ----------
    beams
        By id.
    """
    for card in cards.get("CBEAM", ()):
        if not any(card.text(field) for field in POINTS):
            continue
        beam = beams[card.integer(0)]
        resisting = sections[beam.property].warping
        if not resisting:
            continue
        start, end = (grids.nodes[node] for node in (grids.one(card, 2), grids.one(card, 3)))
        points = [_point(card, grids, field) for field in POINTS]
        length = float(np.linalg.norm(end - start))
        axis = (end - start) / length
        twist, bimoment = (np.array(rows) for rows in (_TWIST, _BIMOMENT))
        scale = np.diag([1.0, length, 1.0, length])
        twisting = beam.material.shear_modulus * beam.section.torsion
        bending = beam.material.youngs_modulus * resisting
        K = scale @ (twisting / length * twist + bending / length**3 * bimoment) @ scale
        T = np.zeros((4, 8))
        T[0, :3] = T[2, 4:7] = axis
        T[1, 3] = T[3, 7] = 1.0
        a, b = beam.nodes
        places = [(a, 3), (a, 4), (a, 5), (points[0], 0), (b, 3), (b, 4), (b, 5), (points[1], 0)]
        yield from springs_between(beam.id, places, T.T @ K @ T)


_TWIST = (
    *((0.2, 0.1, -0.2, 0.1), (0.1, 2 / 15, -0.1, -1 / 30)),
    *((-0.2, -0.1, 0.2, -0.1), (0.1, -1 / 30, -0.1, 2 / 15)),
)
"""∫ φ'² of cubic φ over the length, by φ and φ' L at both ends, without that of linear φ."""
_BIMOMENT = ((12, 6, -12, 6), (6, 4, -6, 2), (-12, -6, 12, -6), (6, 2, -6, 4))
"""∫ φ''² over the length."""


def _point(card: Card, grids: Grids, field: int) -> int:
    if not card.text(field):
        card.refuse(
            "a warping point at one end only is not supported; give SA and SB, or none", field
        )
    node = grids.one(card, field)
    if grids.systems.axes(node) is not None:
        card.refuse(
            "a warping point with a displacement system is not supported; use an SPOINT", field
        )
    return node
