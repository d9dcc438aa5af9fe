"""RBE2, RBAR, RBE1, RROD, RTRPLT: rigid bodies.

The independent components u_i = A q fix the rigid motion q of the element; its dependent ones are
equations u_d = D A⁻¹ u_i. RBE2, the case of one independent node, is a coupling of its own unless
single components are tied in a displacement system that is not the basic one.
"""

from collections.abc import Iterator, Sequence

import numpy as np
import scipy.linalg

from faying._typing import Indices, Matrix, Vector
from faying.digits import ROUND_OFF, SOLVED
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card
from faying.io.nastran.components import components, frame_independent
from faying.io.nastran.grids import Grids
from faying.io.nastran.id_lists import id_list
from faying.model.assembly import Equation, RigidCoupling
from faying.model.matrices import rigid_body_motions

Place = tuple[int, int]
"""Node index and component 0..5 in the node's displacement system."""

_RIGID = 6


def read_rigid_elements(bulk: BulkData) -> tuple[list[RigidCoupling], list[Equation]]:
    """Read RBE2, RBAR, RBE1, RROD and RTRPLT; thermal coefficients at their ends are left out."""
    couplings: list[RigidCoupling] = []
    equations: list[Equation] = []
    for card in bulk.cards.get("RBE2", ()):
        reference, nodes, chosen = _rbe2(card, bulk.grids)
        turned = np.array([not _plain(node, chosen, bulk.grids) for node in nodes.tolist()])
        if not turned.all():
            couplings.append(_coupling(card, reference, nodes[~turned], chosen))
        if turned.any():
            free = [(reference, c) for c in range(6)]
            for node in nodes[turned].tolist():
                equations += rigid_equations(card, free, [(node, c) for c in chosen], bulk.grids)
    for card in bulk.cards.get("RBAR", ()):
        ends = [bulk.grids.one(card, 1), bulk.grids.one(card, 2)]
        free, tied = _sides(card, ends, 3)
        if free == [(ends[0], c) for c in range(6)] or free == [(ends[1], c) for c in range(6)]:
            dependent = ends[1] if free[0][0] == ends[0] else ends[0]
            chosen = tuple(c for node, c in tied if node == dependent)
            if _plain(dependent, chosen, bulk.grids):
                couplings.append(_coupling(card, free[0][0], np.array([dependent]), chosen))
                continue
        equations += rigid_equations(card, free, tied, bulk.grids)
    for card in bulk.cards.get("RTRPLT", ()):
        corners = [bulk.grids.one(card, field) for field in (1, 2, 3)]
        free, tied = _sides(card, corners, 4)
        equations += rigid_equations(card, free, tied, bulk.grids)
    for card in bulk.cards.get("RBE1", ()):
        equations += rigid_equations(card, *_rbe1(card, bulk.grids), bulk.grids)
    for card in bulk.cards.get("RROD", ()):
        equations.append(_rrod(card, bulk.grids))
    return couplings, equations


def _plain(node: int, chosen: tuple[int, ...], grids: Grids) -> bool:
    return frame_independent(chosen) or grids.systems.axes(node) is None


def _coupling(card: Card, reference: int, nodes: Indices, chosen: tuple[int, ...]) -> RigidCoupling:
    return RigidCoupling(id=card.integer(0), reference=reference, nodes=nodes, components=chosen)


def _rbe2(card: Card, grids: Grids) -> tuple[int, Indices, tuple[int, ...]]:
    """Independent node, dependent nodes and their components."""
    reference = grids.one(card, 1)
    chosen = components(card.text(2), card.error)
    texts = [text for text in card.texts[3:] if text]
    if texts and "." in texts[-1]:
        texts.pop()  # ALPHA: thermal expansion, no load for it is read
    nodes = np.unique(grids.several(card, id_list(card, texts)))
    if not len(nodes) or reference in nodes:
        card.refuse("it needs dependent nodes other than its independent one")
    return reference, nodes, chosen


def _sides(card: Card, nodes: Sequence[int], first: int) -> tuple[list[Place], list[Place]]:
    """Independent components of all nodes in turn, then dependent ones; blank is all others."""
    count = len(nodes)
    # RTRPLT starts a new row for the dependent components.
    second = first + count if count == 2 else 8
    free = _listed(card, nodes, range(first, first + count))
    tied = _listed(card, nodes, range(second, second + count))
    if not tied:
        tied = [(node, c) for node in nodes for c in range(6) if (node, c) not in free]
    return free, [dof for dof in tied if dof not in free]


def _listed(card: Card, nodes: Sequence[int], fields: Sequence[int]) -> list[Place]:
    return [
        (node, component)
        for node, field in zip(nodes, fields, strict=True)
        if card.text(field) not in ("", "0")
        for component in components(card.text(field), card.error)
    ]


def _rbe1(card: Card, grids: Grids) -> tuple[list[Place], list[Place]]:
    """Pairs of grid and components, dependent ones from UM on; a real at the end is ALPHA."""
    sides: tuple[list[Place], list[Place]] = ([], [])
    side = 0
    for row in range(0, len(card), 8):
        side = 1 if card.text(row) == "UM" else side
        for field in (row + 1, row + 3, row + 5):
            text = card.text(field)
            if not text or "." in text:
                continue
            node = grids.one(card, field)
            chosen = components(card.text(field + 1), card.error)
            sides[side].extend((node, component) for component in chosen)
    return sides


def _rrod(card: Card, grids: Grids) -> Equation:
    """Equal displacements along the line of two nodes; the component given is the dependent one."""
    nodes = [grids.one(card, field) for field in (1, 2)]
    fields = [(node, card.text(field)) for node, field in zip(nodes, (3, 4), strict=True)]
    tied = [(node, components(text, card.error)) for node, text in fields if text not in ("", "0")]
    line = grids.nodes[nodes[1]] - grids.nodes[nodes[0]]
    if len(tied) != 1 or len(tied[0][1]) != 1 or tied[0][1][0] > 2 or not line.any():
        card.refuse(
            "one translation at one of its two ends, which lie apart, must be the dependent one"
        )
    columns = [(node, c) for node in nodes for c in range(3)]
    candidates = [columns.index(dof) for dof in _supports([(tied[0][0], tied[0][1][0])], grids)]
    # Each equation is solved for the largest of the basic components that make up its dependent.
    (equation,) = solved(card, np.append(-line, line)[None], np.array(candidates), columns)
    return equation


def rigid_equations(
    card: Card, free: Sequence[Place], tied: Sequence[Place], grids: Grids
) -> Iterator[Equation]:
    """Yield an equation for each dependent (tied) component of a rigid body by independent ones."""
    nodes = np.array([node for node, _ in free], dtype=np.int64)
    if not 0 < len(free) <= _RIGID or not tied:
        card.refuse(
            f"{len(free)} independent and {len(tied)} dependent components; expected up to six, "
            "and some"
        )
    origin = grids.nodes[nodes].mean(axis=0)
    size = float(np.abs(grids.nodes[nodes] - origin).max()) or 1.0
    motion = _motions(free, grids, origin, size)
    following = _motions(tied, grids, origin, size)
    weights = np.linalg.lstsq(motion.T, following.T, rcond=None)[0].T
    unique = np.linalg.svd(motion, compute_uv=False)[-1] > SOLVED
    if not unique or np.abs(weights @ motion - following).max() > SOLVED:
        card.refuse(
            "the independent components do not determine the motion of a rigid body, as far as the "
            "dependent ones need it; choose others"
        )
    weights *= _scale(free, size) / _scale(tied, size)[:, None]
    columns = sorted({(node, c) for node, c in _supports([*free, *tied], grids)})
    column_of = {basic: k for k, basic in enumerate(columns)}
    rows = np.zeros((len(tied), len(columns)))
    for number, (dependent, row) in enumerate(zip(tied, weights, strict=True)):
        threshold = ROUND_OFF * float(np.abs(row).max())
        for dof, value in ((dependent, 1.0), *zip(free, (-row).tolist(), strict=True)):
            if abs(value) > threshold:
                for c, factor in grids.systems.basic_parts(*dof):
                    rows[number, column_of[dof[0], c]] += value * factor
    candidates = np.array(sorted(column_of[basic] for basic in set(_supports(tied, grids))))
    yield from solved(card, rows, candidates, columns)


def _supports(places: Sequence[Place], grids: Grids) -> list[Place]:
    """Return the basic components that make up components."""
    return [
        (node, c)
        for node, component in places
        for c, _ in grids.systems.basic_parts(node, component)
    ]


def solved(
    card: Card, rows: Matrix, candidates: Indices, columns: Sequence[Place]
) -> Iterator[Equation]:
    """Solve equations for as many of the candidates, the best conditioned ones."""
    _, R, order = scipy.linalg.qr(rows[:, candidates], mode="economic", pivoting=True)
    pivots = np.abs(np.diag(R))
    if len(pivots) < len(rows) or not pivots[-1] > SOLVED * pivots[0]:
        card.refuse("a dependent component is also an independent one; correct the components")
    chosen = candidates[order[: len(rows)]]
    solved = np.linalg.solve(rows[:, chosen], rows)
    solved[np.abs(solved) <= ROUND_OFF * np.abs(solved).max()] = 0.0
    for row, column in zip(solved, chosen.tolist(), strict=True):
        others = [k for k in np.flatnonzero(row).tolist() if k not in set(chosen.tolist())]
        yield Equation(
            id=card.integer(0),
            terms=(
                (*columns[column], 1.0),
                *((*columns[k], float(row[k])) for k in others),
            ),
        )


def _motions(places: Sequence[Place], grids: Grids, origin: Vector, size: float) -> Matrix:
    """Components (n, 6) in the six rigid motions, rotations counted at the distance ``size``."""
    nodes = np.array([node for node, _ in places], dtype=np.int64)
    every = rigid_body_motions(grids.nodes[nodes], origin).reshape(-1, 6, 6)
    every[:, :, 3:] /= size
    every[:, 3:, :] *= size
    rows = np.zeros((len(places), 6))
    for row, place in zip(rows, places, strict=True):
        for c, factor in grids.systems.basic_parts(*place):
            row[c] = factor
    return np.asarray(np.einsum("nc,ncm->nm", rows, every))


def _scale(places: Sequence[Place], size: float) -> Vector:
    """Return what components (n,) were multiplied by."""
    return np.array([1.0 if component < 3 else size for _, component in places])
