"""TEMP, TEMPD, TEMPP1, TEMPRB, DEFORM: free strains of elements as loads.

MSC Nastran Quick Reference Guide, TEMPERATURE (case control): TEMPERATURE(LOAD) selects the
temperatures, TEMPERATURE(INITIAL) the strain-free temperatures, by default TREF of the materials.
Temperatures of elements (TEMPP1, TEMPRB) override the mean temperature of their grids.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.digits import ROUND_OFF
from faying.io.left_out import IGNORABLE
from faying.io.nastran.cards import Card, Cards, by_id, each
from faying.io.nastran.expansions import (
    NOTHING,
    Expansion,
    UnreadError,
    check_constant,
    expansion_of_plate,
    read_expansions,
    unread,
)
from faying.io.nastran.grids import BulkData
from faying.io.nastran.id_lists import id_list
from faying.io.nastran.materials import PlaneMaterial
from faying.io.nastran.reader import TEMPERATURES, UNREAD_TEMPERATURES, Deck
from faying.io.nastran.shells import SHELL_CARDS
from faying.io.nastran.solids import property_ids
from faying.io.nastran.supports import ALWAYS
from faying.model.assembly import Assembly, NodalLoads
from faying.model.body_forces import (
    UNSEEN,
    expansion_forces,
    shell_expansion_forces,
    stretching_forces,
)
from faying.model.deck_bolt import bolt_axis_element
from faying.model.elastic_law import turned_strain
from faying.model.elements.curved_shell import CURVED_SHELLS
from faying.model.elements.shell_frames import flat_frames
from faying.model.shell_matrices import PANEL
from faying.model.shells import ShellBlock
from faying.model.specs import BoltSpec


@dataclass(frozen=True, eq=False, kw_only=True)
class _Field:
    """Temperatures of nodes (n_node,), NaN where missing, and of elements by id."""

    number: int
    nodes: Vector
    elements: Mapping[int, float]

    def of_elements(self, ids: Indices, nodes: Indices) -> Vector:
        """Return the temperature (n,) of elements of nodes (n, n_node)."""
        mean = self.nodes[nodes].mean(axis=1)
        element_ids = np.array(sorted(self.elements), dtype=np.int64)
        listed = np.isin(ids, element_ids)
        temperatures = np.array([self.elements[number] for number in element_ids.tolist()])
        mean[listed] = temperatures[np.searchsorted(element_ids, ids[listed])]
        return np.asarray(mean)


class _Change(NamedTuple):
    """Final and strain-free temperatures; without an initial set, TREF of each material."""

    final: _Field
    initial: _Field | None

    def of_elements(self, ids: Indices, nodes: Indices, zero: float | Vector) -> Vector:
        """Return the temperature rise (n,) of elements with nodes (n, n_node)."""
        start = zero if self.initial is None else self.initial.of_elements(ids, nodes)
        return self.final.of_elements(ids, nodes) - start

    def of_nodes(self, zero: float) -> tuple[Vector, Vector]:
        """Return strain-free and final temperatures (n_node,) of nodes."""
        nodes = self.final.nodes
        return (np.full_like(nodes, zero) if self.initial is None else self.initial.nodes), nodes


def with_free_strains(deck: Deck, bolts: Sequence[BoltSpec]) -> Assembly:
    """Return the assembly with the forces of temperatures and DEFORM added to the selected load.

    If no load set is selected, they become the loads ``temperature`` and ``deform``. A load with an
    unsupported feature is left out with a note.
    """
    control, assembly = deck.control, deck.assembly
    note = _not_applied(deck)
    if note:
        deck.ignored.append(note)
    tightened = {bolt_axis_element(assembly, bolt).id for bolt in bolts}
    thermal = None if note else control.set_of("TEMPERATURE(LOAD)")
    for name, number, read in (
        ("temperature", thermal, _thermal),
        ("deform", control.set_of("DEFORM"), _deformed),
    ):
        if number is None:
            continue
        loads = dict(assembly.loads)
        names = (str(control.set_of("LOAD")), *_WITHOUT_LOAD)
        load = next((key for key in names if key in loads), name)
        mechanical = loads.pop(load, None)
        try:
            forces = read(deck, number, tightened)
        except UnreadError as error:
            deck.ignored.append(f"load set {load} ({error} is not supported)")
        else:
            merged = f"{load}+{name}" if load in _WITHOUT_LOAD and mechanical else load
            loads = {merged: _sum(mechanical, forces), **loads}
            deck.ignored.append(
                f"{name} of set {number}: free strains are part of load '{merged}', which case "
                "control selects; apply them by deck_load"
            )
        assembly = replace(assembly, loads=loads)
    return assembly


_WITHOUT_LOAD = (ALWAYS, f"{ALWAYS}+temperature", "temperature")
"""Names of the loads if case control selects no load set."""


def _not_applied(deck: Deck) -> str:
    """Return why temperatures are not applied; empty if they are or there are none."""
    chosen = deck.control.set_of("TEMPERATURE(LOAD)")
    cards = [deck.cards[n] for n in (*TEMPERATURES, *UNREAD_TEMPERATURES) if n in deck.cards]
    if not cards and chosen is None:
        return ""
    what = ", ".join(f"{len(group)} {group.name}" for group in cards)
    if chosen is None:
        return f"{what}: case control selects none by TEMPERATURE(LOAD), so nothing expands"
    if deck.control.heat:
        return f"{what}: the analysis is heat transfer, so nothing expands"
    if "temperature" in deck.ignore:
        return f"TEMPERATURE(LOAD) = {chosen}: {IGNORABLE['temperature']} (ignore = temperature)"
    return ""


def _sum(mechanical: NodalLoads | None, forces: Matrix) -> NodalLoads:
    total = forces.copy()
    if mechanical is not None:
        np.add.at(total, mechanical.nodes, mechanical.forces)
    loaded = np.flatnonzero(total.any(axis=1))
    return NodalLoads(nodes=loaded, forces=total[loaded])


def _deformed(deck: Deck, number: int, tightened: Collection[int]) -> Matrix:
    """Return the forces of DEFORM, which lists line elements with their elongations."""
    assembly = deck.assembly
    index_of = {beam.id: i for i, beam in enumerate(assembly.beams)}
    nodes = assembly.mesh.nodes
    strains = np.zeros(len(index_of))
    chosen = False
    for card in deck.cards.get("DEFORM", ()):
        if card.integer(0) != number:
            continue
        chosen = True
        for pair in card.groups(1, 2):
            if pair.integer(0) not in index_of:
                pair.refuse(f"element {pair.text(0)} is not a CBAR, CBEAM, CROD, CONROD or CTUBE")
            i = index_of[pair.integer(0)]
            first, second = assembly.beams[i].nodes
            strains[i] += pair.real(1) / np.linalg.norm(nodes[second] - nodes[first])
    if not chosen:
        unread(f"DEFORM = {number}, a set the deck does not have,")
    return _stretched(assembly, strains, tightened)


def _stretched(assembly: Assembly, strains: Vector, tightened: Collection[int]) -> Matrix:
    for i in np.flatnonzero(strains).tolist():
        if assembly.beams[i].id in tightened:
            unread(f"expansion of element {assembly.beams[i].id}, a bolt ({UNSEEN}),")
    return stretching_forces(assembly, strains)


def _thermal(deck: Deck, number: int, tightened: Collection[int]) -> Matrix:
    """Return the thermal forces (n_node, 6) of the selected temperatures."""
    cards, grids, assembly = deck.cards, deck.grids, deck.assembly
    parents = deck.parents
    check_constant(deck)
    start = deck.control.set_of("TEMPERATURE(INITIAL)")
    initial = None if start is None else _field(deck, start, parents)
    change = _Change(_field(deck, number, parents), initial)
    expansions = read_expansions(cards)
    _check_others(cards, expansions)
    forces = _of_solids(deck, assembly, expansions, change)
    of_beams = [expansions.get(int(beam.material.name), NOTHING) for beam in assembly.beams]
    ids = np.array([beam.id for beam in assembly.beams], dtype=np.int64)
    ends = np.array([beam.nodes for beam in assembly.beams], dtype=np.int64).reshape(-1, 2)
    zero = np.array([expansion.zero for expansion in of_beams])
    degrees = change.of_elements(ids, ends, zero)
    coefficients = np.array([expansion.strains[0] for expansion in of_beams])
    strains = np.where(coefficients == 0, 0.0, coefficients * degrees)
    forces += _stretched(assembly, strains, tightened)
    free_strains = _of_shells(cards, assembly, expansions, deck.plane, change)
    forces += shell_expansion_forces(assembly, free_strains)
    if not np.isfinite(forces).all():
        fields = [field for field in change if field is not None]
        without = np.any([np.isnan(field.nodes) for field in fields], axis=0)
        without &= np.isnan(forces).any(axis=1)
        if not without.any():
            unread(f"temperature set {number} with numbers too large")
        grid = grids.ids[parents[int(without.argmax()), 0]]
        sets = " or ".join(str(field.number) for field in fields)
        unread(f"GRID {grid} without a temperature in set {sets}")
    return forces


def _check_others(cards: Mapping[str, Cards], expansions: Mapping[int, Expansion]) -> None:
    """Refuse expansion of elements whose thermal forces are not supported."""
    for user, name in (("CBEND", "PBEND"), ("CSHEAR", "PSHEAR")):
        used = {card.integer(1, card.integer(0)) for card in cards.get(user, ())}
        for card in cards.get(name, ()):
            if card.integer(0) in used and card.integer(1) in expansions:
                unread(f"{card.where()} of a material that expands")


def _field(bulk: BulkData, number: int, parents: Indices) -> _Field:
    """Read a set of temperatures."""
    for card in each(bulk.cards, *UNREAD_TEMPERATURES):
        if card.integer(0) == number:
            unread(card.where())
    temperatures = np.full(len(bulk.grids.ids), np.nan)
    listed = False
    for pair in (pair for card in bulk.cards.get("TEMPD", ()) for pair in card.groups(0, 2)):
        if pair.integer(0) == number:
            temperatures[:], listed = pair.real(1), True
    if "TEMP" in bulk.cards:
        of_set = bulk.cards["TEMP"].take(bulk.cards["TEMP"].integers(0) == number)
        pairs = of_set.groups(1, 2)
        temperatures[bulk.grids.of_column(pairs, 0)] = pairs.reals(1)
        listed |= bool(len(of_set))
    elements: dict[int, float] = {}
    for card in each(bulk.cards, "TEMPP1", "TEMPRB"):
        if card.integer(0) == number:
            elements.update(_of_elements(card))
    if not listed and not elements:
        unread(f"temperature set {number}, which the deck does not have,")
    return _Field(number=number, nodes=temperatures[parents].mean(axis=1), elements=elements)


def _of_elements(card: Card) -> Iterator[tuple[int, float]]:
    """Yield elements and their temperatures; refuse gradients across them."""
    rods = card.cards.name == "TEMPRB"
    gradients = range(4, 8) if rods else (3,)
    if any(card.real(field, 0.0) for field in gradients):
        unread(f"{card.where()} with a gradient across the element")
    mean = (card.real(2) + card.real(3)) / 2 if rods else card.real(2)
    # Other fields of the row, and another row of TEMPRB, are for stresses.
    others = [text for text in card.texts[16 if rods else 8 :] if text]
    for number in (card.integer(1), *id_list(card, others)):
        yield number, mean


def _of_solids(
    bulk: BulkData,
    assembly: Assembly,
    expansions: Mapping[int, Expansion],
    change: _Change,
) -> Matrix:
    properties = by_id(bulk.cards, "PSOLID")
    forces = np.zeros((len(assembly.mesh.nodes), 6))
    for number, material in assembly.materials.items():
        expansion = expansions.get(int(material.name))
        if expansion is None:
            continue
        if number not in properties:
            unread(f"property {number} (PCOMPS) of a material that expands")
        system = properties[number].integer(2, 0)
        along = np.eye(3) if system == 0 else np.asarray(bulk.grids.systems.frames[system].axes)
        # Temperatures missing for other materials do not matter here.
        used = np.zeros(len(assembly.mesh.nodes), dtype=bool)
        for block in assembly.mesh.blocks:
            used[block.nodes[block.properties == number]] = True
        start, end = (np.where(used, field, 0.0) for field in change.of_nodes(expansion.zero))
        direction = turned_strain(expansion.strains, along)
        forces += expansion_forces(assembly, {number: lambda T: T}, start, end, {number: direction})
    return forces


def _of_shells(
    cards: Mapping[str, Cards],
    assembly: Assembly,
    expansions: Mapping[int, Expansion],
    laws: Mapping[int, PlaneMaterial],
    change: _Change,
) -> dict[int, Matrix]:
    """Return the free strains of shells, by index of the block."""
    plates = {n: card for name in _PLATES for n, card in by_id(cards, name).items()}
    free_strains: dict[int, Matrix] = {}
    for position, block in enumerate(assembly.shells):
        if block.kind == PANEL:
            continue
        strains = np.zeros((len(block.ids), 3, 3))
        properties = _of_deck(cards, block.ids)
        for number in np.unique(properties).tolist():
            expansion = expansion_of_plate(plates[number], expansions, laws)
            if expansion is None:
                continue
            members: Mask = np.asarray(properties == number)
            degrees = change.of_elements(block.ids[members], block.nodes[members], expansion.zero)
            same = (
                np.isclose(expansion.strains[0], expansion.strains[1], rtol=ROUND_OFF)
                and not expansion.strains[2]
            )
            if same:
                axes = np.broadcast_to(np.eye(3), (int(members.sum()), 3, 3))
            elif block.kind in CURVED_SHELLS:
                message = f"{plates[number].where()} of six- or eight-node shells that expand "
                message += "more in one direction"
                raise UnreadError(message)
            else:
                axes = _material_axes(assembly, block, members)
            a, b, shear = expansion.strains
            strain = np.array(
                [[a, shear / 2, 0.0], [shear / 2, b, 0.0], [0.0, 0.0, a if same else 0]]
            )
            turned = np.einsum("eki,kl,elj->eij", axes, strain, axes)
            strains[members] = degrees[:, None, None] * turned
        if strains.any():
            free_strains[position] = strains
    return free_strains


_PLATES = ("PSHELL", "PCOMP", "PCOMPG")


def _of_deck(cards: Mapping[str, Cards], ids: Indices) -> Indices:
    """Return the deck's properties (n,) of shells; thicknesses have extra properties here."""
    shells = [cards[name] for name in SHELL_CARDS if name in cards]
    known, properties = (
        np.concatenate([read(these) for these in shells])
        for read in (lambda these: these.integers(0), property_ids)
    )
    order = np.argsort(known)
    return np.asarray(properties[order[np.searchsorted(known, ids, sorter=order)]])


def _material_axes(assembly: Assembly, block: ShellBlock, which: Mask) -> Matrix:
    """Return material directions (n, 3, 3) of flat shells: x, y and the normal."""
    frames, _ = flat_frames(assembly.mesh.nodes[block.nodes[which]], block.ids[which])
    x, normal = frames[:, 0], frames[:, 2]
    direction = block.directions[which]
    direction = np.where(np.asarray(direction.any(axis=1))[:, None], direction, x)
    across = np.cross(normal, direction)
    across /= np.linalg.norm(across, axis=1)[:, None]
    return np.stack([np.cross(across, normal), across, normal], axis=1)
