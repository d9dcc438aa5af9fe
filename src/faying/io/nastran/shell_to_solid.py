"""RSSCON: an edge of a shell clamped to a face of a solid.

MSC Nastran Quick Reference Guide: translations of the edge are those of the solid, and its two
rotations follow what the lower and upper edges of the face do to each other. With A below and B
above a node of the shell at the part t of h = x_B - x_A its motion is u = (1 - t) u_A + t u_B, and
θ = h × (u_B - u_A) / h² but for the turn about h, which stays that of the shell.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card
from faying.io.nastran.grids import Grids
from faying.io.nastran.rigid_elements import solved
from faying.io.nastran.solids import Solids
from faying.model.assembly import Equation
from faying.model.elements import SOLIDS
from faying.model.shells import ShellBlock

Mean = dict[int, float]
"""Nodes to the parts of a motion they make up."""

_SIDES = ((0, 1), (1, 2), (2, 3), (3, 0))
_LARGEST_DISTANCE = 1e-3
"""Distance from a face, in its size, that an edge of a shell may have."""


def read_shell_to_solid(
    bulk: BulkData, solids: Solids, shells: Sequence[ShellBlock]
) -> Iterator[Equation]:
    """Yield the equations of RSSCON, those of a node of two shells once."""
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
    card: Card, solids: Solids, shells: Sequence[ShellBlock], grids: Grids
) -> list[tuple[int, Mean, Mean]]:
    """Edge of shell ES1 on a face of solid EA1."""
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
    """Nodes of the edges of a shell: two corners, and the node between if there is one."""
    for block in shells:
        for nodes in block.nodes[block.ids == number].tolist():
            count = 3 if block.kind.startswith("tri") else 4
            between = nodes[count:]
            pairs = [[nodes[i], nodes[(i + 1) % count]] for i in range(count)]
            return [[*pair, *between[i : i + 1]] for i, pair in enumerate(pairs)]
    message = f"element {number} is no shell of the deck"
    raise card.error(message, 2)


def _faces(card: Card, solids: Solids, number: int) -> list[Indices]:
    """Faces of four corners of a solid, mid-side nodes behind."""
    for block in solids.blocks:
        for nodes in block.nodes[block.ids == number]:
            faces = SOLIDS[block.kind].faces
            return [nodes[list(local)] for face, local in faces if face.n_corners == 4]
    message = f"element {number} is no solid of the deck"
    raise card.error(message, 3)


def _on_face(nodes: Matrix, edge: list[int], face: Indices) -> list[tuple[int, Mean, Mean]]:
    """Find what is below and above each node of an edge; nothing if it is not on the face.

    The edge runs from one side of the face to the opposite one, between the other two sides.
    """
    corners = nodes[face[:4]]
    size = float(np.ptp(corners, axis=0).max())
    for first in (0, 1):
        # Below runs from corner a to b, above beside it from d to c.
        a, b, c, d = (int(face[(first + k) % 4]) for k in range(4))
        ends = []
        for node in edge:
            s, t = _place(nodes, (a, b, c, d), nodes[node])
            point = (1 - t) * ((1 - s) * nodes[a] + s * nodes[b]) + t * (
                (1 - s) * nodes[d] + s * nodes[c]
            )
            if np.abs(point - nodes[node]).max() > _LARGEST_DISTANCE * size:
                return []
            if min(s, t) < -_LARGEST_DISTANCE or max(s, t) > 1 + _LARGEST_DISTANCE:
                return []
            between = face[4:].tolist()
            low = between[first] if between else None
            high = between[(first + 2) % 4] if between else None
            ends.append((s, t, node, _along(a, b, low, s), _along(d, c, high, s)))
        (s0, t0, *_), (s1, t1, *_) = ends[:2]
        if abs(t1 - t0) < abs(s1 - s0):
            return [(node, below, above) for _, _, node, below, above in ends]
    return []


def _place(nodes: Matrix, corners: tuple[int, ...], point: Vector) -> tuple[float, float]:
    """Parameters of a point on a flat parallelogram, least squares on others."""
    a, b, c, d = (nodes[k] for k in corners)
    along, up = ((b - a) + (c - d)) / 2, ((d - a) + (c - b)) / 2
    middle = (a + b + c + d) / 4
    s, t = np.linalg.lstsq(np.column_stack([along, up]), point - middle, rcond=None)[0]
    return float(s) + 0.5, float(t) + 0.5


def _along(start: int, end: int, between: int | None, s: float) -> Mean:
    """Shape functions of a side at s from 0 to 1."""
    if between is None:
        parts = {start: 1 - s, end: s}
    else:
        parts = {start: (1 - s) * (1 - 2 * s), end: s * (2 * s - 1), between: 4 * s * (1 - s)}
    return {node: value for node, value in parts.items() if abs(value) > _LARGEST_DISTANCE**3}


def _middle(nodes: Matrix, mean: Mean) -> Vector:
    return np.asarray(np.array([*mean.values()]) @ nodes[[*mean]])


def _clamped(card: Card, nodes: Matrix, node: int, below: Mean, above: Mean) -> Iterator[Equation]:
    low, high = _middle(nodes, below), _middle(nodes, above)
    h = high - low
    square = float(h @ h)
    if not square > 0:
        card.refuse("the places of the solid below and above a node of the shell are one")
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
    # A node of the solid itself needs nothing for its translations.
    free = node in below or node in above
    first = 3 if free else 0
    yield from solved(card, rows[first:], np.arange(first, 6), columns)
