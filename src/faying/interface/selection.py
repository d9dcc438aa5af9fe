"""Facets by name: what a user's selection of a surface stands for."""

from difflib import get_close_matches

import numpy as np

from faying._typing import Indices
from faying.display.facts import MOST_SHOWN
from faying.exceptions import ModelError
from faying.model.assembly import Assembly
from faying.model.specs import Selection
from faying.model.surface import Facets, padded


def select_facets(assembly: Assembly, selection: Selection) -> Facets:
    """Find the facets a selection stands for.

    A name is looked for among face sets, then node sets (exterior facets with *all* nodes in the
    set), then element sets (exterior facets of these elements); ``"body 0"``, ``"body 1"``, … are
    the separate bodies. One or several numbers are property ids or, if not all of them are, element
    ids. Facets are in the order of ``Mesh.exterior``; those of face sets in their own.
    """
    facets = _resolve(assembly, selection)
    if not len(facets):
        message = (
            f"no exterior facet belongs to {selection!r}; a node set must hold all nodes of a "
            "facet (mid-side nodes too), an element set must reach the surface of its body"
        )
        raise ModelError(message)
    return facets


def _resolve(assembly: Assembly, selection: Selection) -> Facets:
    if isinstance(selection, str):
        return _by_name(assembly, selection.strip())
    numbers = np.atleast_1d(np.asarray(selection))
    if numbers.ndim != 1 or not np.issubdtype(numbers.dtype, np.integer):
        message = f"cannot select facets by {selection!r}; give a set name, an id or a list of ids"
        raise ModelError(message)
    return _by_number(assembly, numbers.astype(np.int64))


def _by_name(assembly: Assembly, name: str) -> Facets:
    mesh = assembly.mesh
    if name in assembly.face_sets:
        return _face_set(assembly, name)
    exterior = mesh.exterior
    if name in mesh.node_sets:
        # The extra last entry stands for the unused columns (-1) and is always inside.
        inside = np.zeros(len(mesh.nodes) + 1, dtype=bool)
        inside[mesh.node_sets[name]] = inside[-1] = True
        return exterior.taken(np.all(inside[exterior.nodes], axis=1))
    if name in mesh.element_sets:
        return exterior.taken(np.isin(exterior.elements, mesh.element_sets[name]))
    if name in (names := _body_names(assembly)):
        return exterior.taken(exterior.bodies == names.index(name))
    if name.isdecimal():
        return _by_number(assembly, np.array([int(name)]))
    raise ModelError(_unknown(assembly, name))


def _by_number(assembly: Assembly, numbers: Indices) -> Facets:
    exterior = assembly.mesh.exterior
    elements, properties = assembly.mesh.element_ids, assembly.mesh.element_properties
    meanings = [(properties, exterior.properties), (elements, exterior.elements)]
    for meaning, owner in meanings:
        if np.isin(numbers, meaning).all():
            return exterior.taken(np.isin(owner, numbers))
    missing = numbers[~np.isin(numbers, elements)]
    message = (
        f"there is no solid element with id {', '.join(map(str, missing[:MOST_SHOWN]))}, nor do "
        f"all of the given numbers name properties of solids; properties are "
        f"{', '.join(map(str, np.unique(properties)[:MOST_SHOWN])) or 'not defined'}"
    )
    raise ModelError(message)


def _face_set(assembly: Assembly, name: str) -> Facets:
    """Take a face set as given and look up whose facets these are."""
    nodes = padded(assembly.face_sets[name].nodes)
    owner = assembly.mesh.exterior.positions(nodes)
    owned = owner >= 0
    source = assembly.mesh.exterior.taken(owner[owned])
    filled = np.full((3, len(nodes)), -1, dtype=np.int64)
    filled[:, owned] = source.elements, source.properties, source.bodies
    return Facets(nodes=nodes, elements=filled[0], properties=filled[1], bodies=filled[2])


def _body_names(assembly: Assembly) -> list[str]:
    count = int(assembly.mesh.bodies.max(initial=-1)) + 1
    return [f"body {number}" for number in range(count)]


def _unknown(assembly: Assembly, name: str) -> str:
    mesh = assembly.mesh
    names = [*assembly.face_sets, *mesh.node_sets, *mesh.element_sets, *_body_names(assembly)]
    alike = get_close_matches(name, names, n=5, cutoff=0.5)
    if alike:
        hint = f"did you mean {' or '.join(map(repr, alike))}?"
    elif names:
        hint = (
            f"known names are {', '.join(repr(alternative) for alternative in names[:MOST_SHOWN])}"
        )
    else:
        hint = "the model has no named sets"
    return f"no face set, node set, element set or body is called {name!r}; {hint}"
