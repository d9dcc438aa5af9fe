"""The threads of the bolts of a study, and the forces that torque or utilisation bring them to."""

import tomllib
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faying.assessment.strength.bolt_strengths import BoltStrengths
from faying.assessment.strength.grades import BoltStrength
from faying.assessment.strength.thread import Thread
from faying.assessment.strength.tightening import (
    PreloadRange,
    force_of_torque,
    force_of_utilisation,
    variation_of,
)
from faying.simulation.load import Load
from faying.study.keys.model_tables import BoltSection
from faying.study.keys.requirement_tables import MarginsSection, RequirementSection, ScatterSection
from faying.study.keys.tables import Study


def thread_of(bolt: BoltSection, units: str) -> Thread | None:
    """Return the thread of a bolt whose size the study names; None without it.

    Raises
    ------
    ModelError
        If it makes no sense, or it is not known what a length is in these units.
    """
    rubbing = {"friction": bolt.thread_friction, "head_friction": bolt.head_friction}
    limits = {"pressure_limit": bolt.head_pressure_limit, "engagement": bolt.engagement}
    stated = {key: value for key, value in {**rubbing, **limits}.items() if value is not None}
    if bolt.thread is not None:
        return Thread(**{**bolt.thread.model_dump(), **stated})
    if bolt.size is None:
        return None
    strength = None if bolt.strength is None else BoltStrength(**bolt.strength.model_dump())
    thread = Thread.named(
        bolt.size, bolt.grade or "", units, bolt.head, strength=strength, **stated
    )
    face, standard = thread.bearing or (None, None)
    outer = 2 * bolt.washer_radius if bolt.washer_radius else face
    inner = bolt.hole or standard
    if outer is None or inner is None:
        return thread
    # Without a head of its own the mean of what bears rubs.
    rubs = thread.head_diameter or (outer + inner) / 2
    if bolt.hole and standard:
        rubs += (bolt.hole - standard) / 2
    return replace(thread, bearing=(outer, inner), head_diameter=rubs)


def strengths_of(study: Study) -> BoltStrengths:
    """Return what the strength of the bolts of a study is judged by."""
    scatter, margins = study.preload_scatter, study.requirement.margins
    return _strengths(study.bolts, scatter, margins, study.units)


def stored_strengths(text: str, units: str) -> BoltStrengths:
    """Return that of a study that was checked before; its files need not be here."""
    tables = tomllib.loads(text)
    scatter = tables.get("preload_scatter")
    return _strengths(
        [BoltSection.model_validate(bolt) for bolt in tables.get("bolt", [])],
        None if scatter is None else ScatterSection.model_validate(scatter),
        RequirementSection.model_validate(tables.get("requirement", {})).margins,
        units,
    )


def _strengths(
    bolts: Sequence[BoltSection],
    scatter: ScatterSection | None,
    margins: MarginsSection | None,
    units: str,
) -> BoltStrengths:
    rubs = None if scatter is None else scatter.surface_friction
    heated = () if scatter is None else scatter.temperatures
    return BoltStrengths(
        threads=_threads(bolts, units),
        ranges=_ranges(bolts, scatter, margins, units),
        tightened=_final_forces(bolts, scatter, units),
        temperatures={name: Load({name: 1.0}, name=name) for name in heated},
        smallest_friction=None if rubs is None else rubs[0],
    )


def threads_of(study: Study) -> dict[str, Thread]:
    """Return the threads of the bolts of a study whose size and grade it names, by name."""
    return _threads(study.bolts, study.units)


def _threads(bolts: Sequence[BoltSection], units: str) -> dict[str, Thread]:
    graded = [bolt for bolt in bolts if bolt.thread or bolt.grade or bolt.strength]
    threads = {bolt.name: thread_of(bolt, units) for bolt in graded}
    return {name: thread for name, thread in threads.items() if thread is not None}


def _ranges(
    bolts: Sequence[BoltSection],
    scatter: ScatterSection | None,
    margins: MarginsSection | None,
    units: str,
) -> dict[str, PreloadRange]:
    losses = _losses(margins)
    ranges = {}
    for bolt in bolts:
        smallest, largest = _of_friction(bolt, scatter, units)
        ranges[bolt.name] = replace(
            losses,
            variation=variation_in(bolt, scatter),
            least_control=losses.least_control * smallest,
            most_control=losses.most_control * largest,
        )
    return ranges


def _of_friction(
    bolt: BoltSection, scatter: ScatterSection | None, units: str
) -> tuple[float, float]:
    """Return the preload of a torque where friction is largest and smallest, over that meant."""
    thread = thread_of(bolt, units)
    if scatter is None or scatter.thread_friction is None or scatter.head_friction is None:
        return 1.0, 1.0
    if thread is None or thread.head_diameter is None:
        return 1.0, 1.0
    in_thread, at_head = np.array([scatter.thread_friction, scatter.head_friction])
    meant = thread.torque_per_force(in_thread.mean(), at_head.mean())
    largest, smallest = meant / thread.torque_per_force(in_thread, at_head)
    return float(smallest), float(largest)


def variation_in(bolt: BoltSection, scatter: ScatterSection | None) -> float:
    """Return Γ of the preload of a bolt, its own or that of all."""
    if bolt.gamma is not None:
        return bolt.gamma
    return variation_of(bolt.tightening_factor or (scatter.tightening_factor if scatter else 1.0))


def _losses(margins: MarginsSection | None) -> PreloadRange:
    """Return what is lost and gained of every preload, by the standard that a study names."""
    if margins is None:
        return PreloadRange()
    low, high = margins.control
    return PreloadRange(
        loss=margins.relaxation,
        creep=margins.creep,
        gained=margins.thermal_gain,
        lost=margins.thermal_loss,
        least_control=low,
        most_control=high,
    )


def final_force(bolt: BoltSection, units: str, variation: float = 0.0) -> float | None:
    """Return the force that a bolt is tightened to; None where the study does not tell.

    The variation is Γ of its preload: a utilisation is that at the largest one, (1 + Γ) F_V.

    Raises
    ------
    ModelError
        If its torque or utilisation does not tell it.
    """
    thread = thread_of(bolt, units)
    if thread is not None and bolt.torque is not None:
        return force_of_torque(thread, bolt.torque)
    if thread is not None and bolt.utilisation is not None:
        return force_of_utilisation(thread, bolt.utilisation, units) / (1 + variation)
    return bolt.preload


def final_forces(study: Study) -> dict[str, float]:
    """Return the forces that bolts of a study are tightened to, of those that are."""
    return _final_forces(study.bolts, study.preload_scatter, study.units)


def _final_forces(
    bolts: Sequence[BoltSection], scatter: ScatterSection | None, units: str
) -> dict[str, float]:
    forces = {bolt.name: final_force(bolt, units, variation_in(bolt, scatter)) for bolt in bolts}
    return {name: force for name, force in forces.items() if force is not None}


def forced_bolts(study: Study) -> set[str]:
    """Return the bolts whose final or initial force the study tells."""
    locked = {bolt.name for bolt in study.bolts if bolt.initial_force is not None}
    return {*final_forces(study), *locked}
