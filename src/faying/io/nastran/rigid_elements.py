"""RBE2, RBAR, RBE1, RROD, RTRPLT, RSSCON: rigid bodies, and shells clamped to solids.

The independent components u_i = A q determine the rigid motion q of the element; the dependent
components follow from equations u_d = D A⁻¹ u_i. RBE2 has one independent node and is a coupling,
unless single components are tied in a displacement system other than the basic one.

MSC Nastran Quick Reference Guide, RSSCON: translations of the edge are those of the solid, and its
two rotations follow the relative motion of the lower and upper edges of the face. A node of the
shell at the fraction t of h = x_B - x_A, from A below to B above, moves by u = (1 - t) u_A + t u_B,
θ = h × (u_B - u_A) / h²; the rotation about h remains that of the shell.
"""

from collections.abc import Iterator, Sequence
from itertools import groupby
from operator import itemgetter

import numpy as np
import scipy.linalg

from faying._typing import Indices, Matrix, Vector
from faying.digits import ROUND_OFF, SHORT_DIGITS, SOLVED
from faying.interface.facets import shape_functions
from faying.io.nastran.cards import Card
from faying.io.nastran.fields import ROW, components, frame_independent
from faying.io.nastran.grids import BulkData, Grids
from faying.io.nastran.id_lists import id_list
from faying.model.assembly import Equation, RigidCoupling
from faying.model.boundary import DISPLACEMENT_NAMES
from faying.model.cells import CellBlock
from faying.model.elements import SOLIDS
from faying.model.matrices import rigid_body_motions
from faying.model.shells import ShellBlock

Place = tuple[int, int]
"""Node index and component 0..5 in the node's displacement system."""


def read_rigid_elements(bulk: BulkData) -> tuple[list[RigidCoupling], list[Equation]]:
    """Read RBE2, RBAR, RBE1, RROD and RTRPLT, without thermal coefficients."""
    couplings: list[RigidCoupling] = []
    equations: list[Equation] = []
    for name, sides in (("RBE2", _rbe2), ("RBAR", _ends), ("RTRPLT", _ends), ("RBE1", _rbe1)):
        for card in bulk.cards.get(name, ()):
            free, tied = sides(card, bulk.grids)
            if not tied or free != [(free[0][0] if free else -1, c) for c in range(6)]:
                equations += rigid_equations(card, free, tied, bulk.grids)
                continue
            plain: dict[tuple[int, ...], list[int]] = {}
            for node, dofs in groupby(tied, key=itemgetter(0)):
                chosen = tuple(c for _, c in dofs)
                if frame_independent(chosen) or bulk.grids.systems.axes(node) is None:
                    plain.setdefault(chosen, []).append(node)
                else:
                    of_node = [(node, c) for c in chosen]
                    equations += rigid_equations(card, free, of_node, bulk.grids)
            couplings += [
                RigidCoupling(
                    id=card.integer(0),
                    reference=free[0][0],
                    nodes=np.array(nodes),
                    components=chosen,
                )
                for chosen, nodes in plain.items()
            ]
    for card in bulk.cards.get("RROD", ()):
        equations.append(_rrod(card, bulk.grids))
    return couplings, equations


def _rbe2(card: Card, grids: Grids) -> tuple[list[Place], list[Place]]:
    """Return all components of the independent node, and components of the dependent nodes."""
    reference = grids.one(card, 1)
    chosen = components(card.text(2), card.error)
    texts = [text for text in card.texts[3:] if text]
    if texts and "." in texts[-1]:
        texts.pop()  # ALPHA: thermal expansion, which no load uses
    nodes = np.unique(grids.several(card, id_list(card, texts)))
    if not len(nodes) or reference in nodes:
        card.refuse("it needs dependent nodes other than its independent one")
    free = [(reference, c) for c in range(6)]
    return free, [(node, c) for node in nodes.tolist() for c in chosen]


def _ends(card: Card, grids: Grids) -> tuple[list[Place], list[Place]]:
    """Return independent and dependent components of all nodes; blank means all others."""
    count = 2 if card.cards.name == "RBAR" else 3
    nodes = [grids.one(card, 1 + i) for i in range(count)]
    # RTRPLT starts a new row for the dependent components.
    first, second = (3, 5) if count == 2 else (4, 8)
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
    """Return independent components and, after UM, dependent ones; a real at the end is ALPHA."""
    sides: tuple[list[Place], list[Place]] = ([], [])
    side = 0
    for row in card.groups(0, ROW):
        side = 1 if row.text(0) == "UM" else side
        for pair in row.groups(1, 2):
            if "." not in pair.text(0):
                chosen = components(pair.text(1), pair.error)
                sides[side].extend((grids.one(pair, 0), component) for component in chosen)
    return sides


def _rrod(card: Card, grids: Grids) -> Equation:
    """Return the equation of equal displacements along the line of two nodes."""
    nodes = [grids.one(card, field) for field in (1, 2)]
    fields = [(node, card.text(field)) for node, field in zip(nodes, (3, 4), strict=True)]
    tied = [(node, components(text, card.error)) for node, text in fields if text not in ("", "0")]
    line = grids.nodes[nodes[1]] - grids.nodes[nodes[0]]
    if len(tied) != 1 or len(tied[0][1]) != 1 or tied[0][1][0] > 2 or not line.any():
        card.refuse(
            "give two nodes apart, and one translation at one of them as dependent component"
        )
    columns = [(node, c) for node in nodes for c in range(3)]
    candidates = [columns.index(dof) for dof in _supports([(tied[0][0], tied[0][1][0])], grids)]
    # Each equation is solved for the largest basic component of its dependent component.
    (equation,) = solved(card, np.append(-line, line)[None], np.array(candidates), columns)
    return equation


def rigid_equations(
    card: Card, free: Sequence[Place], tied: Sequence[Place], grids: Grids
) -> Iterator[Equation]:
    """Yield the equation of each dependent (tied) component of a rigid body."""
    nodes = np.array([node for node, _ in free], dtype=np.int64)
    if not 0 < len(free) <= len(DISPLACEMENT_NAMES) or not tied:
        card.refuse(
            f"{len(free)} independent and {len(tied)} dependent components; expected one to six, "
            "and at least one"
        )
    origin = grids.nodes[nodes].mean(axis=0)
    size = float(np.abs(grids.nodes[nodes] - origin).max()) or 1.0
    motion = rigid_motions(free, grids, origin, size)
    following = rigid_motions(tied, grids, origin, size)
    weights = np.linalg.lstsq(motion.T, following.T, rcond=None)[0].T
    unique = np.linalg.svd(motion, compute_uv=False)[-1] > SOLVED
    if not unique or np.abs(weights @ motion - following).max() > SOLVED:
        card.refuse(
            "the independent components do not determine the rigid motion of the dependent "
            "components; choose others"
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
    """Return the basic components that contribute to components."""
    return [
        (node, c)
        for node, component in places
        for c, _ in grids.systems.basic_parts(node, component)
    ]


def solved(
    card: Card, rows: Matrix, candidates: Indices, columns: Sequence[Place]
) -> Iterator[Equation]:
    """Solve equations for the best conditioned candidates, one per equation."""
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


def rigid_motions(
    places: Sequence[Place], grids: Grids, origin: Vector, size: float = 1.0
) -> Matrix:
    """Return components (n, 6) in the six rigid motions, with rotations times a length."""
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
    """Return the factors (n,) of components."""
    return np.array([1.0 if component < 3 else size for _, component in places])


Mean = dict[int, float]
"""Nodes to their weights in a mean motion."""


def read_shell_to_solid(
    bulk: BulkData, solids: Sequence[CellBlock], shells: Sequence[ShellBlock]
) -> Iterator[Equation]:
    """Yield the equations of RSSCON, once for a node of two shells."""
    done: set[int] = set()
    for card in bulk.cards.get("RSSCON", ()):
        by_grids = card.text(1) == "GRID"
        connections = (
            _of_grids(card, bulk.grids)
            if by_grids
            else _of_elements(card, solids, shells, bulk.grids)
        )
        for node, below, above in connections:
            if node not in done:
                done.add(node)
                yield from _clamped(card, bulk.grids.nodes, node, below, above)


def _of_grids(card: Card, grids: Grids) -> list[tuple[int, Mean, Mean]]:
    rows = [[grids.one(card, field + j) for j in range(3)] for field in (2, 5) if card.text(field)]
    return [(shell, {below: 1.0}, {above: 1.0}) for shell, below, above in rows]


def _of_elements(
    card: Card, solids: Sequence[CellBlock], shells: Sequence[ShellBlock], grids: Grids
) -> list[tuple[int, Mean, Mean]]:
    """Return the connection of an edge of shell ES1 to a face of solid EA1."""
    edges = _edges(card, shells, card.integer(2))
    if card.text(4) or card.text(5):
        card.refuse("one shell with one solid is supported; give another RSSCON for others", 4)
    faces = _faces(card, solids, card.integer(3))
    connections = [
        connection
        for face in faces
        for edge in edges
        if (connection := _on_face(grids.nodes, edge, face))
    ]
    if connections:
        # An edge along a side of the solid lies on two faces: one continues the shell, the other
        # goes through its thickness.
        corners = grids.nodes[[edge[0] for edge in edges]]
        normal = np.cross(corners[1] - corners[0], corners[-1] - corners[0])

        def across(connection: list[tuple[int, Mean, Mean]]) -> float:
            _, below, above = connection[0]
            h = _middle(grids.nodes, above) - _middle(grids.nodes, below)
            return float(abs(h @ normal) / np.linalg.norm(h))

        return max(connections, key=across)
    message = (
        f"no edge of shell {card.integer(2)} lies on a face of solid {card.integer(3)} with four "
        "corners; use TYPE = GRID"
    )
    raise card.error(message)


def _edges(card: Card, shells: Sequence[ShellBlock], number: int) -> list[list[int]]:
    """Return the nodes of each edge of a shell: two corners, and any mid-side node."""
    for block in shells:
        for nodes in block.nodes[block.ids == number].tolist():
            count = 3 if block.kind.startswith("tri") else 4
            between = nodes[count:]
            pairs = [[nodes[i], nodes[(i + 1) % count]] for i in range(count)]
            return [[*pair, *between[i : i + 1]] for i, pair in enumerate(pairs)]
    message = f"element {number} is not a shell of the deck"
    raise card.error(message, 2)


def _faces(card: Card, solids: Sequence[CellBlock], number: int) -> list[Indices]:
    """Return the quadrilateral faces of a solid, corners before mid-side nodes."""
    for block in solids:
        for nodes in block.nodes[block.ids == number]:
            faces = SOLIDS[block.kind].faces
            return [nodes[list(local)] for face, local in faces if face.n_corners == 4]
    message = f"element {number} is not a solid of the deck"
    raise card.error(message, 3)


def _on_face(nodes: Matrix, edge: list[int], face: Indices) -> list[tuple[int, Mean, Mean]]:
    """Return the means below and above each node of an edge; empty if it is not on the face.

    The edge runs from one side of the face to the opposite side, between the other two.
    """
    corners = nodes[face[:4]]
    # Parameters from 0 to 1: exact on a flat parallelogram, least squares otherwise.
    sides = (corners[[1, 3]] - corners[0] + corners[2] - corners[[3, 1]]) / 2
    beside = (nodes[edge] - corners.mean(axis=0)).T
    places = np.linalg.lstsq(sides.T, beside, rcond=None)[0].T + 0.5
    apart = np.abs(shape_functions("quad4", places) @ corners - nodes[edge]).max()
    if np.abs(places - 0.5).max() > 0.5 + SHORT_DIGITS:
        return []
    if apart > SHORT_DIGITS * float(np.ptp(corners, axis=0).max()):
        return []
    ends = np.stack([places, places])
    across = int(np.abs(places[1] - places[0]).argmin())
    ends[0, :, across], ends[1, :, across] = 0.0, 1.0
    kind = "quad4" if len(face) == 4 else "quad8"
    below, above = (
        [
            {
                node: part
                for node, part in zip(face.tolist(), row, strict=True)
                if abs(part) > SOLVED
            }
            for row in shape_functions(kind, end).tolist()
        ]
        for end in ends
    )
    return list(zip(edge, below, above, strict=True))


def _middle(nodes: Matrix, mean: Mean) -> Vector:
    return np.asarray(np.array([*mean.values()]) @ nodes[[*mean]])


def _clamped(card: Card, nodes: Matrix, node: int, below: Mean, above: Mean) -> Iterator[Equation]:
    low, high = _middle(nodes, below), _middle(nodes, above)
    h = high - low
    square = float(h @ h)
    if not square > 0:
        card.refuse("points of the solid below and above a node of the shell coincide")
    t = float((nodes[node] - low) @ h) / square
    columns = [(node, c) for c in range(6)]
    columns += [(k, c) for k in sorted({*below, *above} - {node}) for c in range(3)]
    column_of = {dof: k for k, dof in enumerate(columns)}
    across = np.linalg.svd(h[None])[2][1:]
    rows = np.zeros((5, len(columns)))
    rows[:3, :3] = np.eye(3)
    rows[3:, 3:6] = across
    for sign, part, dof in ((-1, 1 - t, below), (1, t, above)):
        for k, weight in dof.items():
            for c in range(3):
                rows[c, column_of[k, c]] -= part * weight
                turn = np.cross(h, np.eye(3)[c]) / square
                rows[3:, column_of[k, c]] -= sign * weight * across @ turn
    # A node of the solid needs no equations for its translations.
    free = node in below or node in above
    first = 3 if free else 0
    yield from solved(card, rows[first:], np.arange(first, 6), columns)
