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
from faying.model.assembly import Equation, RigidCoupling

Group = tuple[Indices, tuple[int, ...]]
"""Nodes and the components in which they follow."""


def rotation_nodes(deck: Deck, nodes: Nodes, sets: NamedSets) -> dict[int, int]:
    """Return CalculiX's rotation nodes: their index to that of the first reference node."""
    return {rotation: reference for reference, rotation in reversed(_turning(deck, nodes, sets))}


def shared_rotations(deck: Deck, nodes: Nodes, sets: NamedSets, first_id: int) -> list[Equation]:
    """Return the equations by which bodies with one rotation node turn together."""
    pairs, first = _turning(deck, nodes, sets), rotation_nodes(deck, nodes, sets)
    others = [
        (reference, first[rotation])
        for reference, rotation in pairs
        if reference != first[rotation]
    ]
    return [
        Equation(id=first_id + i, terms=((reference, c, 1.0), (follower, c, -1.0)))
        for i, (reference, follower, c) in enumerate(
            (*pair, c) for pair in others for c in (3, 4, 5)
        )
    ]


def _turning(deck: Deck, nodes: Nodes, sets: NamedSets) -> list[tuple[int, int]]:
    """Return the reference and the rotation node of each rigid body that has one."""
    pairs = []
    plain = Dofs(nodes=nodes, sets=sets, system=np.full(len(nodes.ids), -1), transforms=())
    for keyword in deck.of("RIGID BODY"):
        if keyword.has("ROT NODE"):
            what = "the rotation node"
            rotation = plain.one(keyword, None, keyword.required("ROT NODE"), what)
            reference = _reference(keyword, plain, _named_nodes(keyword, plain))
            if rotation == reference:
                keyword.refuse("the rotation node must be another one than the reference node")
            pairs.append((reference, rotation))
    return pairs


def read_rigid_bodies(
    deck: Deck, dofs: Dofs, elements: Elements, by_element: NamedSets, first_id: int
) -> Iterator[RigidCoupling]:
    """Read all *RIGID BODY of CalculiX (NSET or ELSET) and Abaqus (PIN NSET, TIE NSET, ELSET)."""
    number = first_id
    for keyword in deck.of("RIGID BODY"):
        keyword.check()
        groups = _groups(keyword, dofs, elements, by_element)
        if not sum(len(nodes) for nodes, _ in groups):
            keyword.refuse("it names no nodes; give NSET=, ELSET=, PIN NSET= or TIE NSET=")
        reference = _reference(keyword, dofs, groups)
        for nodes, components in groups:
            others = nodes[nodes != reference]
            if len(others):
                yield RigidCoupling(
                    id=number, reference=reference, nodes=others, components=components
                )
                number += 1


def _reference(keyword: Keyword, dofs: Dofs, groups: list[Group]) -> int:
    """Return the reference node, or any node of the body where none is named."""
    nodes = next((nodes for nodes, _ in groups if len(nodes)), None)
    if keyword.has("REF NODE") or nodes is None:
        return dofs.one(keyword, None, keyword.required("REF NODE"), "the reference node")
    return int(nodes[0])


def _groups(keyword: Keyword, dofs: Dofs, elements: Elements, by_element: NamedSets) -> list[Group]:
    groups = _named_nodes(keyword, dofs)
    if keyword.has("ELSET"):
        ids = by_element.find(keyword, keyword.required("ELSET"))
        parts = [b.nodes[np.isin(b.ids, ids)].ravel() for b in elements.blocks]
        groups.append((np.unique(np.concatenate(parts)), tuple(range(6))))
    return groups


def _named_nodes(keyword: Keyword, dofs: Dofs) -> list[Group]:
    groups: list[Group] = []
    for name, components in (("NSET", range(3)), ("PIN NSET", range(3)), ("TIE NSET", range(6))):
        if keyword.has(name):
            ids = dofs.sets.find(keyword, keyword.required(name))
            nodes = dofs.nodes.index(ids, keyword, np.full(len(ids), -1))
            groups.append((nodes, tuple(components)))
    return groups
