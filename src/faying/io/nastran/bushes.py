"""CBUSH, CBUSH1D with PBUSH, PBUSH1D: springs along and about axes of their own."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Matrix, Vector
from faying.digits import DECK_DIGITS
from faying.io.nastran import fields as numbers
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card, by_id, property_of
from faying.io.nastran.grids import Grids
from faying.model.assembly import Bush
from faying.model.axes import any_across, axes_along

_ROWS = ("K", "B", "GE", "RCV", "M", "T", "D", "")


@dataclass(frozen=True, kw_only=True)
class _Property:
    """What a bush is made of: six stiffnesses and a mass."""

    stiffness: tuple[float, ...]
    mass: float
    damped: bool
    card: Card


def read_bushes(bulk: BulkData) -> list[Bush]:
    """Read bushes.

    MSC Nastran Quick Reference Guide, CBUSH, remarks 2 to 9: the axes are those of CID (at GA where
    it is curved), else x runs from GA to GB and the orientation vector lies in the x-y plane; the
    springs act at the fraction S between the nodes, or at the place given in OCID.
    """
    properties = {
        name: {
            number: read(card) for number, card in by_id(bulk.cards, name, what="property").items()
        }
        for name, read in (("PBUSH", _general), ("PBUSH1D", _axial))
    }
    bushes: list[Bush] = []
    damped = 0
    for name, family in (("CBUSH", "PBUSH"), ("CBUSH1D", "PBUSH1D")):
        for card in bulk.cards.get(name, ()):
            bush_property = property_of(card, properties[family], family)
            damped += bush_property.damped
            bushes.append(_bush(bulk, card, bush_property))
    if damped:
        bulk.ignored.append(f"damping of {damped} CBUSH (give [damping] in the study)")
    return bushes


def _general(card: Card) -> _Property:
    """Rows of a word and up to six values: stiffness K, damping B or GE, mass M."""
    stiffness, mass, damped = [0.0] * 6, 0.0, False
    for row in range(0, len(card), 8):
        word = card.text(row + 1)
        values = range(row + 2, row + 8)
        if word not in _ROWS or (row and card.text(row)):
            card.refuse(f"'{word}' in field 3 is not supported; K, B, GE, RCV and M are", row + 1)
        if word == "K":
            stiffness = [card.real(field, 0.0) for field in values]
        elif word == "M":
            mass = card.real(row + 2, 0.0)
        elif word in ("B", "GE"):
            damped |= any(card.real(field, 0.0) for field in values)
        elif word in ("T", "D") and any(card.text(field) for field in values):
            card.refuse(
                f"{word} (thermal or initial deformation) is not supported; remove the row", row + 1
            )
    return _checked(card, stiffness, mass, damped)


def _axial(card: Card) -> _Property:
    """K, C, M; nonlinear springs and dampers follow by name."""
    if any(card.text(field) for field in range(8, len(card))):
        card.refuse("a nonlinear spring or damper is not supported; leave K, C and M only", 8)
    stiffness = [card.real(1, 0.0), *[0.0] * 5]
    return _checked(card, stiffness, card.real(3, 0.0), bool(card.real(2, 0.0)))


def _checked(card: Card, stiffness: list[float], mass: float, damped: bool) -> _Property:
    if mass < 0 or min(stiffness) < 0:
        card.refuse(f"stiffness {min(stiffness):g}, mass {mass:g}; neither may be negative")
    return _Property(stiffness=tuple(stiffness), mass=mass, damped=damped, card=card)


def _bush(bulk: BulkData, card: Card, bush_property: _Property) -> Bush:
    start = bulk.grids.one(card, 2)
    end = bulk.grids.one(card, 3) if card.integer(3, 0) else None
    line = np.zeros(3) if end is None else bulk.grids.nodes[end] - bulk.grids.nodes[start]
    x, y, z = _axes(card, bush_property, bulk.grids, start, line).tolist()
    a, b, c = _place(card, bulk.grids, start, line).tolist()
    return Bush(
        id=card.integer(0),
        nodes=(start,) if end is None else (start, end),
        stiffness=bush_property.stiffness,
        axes=(tuple(x), tuple(y), tuple(z)),
        place=(a, b, c),
        mass=bush_property.mass * bulk.mass_factor,
    )


def _axes(card: Card, bush_property: _Property, grids: Grids, start: int, line: Vector) -> Matrix:
    field = 7 if card.cards.name == "CBUSH" else 4
    if card.text(field):
        frame = grids.systems.frame_of(card, field)
        of_frame = np.asarray(frame.directions(grids.nodes[start][None])[0])
        if card.cards.name == "CBUSH1D" and np.abs(
            np.cross(of_frame[0], line)
        ).max() > DECK_DIGITS * max(float(np.abs(line).max()), 1e-300):
            card.refuse(
                "its nodes lie apart across the axis of CID; use CBUSH, or leave CID blank", field
            )
        return of_frame
    with np.errstate(over="ignore"):
        length = float(np.linalg.norm(line))
    if not 0 < length < np.inf:
        card.refuse("its nodes coincide or GB is blank; give the axes of the springs by CID", field)
    vector = orientation(card, grids, start) if field == 7 else None
    if vector is None:
        if any(bush_property.stiffness[component] for component in (1, 2, 4, 5)):
            card.refuse(
                "springs across the line of its nodes need an orientation (GO, X1 to X3 or CID)", 4
            )
        vector = np.array(any_across(line))
    axes = axes_along(line, vector)
    if axes is None:
        card.refuse("the orientation vector is zero or parallel to the line of the nodes", 4)
    return axes


def orientation(card: Card, grids: Grids, start: int, *, basic: bool = False) -> Vector | None:
    """Return the vector in the x-y plane, in the basic frame; None if the card gives none.

    Its components are basic ones, or those of the displacement system of the first grid.
    """
    if not any(card.text(field) for field in (4, 5, 6)):
        return None
    if not card.text(5) and not card.text(6) and numbers.integer(card.text(4)) is not None:
        return np.asarray(grids.nodes[grids.one(card, 4)] - grids.nodes[start])
    vector = card.reals((4, 5, 6), 0.0)
    axes = None if basic else grids.systems.axes(start)
    return vector if axes is None else np.asarray(vector @ axes)


def _place(card: Card, grids: Grids, start: int, line: Vector) -> Vector:
    """Where the springs act."""
    if card.cards.name == "CBUSH1D":
        return np.asarray(grids.nodes[start])
    if card.integer(9, -1) >= 0:
        location = np.array([[card.real(field, 0.0) for field in (10, 11, 12)]])
        return np.asarray(grids.systems.frame_of(card, 9).to_basic(location)[0])
    return np.asarray(grids.nodes[start] + card.real(8, 0.5) * line)
