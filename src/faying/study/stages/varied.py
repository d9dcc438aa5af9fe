"""Backbones of a study at other values of its parameters, on a structure reduced once."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

from faying.assessment.backbone import Backbone
from faying.assessment.modal_analysis import backbone
from faying.exceptions import naming
from faying.execution.checkpoint import Arrays
from faying.execution.executor import Function
from faying.files.flattening import flattened, restored
from faying.joint.model import Model
from faying.linalg.threads import one_thread
from faying.model.description import JointDescription
from faying.reduction.craig_bampton import craig_bampton
from faying.reduction.projection import projected
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.path import last_of
from faying.simulation.solution import Solution
from faying.simulation.tightening import tightened_joint
from faying.study.inputs.bolts import losses
from faying.study.inputs.load_model import (
    LoadedModel,
    build_loaded,
    check_interfaces,
    load_model,
    read_source,
)
from faying.study.keys.parameter_tables import steps_to, value_at
from faying.study.keys.schema import parse_study, parse_tables
from faying.study.keys.tables import DEFAULT_NORMAL_MODES, Study
from faying.study.stages.offline import joint_while_tightened
from faying.study.stages.path_cases import cycle_increments

Curves = Mapping[tuple[str, int], Backbone]
"""Backbones by load case and mode number."""


def with_values(study: Study, values: Mapping[str, float]) -> Study:
    """Return a study with other values of its parameters, by name; its file is not changed."""
    tables = tomllib.loads(study.text)
    for section in study.parameters:
        for key in section.keys if section.name in values else ():
            steps = steps_to(key, tables)
            value_at(steps[:-1], tables)[steps[-1]] = float(values[section.name])
    with naming(_written(values)):
        return parse_tables(tables, study.source)


def _written(values: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:g}" for name, value in values.items())


@dataclass(frozen=True, eq=False, kw_only=True)
class VariedJoint:
    """A joint whose parameters may vary, with its structure reduced once.

    Attributes
    ----------
    study
        Study with the values of its file.
    source
        Source of the model.
    model
        Full model.
    rom
        Reduced model with the compliance, which keeps static solutions exact.
    """

    study: Study
    source: JointDescription
    model: Model
    rom: ReducedModel

    def tightened(self, values: Mapping[str, float]) -> tuple[ReducedModel, Solution]:
        """Return the reduced model with locked bolts, and its state after tightening."""
        study = with_values(self.study, values)
        loaded = load_model(study, self.source)
        system = self._with_contact(loaded)
        forces = {name: force for name, force in loaded.preloads.items() if force > 0}
        with naming(_written(values)):
            joint = joint_while_tightened(study, system)
            tight = tightened_joint(joint, forces, losses=losses(study))
            locked = system.with_bolt_forces(tight.tightening.initial_forces)
            return locked, last_of(tight.rest(locked))

    def curves(self, values: Mapping[str, float]) -> Curves:
        """Return the backbones of all load cases of this kind."""
        locked, state = self.tightened(values)
        with naming(_written(values)):
            return {
                (case.name, mode): backbone(
                    locked,
                    mode,
                    case.levels,
                    over=case.over,
                    at=case.at,
                    initial=state,
                    increments=cycle_increments(case),
                )
                for case in self.study.load_cases
                if case.kind == "backbone"
                for mode in case.modes
            }

    def _with_contact(self, loaded: LoadedModel) -> ReducedModel:
        """Return the reduced model with the laws, gaps, damping and locked bolts of a study."""
        model = self.model.with_interfaces(build_loaded(loaded).interfaces)
        rom, rayleigh, law = self.rom, self.model.damping, loaded.damping
        contact = replace(
            rom.contact, laws=model.contact.laws, initial_gap=model.contact.initial_gap
        )
        C = rom.C + (law.alpha - rayleigh.alpha) * rom.M + (law.beta - rayleigh.beta) * rom.K
        changed = replace(rom, contact=contact, C=C)
        return changed.with_bolt_forces(loaded.initial_forces)


def varied_joint(study: Study) -> VariedJoint:
    """Build and reduce the joint of a study once."""
    source = read_source(study)
    # Values within the ranges, so that interfaces with a range of friction have friction.
    inside = {parameter.name: sum(parameter.range) / 2 for parameter in study.parameters}
    loaded = load_model(with_values(study, inside), source)
    check_interfaces(study, loaded)
    model = build_loaded(loaded)
    count = study.reduction.normal_modes or DEFAULT_NORMAL_MODES
    basis = craig_bampton(model, normal_modes=count)
    return VariedJoint(
        study=study, source=source, model=model, rom=projected(model, basis, compliance=True)
    )


@lru_cache(maxsize=1)
def prepare_curves(text: str, path: Path) -> Function:
    """Prepare the joint of a study on a worker; return the function from values to backbones."""
    return partial(_packed, varied_joint(parse_study(text, path)))


@one_thread()
def _packed(joint: VariedJoint, values: Mapping[str, float]) -> Arrays:
    return {
        f"{mode} {case}/{name}": array
        for (case, mode), curve in joint.curves(values).items()
        for name, array in flattened(curve).items()
    }


def unpacked_curves(arrays: Arrays) -> Curves:
    """Return the backbones from the arrays of a worker."""
    members: dict[tuple[str, int], dict[str, Any]] = {}
    for name, array in arrays.items():
        where, _, member = name.rpartition("/")
        mode, _, case = where.partition(" ")
        members.setdefault((case, int(mode)), {})[member] = array
    return {where: restored(Backbone, packed) for where, packed in members.items()}
