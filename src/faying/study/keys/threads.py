"""Threads of the bolts of a study, and preloads from torque or utilisation."""

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from faying.assessment.strength.grades import BoltStrength
from faying.assessment.strength.preload_ends import BoltStrengths
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
    """Return the thread of a bolt; None where the study gives no size.

    Raises
    ------
    ModelError
        If the data of the thread are inconsistent, or the unit of length is unknown.
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
    # Without head data, the mean diameter of the bearing face is the friction diameter.
    rubs = thread.head_diameter or (outer + inner) / 2
    if bolt.hole and standard:
        rubs += (bolt.hole - standard) / 2
    return replace(thread, bearing=(outer, inner), head_diameter=rubs)


def final_force(bolt: BoltSection, units: str, variation: float = 0.0) -> float | None:
    """Return the preload of a bolt from preload, torque or utilisation; None without any.

    ``variation`` is Γ of the preload: a utilisation refers to the largest preload, (1 + Γ) F_V.

    Raises
    ------
    ModelError
        If the preload does not follow from torque or utilisation.
    """
    thread = thread_of(bolt, units)
    if thread is not None and bolt.torque is not None:
        return force_of_torque(thread, bolt.torque)
    if thread is not None and bolt.utilisation is not None:
        return force_of_utilisation(thread, bolt.utilisation, units) / (1 + variation)
    return bolt.preload


@dataclass(frozen=True, eq=False, kw_only=True)
class StudyBolts:
    """The bolts of a study, their preload scatter, and required margins."""

    bolts: Sequence[BoltSection]
    scatter: ScatterSection | None
    margins: MarginsSection | None
    units: str

    @classmethod
    def of(cls, study: Study) -> Self:
        """Return the bolts of a study."""
        scatter, margins = study.preload_scatter, study.requirement.margins
        return cls(bolts=study.bolts, scatter=scatter, margins=margins, units=study.units)

    @classmethod
    def stored(cls, text: str, units: str) -> Self:
        """Return the bolts in the text of a checked study, whose files may be missing."""
        tables = tomllib.loads(text)
        scatter = tables.get("preload_scatter")
        return cls(
            bolts=[BoltSection.model_validate(bolt) for bolt in tables.get("bolt", [])],
            scatter=None if scatter is None else ScatterSection.model_validate(scatter),
            margins=RequirementSection.model_validate(tables.get("requirement", {})).margins,
            units=units,
        )

    @property
    def strengths(self) -> BoltStrengths:
        """Data by which the strength of the bolts is judged."""
        scatter = self.scatter or ScatterSection()
        rubs = scatter.surface_friction
        return BoltStrengths(
            threads=self.threads,
            ranges=self.ranges,
            tightened=self.forces,
            temperatures={name: Load({name: 1.0}, name=name) for name in scatter.temperatures},
            smallest_friction=None if rubs is None else rubs[0],
        )

    @property
    def threads(self) -> dict[str, Thread]:
        """Threads of the bolts with size and grade, by bolt name."""
        graded = [bolt for bolt in self.bolts if bolt.thread or bolt.grade or bolt.strength]
        threads = {bolt.name: thread_of(bolt, self.units) for bolt in graded}
        return {name: thread for name, thread in threads.items() if thread is not None}

    @property
    def forces(self) -> dict[str, float]:
        """Preloads [force] of the tightened bolts, by name."""
        forces = {b.name: final_force(b, self.units, self._variation(b)) for b in self.bolts}
        return {name: force for name, force in forces.items() if force is not None}

    @property
    def forced(self) -> set[str]:
        """Names of the bolts whose final or initial force the study gives."""
        locked = {bolt.name for bolt in self.bolts if bolt.initial_force is not None}
        return {*self.forces, *locked}

    @property
    def ranges(self) -> dict[str, PreloadRange]:
        """Scatter and losses of each preload by the standard of the study, by bolt name."""
        margins, losses = self.margins, PreloadRange()
        if margins is not None:
            losses = PreloadRange(
                loss=margins.relaxation,
                creep=margins.creep,
                gained=margins.thermal_gain,
                lost=margins.thermal_loss,
                least_control=margins.control[0],
                most_control=margins.control[1],
            )
        ranges = {}
        for bolt in self.bolts:
            smallest, largest = self._of_friction(bolt)
            ranges[bolt.name] = replace(
                losses,
                variation=self._variation(bolt),
                least_control=losses.least_control * smallest,
                most_control=losses.most_control * largest,
            )
        return ranges

    def _variation(self, bolt: BoltSection) -> float:
        """Return Γ of the preload of a bolt, or of all bolts if it has none."""
        if bolt.gamma is not None:
            return bolt.gamma
        shared = self.scatter.tightening_factor if self.scatter else 1.0
        return variation_of(bolt.tightening_factor or shared)

    def _of_friction(self, bolt: BoltSection) -> tuple[float, float]:
        """Return the preload of a torque at largest and least friction, over the nominal one."""
        thread, scatter = thread_of(bolt, self.units), self.scatter
        if scatter is None or scatter.thread_friction is None or scatter.head_friction is None:
            return 1.0, 1.0
        if thread is None or thread.head_diameter is None:
            return 1.0, 1.0
        in_thread, at_head = np.array([scatter.thread_friction, scatter.head_friction])
        meant = thread.torque_per_force(in_thread.mean(), at_head.mean())
        largest, smallest = meant / thread.torque_per_force(in_thread, at_head)
        return float(smallest), float(largest)
