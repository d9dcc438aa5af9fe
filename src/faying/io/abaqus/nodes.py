"""``*NODE``: ids and coordinates in the basic frame."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.exceptions import FormatError
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import integers, padded, reals, table
from faying.io.abaqus.keyword import Keyword
from faying.model.axes import axes_along


@dataclass(frozen=True, eq=False, kw_only=True)
class Nodes:
    """All nodes, sorted by id.

    Attributes
    ----------
    ids : (n_node,)
        Increasing.
    coordinates : (n_node, 3) [length]
    """

    ids: Indices
    coordinates: Matrix

    def index(self, ids: Indices, keyword: Keyword, rows: Indices) -> Indices:
        """Return the indices of nodes; ``rows`` are the data lines they stand on."""
        index: Indices = np.minimum(np.searchsorted(self.ids, ids), len(self.ids) - 1)
        wrong = np.flatnonzero(self.ids[index] != ids)
        if wrong.size:
            shown = int(ids[wrong[0]]) - keyword.scope.offset
            keyword.refuse(
                f"there is no node {shown}; define it under *NODE or correct the id",
                int(rows[wrong[0]]),
            )
        return index


def read_nodes(deck: Deck) -> Nodes:
    """Read all *NODE, with the *SYSTEM in force and the position of their instance."""
    ids, coordinates, owners, rows = [], [], [], []
    system: tuple[Matrix, Vector] | None = None
    for keyword in deck.of("NODE", "SYSTEM"):
        if keyword.name == "SYSTEM":
            system = _system(keyword)
            continue
        numbers, points, lines = _node_block(keyword, system, deck.ignored)
        owners.append(keyword)
        ids.append(numbers + keyword.scope.offset)
        coordinates.append(points)
        rows.append(lines)
    if not ids or not sum(map(len, ids)):
        message = f"{deck.path}: the deck has no nodes; it needs *NODE with data lines"
        raise FormatError(message)
    all_ids, points = np.concatenate(ids), np.concatenate(coordinates)
    order = np.argsort(all_ids, kind="stable")
    again = np.flatnonzero(np.diff(all_ids[order]) == 0)
    if again.size:
        position = int(order[again[0] + 1])
        block = int(np.searchsorted(np.cumsum([len(i) for i in ids]), position, side="right"))
        row = position - sum(len(i) for i in ids[:block])
        owners[block].refuse(
            f"node {all_ids[position]} is defined twice; remove one definition",
            int(rows[block][row]),
        )
    return Nodes(ids=all_ids[order], coordinates=points[order])


def _node_block(
    keyword: Keyword, system: tuple[Matrix, Vector] | None, ignored: list[str]
) -> tuple[Indices, Matrix, Indices]:
    keyword.check()
    if keyword.has("INPUT"):
        keyword.refuse("INPUT= is not supported; use *INCLUDE, INPUT=… below *NODE")
    expected = "id, x, y, z"
    columns, counts = table(keyword).columns(1, 7, f"{expected}, and a normal at most")
    if (counts > 4).any():
        ignored.append(
            f"{int((counts > 4).sum())} nodes with fields behind their coordinates (the first at "
            f"{keyword.where(int((counts > 4).argmax()))}): normals there are not taken"
        )
    # An id alone is a node whose place does not matter, such as that of a pretension section.
    short = np.flatnonzero((counts > 1) & (counts < 4))
    if short.size:
        # Both programs read zeros; a lost coordinate must not pass for one unseen.
        ignored.append(
            f"{len(short)} nodes with fewer than three coordinates (the first at "
            f"{keyword.where(int(short[0]))}): those left out are zero"
        )
    rows = np.arange(len(keyword.data), dtype=np.int64)
    ids = integers(columns[0], keyword, rows, "a node id")
    if ids.size and ids.min() < 1:
        keyword.refuse(f"node id {ids.min()}; ids are positive", int(ids.argmin()))
    points = np.column_stack([reals(c, keyword, rows, "a coordinate") for c in columns[1:4]])
    points = _cartesian(keyword, points)
    if system is not None:
        points = points @ system[0] + system[1]
    return ids, points @ keyword.scope.rotation.T + keyword.scope.translation, rows


def _cartesian(keyword: Keyword, points: Matrix) -> Matrix:
    kind = keyword.choice("SYSTEM")
    if kind == "R":
        return points
    first, angle, third = points[:, 0], np.radians(points[:, 1]), points[:, 2]
    if kind == "C":
        return np.column_stack([first * np.cos(angle), first * np.sin(angle), third])
    height = np.radians(third)
    flat = first * np.cos(height)
    return np.column_stack([flat * np.cos(angle), flat * np.sin(angle), first * np.sin(height)])


def _system(keyword: Keyword) -> tuple[Matrix, Vector] | None:
    """Axes (rows) and origin of local coordinates; without data, back to the basic frame."""
    keyword.check()
    rows = keyword.rows()
    if not rows:
        return None
    values = [padded(keyword, i, row, 6, "a coordinate") for i, row in enumerate(rows[:2])]
    origin = values[0][:3]
    x = values[0][3:] - origin
    # Without a second line z stays and y is perpendicular to it and x.
    y = values[1][:3] - origin if len(rows) > 1 else np.cross([0.0, 0.0, 1.0], x)
    axes = axes_along(x, y)
    if len(rows) > 2 or axes is None:
        keyword.refuse(
            "expected the origin and a point on the x axis, then a point in the x-y plane", 0
        )
    return axes, origin
