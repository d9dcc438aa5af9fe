"""CORD1R/C/S, CORD2R/C/S: coordinate systems in the basic frame."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from faying._typing import Indices, Mask, Matrix, frozen
from faying.digits import ROUND_OFF
from faying.io.nastran.cards import Card, Cards
from faying.model.axes import axes_along

CARDS = "CORD2R, ..."
"""Cards of coordinate systems."""

ON_AXIS = (
    "GRID on the axis of their displacement system, which has no radial direction there: faying "
    "takes the system's x axis, Nastran a direction that depends on rounding"
)
"""Note on grid points on such an axis, after their number."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Frame:
    """A coordinate system.

    Attributes
    ----------
    kind
        ``"R"`` rectangular, ``"C"`` cylindrical (r, θ, z) or ``"S"`` spherical (r, θ, φ), degrees.
    origin : (3,) [length]
    axes : (3, 3)
        Rows are the rectangular axes in the basic frame.
    """

    kind: str
    origin: Matrix
    axes: Matrix

    def to_basic(self, points: Matrix) -> Matrix:
        """Return basic coordinates of points (n, 3) in this system."""
        a, b, c = points.T
        if self.kind == "C":
            angle = np.radians(b)
            local = np.stack([a * np.cos(angle), a * np.sin(angle), c], axis=1)
        elif self.kind == "S":
            polar, around = np.radians(b), np.radians(c)
            ring = a * np.sin(polar)
            local = np.stack(
                [ring * np.cos(around), ring * np.sin(around), a * np.cos(polar)], axis=1
            )
        else:
            local = points
        return np.asarray(local @ self.axes + self.origin)

    def on_axis(self, points: Matrix) -> Mask:
        """Return which basic points (n, 3) lie on the axis, without a radial direction."""
        if self.kind == "R":
            return np.zeros(len(points), dtype=bool)
        x, y, _ = ((points - self.origin) @ self.axes.T).T
        scale = max(
            float(np.abs(points).max(initial=0.0)), float(np.abs(self.origin).max()), 1e-300
        )
        return np.asarray(np.hypot(x, y) <= ROUND_OFF * scale)

    def directions(self, points: Matrix) -> Matrix:
        """Return unit vectors (n, 3, 3), one per row, along the components at basic points.

        On the axis of a cylindrical or spherical system its rectangular axes are used.
        """
        if self.kind == "R":
            return np.broadcast_to(self.axes, (len(points), 3, 3))
        x, y, z = ((points - self.origin) @ self.axes.T).T
        ring = np.hypot(x, y)
        off = ~self.on_axis(points)
        safe = np.where(off, ring, 1.0)
        cos, sin = np.where(off, x / safe, 1.0), np.where(off, y / safe, 0.0)
        zero, ones = np.zeros_like(x), np.ones_like(x)
        around = np.stack([-sin, cos, zero], axis=1)
        if self.kind == "C":
            rows = [
                np.stack([cos, sin, zero], axis=1),
                around,
                np.stack([zero, zero, ones], axis=1),
            ]
        else:
            radius = np.where(off, np.hypot(ring, z), 1.0)
            s, c = ring / radius, z / radius
            rows = [
                np.stack([s * cos, s * sin, c], axis=1),
                np.stack([c * cos, c * sin, -s], axis=1),
                around,
            ]
        local = np.stack(rows, axis=1)
        local[~off] = np.eye(3)
        return np.asarray(local @ self.axes)


BASIC = Frame(kind="R", origin=frozen(np.zeros(3)), axes=frozen(np.eye(3)))


def missing_system(number: int) -> str:
    """Return the message for a missing coordinate system."""
    return f"coordinate system {number} is not in the deck; define it ({CARDS})"


class _Definition(NamedTuple):
    """Definition of a frame: three points (3, 3), and the system of each."""

    card: Card
    systems: list[int]
    points: Matrix


def read_frames(
    cards: Mapping[str, Cards], locate: Callable[[int, Card], tuple[int, Matrix]]
) -> dict[int, Frame]:
    """Return all coordinate systems of a deck in the basic frame.

    ``locate`` maps a grid id to its coordinate system and its coordinates (3,) there.
    """
    waiting = _definitions(cards, locate)
    frames = {0: BASIC}
    while waiting:
        ready = {
            number: _frame(definition, frames)
            for number, definition in waiting.items()
            if frames.keys() >= set(definition.systems)
        }
        if not ready:
            number, (card, systems, _) = next(iter(waiting.items()))
            card.refuse(
                f"coordinate system {number} refers to system "
                f"{next(system for system in systems if system not in frames)}, which is missing "
                "or refers back to it; define it"
            )
        frames |= ready
        waiting = {number: d for number, d in waiting.items() if number not in ready}
    return frames


def _definitions(
    cards: Mapping[str, Cards], locate: Callable[[int, Card], tuple[int, Matrix]]
) -> dict[int, _Definition]:
    definitions: dict[int, _Definition] = {}
    for card in (card for kind in "RCS" for card in cards.get(f"CORD2{kind}", ())):
        points = card.reals(range(2, 11), 0.0).reshape(3, 3)
        _add(definitions, card, [card.integer(1, 0)] * 3, points)
    for card in (card for kind in "RCS" for card in cards.get(f"CORD1{kind}", ())):
        for fields in card.groups(0, 4):
            places = [locate(fields.integer(j), fields) for j in (1, 2, 3)]
            systems, coordinates = zip(*places, strict=True)
            _add(definitions, fields, [*systems], np.array(coordinates))
    return definitions


def _add(
    definitions: dict[int, _Definition], card: Card, systems: list[int], points: Matrix
) -> None:
    number = card.integer(0)
    if number in definitions:
        where = definitions[number].card.where()
        card.refuse(f"coordinate system {number} is already defined at {where}; give it another id")
    if number <= 0:
        card.refuse(f"coordinate system id {number} must be positive")
    definitions[number] = _Definition(card, systems, points)


def _frame(definition: _Definition, frames: Mapping[int, Frame]) -> Frame:
    card, systems, points = definition
    a, b, c = (
        frames[system].to_basic(xyz[None])[0] for system, xyz in zip(systems, points, strict=True)
    )
    axes = axes_along(b - a, c - a)
    if axes is None:
        card.refuse("its three points lie on one line, so they define no axes; move one of them")
    return Frame(kind=card.cards.name[-1], origin=a, axes=axes[[1, 2, 0]])


@dataclass(frozen=True, eq=False, kw_only=True)
class Systems:
    """The coordinate systems of a deck with the grid points that use them.

    Attributes
    ----------
    displacement : (n_node,)
        System of the displacement components of each node (CD).
    """

    frames: Mapping[int, Frame]
    nodes: Matrix
    displacement: Indices

    def frame_of(self, card: Card, field: int, number: int | None = None) -> Frame:
        """Return the system named in a field of a card, or the system ``number``."""
        number = card.integer(field, 0) if number is None else number
        return card.find(self.frames, field, "coordinate system", CARDS, number)

    def directions_at(self, cards: Cards, field: int, rows: Indices, points: Matrix) -> Matrix:
        """Return the directions (n, 3, 3) at points of the systems named in a field of cards.

        ``rows`` (n,) are the cards of the points.
        """
        systems = cards.integers(field, 0)[rows]
        result = np.empty((len(points), 3, 3))
        for number in np.unique(systems).tolist():
            these = np.flatnonzero(systems == number)
            if number not in self.frames:
                cards.refuse(int(rows[these[0]]), missing_system(number), field)
            result[these] = self.frames[number].directions(points[these])
        return result

    @property
    def n_on_axis(self) -> int:
        """Number of grid points on the axis of their system."""
        numbers = np.unique(self.displacement[self.displacement != 0]).tolist()
        return sum(
            int(self.frames[number].on_axis(self.nodes[self.displacement == number]).sum())
            for number in numbers
        )

    def axes(self, node: int) -> Matrix | None:
        """Return directions (3, 3) of the components of a node; None for the basic ones."""
        system = int(self.displacement[node])
        if system == 0:
            return None
        axes = self.frames[system].directions(self.nodes[node][None])[0]
        return None if np.allclose(axes, np.eye(3), rtol=0, atol=ROUND_OFF) else axes

    def basic_parts(self, node: int, component: int) -> list[tuple[int, float]]:
        """Return a component of a node as basic components with factors."""
        axes = self.axes(node)
        if axes is None:
            return [(component, 1.0)]
        first, row = 3 * (component // 3), axes[component % 3].tolist()
        return [(first + k, cosine) for k, cosine in enumerate(row) if abs(cosine) > ROUND_OFF]

    def axes_of(self, nodes: Indices) -> Matrix:
        """Return directions (n, 3, 3) of the components of several nodes."""
        result = np.broadcast_to(np.eye(3), (len(nodes), 3, 3)).copy()
        system = self.displacement[nodes]
        for number in np.unique(system[system != 0]).tolist():
            rows = system == number
            result[rows] = self.frames[number].directions(self.nodes[nodes[rows]])
        return result
