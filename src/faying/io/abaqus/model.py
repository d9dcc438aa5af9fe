"""A deck as an assembly with its interfaces and bolts."""

from collections.abc import Iterable
from dataclasses import replace
from itertools import count

import numpy as np

from faying._typing import Matrix
from faying.io.abaqus import contact, materials, pretension
from faying.io.abaqus.constraints import (
    read_equations,
    read_mpcs,
    read_rigid_bodies,
    rotation_nodes,
    shared_rotations,
)
from faying.io.abaqus.contact import with_lone_nodes
from faying.io.abaqus.couplings import (
    Couplings,
    read_couplings,
    read_distributing,
    with_real_rotations,
)
from faying.io.abaqus.deck import Deck, check_parameters, with_distinct_ids
from faying.io.abaqus.deck_data import DeckData, read_data, with_transforms
from faying.io.abaqus.general_contact import (
    joined_bodies,
    read_general_contact,
    read_listed,
)
from faying.io.abaqus.interactions import read_interactions
from faying.io.abaqus.keyword import READ, Keyword, without_blanks
from faying.io.abaqus.left_out import KEYWORDS
from faying.io.abaqus.line_elements import (
    note_masses,
    read_beams,
    read_masses,
    read_springs,
    read_trusses,
)
from faying.io.abaqus.loads import (
    concentrated_forces,
    read_amplitudes,
    read_concentrated,
    read_distributed,
)
from faying.io.abaqus.materials import (
    read_temperatures,
    thermal_forces,
    without_temperatures,
)
from faying.io.abaqus.mesh import (
    LINE_TYPES,
    SHELL_TYPES,
    SOLID_TYPES,
)
from faying.io.abaqus.model_changes import (
    is_from_the_start,
    without_removed,
    without_removed_pairs,
)
from faying.io.abaqus.pretension import step_name
from faying.io.abaqus.shells import Shells, read_shells
from faying.io.abaqus.solid_sections import formulation, note_controls, read_solid_sections
from faying.io.abaqus.supports import read_supports
from faying.io.abaqus.surfaces import face_sets, find_surface, read_surfaces
from faying.io.abaqus.ties import read_ties, with_ties
from faying.io.left_out import Occurrence
from faying.io.moved_supports import moved_note, with_moved_supports
from faying.io.solid_cuts import Cut, close_cuts, cut_mesh, origins
from faying.model.assembly import Assembly, NodalLoads
from faying.model.deck_bolt import with_unlocked_bolts
from faying.model.description import JointDescription
from faying.model.mesh import Mesh


def description(deck: Deck) -> JointDescription:
    """Return the description of a deck in its last step."""
    ignored = deck.ignored
    deck = materials.without_unused(without_temperatures(deck))
    check_supported(deck)
    check_parameters(deck)
    deck = replace(deck, keywords=with_distinct_ids(deck.keywords, ignored))
    data = without_removed(read_data(deck))
    nodes, elements = data.nodes, data.elements
    rotations = rotation_nodes(data)
    data = replace(with_transforms(data), rotations=rotations)
    amplitudes = read_amplitudes(deck)
    temperatures = read_temperatures(data, amplitudes)
    used = np.concatenate([np.empty(0, np.int64), *(b.nodes.ravel() for b in elements.blocks)])
    named, expansions = materials.read_materials(deck, temperatures.uniform(np.unique(used)))
    solids, of_property = read_solid_sections(data, named)
    note_controls(deck, elements.solids)
    note_masses(deck, elements.solids)
    mesh = Mesh(
        nodes=nodes.coordinates,
        node_ids=nodes.ids,
        blocks=solids,
        node_sets=data.node_sets.indices(nodes),
        element_sets={
            data.element_sets.names[key]: ids for key, ids in data.element_sets.ids.items()
        },
    )
    sections = pretension.read_sections(data)
    shells = read_shells(data, named)
    mesh, cuts = _cut(data, mesh, sections, shells)
    surfaces = read_surfaces(data, mesh, shells)
    couplings, data = read_couplings(data, surfaces)
    forces = list(read_concentrated(data, amplitudes))
    general = forces[: len(forces) - (deck.n_step in deck.perturbations)]
    holds = read_supports(data, frozenset(section.node for section in sections), amplitudes)
    springs, bushes = read_springs(data)
    interactions = read_interactions(deck)
    declared = contact.read_pairs(data, interactions, surfaces)
    declared += read_listed(deck, interactions, surfaces)
    deck, declared = without_removed_pairs(deck, declared)
    pairs = [pair for pair in declared if not pair.interaction.tied]
    ties = read_ties(deck, surfaces, [pair for pair in declared if pair.interaction.tied])
    assembly = Assembly(
        mesh=mesh,
        materials=of_property,
        element=formulation(deck, elements.solids),
        beams=(
            *read_beams(data, named),
            *read_trusses(data, named),
        ),
        shells=shells.blocks,
        shell_sections=shells.sections,
        springs=springs,
        bushes=bushes,
        masses=tuple(read_masses(data)),
        supports=holds.supports,
        face_sets=face_sets(surfaces, mesh),
        name=deck.path.stem,
    )
    apart = {section.node for section in sections}
    concentrated = (
        concentrated_forces(
            {component: f for component, f in in_step.items() if component[0] not in apart}, data
        )
        for in_step in forces
    )
    distributed = list(read_distributed(data, assembly, surfaces, amplitudes))
    free = [item for item in sections if item.element is not None and item.node not in holds.since]
    heated = with_unlocked_bolts(assembly, pretension.bolts(free, []))
    locked = [item.element for item in sections if item.node in holds.since]
    thermal = thermal_forces(heated, temperatures, expansions, origins(mesh, cuts), locked, ignored)
    assembly = _tied(data, assembly, couplings)
    assembly = with_ties(assembly, ties, ignored)
    assembly = close_cuts(assembly, cuts)
    closing = assembly.springs[len(assembly.springs) - len(cuts) :]
    bolts = pretension.bolts(sections, [spring.id for spring in closing])
    standing = len(assembly.springs)
    assembly, moving = with_moved_supports(assembly, holds.moved, deck.n_step + 1)
    if holds.moved:
        n_spring = len(assembly.springs) - standing
        ignored.append(moved_note(n_spring, "*BOUNDARY", "the loads of the steps"))
    if len(general) < len(forces):
        thermal[-1] = thermal[-1] - thermal[-2]
        ignored.append(
            f"step {deck.n_step} is a linear perturbation: only its own loads act; contact "
            "opens and closes here under the loads of a study, and is not fixed by earlier steps"
        )
    loads = _loads(deck, concentrated, distributed, thermal, moving)
    assembly = replace(assembly, loads=loads)
    senses = {cut.name: cut.sense for cut in cuts}
    sections = [replace(item, sense=senses.get(item.name, item.sense)) for item in sections]
    preloads = pretension.preloads(sections, general, holds, data)
    unlocked = pretension.unlocked(sections, holds, preloads, loads, deck.n_step, ignored)
    assembly, points = with_lone_nodes(assembly, pairs, ignored)
    specs = contact.specs(assembly, points, deck)
    sides = [(item.slave.nodes, item.master.nodes) for item in pairs]
    sides += [(tie.slave.nodes, tie.master.nodes) for tie in ties]
    joined = joined_bodies(assembly, cuts, sides)
    specs += read_general_contact(deck, assembly, interactions, surfaces, joined)
    return JointDescription(
        assembly=replace(assembly, ignored=tuple(ignored)),
        interfaces=specs,
        bolts=bolts,
        preloads=preloads,
        initial_forces=pretension.initial_forces(sections, bolts, holds.pretension, assembly),
        unlocked=unlocked,
        selected_load=step_name(deck.n_step) if step_name(deck.n_step) in loads else None,
        has_joined_faces=bool(cuts or ties),
    )


def _cut(
    data: DeckData, mesh: Mesh, sections: list[pretension.Section], shells: Shells
) -> tuple[Mesh, list[Cut]]:
    """Return the mesh cut at pretension sections, and the cuts; surfaces are read again on it."""
    through_solids = [section for section in sections if section.element is None]
    cuts = []
    for section in through_solids:
        surfaces = read_surfaces(data, mesh, shells)
        surface = find_surface(surfaces, section.keyword, section.surface, None)
        mesh, cut = cut_mesh(mesh, section.through(surface))
        cuts.append(cut)
    if cuts:
        data.deck.ignored.append(
            "solids are cut at *PRE-TENSION SECTION: name the sides of interfaces, because minus = "
            '"auto" would find the cuts too'
        )
    data.deck.ignored.extend(
        f"*PRE-TENSION SECTION {cut.name}: {cut.touching} elements of the side that "
        "owns the surface touch it only with an edge or a corner; they are cut from the other "
        "side, where CalculiX 2.20 leaves them on both, so that its bolt is tightened "
        "less and is stiffer; sections through bricks have no such elements"
        for cut in cuts
        if cut.touching
    )
    return mesh, cuts


def _tied(data: DeckData, assembly: Assembly, couplings: Couplings) -> Assembly:
    """Return the assembly with couplings and equations."""
    more, links = read_mpcs(data)
    average, turned = couplings.average, couplings.turned
    equations = [
        *(*read_equations(data), *shared_rotations(data)),
        *(*more, *turned, *read_distributing(data)),
    ]
    rigid = [*links, *read_rigid_bodies(data), *couplings.rigid]
    rotating = np.zeros(len(assembly.mesh.nodes), dtype=bool)
    rotating[[coupling.reference for coupling in rigid]] = True
    rotating[[coupling.reference for coupling in average]] = True
    rotating[[node for item in turned for node, c, _ in item.terms if c > 2]] = True
    bending = [beam for beam in assembly.beams if beam.section.inertia_y > 0]
    rotating[[node for beam in bending for node in beam.nodes]] = True
    for block in assembly.shells:
        rotating[block.nodes] = True
    rotating[[node for s in assembly.springs for node, component in s.ends if component > 2]] = True
    rotating[[mass.node for mass in assembly.masses if np.any(mass.inertia)]] = True
    rigid, number = with_real_rotations(rigid, rotating), count(1)
    return replace(
        assembly,
        equations=tuple(equations),
        rigid_couplings=tuple(replace(item, id=next(number)) for item in rigid),
        average_couplings=tuple(replace(item, id=next(number)) for item in average),
    )


def check_supported(deck: Deck) -> None:
    """Refuse unsupported keywords and elements that may change the structure; note others."""
    unread: dict[str, list[Keyword]] = {}
    for keyword in deck.keywords:
        name = _unread_name(keyword)
        if name:
            unread.setdefault(name, []).append(keyword)
    occurrences = [
        Occurrence(name=name, count=len(these), where=these[0].where())
        for name, these in unread.items()
    ]
    deck.ignored.extend(KEYWORDS.notes(occurrences, deck.ignore, deck.path))
    if any(
        k.choice("NLGEOM", "NO") != "NO" or k.value("NLGEOM", "-") == "" for k in deck.of("STEP")
    ):
        deck.ignored.append("NLGEOM of *STEP: displacements are small here")


def _unread_name(keyword: Keyword) -> str:
    """Return the name under which an unread keyword is handled; empty for a read one."""
    if keyword.name == "ELEMENT":
        kind = keyword.choice("TYPE")
        supported = not kind or kind in {*SOLID_TYPES, *LINE_TYPES, *SHELL_TYPES}
        return "" if supported else f"ELEMENT, TYPE={kind}"
    if keyword.name == "TIE":
        cyclic = keyword.has("CYCLIC SYMMETRY") or keyword.has("MULTISTAGE")
        return "TIE, CYCLIC SYMMETRY" if cyclic else ""
    if keyword.name == "INITIAL CONDITIONS" and keyword.has("TYPE"):
        kind = without_blanks(keyword.value("TYPE"))
        return "" if kind == "TEMPERATURE" else f"INITIAL CONDITIONS, TYPE={kind}"
    return "" if keyword.name in READ or is_from_the_start(keyword) else keyword.name


def _loads(
    deck: Deck,
    concentrated: Iterable[Matrix],
    *others: Iterable[Matrix],
) -> dict[str, NodalLoads]:
    """Return the loads in force in every step up to the chosen one, which comes first."""
    steps = {keyword.step for keyword in deck.of("STEP")} | {deck.n_step}
    loads = {}
    for step, (applied, *further) in enumerate(zip(concentrated, *others, strict=True)):
        forces = np.zeros_like(max(further, key=len))
        for part in (applied, *further):
            forces[: len(part)] += part
        loaded = np.flatnonzero((forces != 0).any(axis=1))
        if loaded.size and step in steps:
            loads[step] = NodalLoads(nodes=loaded, forces=forces[loaded])
    order = sorted(loads, key=lambda step: (step != deck.n_step, step))
    return {step_name(step): loads[step] for step in order}
