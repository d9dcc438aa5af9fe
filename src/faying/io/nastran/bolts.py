"""BOLT, BOLTFOR, BOLTLD: bolts and their pretension.

Simcenter Nastran Quick Reference Guide: BOLT with ETYPE = 1 lists the CBAR and CBEAM elements of a
shank, with ETYPE = 2 and 3 solids to cut, BOLTFOR gives bolts a force, BOLTLD combines sets of
BOLTFOR like LOAD does. MSC's BOLT of the same name has a control grid that carries the force.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from faying.exceptions import FormatError
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card, by_id
from faying.io.nastran.case_control import CaseControl
from faying.io.nastran.id_lists import id_list
from faying.io.nastran.moved_supports import Moved
from faying.io.nastran.selection import chosen_sets
from faying.io.nastran.solid_bolts import read_solid_bolts
from faying.io.nastran.split_bolts import (
    SPLIT,
    SplitBolt,
    parted,
    read_split_bolts,
    without_controls,
)
from faying.io.solid_cuts import Cut, cut_mesh
from faying.model.assembly import Assembly, Beam
from faying.model.specs import BoltSpec

SOLIDS_ARE_CUT = (
    'solids are cut at BOLT: name the sides of interfaces, for minus = "auto" would find the '
    "cuts too"
)


@dataclass(frozen=True, eq=False, kw_only=True)
class CutBolts:
    """Bolts of solids: the structure with its cuts, not closed yet.

    Attributes
    ----------
    cuts
        By the ids of the bolts.
    preloads
        Forces that are loads on control grids.
    shortened
        By how much bolts are shortened whose control grids are moved.
    """

    assembly: Assembly
    cuts: Mapping[int, Cut]
    preloads: Mapping[int, float]
    shortened: Mapping[int, float]


def cut_bolts(bulk: BulkData, assembly: Assembly, moved: Moved) -> CutBolts:
    """Cut the solids of a structure at its bolts."""
    mesh, cuts = assembly.mesh, dict[int, Cut]()
    for number, section in read_solid_bolts(bulk, mesh).items():
        mesh, cuts[number] = cut_mesh(mesh, section)
    split = read_split_bolts(bulk, assembly.loads, moved)
    for number, bolt in split.items():
        mesh, cuts[number] = parted(mesh, number, bolt)
    if split:
        bulk.ignored.append(SPLIT)
        assembly = without_controls(assembly, split)
    if cuts:
        bulk.ignored.append(SOLIDS_ARE_CUT)
        bulk.ignored.extend(
            f"bolt {number}: {cut.touching} elements touch its section with an edge or a corner "
            "only and are parted too"
            for number, cut in cuts.items()
            if cut.touching
        )
    preloads, shortened = dict[int, float](), dict[int, float]()
    for number, bolt in split.items():
        amount = _only_amount(bolt, bulk.control)
        if amount is None:
            what = "displacements of" if bolt.shortens else "forces on"
            sets = ", ".join(bolt.sets)
            bulk.ignored.append(f"{what} the control grid of bolt {number} differ in sets {sets}")
        else:
            (shortened if bolt.shortens else preloads)[number] = amount
    return CutBolts(
        assembly=replace(assembly, mesh=mesh), cuts=cuts, preloads=preloads, shortened=shortened
    )


def _only_amount(bolt: SplitBolt, control: CaseControl) -> float | None:
    """Return the force or displacement of the selected set, else the one all sets agree on."""
    chosen = bolt.sets.get(str(control.load))
    values = set(bolt.sets.values())
    return chosen if chosen is not None or len(values) != 1 else values.pop()


def read_bolts(
    bulk: BulkData, beams: tuple[Beam, ...], closing: Mapping[int, int]
) -> tuple[tuple[BoltSpec, ...], dict[str, float]]:
    """Return the bolts, named ``bolt-<id>``, and the forces that case control selects.

    Without a case control section the only set of BOLTFOR applies. ``closing`` has the ids of the
    springs that close the cuts of bolts of solids.
    """
    bolts = {
        number: (closing[number],) if number in closing else _elements(card, beams)
        for number, card in by_id(bulk.cards, "BOLT").items()
    }
    for name in ("BOLTFRC", "BOLTSEQ"):
        for card in bulk.cards.get(name, ()):
            if bulk.control.present and card.integer(0) != bulk.control.bolts:
                bulk.ignored.append(f"{name} {card.integer(0)} (case control does not select it)")
                continue
            card.refuse("it is not supported; give the final force of the bolts by BOLTFOR")
    names = {number: f"bolt-{number}" for number in bolts}
    forces = _forces(bulk, names)
    specs = tuple(BoltSpec(name=names[number], elements=ids) for number, ids in bolts.items())
    return specs, {names[number]: force for number, force in forces.items()}


def _elements(card: Card, beams: tuple[Beam, ...]) -> tuple[int, ...]:
    kind = card.integer(1)
    if kind != 1:
        card.refuse(f"ETYPE = {kind}; it is 1 (beams), 2 or 3 (solids)", 1)
    beam_ids = np.array(sorted(beam.id for beam in beams), dtype=np.int64)
    ids = id_list(card, card.texts[2:], beam_ids)
    missing = sorted(set(ids) - set(beam_ids.tolist()))
    if missing or not ids:
        what = f"element {missing[0]} is no CBAR or CBEAM of the deck" if missing else "no elements"
        card.refuse(f"{what}; list the beams of the shank", 2)
    return tuple(dict.fromkeys(ids))


def _forces(bulk: BulkData, names: dict[int, str]) -> dict[int, float]:
    """Force of each bolt by the set that applies."""
    sets: dict[int, dict[int, float]] = {}
    for card in bulk.cards.get("BOLTFOR", ()):
        of_set = sets.setdefault(card.integer(0), {})
        force = card.real(1)
        for bolt in id_list(card, card.texts[2:], np.array(list(names))):
            card.find(names, 2, "bolt", "BOLT", bolt)
            if bolt in of_set:
                card.refuse(f"bolt {bolt} has two forces in set {card.integer(0)}; remove one", 2)
            of_set[bolt] = force
    combined = {
        number: _combination(card, sets) for number, card in by_id(bulk.cards, "BOLTLD").items()
    }
    both = set(sets) & set(combined)
    if both:
        message = (
            f"{bulk.cards['BOLTLD'].where(0)}: set {min(both)} is also a BOLTFOR; renumber one"
        )
        raise FormatError(message)
    available = {**sets, **combined}
    if bulk.control.bolts is None and not bulk.control.present and len(available) == 1:
        return next(iter(available.values()))
    what = "sets of bolt forces"
    chosen, note = chosen_sets(bulk.control, bulk.control.bolts, available, what, "BOLTLD")
    if len(chosen) == 1:
        return available[chosen[0]]
    if available:
        bulk.ignored.append(
            note or f"{what} {', '.join(map(str, chosen))} (give case control a BOLTLD)"
        )
    return {}


def _combination(card: Card, sets: dict[int, dict[int, float]]) -> dict[int, float]:
    """Add sets of BOLTFOR with factors."""
    total = dict[int, float]()
    for factor, member, field in card.combination():
        for bolt, force in card.find(sets, field + 1, "set", "BOLTFOR", member).items():
            total[bolt] = total.get(bolt, 0.0) + factor * force
    return total
