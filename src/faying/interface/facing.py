"""Detection of faces of different bodies that face each other."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Indices
from faying.exceptions import ModelError
from faying.interface.coupling import couple
from faying.interface.pairing import pair_facets
from faying.interface.segments import Segments, find_segments
from faying.interface.selection import touching_tolerance
from faying.model.assembly import Assembly
from faying.model.specs import InterfaceSpec
from faying.model.surface import Facets, facet_area_vectors

LARGEST_GAP = 0.5
"""Largest gap of paired faces, over the median size of the facets."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Facing:
    """Two bodies whose surfaces face each other.

    Attributes
    ----------
    minus, plus
        Bodies, by number. The minus side has the finer facets.
    area : [length²]
        Area of the part that faces the other body.
    gap : [length]
        Smallest and largest gap; negative where they overlap.
    touching
        Whether the faces are close enough for an interface.
    matching
        Whether the facets lie node on node.
    normal
        Mean outward normal of the minus side.
    nodes : (n,)
        Corner nodes of the facets of both sides.
    """

    minus: int
    plus: int
    area: float
    gap: tuple[float, float]
    touching: bool
    matching: bool
    normal: tuple[float, float, float]
    nodes: Indices


def facing_bodies(assembly: Assembly) -> list[Facing]:
    """Return all pairs of bodies whose faces touch, or face each other across a small gap.

    Notes
    -----
    A k-d tree of the facets for each body; time grows with the number of facets that are close to
    others, times the number of bodies.
    """
    facets = assembly.mesh.exterior
    vectors = facet_area_vectors(assembly.mesh.nodes, facets)
    facets = facets.taken(np.linalg.norm(vectors, axis=1) > 0)
    if len(np.unique(facets.bodies)) < 2:
        return []
    sizes = np.sqrt(np.linalg.norm(facet_area_vectors(assembly.mesh.nodes, facets), axis=1))
    touching = touching_tolerance(assembly.mesh.nodes, facets, InterfaceSpec(name="joint"))
    reach = max(LARGEST_GAP * float(np.median(sizes)), touching)
    # Repeated within the tolerance: facets beyond it do not belong to a touching interface, whose
    # finer side may be the other one.
    both = [*_within(assembly, facets, reach, touching)]
    both += _within(assembly, facets, touching, touching)
    return list({frozenset((spec.minus, spec.plus)): spec for spec in both}.values())


def _within(assembly: Assembly, facets: Facets, distance: float, touching: float) -> list[Facing]:
    """Return the pairs of bodies with faces within a distance."""
    nodes, specs = assembly.mesh.nodes, []
    for body in np.unique(facets.bodies)[:-1]:  # bodies, of which there are few
        minus = facets.taken(facets.bodies == body)
        plus = facets.taken(facets.bodies > body)
        segments = find_segments(nodes, minus, plus, distance)
        partner = segments.plus.bodies[segments.plus_of]
        for partner_body in np.unique(partner):
            pair = segments.touched(partner == partner_body)
            specs.append(_facing(assembly, pair, int(body), int(partner_body), touching))
    return specs


def _facing(
    assembly: Assembly, segments: Segments, body: int, partner_body: int, touching: float
) -> Facing:
    nodes = assembly.mesh.nodes
    gaps = couple(nodes, segments).gap
    smallest, largest = float(gaps.min()), float(gaps.max())
    sizes = [
        float(np.linalg.norm(facet_area_vectors(nodes, side), axis=1).mean())
        for side in (segments.minus, segments.plus)
    ]
    normal = (
        np.bincount(segments.minus_of, segments.areas, len(segments.minus)) @ segments.frames[:, 2]
    )
    normal = normal / (float(np.linalg.norm(normal)) or 1.0)
    swapped = sizes[1] < sizes[0]
    minus, plus = (partner_body, body) if swapped else (body, partner_body)
    x, y, z = (-normal if swapped else normal).tolist()
    return Facing(
        minus=minus,
        plus=plus,
        area=float(segments.areas.sum()),
        gap=(smallest, largest),
        touching=smallest <= touching,
        matching=_matching(assembly, minus, plus),
        normal=(x, y, z),
        nodes=np.unique(
            np.concatenate([segments.minus.corners.ravel(), segments.plus.corners.ravel()])
        ),
    )


def _matching(assembly: Assembly, minus: int, plus: int) -> bool:
    """Return whether the facets of two bodies lie node on node."""
    spec = InterfaceSpec(name="joint", minus=f"body {minus}", plus=f"body {plus}")
    try:
        return bool(pair_facets(assembly, spec))
    except ModelError:
        return False
