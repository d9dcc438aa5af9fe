"""Contact pairs of a deck, in whichever dialect they are written."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from faying._typing import Indices
from faying.exceptions import FormatError
from faying.io.nastran import fields as numbers
from faying.io.nastran.cards import Card
from faying.io.nastran.contact_parameters import FRICTION_REMEDY, GLUE_REMEDY
from faying.io.nastran.regions import Region
from faying.model.mesh import Mesh

# Coordinates written with eight digits agree to 1e-7 of their size.
_COINCIDENT = 1e-7


@dataclass(frozen=True, eq=False, kw_only=True)
class Pair:
    """Two regions that may touch; ``minus`` is the source (secondary, slave) side.

    Attributes
    ----------
    where
        Place of the card that makes the pair.
    closing
        Parameter that closes gaps before the analysis, with its place; empty if there is none.
    """

    name: str
    minus: Region
    plus: Region
    where: str
    closing: str = ""


def refuse_friction(card: Card, field: int, name: str = "FRIC") -> None:
    """Raise if a field holds a friction coefficient (or table) other than zero."""
    text = card.text(field)
    if text and numbers.real(text) != 0.0:
        message = f"{name} = {text}: {FRICTION_REMEDY}"
        raise card.error(message, field)


def refuse_glue(card: Card, field: int) -> None:
    """Raise if a field asks for glue."""
    text = card.text(field)
    if text and numbers.real(text) != 0.0:
        message = f"IGLUE = {text}: glued contact is not supported; {GLUE_REMEDY}"
        raise card.error(message, field)


def rows(card: Card) -> Iterator[tuple[int, list[str]]]:
    """Yield the first field and the eight texts of each row of a card."""
    for first in range(0, max(len(card), 1), 8):
        yield first, [card.text(first + j) for j in range(8)]


def region_of(regions: dict[int, Region], card: Card, field: int) -> Region:
    """Return the region a field names.

    Raises
    ------
    FormatError
        If there is none, or it selects no face of a solid.
    """
    number = card.integer(field)
    if number not in regions:
        text = f"contact region {number} is not in the deck; define it (BSURFS, BSURF, BCPROP)"
        raise card.error(text, field)
    return regions[number]


def check_distinct(pairs: list[Pair]) -> None:
    """Refuse a region in contact with itself, and the same two regions twice.

    Raises
    ------
    FormatError
        Naming both places.
    """
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
                f"{pair.where}: contact between {pair.minus.name} and {pair.plus.name} is already "
                f"defined at {seen[key].where} and would count twice; remove one"
            )
            raise FormatError(message)
        seen[key] = pair


def check_closed(pair: Pair, mesh: Mesh) -> None:
    """Refuse a parameter that closes gaps where there may be any.

    Where touching nodes coincide there is nothing to close. Nodes farther apart than a tenth of
    the distance between the nodes of a side are off the overlap.

    Raises
    ------
    FormatError
        If nodes of the two sides are close but do not coincide, or none coincide.
    """
    if not pair.closing:
        return
    minus, plus = (_nodes(mesh, region) for region in (pair.minus, pair.plus))
    points, others = mesh.nodes[minus], mesh.nodes[plus]
    if len(minus) < 2 or not len(plus):
        return
    distance = cKDTree(others).query(points)[0]
    spacing = cKDTree(points).query(points, k=2)[0][:, 1].min()
    zero = _COINCIDENT * float(np.abs(points).max())
    apart = (distance > zero) & (distance < 0.1 * spacing)
    if apart.any() or not (distance <= zero).any():
        shown = f"a gap of {distance[apart].min():.3g}" if apart.any() else "no coincident nodes"
        message = (
            f"{pair.closing} closes gaps and penetrations of the mesh, which is not supported, and "
            f"contact {pair.name} has {shown}; remove it, or move the nodes together"
        )
        raise FormatError(message)


def _nodes(mesh: Mesh, region: Region) -> Indices:
    if region.facets is not None:
        return np.unique(region.facets[region.facets >= 0])
    none = np.zeros(0, dtype=np.int64)
    return mesh.element_nodes(none if region.elements is None else region.elements)
