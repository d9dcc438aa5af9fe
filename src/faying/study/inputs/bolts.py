"""The bolts of a study: their elements, preloads and initial forces."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from faying.digits import DECK_DIGITS
from faying.exceptions import StudyError, refuse_study
from faying.model.assembly import Assembly, NodalLoads
from faying.model.description import JointDescription
from faying.model.specs import BoltSpec
from faying.simulation.preload_loss import PreloadLoss
from faying.study.keys.loadings import loadings
from faying.study.keys.model_tables import BoltSection
from faying.study.keys.section import stated
from faying.study.keys.tables import Study
from faying.study.keys.threads import StudyBolts, thread_of


def bolt_entries(study: Study, assembly: Assembly) -> list[dict[str, Any]]:
    """Return the keys of each bolt without its forces, with nodes of a deck turned into elements.

    Raises
    ------
    StudyError
        If neither a beam nor a single spring of the deck joins the nodes.
    """
    entries = []
    for number, bolt in enumerate(study.bolts):
        entry = stated(bolt, BoltSpec)
        if bolt.nodes is not None and assembly.matrices is None:
            del entry["nodes"]
            entry["elements"] = _elements_between(study, number, bolt, assembly)
        if bolt.axis is not None and bolt.size is not None:
            entry = {**_measures(study, bolt), **entry}
        entries.append(entry)
    return entries


def _measures(study: Study, bolt: BoltSection) -> dict[str, float]:
    """Return the diameter of a bolt of a standard size, and the bearing radius under its head."""
    thread = thread_of(bolt, study.units)
    if thread is None:
        return {}
    face = {} if thread.bearing is None else {"washer_radius": thread.bearing[0] / 2}
    return {"diameter": thread.diameter, **face}


def _elements_between(
    study: Study, number: int, bolt: BoltSection, assembly: Assembly
) -> tuple[int, ...]:
    """Return the ids of the beams, or of the axial spring, between the nodes of a bolt."""
    nodes = set(assembly.mesh.node_index(np.array(bolt.nodes or ())).tolist())
    beams = tuple(beam.id for beam in assembly.beams if nodes.issuperset(beam.nodes))
    springs = tuple(
        spring.id
        for spring in assembly.springs
        if len(spring.ends) == 2
        and nodes.issuperset(node for node, _ in spring.ends)
        and all(component < 3 for _, component in spring.ends)
    )
    if beams or len(springs) == 1:
        return beams or springs
    location = study.source.place(("bolt", number, "nodes"))
    if springs:
        shown = ", ".join(map(str, springs))
        message = f"{location}: springs {shown} join these nodes; give the axial one as 'elements'"
        raise StudyError(message)
    message = (
        f"{location}: no beam and no axial spring of the deck joins two of these nodes; give the "
        "nodes its beams run through, or 'elements'"
    )
    raise StudyError(message)


def check_distinct_bolts(study: Study, bolts: tuple[BoltSpec, ...]) -> None:
    """Refuse two bolts, of the deck or the study, that tighten the same element."""
    owner: dict[int, str] = {}
    for bolt in bolts:
        for element in bolt.elements or ():
            owner_name = owner.setdefault(element, bolt.name)
            if owner_name != bolt.name:
                refuse_study(
                    f"{study.path.name}: bolts '{owner_name}' and '{bolt.name}' both tighten "
                    f"element {element}; to change the preload of a deck's bolt, use its name"
                )


def check_no_second_preload(
    study: Study,
    assembly: Assembly,
    bolts: tuple[BoltSpec, ...],
    tightened: Mapping[str, float],
) -> None:
    """Refuse loads of the deck that pull the ends of a bolt together, which are a second preload.

    ``tightened`` holds the final or initial force [force] of each bolt.
    """
    wished = {load.deck_load for _, load in loadings(study)}
    applied = [name for name in assembly.loads if name in wished]
    for bolt in bolts:
        force = tightened.get(bolt.name, 0.0)
        nodes = _nodes_of(assembly, bolt) if force else []
        for name in applied:
            pull = _pull(assembly.loads[name], nodes)
            if pull:
                refuse_study(
                    f"{study.path.name}: deck load '{name}' pulls at both ends of bolt "
                    f"'{bolt.name}' with {pull:g}, which is the deck's own preload of it, and the "
                    f"bolt is tightened to {force:g} beside it: both would act. Take the pair of "
                    "forces out of the deck, or give the bolt preload = 0"
                )


def _nodes_of(assembly: Assembly, bolt: BoltSpec) -> list[int]:
    """Return the node indices of the beams and springs of a bolt."""
    elements = set(bolt.elements or ())
    beams = [node for beam in assembly.beams if beam.id in elements for node in beam.nodes]
    springs = [
        node for spring in assembly.springs if spring.id in elements for node, _ in spring.ends
    ]
    return sorted({*beams, *springs})


def _pull(load: NodalLoads, nodes: list[int]) -> float:
    """Return the force of a load that pulls nodes in opposite directions; zero of other loads."""
    forces = load.forces[np.isin(load.nodes, nodes), :3]
    sizes = np.linalg.norm(forces, axis=1)
    largest = float(sizes.max(initial=0.0))
    balanced = np.linalg.norm(forces.sum(axis=0)) <= DECK_DIGITS * largest
    return largest if balanced and np.count_nonzero(sizes) > 1 else 0.0


def initial_forces(study: Study, described: JointDescription) -> dict[str, float]:
    """Return the initial forces at which the study or the source locks bolts, by bolt name."""
    tightened = StudyBolts.of(study).forces
    forces = {n: force for n, force in described.initial_forces.items() if n not in tightened}
    wished = {b.name: b.initial_force for b in study.bolts if b.initial_force is not None}
    return forces | wished


def losses(study: Study) -> dict[str, PreloadLoss]:
    """Return the preload losses after tightening, by bolt name, where they are not zero."""
    return {
        bolt.name: PreloadLoss(embedding=bolt.embedding, relaxation=bolt.relaxation)
        for bolt in study.bolts
        if any(bolt.embedding) or bolt.relaxation
    }


def unlocked(
    study: Study, described: JointDescription, bolts: Sequence[BoltSpec]
) -> list[BoltSpec]:
    """Return the bolts that neither the source locks nor the study gives a force."""
    forced = StudyBolts.of(study).forced
    return [bolt for bolt in bolts if bolt.name in described.unlocked - forced]


def preloads(
    study: Study, described: JointDescription, bolts: tuple[BoltSpec, ...]
) -> dict[str, float]:
    """Return the final force of every bolt that is not locked at an initial force."""
    wished = StudyBolts.of(study).forces
    locked = initial_forces(study, described)
    forces = {**described.preloads, **wished}
    for bolt in bolts:
        if bolt.name in locked:
            forces.pop(bolt.name, None)
            continue
        if bolt.name not in forces:
            refuse_study(
                f"{study.path.name}: bolt '{bolt.name}' of the model has no preload; add [[bolt]] "
                f'with name = "{bolt.name}" and preload = its final force (0 if not tightened)'
            )
        if not forces[bolt.name] >= 0:
            refuse_study(
                f"{study.path.name}: bolt '{bolt.name}' has the preload {forces[bolt.name]:g}, "
                "which is compressive; give a positive final force in the deck or by [[bolt]]"
            )
    return forces
