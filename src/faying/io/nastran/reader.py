"""Structure of a Nastran deck."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path

import numpy as np

from faying._typing import Indices
from faying.exceptions import refuse
from faying.io.left_out import Occurrence
from faying.io.nastran.beams import BeamEnds, read_beams, read_rods, read_warping
from faying.io.nastran.bushes import read_bends, read_bushes
from faying.io.nastran.card_table import ADDED_MASS, CARDS, FIELDS, USERS
from faying.io.nastran.cards import Cards
from faying.io.nastran.case_control import (
    LUMPED,
    CaseControl,
    mass_factor,
    parameter_lines,
    parameters,
    read_case_control,
)
from faying.io.nastran.coordinates import ON_AXIS
from faying.io.nastran.couplings import read_average_coupling, read_equations
from faying.io.nastran.grids import BulkData, Grids, read_grids, read_sets
from faying.io.nastran.loads import UNSUPPORTED, read_loads
from faying.io.nastran.materials import (
    MATERIALS,
    PlaneMaterial,
    materials_of,
    read_anisotropic,
    read_materials,
    read_plane_materials,
)
from faying.io.nastran.rigid_elements import read_rigid_elements, read_shell_to_solid
from faying.io.nastran.sections import read_sections
from faying.io.nastran.shell_sections import read_shell_properties
from faying.io.nastran.shells import read_panel_sides, read_shells
from faying.io.nastran.solid_bolts import control_grids
from faying.io.nastran.solids import (
    check_element_ids,
    element_sets,
    read_solids,
)
from faying.io.nastran.springs import (
    read_general_elements,
    read_masses,
    read_scalar_masses,
    read_springs,
    without_rotation,
)
from faying.io.nastran.supports import Moved, read_supports, with_moving
from faying.io.nastran.tokenizer import read_cards, read_source
from faying.io.straight_sides import StraightSides
from faying.model.assembly import Assembly
from faying.model.mesh import Mesh

RIGID = ("RBE2", "RBE3", "RBAR", "RBE1", "RROD", "RTRPLT", "RSSCON")
ELEMENTS = tuple(
    name
    for name, fields in FIELDS.items()
    if fields[:1] == FIELDS["CHEXA"][:1] and name not in RIGID
)
TEMPERATURES = ("TEMP", "TEMPD", "TEMPP1", "TEMPRB")
UNREAD_TEMPERATURES = (
    *("TEMPG", "TEMPN1", "TEMPP3", "TEMPF", "TEMPBC", "TEMPADD", "TEMPT", "TEMPB3", "TEMPEX"),
)
"""Unsupported cards of temperatures; sets with them load nothing."""
_READ = frozenset((*FIELDS, *UNSUPPORTED, *UNREAD_TEMPERATURES))


@dataclass(frozen=True, eq=False, kw_only=True)
class Deck(BulkData):
    """A deck in parts: the structure, and other data for the readers of contact and bolts.

    Attributes
    ----------
    ignore
        Features left out on request: words of :data:`faying.io.left_out.IGNORABLE`.
    moved
        Displacements by SPC and SPCD, also of control grids of bolts.
    parents : (n_node, 2)
        Nodes of the deck whose mean each node is: the same one twice, or both ends of a side.
    plane
        Materials of shells.
    thicknesses : [length]
        Thicknesses of shells, by property.
    """

    assembly: Assembly
    parents: Indices
    plane: Mapping[int, PlaneMaterial]
    thicknesses: Mapping[int, float]
    ignore: frozenset[str] = frozenset()
    moved: Moved = field(default_factory=Moved)


def read_parts(
    path: str | PathLike[str],
    subcase: int | None = None,
    ignore: frozenset[str] = frozenset(),
) -> Deck:
    """Read the structure of a deck; see :func:`faying.io.nastran.read_deck`."""
    path = Path(path)
    control_lines, bulk_lines = read_source(path)
    cards = read_cards(bulk_lines).cards()
    ignored: list[str] = []
    control = read_case_control(control_lines, ignored, subcase)
    _check_supported(cards, control, ignored, ignore, path)
    # Finiteness checks catch overflow, where the line can be named.
    with np.errstate(over="ignore", invalid="ignore"):
        given = parameters(cards, read_cards(parameter_lines(control_lines)))
        factor = mass_factor(given, ignored)
        heat = "HEATSTAT" in given and given["HEATSTAT"].text(1).startswith("Y")
        control = replace(control, heat=control.heat or heat)
        grids = read_grids(cards)
        if count := grids.systems.n_on_axis:
            ignored.append(f"{count} {ON_AXIS}")
        bulk = BulkData(
            cards=cards, control=control, grids=grids, mass_factor=factor, ignored=ignored
        )
        if not np.isfinite(grids.nodes).all():
            refuse(f"{path}: coordinates are too large for a number; check the units")
        materials, factors = read_materials(bulk)
        bulk = replace(bulk, materials=materials, shear_factors=factors)
        solid = {**materials, **read_anisotropic(bulk)}
        straight = StraightSides(places=grids.nodes, ids=grids.ids)
        blocks, of_property, element = read_solids(bulk, solid, straight)
        heavy = any(item.density > 0 for item in solid.values())
        lumped = "COUPMASS" not in given or given["COUPMASS"].integer(1) <= 0
        if control.present and heavy and lumped:
            ignored.append(LUMPED)
        check_element_ids([cards[name] for name in ELEMENTS if name in cards])
        check_element_ids([cards[name] for name in RIGID if name in cards])
        by_property = element_sets(blocks)
        node_sets, more_sets = read_sets(bulk, by_property)
        plane = read_plane_materials(bulk)
        laminates = read_shell_properties(bulk, plane)
        shells, shell_sections = read_shells(bulk, laminates, straight)
        rigid, rigid_equations = read_rigid_elements(bulk)
        sections = read_sections(bulk)
        ends = BeamEnds(first=len(grids.ids) + len(straight.node_ids))
        beams = read_beams(bulk, sections, ends)
        springs, turned = read_springs(bulk)
        supports, moved = read_supports(bulk)
        ids = np.concatenate([grids.ids, straight.node_ids])
        mesh = Mesh(
            nodes=np.vstack([grids.nodes, straight.nodes, ends.nodes]),
            node_ids=np.concatenate([ids, ends.ids_behind(ids)]),
            blocks=blocks,
            node_sets=node_sets,
            element_sets={**by_property, **more_sets},
        )
        assembly = Assembly(
            mesh=mesh,
            materials=of_property,
            element=element,
            beams=(*beams, *read_rods(bulk)),
            shells=shells,
            shell_sections=shell_sections,
            springs=(
                *springs,
                *read_general_elements(bulk),
                *read_warping(bulk, sections["CBEAM"], {item.id: item for item in beams}),
            ),
            bushes=(
                *turned,
                *read_bushes(bulk),
                *read_bends(bulk),
            ),
            scalar_masses=tuple(read_scalar_masses(bulk)),
            rigid_couplings=(*rigid, *ends.couplings),
            average_couplings=tuple(read_average_coupling(c, grids) for c in cards.get("RBE3", ())),
            equations=(
                *straight.equations(),
                *rigid_equations,
                *read_shell_to_solid(bulk, blocks, shells),
                *ends.equations,
                *read_equations(bulk),
            ),
            supports=tuple(supports),
            name=path.stem,
        )
        masses = without_rotation(read_masses(bulk), assembly, ignored)
        assembly = replace(assembly, masses=masses)
        sides = read_panel_sides(bulk, assembly.largest_id + 1)
        assembly = replace(assembly, beams=(*assembly.beams, *sides))
        resting = moved.without(control_grids(bulk))
        assembly, pulls = with_moving(bulk, assembly, resting)
        loads = read_loads(bulk, assembly, pulls, moved.unread)
        assembly = replace(assembly, loads=loads)
    return Deck(
        cards=cards,
        control=control,
        grids=grids,
        mass_factor=factor,
        materials=materials,
        shear_factors=factors,
        assembly=assembly,
        parents=_parents(grids, straight, ends),
        plane=plane,
        thicknesses={number: item.thickness for number, item in laminates.items()},
        ignored=ignored,
        ignore=ignore,
        moved=moved,
    )


def _parents(grids: Grids, straight: StraightSides, ends: BeamEnds) -> Indices:
    whole = np.concatenate([np.arange(len(grids.ids)), np.array(ends.grids, dtype=np.int64)])
    sides = np.array(list(straight.ends), dtype=np.int64).reshape(-1, 2)
    alone = np.column_stack([whole, whole])
    return np.vstack([alone[: len(grids.ids)], sides, alone[len(grids.ids) :]])


def _check_supported(
    cards: Mapping[str, Cards],
    control: CaseControl,
    ignored: list[str],
    ignore: frozenset[str],
    path: Path,
) -> None:
    """Refuse all unsupported cards that may change the structure; note the other omissions."""
    named = materials_of(cards, *FIELDS)
    unread = []
    for name, cards_of_name in cards.items():
        if name in _READ:
            continue
        if name in USERS and not any(user in cards for user in USERS[name]):
            ignored.append(f"{len(cards_of_name)} {name} that no element uses")
            continue
        if name in ADDED_MASS and control.present and control.set_of("NSM") is None:
            ignored.append(f"{len(cards_of_name)} {name}: case control selects none by NSM")
            continue
        first = 0
        if name in MATERIALS:
            used = [card.number for card in cards_of_name if card.integer(0) in named]
            if not used:
                ignored.append(f"{len(cards_of_name)} {name} that no property uses")
                continue
            first = used[0]
        unread.append(
            Occurrence(name=name, count=len(cards_of_name), where=cards_of_name.place(first))
        )
    ignored += CARDS.notes(unread, ignore, path)
