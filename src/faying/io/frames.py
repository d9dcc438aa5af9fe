"""Coordinate systems of decks, and nodes whose components are along them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Mask, Matrix, frozen
from faying.digits import ROUND_OFF
from faying.model.assembly import Support


@dataclass(frozen=True, eq=False, kw_only=True)
class Frame:
    """A coordinate system.

    Attributes
    ----------
    kind
        ``"R"`` rectangular, ``"C"`` cylindrical (r, θ, z), ``"S"`` spherical with the angle from
        the z axis before that about it (Nastran), ``"E"`` spherical with the angle about the z
        axis before the elevation above the x-y plane (Abaqus). Angles are in degrees.
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
        if self.kind == "R":
            local = points
        elif self.kind == "C":
            angle = np.radians(b)
            local = np.stack([a * np.cos(angle), a * np.sin(angle), c], axis=1)
        else:
            polar, around = map(np.radians, (b, c) if self.kind == "S" else (90.0 - c, b))
            ring = a * np.sin(polar)
            local = np.stack(
                [ring * np.cos(around), ring * np.sin(around), a * np.cos(polar)], axis=1
            )
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
            outward = np.stack([s * cos, s * sin, c], axis=1)
            down = np.stack([c * cos, c * sin, -s], axis=1)
            rows = [outward, down, around] if self.kind == "S" else [outward, around, -down]
        local = np.stack(rows, axis=1)
        local[~off] = np.eye(3)
        return np.asarray(local @ self.axes)


BASIC = Frame(kind="R", origin=frozen(np.zeros(3)), axes=frozen(np.eye(3)))


@dataclass(frozen=True, eq=False, kw_only=True)
class NodeAxes:
    """The coordinate systems of a deck with the nodes that use them.

    Attributes
    ----------
    frames
        Systems by number; 0 is the basic one.
    nodes : (n_node, 3) [length]
    displacement : (n_node,)
        System of the displacement components of each node.
    """

    frames: Mapping[int, Frame]
    nodes: Matrix
    displacement: Indices

    @property
    def n_on_axis(self) -> int:
        """Number of nodes on the axis of their system."""
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

    def supports(self, fixed: Mask, number: int) -> Iterator[Support]:
        """Yield supports of fixed components (n_node, 6), one for nodes of the same kind.

        These have equal components and directions, which do not matter where all translations,
        or all rotations, are fixed together.
        """
        nodes = np.flatnonzero(fixed.any(axis=1))
        axes = self.axes_of(nodes)
        whole = np.isin(fixed[nodes].reshape(-1, 2, 3).sum(axis=2), (0, 3)).all(axis=1)
        axes[whole] = np.eye(3)
        # Rounding at 1e-12 joins nodes whose directions differ by arithmetic only.
        keys = np.hstack([fixed[nodes], np.round(axes.reshape(-1, 9), 12)])
        _, first, which = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        for i, row in enumerate(first.tolist()):
            turned = not np.allclose(axes[row], np.eye(3), rtol=0, atol=ROUND_OFF)
            yield Support(
                id=number,
                nodes=nodes[which.ravel() == i],
                components=tuple(np.flatnonzero(fixed[nodes[row]]).tolist()),
                axes=axes[row] if turned else None,
            )
