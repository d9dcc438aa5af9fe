"""``*RIGID BODY``: nodes that follow a reference node."""

from collections.abc import Iterator

import numpy as np

from faying._typing import Indices
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.dofs import Dofs
from faying.io.abaqus.elements import Elements
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.nodes import Nodes
from faying.io.abaqus.sets import NamedSets
from faying.model.assembly import RigidCoupling


def rotation_nodes(deck: Deck, nodes: Nodes, sets: NamedSets) -> dict[int, int]:
    """Return CalculiX's rotation nodes: their index to that of the reference node.

    Raises
    ------
    FormatError
        If a node is not there.
    """
    found = {}
    plain = Dofs(nodes=nodes, sets=sets, system=np.full(len(nodes.ids), -1), transforms=())
    for keyword in deck.of("RIGID BODY"):
        if keyword.has("ROT NODE"):
            what = "the rotation node"
            rotation = plain.one(keyword, None, keyword.required("ROT NODE"), what)
            reference = plain.one(keyword, None, keyword.required("REF NODE"), "the reference node")
            if rotation == reference or rotation in found:
                message = "the rotation node must be a node of its own"
                raise keyword.error(message)
            found[rotation] = reference
    return found


def read_rigid_bodies(
    deck: Deck, dofs: Dofs, elements: Elements, by_element: NamedSets, first_id: int
) -> Iterator[RigidCoupling]:
    """Read all *RIGID BODY of CalculiX (NSET or ELSET) and Abaqus (PIN NSET, TIE NSET, ELSET).

    Raises
    ------
    FormatError
        Naming the line, if a set or the reference node is missing.
    """
    number = first_id
    for keyword in deck.of("RIGID BODY"):
        keyword.allow("NSET", "ELSET", "REF NODE", "ROT NODE", "PIN NSET", "TIE NSET", "POSITION")
        if keyword.choice("POSITION", "INPUT") != "INPUT":
            message = "POSITION=CENTER OF MASS is not supported; place the reference node yourself"
            raise keyword.error(message)
        reference = dofs.one(keyword, None, keyword.required("REF NODE"), "the reference node")
        groups = _groups(keyword, dofs, elements, by_element)
        if not sum(len(nodes) for nodes, _ in groups):
            message = "it names no nodes; give NSET=, ELSET=, PIN NSET= or TIE NSET="
            raise keyword.error(message)
        for nodes, components in groups:
            others = nodes[nodes != reference]
            if len(others):
                yield RigidCoupling(
                    id=number, reference=reference, nodes=others, components=components
                )
                number += 1


def _groups(
    keyword: Keyword, dofs: Dofs, elements: Elements, by_element: NamedSets
) -> list[tuple[Indices, tuple[int, ...]]]:
    groups: list[tuple[Indices, tuple[int, ...]]] = []
    for name, components in (("NSET", range(3)), ("PIN NSET", range(3)), ("TIE NSET", range(6))):
        if keyword.has(name):
            ids = dofs.sets.find(keyword, keyword.required(name))
            nodes = dofs.nodes.index(ids, keyword, np.full(len(ids), -1))
            groups.append((nodes, tuple(components)))
    if keyword.has("ELSET"):
        ids = by_element.find(keyword, keyword.required("ELSET"))
        parts = [b.nodes[np.isin(b.ids, ids)].ravel() for b in elements.blocks]
        groups.append((np.unique(np.concatenate(parts)), tuple(range(6))))
    return groups
