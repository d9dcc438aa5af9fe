"""A deck with its nodes, elements, sets and local axes."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from faying._typing import Indices
from faying.digits import SOLVED
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import Line, only_line
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.mesh import SYSTEMS, Elements, Nodes, read_elements, read_nodes
from faying.io.abaqus.sets import NamedSets, read_element_sets, read_node_sets
from faying.io.frames import BASIC, Frame, NodeAxes
from faying.model.axes import axes_along


@dataclass(frozen=True, eq=False, kw_only=True)
class DeckData:
    """A deck with its nodes, elements and sets, and its degrees of freedom in the model.

    Attributes
    ----------
    local
        Local axes of nodes: of *TRANSFORM, and of reference nodes of *DISTRIBUTING with an
        ORIENTATION, as in CalculiX.
    rotations
        Index of the node whose rotations are the translations of a rotation node of CalculiX,
        by index of the rotation node.
    """

    deck: Deck
    nodes: Nodes
    elements: Elements
    element_sets: NamedSets
    node_sets: NamedSets
    local: NodeAxes
    rotations: Mapping[int, int] = field(default_factory=dict)

    def find(self, line: Line, column: int = 0) -> Indices:
        """Return the node indices of a field: an id, or a node set."""
        ids = self.node_sets.members(line.keyword, line.text(column), line.row)
        return self.nodes.index(ids, line.keyword, np.full(len(ids), line.row))

    def named_nodes(self, keyword: Keyword, name: str) -> Indices:
        """Return the node indices of the set of a parameter."""
        ids = self.node_sets.find(keyword, keyword.required(name))
        return self.nodes.index(ids, keyword, np.full(len(ids), -1))

    def one(self, keyword: Keyword, row: int | None, label: str, what: str) -> int:
        """Return the node index of a field for a single node."""
        ids = self.node_sets.members(keyword, label, row)
        if len(ids) != 1:
            keyword.refuse(f"'{label}' has {len(ids)} nodes; {what} is one node", row)
        rows = np.array([-1 if row is None else row])
        if not np.isin(ids, self.nodes.ids).all():
            keyword.refuse(f"there is no node {label}; define it under *NODE", row)
        return int(self.nodes.index(ids, keyword, rows)[0])

    def along(self, nodes: Indices, frame: Frame) -> "DeckData":
        """Return the data with local axes of some nodes."""
        number, local = len(self.local.frames), self.local
        displacement = local.displacement.copy()
        displacement[nodes] = number
        frames = {**local.frames, number: frame}
        return replace(self, local=replace(local, frames=frames, displacement=displacement))

    def parts(self, node: int, component: int) -> list[tuple[int, int, float]]:
        """Return a degree of freedom of the deck as nodes, components and factors in the model.

        The largest factor comes first.
        """
        if node in self.rotations and component < 3:
            return [(self.rotations[node], component + 3, 1.0)]
        parts = ((node, c, factor) for c, factor in self.local.basic_parts(node, component))
        return sorted(parts, key=lambda part: -abs(part[2]))


def read_data(deck: Deck) -> DeckData:
    """Read the nodes, elements and sets of a deck."""
    nodes = read_nodes(deck)
    elements = read_elements(deck, nodes)
    element_sets = read_element_sets(deck, elements)
    return DeckData(
        deck=deck,
        nodes=nodes,
        elements=elements,
        element_sets=element_sets,
        node_sets=read_node_sets(deck, nodes, elements, element_sets),
        local=NodeAxes(
            frames={0: BASIC},
            nodes=nodes.coordinates,
            displacement=np.zeros(len(nodes.ids), dtype=np.int64),
        ),
    )


def with_transforms(data: DeckData) -> DeckData:
    """Return the data with the local axes of all *TRANSFORM."""
    for keyword in data.deck.of("TRANSFORM"):
        line = only_line(keyword, range(7), "the coordinates of two points a and b")
        kind, nodes = keyword.choice("TYPE"), data.named_nodes(keyword, "NSET")
        frame = rectangular(line) if kind == "R" else about_axis(line, SYSTEMS[kind])
        data = data.along(nodes, frame)
    if count := data.local.n_on_axis:
        data.deck.ignored.append(f"{count} nodes on the axis of their *TRANSFORM: {ON_AXIS}")
    return data


ON_AXIS = "any direction normal to it is radial there; that of CalculiX is used"


def rectangular(line: Line) -> Frame:
    """Return the system of points a and b, and of an origin after them if given."""
    first, second, origin = line.padded(9, "a coordinate").reshape(3, 3)
    axes = axes_along(first - origin, second - origin)
    if axes is None:
        line.refuse("points a and b lie on one line with the origin; they must span a plane")
    return Frame(kind="R", origin=origin, axes=axes)


def about_axis(line: Line, kind: str) -> Frame:
    """Return a cylindrical or spherical system about the line between two points.

    Its x axis is the direction that CalculiX uses as radial on the axis.
    """
    origin, end = line.padded(6, "a coordinate").reshape(2, 3)
    axis = end - origin
    length = float(np.linalg.norm(axis))
    if not length > 0:
        line.refuse("the two points of the axis coincide")
    axis = axis / length
    if abs(axis[0]) > SOLVED:
        radial = np.array([-axis[1] / axis[0], 1.0, 0.0])
    elif abs(axis[1]) > SOLVED:
        radial = np.array([0.0, -axis[2] / axis[1], 1.0])
    else:
        radial = np.array([1.0, 0.0, 0.0])
    radial /= np.linalg.norm(radial)
    axes = np.stack([radial, np.cross(axis, radial), axis])
    return Frame(kind=kind, origin=origin, axes=axes)


def component(line: Line, column: int) -> int:
    """Return the component 0..5 of a field 1..6."""
    value = line.integer(column, "a degree of freedom")
    if not 1 <= value <= 6:
        line.refuse(
            f"found degree of freedom {value}, expected 1 to 6 (displacements and rotations)"
        )
    return value - 1


def component_range(line: Line, column: int) -> range:
    """Return the components 0..5 between two fields, of which the last may be blank."""
    first = component(line, column)
    last = component(line, column + 1) if line.text(column + 1) else first
    if last < first:
        line.refuse(f"the last degree of freedom {last + 1} is below the first {first + 1}")
    return range(first, last + 1)
