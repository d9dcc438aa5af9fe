"""Bolts of a deck: the one of their beams or springs that is tightened."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faying.exceptions import ModelError
from faying.model.assembly import Assembly, Beam, Spring
from faying.model.specs import BoltSpec

CUT_STIFFNESS = 1e4
"""Stiffness of the spring that closes a cut over E A / h of the layer of elements beside it: one
part in ten thousand of one layer is added to the bolt's compliance, K loses four digits at most."""

UNLOCKED_STIFFNESS = 1e-6
"""Axial stiffness left of a bolt that pulls with a given force: its force changes by a millionth of
what it would if it were locked, and K loses six digits at most."""


def bolt_axis_element(assembly: Assembly, spec: BoltSpec) -> Beam | Spring:
    """Return the beam or spring of a deck's bolt that is tightened: the middle one of its chain.

    The ids of the bolt's elements, in any order, form one chain end to end. Of an even number it is
    the one before the middle, counted from the end listed first.

    Raises
    ------
    ModelError
        If an id is not a beam or an axial spring, or the elements do not form one chain.
    """
    chain = bolt_chain(assembly, spec)
    return chain[(len(chain) - 1) // 2]


def axial_stiffness(assembly: Assembly, element: Beam | Spring) -> float:
    """Return the force over the elongation of an element of a bolt."""
    if isinstance(element, Spring):
        return element.stiffness
    start, end = assembly.mesh.nodes[list(element.nodes)]
    length = float(np.linalg.norm(end - start))
    section = element.section
    return section.axial_factor * element.material.youngs_modulus * section.area / length


def with_unlocked_bolts(assembly: Assembly, specs: Sequence[BoltSpec]) -> Assembly:
    """Let bolts pull with their initial force whatever their length: hardly any stiffness is left.

    What is left holds a part that nothing but the bolt and contact hold.
    """
    ids = {bolt_axis_element(assembly, spec).id for spec in specs}
    return replace(
        assembly,
        beams=tuple(
            replace(beam, section=replace(beam.section, axial_factor=UNLOCKED_STIFFNESS))
            if beam.id in ids
            else beam
            for beam in assembly.beams
        ),
        springs=tuple(
            replace(spring, stiffness=spring.stiffness * UNLOCKED_STIFFNESS / CUT_STIFFNESS)
            if spring.id in ids
            else spring
            for spring in assembly.springs
        ),
    )


def bolt_chain(assembly: Assembly, spec: BoltSpec) -> list[Beam | Spring]:
    """Return the elements of a deck's bolt end to end, the end listed first in front."""
    if not spec.elements:
        message = f"bolt '{spec.name}' names no elements; give the ids of its beam elements"
        raise ModelError(message)
    chosen = [_line_element(assembly, spec, i) for i in dict.fromkeys(spec.elements)]
    return _chain(spec, chosen)


def _line_element(assembly: Assembly, spec: BoltSpec, element_id: int) -> Beam | Spring:
    """Look up a beam or axial spring by id."""
    for beam in assembly.beams:
        if beam.id == element_id:
            return beam
    for spring in assembly.springs:
        if spring.id == element_id:
            components = {component for _, component in spring.ends}
            if len(spring.ends) == 2 and len(components) == 1 and components <= {0, 1, 2}:
                return spring
            message = (
                f"bolt '{spec.name}': spring {element_id} is not axial; it must join the same "
                "translation (1, 2 or 3) of two nodes"
            )
            raise ModelError(message)
    message = (
        f"bolt '{spec.name}': element {element_id} is no beam and no spring; "
        "name the beam elements of the bolt's shank"
    )
    raise ModelError(message)


def _chain(spec: BoltSpec, elements: list[Beam | Spring]) -> list[Beam | Spring]:
    """Order elements end to end."""
    at_node: dict[int, list[Beam | Spring]] = defaultdict(list)
    for element in elements:
        for node in end_nodes(element):
            at_node[node].append(element)
    loose = [node for element in elements for node in end_nodes(element) if len(at_node[node]) == 1]
    chain: list[Beam | Spring] = []
    node = loose[0] if loose else -1
    while following := [e for e in at_node.get(node, []) if e not in chain]:
        chain.append(following[0])
        node = next(n for n in end_nodes(following[0]) if n != node)
    if len(chain) != len(elements) or len(loose) != 2:
        ids = ", ".join(str(element.id) for element in elements)
        message = (
            f"bolt '{spec.name}': elements {ids} do not form one chain end to end; "
            "list the shank's elements only"
        )
        raise ModelError(message)
    return chain


def end_nodes(element: Beam | Spring) -> tuple[int, ...]:
    """Return the indices of the nodes of a line element."""
    return element.nodes if isinstance(element, Beam) else tuple(node for node, _ in element.ends)


def chain_ends(chain: Sequence[Beam | Spring]) -> list[tuple[Beam | Spring, int]]:
    """Return the first and the last element of a chain, each with the node that is an end."""
    if len(chain) == 1:
        first, last = end_nodes(chain[0])
        return [(chain[0], first), (chain[0], last)]
    return [
        (end, next(node for node in end_nodes(end) if node not in end_nodes(inner)))
        for end, inner in ((chain[0], chain[1]), (chain[-1], chain[-2]))
    ]
