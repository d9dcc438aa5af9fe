"""A deck with its nodes, elements, sets and local axes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import integer, only_line, padded
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.mesh import Elements, Nodes, read_elements, read_nodes
from faying.io.abaqus.sets import NamedSets, read_element_sets, read_node_sets
from faying.model.axes import axes_along


@dataclass(frozen=True, eq=False, kw_only=True)
class DeckData:
    """A deck with its nodes, elements and sets, and its degrees of freedom in the model.

    Attributes
    ----------
    system : (n_node,)
        Number of the *TRANSFORM of each node, -1 for none.
    transforms
        The *TRANSFORM keywords.
    rotations
        Index of the node whose rotations are the translations of a rotation node of CalculiX,
        by index of the rotation node.
    turned
        Axes of reference nodes of *DISTRIBUTING with an ORIENTATION, as in CalculiX.
    """

    deck: Deck
    nodes: Nodes
    elements: Elements
    element_sets: NamedSets
    node_sets: NamedSets
    system: Indices
    transforms: Sequence[Keyword] = ()
    rotations: Mapping[int, int] = field(default_factory=dict)
    turned: Mapping[int, Matrix] = field(default_factory=dict)

    def find(self, keyword: Keyword, row: int, label: str) -> Indices:
        """Return the node indices of a field: an id, or a node set."""
        ids = self.node_sets.members(keyword, label, row)
        return self.nodes.index(ids, keyword, np.full(len(ids), row))

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

    def axes(self, node: int) -> Matrix | None:
        """Return the local axes (3, 3) of a node as rows; None for the basic frame."""
        number = int(self.system[node])
        if number < 0:
            return self.turned.get(node)
        return _axes(self.transforms[number], self.nodes.coordinates[node])

    def place(self, node: int, component: int) -> tuple[int, int]:
        """Return node and component in the model of a degree of freedom of the deck."""
        if node in self.rotations and component < 3:
            return self.rotations[node], component + 3
        return node, component


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
        system=np.full(len(nodes.ids), -1),
    )


def with_transforms(data: DeckData) -> DeckData:
    """Return the data with the local axes of all *TRANSFORM."""
    system = data.system.copy()
    transforms = data.deck.of("TRANSFORM")
    for number, keyword in enumerate(transforms):
        system[data.named_nodes(keyword, "NSET")] = number
        first, second = _points(keyword)
        _axes(keyword, first + 0.371 * second + np.array([0.1, 0.7, 0.3]))
    return replace(data, system=system, transforms=transforms)


def _points(keyword: Keyword) -> tuple[Vector, Vector]:
    fields = only_line(keyword, range(7), "the coordinates of two points a and b")
    values = padded(keyword, 0, fields, 6, "a coordinate")
    return values[:3], values[3:]


def _axes(keyword: Keyword, point: Vector) -> Matrix:
    """Return local axes at a point: rectangular, cylindrical (r, t, z) or spherical."""
    first, second = _points(keyword)
    arm, axis = point - first, second - first
    # x, and a direction of its plane with y
    x, plane = {
        "R": (first, second),
        "C": (arm - axis * (arm @ axis) / (float(axis @ axis) or 1.0), np.cross(axis, arm)),
        "S": (arm, np.cross(axis, arm)),
    }[keyword.choice("TYPE")]
    axes = axes_along(x, plane)
    if axes is None:
        keyword.refuse(
            "the axes are not defined: points coincide or lie on one line, or a node on it", 0
        )
    return axes


def component(keyword: Keyword, row: int, text: str) -> int:
    """Return the component 0..5 of a field 1..6."""
    value = integer(keyword, row, text, "a degree of freedom")
    if not 1 <= value <= 6:
        keyword.refuse(
            f"found degree of freedom {value}, expected 1 to 6 (displacements and rotations)", row
        )
    return value - 1


def component_range(keyword: Keyword, row: int, fields: list[str]) -> range:
    """Return the components 0..5 between two fields, of which the last may be blank."""
    first = component(keyword, row, fields[0])
    last = component(keyword, row, fields[1]) if len(fields) > 1 and fields[1] else first
    if last < first:
        keyword.refuse(f"the last degree of freedom {last + 1} is below the first {first + 1}", row)
    return range(first, last + 1)
