"""Supports on named sets of nodes or faces."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Indices
from faying.exceptions import ModelError, refuse_model
from faying.model.assembly import Assembly, Support
from faying.model.bodies import body_names


def with_supports(assembly: Assembly, supports: Mapping[str, Sequence[int]]) -> Assembly:
    """Return the assembly with supports added.

    They map node or face sets to the components 0..5 that are held at zero.
    """
    added = []
    for name, components in supports.items():
        wrong = [component for component in components if component not in range(6)]
        if wrong:
            refuse_model(f"support '{name}': component {wrong[0]}; components are 0 to 5")
        added.append((nodes_of_set(assembly, name), components))
    return with_held_nodes(assembly, added)


def with_held_nodes(
    assembly: Assembly, supported: Iterable[tuple[Indices, Iterable[int]]]
) -> Assembly:
    """Return the assembly with supports of node indices in components 0..5 added."""
    first = max((support.id for support in assembly.supports), default=0) + 1
    added = tuple(
        Support(id=number, nodes=nodes, components=tuple(sorted({*components})))
        for number, (nodes, components) in enumerate(supported, start=first)
    )
    return replace(assembly, supports=(*assembly.supports, *added))


def nodes_of_set(assembly: Assembly, name: str) -> Indices:
    """Return the node indices of a node set, or else of a face set, an element set or a body."""
    mesh = assembly.mesh
    if name in mesh.node_sets:
        return mesh.node_sets[name]
    if name in assembly.face_sets:
        faces = assembly.face_sets[name]
        return np.unique(faces[faces >= 0])
    if name in mesh.element_sets:
        return mesh.element_nodes(mesh.element_sets[name])
    parts = body_names(mesh)
    if name in parts:
        return np.flatnonzero(mesh.bodies == parts.index(name))
    sets = [*mesh.node_sets, *assembly.face_sets, *mesh.element_sets, *parts]
    names = ", ".join(dict.fromkeys(sets)) or "none, so give a node"
    message = f"there is no node set '{name}', nor another set or body; known are {names}"
    raise ModelError(message)
