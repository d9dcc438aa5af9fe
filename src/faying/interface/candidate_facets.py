"""Sides: the facets of an interface's two sides, before it is known which of them touch."""

import numpy as np

from faying._typing import Indices, Matrix
from faying.exceptions import ModelError, naming
from faying.interface.selection import select_facets
from faying.model.assembly import Assembly
from faying.model.specs import InterfaceSpec
from faying.model.surface import Facets

DEFAULT_TOLERANCE = 0.01
"""Default tolerance as a fraction of the smallest facet edge."""


def candidates(assembly: Assembly, spec: InterfaceSpec) -> tuple[Facets, Indices]:
    """Return the facets that may touch and the side of each; lower sides are minus."""
    if spec.minus == "auto" and spec.plus == "auto":
        return _all_bodies(assembly, spec)
    if spec.minus == "auto" or spec.plus == "auto":
        minus, plus = _one_side_and_the_rest(assembly, spec)
    else:
        minus, plus = (_selected(assembly, spec, name) for name in ("minus", "plus"))
    both = minus.joined(plus)
    return both, np.repeat([0, 1], [len(minus), len(plus)])


def _all_bodies(assembly: Assembly, spec: InterfaceSpec) -> tuple[Facets, Indices]:
    facets = assembly.mesh.exterior
    count = len(np.unique(facets.bodies))
    if count < 2:
        state = "is one body" if count else "has no solid elements"
        message = (
            f"interface '{spec.name}': the mesh {state}, so no facets of different bodies can be "
            "found; parts that touch must not share nodes, and a model given as matrices needs "
            "face sets named as 'minus' and 'plus'"
        )
        raise ModelError(message)
    return facets, _body_ranks(assembly)[facets.bodies]


def _one_side_and_the_rest(assembly: Assembly, spec: InterfaceSpec) -> tuple[Facets, Facets]:
    named = _selected(assembly, spec, "plus" if spec.minus == "auto" else "minus")
    exterior = assembly.mesh.exterior
    unnamed = exterior.taken(named.positions(exterior.nodes) < 0)
    return (unnamed, named) if spec.minus == "auto" else (named, unnamed)


def _selected(assembly: Assembly, spec: InterfaceSpec, name: str) -> Facets:
    with naming(f"interface '{spec.name}', {name} side"):
        return select_facets(assembly, getattr(spec, name))


def _body_ranks(assembly: Assembly) -> Indices:
    """Rank bodies by their smallest node id, which does not depend on the order of the nodes."""
    mesh = assembly.mesh
    label = mesh.bodies
    smallest = np.full(int(label.max()) + 1, np.iinfo(np.int64).max)
    np.minimum.at(smallest, label[label >= 0], mesh.node_ids[label >= 0])
    rank = np.empty_like(smallest)
    rank[np.argsort(smallest, kind="stable")] = np.arange(len(smallest))
    return rank


def touching_tolerance(nodes: Matrix, facets: Facets, spec: InterfaceSpec) -> float:
    """Return the tolerance a spec gives, or the default of the facets that may touch [length]."""
    if spec.tolerance is not None:
        if not 0 <= spec.tolerance < np.inf:
            message = (
                f"interface '{spec.name}': the tolerance is {spec.tolerance:g}; give a length, or "
                "leave it out for 1 % of the smallest facet edge"
            )
            raise ModelError(message)
        return float(spec.tolerance)
    corners = nodes[facets.corners]
    edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    return DEFAULT_TOLERANCE * float(edges[edges > 0].min())
