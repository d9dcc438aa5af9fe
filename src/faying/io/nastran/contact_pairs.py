"""Contact pairs of a deck, in whichever dialect they are written."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from faying._typing import Vector
from faying.exceptions import FormatError
from faying.interface.gap_pairing import declared
from faying.io.nastran.cards import Card
from faying.io.nastran.contact_parameters import Parameters, note_friction
from faying.io.nastran.regions import Region
from faying.model.assembly import Assembly
from faying.model.gap_rule import GapRule
from faying.model.mesh import Mesh
from faying.model.specs import InterfaceSpec
from faying.model.surface import corner_nodes

DEFAULT_ERROR = 1 / 20
"""MSC's contact tolerance over the smallest edge of solids, where none is given."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Pair:
    """Two regions that may touch; ``minus`` is the source (secondary, slave) side.

    Attributes
    ----------
    where
        Place of the card that makes the pair.
    parameters
        Those of its contact set, table or pair.
    search_distance : [length]
        Largest gap across which its faces are paired.
    friction
        Coefficient of friction.
    glued
        Whether the two neither open nor slide.
    """

    name: str
    minus: Region
    plus: Region
    where: str
    parameters: Parameters = field(default_factory=Parameters)
    search_distance: float = np.inf
    friction: float = 0.0
    glued: bool = False


def rows(card: Card) -> Iterator[tuple[int, list[str]]]:
    """Yield the first field and the eight texts of each row of a card."""
    for first in range(0, max(len(card), 1), 8):
        yield first, [card.text(first + j) for j in range(8)]


def region_of(regions: dict[int, Region], card: Card, field: int) -> Region:
    """Return the region a field names."""
    return card.find(regions, field, "contact region", "BSURFS, BSURF or BCPROP")


def check_distinct(pairs: list[Pair]) -> None:
    """Refuse a region in contact with itself, and the same two regions twice."""
    seen: dict[frozenset[str], Pair] = {}
    for pair in pairs:
        key = frozenset((pair.minus.name, pair.plus.name))
        if len(key) == 1:
            message = (
                f"{pair.where}: region {pair.minus.name} is in contact with itself, which is not "
                "supported; give each side its own region"
            )
            raise FormatError(message)
        if key in seen:
            message = (
                f"{pair.where}: contact or glue between {pair.minus.name} and {pair.plus.name} is "
                f"already defined at {seen[key].where} and would count twice; remove one"
            )
            raise FormatError(message)
        seen[key] = pair


def spec_of(pair: Pair, assembly: Assembly, ignored: dict[str, None]) -> InterfaceSpec:
    """Return a pair as an interface, its faces paired across the gaps between them.

    Bodies declare no faces, only that they may touch. Those of their faces that lie farther apart
    than the size of a face cannot meet at small displacements and are left out.
    """
    distance = pair.search_distance
    if pair.minus.facets is None and pair.plus.facets is None:
        distance = min(distance, float(_edges(pair.minus, assembly.mesh).mean()))
        ignored[
            f"faces of {pair.name} that lie farther apart than the size of a face, {distance:.3g}"
        ] = None
    spec = InterfaceSpec(
        name=pair.name,
        minus=pair.minus.name,
        plus=pair.plus.name,
        friction=pair.friction,
        search_distance=distance,
    )
    if pair.friction > 0:
        note_friction(ignored)
    spec = declared(assembly, spec)
    if spec.meshes == "non-matching":
        ignored[f"meshes of {pair.name} do not match: coupled by projection"] = None
    return spec


def gap_rule(pair: Pair, mesh: Mesh) -> GapRule | None:
    """Return what closes gaps of a pair before the analysis; None if nothing does."""
    parameters = pair.parameters
    closed = [] if parameters.closed_up_to is None else [parameters.closed_up_to]
    if parameters.within_error:
        closed.append(parameters.error or DEFAULT_ERROR * _edges(pair.minus, mesh).min())
    return GapRule(closed_up_to=float(max(closed))) if closed else None


def glue_distance(pair: Pair, mesh: Mesh) -> float:
    """Return how far apart surfaces are glued: SDIST of Simcenter, ERROR of MSC."""
    if np.isfinite(pair.search_distance):
        return pair.search_distance
    return float(pair.parameters.error or DEFAULT_ERROR * _edges(pair.minus, mesh).min())


def _edges(region: Region, mesh: Mesh) -> Vector:
    """Return the lengths of the edges of a region's faces, or of its bodies'."""
    corners = mesh.exterior
    if region.elements is not None:
        corners = corners.taken(np.isin(corners.elements, region.elements))
    nodes = corners.corners if region.facets is None else corner_nodes(region.facets)
    points = mesh.nodes[nodes]
    lengths = np.linalg.norm(np.roll(points, -1, axis=1) - points, axis=2)
    positive: Vector = lengths[lengths > 0]
    return positive
