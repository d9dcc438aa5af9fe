"""BOLT, BOLTFOR, BOLTLD: bolts of beams and their pretension.

Simcenter Nastran Quick Reference Guide: BOLT with ETYPE = 1 lists the CBAR and CBEAM elements of a
shank, BOLTFOR gives bolts a force, BOLTLD combines sets of BOLTFOR like LOAD does. MSC's BOLT of
the same name (control grid, TOP and BOTTOM) cuts solids and is refused.
"""

from collections.abc import Mapping

import numpy as np

from faying.exceptions import FormatError
from faying.io.nastran.cards import Card, Cards
from faying.io.nastran.case_control import CaseControl
from faying.io.nastran.contact_parameters import by_id
from faying.io.nastran.id_lists import id_list
from faying.model.assembly import Beam
from faying.model.specs import BoltSpec

_REMEDY = (
    "model the shank with CBEAM or CBAR and ETYPE = 1, or leave the bolt out and let faying "
    "generate one ([[bolt]] with axis, diameter, washer_radius)"
)


def read_bolts(
    cards: Mapping[str, Cards], beams: tuple[Beam, ...], control: CaseControl, ignored: list[str]
) -> tuple[tuple[BoltSpec, ...], dict[str, float]]:
    """Return the bolts, named ``bolt-<id>``, and the forces that case control selects.

    Without a case control section the only set of BOLTFOR applies.

    Raises
    ------
    FormatError
        If a bolt is not made of beams, a set or bolt is missing, or forces contradict each other.
    """
    bolts = {number: _elements(card, beams) for number, card in by_id(cards, "BOLT").items()}
    for name in ("BOLTFRC", "BOLTSEQ"):
        for card in cards.get(name, ()):
            text = "it is not supported; give the final force of the bolts by BOLTFOR"
            raise card.error(text)
    names = {number: f"bolt-{number}" for number in bolts}
    forces = _forces(cards, names, control, ignored)
    specs = tuple(BoltSpec(name=names[number], elements=ids) for number, ids in bolts.items())
    return specs, {names[number]: force for number, force in forces.items()}


def _elements(card: Card, beams: tuple[Beam, ...]) -> tuple[int, ...]:
    if "TOP" in card.texts or "BOTTOM" in card.texts:
        text = f"a bolt of a control grid and pairs of grids is not supported; {_REMEDY}"
        raise card.error(text)
    kind = card.integer(1)
    if kind != 1:
        what = "a bolt of solid elements" if kind in (2, 3) else "this kind of bolt"
        text = f"ETYPE = {kind}: {what} is not supported; {_REMEDY}"
        raise card.error(text, 1)
    known = np.array(sorted(beam.id for beam in beams), dtype=np.int64)
    ids = id_list(card, [text for text in card.texts[2:] if text], known)
    missing = sorted(set(ids) - set(known.tolist()))
    if missing or not ids:
        what = f"element {missing[0]} is no CBAR or CBEAM of the deck" if missing else "no elements"
        text = f"{what}; list the beams of the shank"
        raise card.error(text, 2)
    return tuple(dict.fromkeys(ids))


def _forces(
    cards: Mapping[str, Cards], names: dict[int, str], control: CaseControl, ignored: list[str]
) -> dict[int, float]:
    """Force of each bolt by the set that applies."""
    sets: dict[int, dict[int, float]] = {}
    for card in cards.get("BOLTFOR", ()):
        own = sets.setdefault(card.integer(0), {})
        force = card.real(1)
        if not force >= 0:
            text = f"the force is {force:g}; a bolt is tightened by a positive one"
            raise card.error(text, 1)
        for bolt in id_list(card, [text for text in card.texts[2:] if text], np.array(list(names))):
            if bolt not in names:
                text = f"bolt {bolt} is not a BOLT of the deck; define it"
                raise card.error(text, 2)
            if bolt in own:
                text = f"bolt {bolt} has two forces in set {card.integer(0)}; remove one"
                raise card.error(text, 2)
            own[bolt] = force
    combined = {number: _combination(card, sets) for number, card in by_id(cards, "BOLTLD").items()}
    both = set(sets) & set(combined)
    if both:
        message = f"{cards['BOLTLD'].where(0)}: set {min(both)} is also a BOLTFOR; renumber one"
        raise FormatError(message)
    available = {**sets, **combined}
    chosen = control.bolts
    if chosen is None and not control.present and len(sets) == 1 and not combined:
        return next(iter(sets.values()))
    if chosen is None:
        if available:
            shown = ", ".join(map(str, available))
            ignored.append(f"bolt forces of sets {shown} (case control selects none by BOLTLD)")
        return {}
    if chosen not in available:
        known = ", ".join(map(str, available)) or "none"
        message = f"case control selects BOLTLD = {chosen}, but the sets of bolt forces are {known}"
        raise FormatError(message)
    return available[chosen]


def _combination(card: Card, sets: dict[int, dict[int, float]]) -> dict[int, float]:
    """Add sets of BOLTFOR with factors: SID, S, S1, L1, S2, L2, ..."""
    overall, total = card.real(1), dict[int, float]()
    for at in range(2, len(card), 2):
        if not card.text(at) and not card.text(at + 1):
            continue
        factor, member = overall * card.real(at), card.integer(at + 1)
        if member not in sets:
            text = f"set {member} is not a BOLTFOR of the deck; define it"
            raise card.error(text, at + 1)
        for bolt, force in sets[member].items():
            total[bolt] = total.get(bolt, 0.0) + factor * force
    return total
