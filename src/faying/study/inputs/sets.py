"""[model.sets], [[support]] and [[mass]] of a study, as nodes of the mesh."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import get_args

import numpy as np

from faying._typing import Indices, frozen
from faying.display.facts import listed
from faying.exceptions import ModelError, StudyError
from faying.model.assembly import Assembly, PointMass
from faying.model.mesh import Mesh
from faying.model.supports import nodes_of_set, with_held_nodes
from faying.study.keys.errors import Location, nearest
from faying.study.keys.model_tables import (
    DisplacementComponent,
    MassSection,
    NamedSet,
    SupportSection,
)
from faying.study.keys.tables import Study


def with_study_sets(assembly: Assembly, study: Study) -> Assembly:
    """Return the assembly with the sets of the study added to its mesh."""
    for name, named in study.model.sets.items():
        for use in SETTERS:
            if getattr(named, use) is not None:
                assembly = SETTERS[use](assembly, study, name, named)
    return assembly


def _from_deck(assembly: Assembly, study: Study, name: str, named: NamedSet) -> Assembly:
    mesh, deck = assembly.mesh, named.deck or ""
    if deck in assembly.face_sets:
        faces = {**assembly.face_sets, name: assembly.face_sets[deck]}
        assembly = replace(assembly, face_sets=faces)
    if deck in mesh.node_sets:
        mesh = mesh.with_node_set(name, mesh.node_sets[deck])
    if deck in mesh.element_sets:
        mesh = _with_elements(mesh, study, name, mesh.element_sets[deck])
    names = [*assembly.face_sets, *mesh.node_sets, *mesh.element_sets]
    if deck not in names:
        _refuse(study, name, f"the deck has no set '{deck}'; {nearest(deck, names)}")
    return replace(assembly, mesh=mesh)


def _from_properties(assembly: Assembly, study: Study, name: str, named: NamedSet) -> Assembly:
    mesh, selected = assembly.mesh, named.properties or ()
    properties = mesh.element_properties
    for missing in sorted(set(selected) - set(properties.tolist())):
        names = ", ".join(map(str, np.unique(properties).tolist()))
        _refuse(study, name, f"no solid has property {missing}; properties are {names or 'none'}")
    chosen = mesh.element_ids[np.isin(properties, selected)]
    return replace(assembly, mesh=_with_elements(mesh, study, name, chosen))


def _from_nodes(assembly: Assembly, study: Study, name: str, named: NamedSet) -> Assembly:
    ids, mesh = named.nodes or (), assembly.mesh
    _check_ids(study, name, "node", ids, mesh.node_ids)
    return replace(assembly, mesh=mesh.with_node_set(name, mesh.node_index(np.array(ids))))


def _from_elements(assembly: Assembly, study: Study, name: str, named: NamedSet) -> Assembly:
    ids, mesh = np.array(named.elements or (), dtype=np.int64), assembly.mesh
    _check_ids(study, name, "solid element", ids.tolist(), mesh.element_ids)
    return replace(assembly, mesh=_with_elements(mesh, study, name, ids))


def _from_ids(assembly: Assembly, study: Study, name: str, named: NamedSet) -> Assembly:
    """Take ids as elements where an interface uses the set, and as nodes elsewhere."""
    by_interface = any(name in (i.minus, i.plus) for i in study.interfaces)
    if by_interface and _used_by_boundary(study, name):
        text = "an interface and a boundary use it; write { nodes = [..] } or { elements = [..] }"
        _refuse(study, name, text)
    if by_interface:
        return _from_elements(assembly, study, name, NamedSet(elements=named.ids))
    return _from_nodes(assembly, study, name, NamedSet(nodes=named.ids))


def _check_ids(study: Study, name: str, what: str, ids: Sequence[int], existing: Indices) -> None:
    missing = np.setdiff1d(ids, existing)
    if missing.size:
        _refuse(study, name, f"the model has no {what} with id {listed(missing)}; correct the list")


def _with_elements(mesh: Mesh, study: Study, name: str, elements: Indices) -> Mesh:
    """Return a mesh with an element set, and with its node set where a boundary uses the name."""
    sets = {**mesh.element_sets, name: frozen(elements, np.int64)}
    mesh = replace(mesh, element_sets=sets)
    # Not for interfaces, which prefer node sets, whose nodes may span facets of neighbours.
    if name in mesh.node_sets or not _used_by_boundary(study, name):
        return mesh
    return mesh.with_node_set(name, mesh.element_nodes(elements))


def _used_by_boundary(study: Study, name: str) -> bool:
    return any(boundary.set == name for boundary in study.boundaries)


def _refuse(study: Study, name: str, text: str) -> None:
    message = f"{study.source.place(('model', 'sets', name))}: {text}"
    raise StudyError(message)


Setter = Callable[[Assembly, Study, str, NamedSet], Assembly]
SETTERS: dict[str, Setter] = {
    "deck": _from_deck,
    "properties": _from_properties,
    "nodes": _from_nodes,
    "elements": _from_elements,
    "ids": _from_ids,
}


def with_study_supports(assembly: Assembly, study: Study) -> Assembly:
    """Return the assembly with the supports of the study."""
    components = get_args(DisplacementComponent)
    supports = [
        (
            named_nodes(assembly, study, ("support", number), section),
            [components.index(name) for name in section.components],
        )
        for number, section in enumerate(study.supports)
    ]
    return with_held_nodes(assembly, supports)


def with_study_masses(assembly: Assembly, study: Study) -> Assembly:
    """Return the assembly with the masses of the study, each shared evenly by its nodes."""
    nodal_masses = [
        (node, section.mass / len(nodes))
        for number, section in enumerate(study.masses)
        for nodes in [named_nodes(assembly, study, ("mass", number), section).tolist()]
        for node in nodes
    ]
    first = assembly.largest_id + 1
    added = tuple(
        PointMass(id=first + number, node=node, mass=mass)
        for number, (node, mass) in enumerate(nodal_masses)
    )
    return replace(assembly, masses=(*assembly.masses, *added))


def named_nodes(
    assembly: Assembly, study: Study, location: Location, section: SupportSection | MassSection
) -> Indices:
    """Return the nodes (n,) of a study table with a node or a set."""
    mesh, key = assembly.mesh, "set" if section.node is None else "node"
    try:
        if section.node is not None:
            return mesh.node_index(np.array([section.node]))
        return nodes_of_set(assembly, section.set or "")
    except ModelError as error:
        message = f"{study.source.place((*location, key))}: {error}"
        raise StudyError(message) from None
