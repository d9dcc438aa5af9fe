"""Facets of named selections of a surface, and candidates for contact."""

from difflib import get_close_matches

import numpy as np

from faying._typing import Indices, Matrix
from faying.display.facts import listed
from faying.exceptions import ModelError, naming, refuse_model
from faying.model.assembly import Assembly
from faying.model.specs import InterfaceSpec, Selection
from faying.model.surface import Facets, padded


def select_facets(assembly: Assembly, selection: Selection) -> Facets:
    """Return the facets of a selection.

    A name is looked up in face sets, then node sets (exterior facets with *all* nodes in the
    set), then element sets (exterior facets of these elements); ``"body 0"``, ``"body 1"``, … are
    the separate bodies. One or several numbers are property ids or, if not all of them are, element
    ids. Facets are in the order of ``Mesh.exterior``; those of face sets in the order of the set.
    """
    facets = _find_facets(assembly, selection)
    if not len(facets):
        refuse_model(
            f"no exterior facet belongs to {selection!r}; a node set must hold all nodes of a "
            "facet (mid-side nodes too), an element set must reach the surface of its body"
        )
    return facets


def _find_facets(assembly: Assembly, selection: Selection) -> Facets:
    if isinstance(selection, str):
        return _facets_by_name(assembly, selection.strip())
    numbers = np.atleast_1d(np.asarray(selection))
    if numbers.ndim != 1 or not np.issubdtype(numbers.dtype, np.integer):
        message = f"cannot select facets by {selection!r}; give a set name, an id or a list of ids"
        raise ModelError(message)
    return _facets_by_number(assembly, numbers.astype(np.int64))


def _facets_by_name(assembly: Assembly, name: str) -> Facets:
    mesh = assembly.mesh
    if name in assembly.face_sets:
        return _face_set(assembly, name)
    exterior = mesh.exterior
    if name in mesh.node_sets:
        return exterior.within(mesh.node_sets[name])
    if name in mesh.element_sets:
        return exterior.taken(np.isin(exterior.elements, mesh.element_sets[name]))
    if name in (names := _body_names(assembly)):
        return exterior.taken(exterior.bodies == names.index(name))
    if name.isdecimal():
        return _facets_by_number(assembly, np.array([int(name)]))
    raise ModelError(_unknown_message(assembly, name))


def _facets_by_number(assembly: Assembly, numbers: Indices) -> Facets:
    exterior = assembly.mesh.exterior
    elements, properties = assembly.mesh.element_ids, assembly.mesh.element_properties
    meanings = [(properties, exterior.properties), (elements, exterior.elements)]
    for meaning, owner in meanings:
        if np.isin(numbers, meaning).all():
            return exterior.taken(np.isin(owner, numbers))
    missing = numbers[~np.isin(numbers, elements)]
    message = (
        f"there is no solid element with id {listed(missing)}, nor do "
        f"all of the given numbers name properties of solids; properties are "
        f"{listed(np.unique(properties)) or 'not defined'}"
    )
    raise ModelError(message)


def _face_set(assembly: Assembly, name: str) -> Facets:
    """Return the facets of a face set with the elements they belong to."""
    nodes = padded(assembly.face_sets[name])
    owner = assembly.mesh.exterior.positions(nodes)
    owned = owner >= 0
    source = assembly.mesh.exterior.taken(owner[owned])
    filled = np.full((3, len(nodes)), -1, dtype=np.int64)
    filled[:, owned] = source.elements, source.properties, source.bodies
    return Facets(nodes=nodes, elements=filled[0], properties=filled[1], bodies=filled[2])


def _body_names(assembly: Assembly) -> list[str]:
    count = int(assembly.mesh.bodies.max(initial=-1)) + 1
    return [f"body {number}" for number in range(count)]


def _unknown_message(assembly: Assembly, name: str) -> str:
    mesh = assembly.mesh
    names = [*assembly.face_sets, *mesh.node_sets, *mesh.element_sets, *_body_names(assembly)]
    alike = get_close_matches(name, names, n=5, cutoff=0.5)
    if alike:
        hint = f"did you mean {' or '.join(map(repr, alike))}?"
    elif names:
        hint = f"known names are {listed(map(repr, names))}"
    else:
        hint = "the model has no named sets"
    return f"no face set, node set, element set or body is called {name!r}; {hint}"


DEFAULT_TOLERANCE = 0.01
"""Default tolerance as a fraction of the smallest facet edge."""

WHOLE_AREA = 0.99
"""Share of a declared area that counts as all of it, because facets only approximate curves."""


def candidates(assembly: Assembly, spec: InterfaceSpec) -> tuple[Facets, Indices]:
    """Return the facets that may touch, and the side of each; lower sides are minus."""
    if spec.minus == "auto" and spec.plus == "auto":
        return _all_bodies(assembly, spec)
    if spec.minus == "auto" or spec.plus == "auto":
        minus, plus = _one_side_and_the_rest(assembly, spec)
    else:
        minus, plus = (_select_side(assembly, spec, name) for name in ("minus", "plus"))
    both = minus.joined(plus)
    return both, np.repeat([0, 1], [len(minus), len(plus)])


def _all_bodies(assembly: Assembly, spec: InterfaceSpec) -> tuple[Facets, Indices]:
    facets = assembly.mesh.exterior
    count = len(np.unique(facets.bodies))
    if count < 2:
        state = "is one body" if count else "has no solid elements"
        refuse_model(
            f"interface '{spec.name}': the mesh {state}, so no facets of different bodies can be "
            "found; parts that touch must not share nodes, and a model given as matrices needs "
            "face sets named as 'minus' and 'plus'"
        )
    return facets, _body_ranks(assembly)[facets.bodies]


def _one_side_and_the_rest(assembly: Assembly, spec: InterfaceSpec) -> tuple[Facets, Facets]:
    named = _select_side(assembly, spec, "plus" if spec.minus == "auto" else "minus")
    exterior = assembly.mesh.exterior
    unnamed = exterior.taken(named.positions(exterior.nodes) < 0)
    return (unnamed, named) if spec.minus == "auto" else (named, unnamed)


def _select_side(assembly: Assembly, spec: InterfaceSpec, name: str) -> Facets:
    with naming(f"interface '{spec.name}', {name} side"):
        return select_facets(assembly, getattr(spec, name))


def _body_ranks(assembly: Assembly) -> Indices:
    """Return ranks of bodies by smallest node id, independent of the order of the nodes."""
    mesh = assembly.mesh
    label = mesh.bodies
    smallest = np.full(int(label.max()) + 1, np.iinfo(np.int64).max)
    np.minimum.at(smallest, label[label >= 0], mesh.node_ids[label >= 0])
    rank = np.empty_like(smallest)
    rank[np.argsort(smallest, kind="stable")] = np.arange(len(smallest))
    return rank


def touching_tolerance(nodes: Matrix, facets: Facets, spec: InterfaceSpec) -> float:
    """Return the tolerance of a spec, or the default for its candidate facets [length]."""
    if spec.tolerance is not None:
        if not 0 <= spec.tolerance < np.inf:
            refuse_model(
                f"interface '{spec.name}': the tolerance is {spec.tolerance:g}; give a length, or "
                "leave it out for 1 % of the smallest facet edge"
            )
        return float(spec.tolerance)
    corners = nodes[facets.corners]
    edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    return DEFAULT_TOLERANCE * float(edges[edges > 0].min())
