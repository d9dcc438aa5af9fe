"""Results and complete reduced models of a run."""

import platform
from collections.abc import Mapping, Sequence
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import scipy

from faying import __version__
from faying.joint.model import Model
from faying.model.deck_bolt import bolt_ends
from faying.model.matrices import mass_properties
from faying.model.solid_cells import tangled
from faying.reduction.basis import Basis
from faying.reduction.projection import completed, contact_surfaces, projected
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.tightening import open_interfaces
from faying.study.judgement.model_warnings import (
    bolt_doubts,
    doubts,
    overlapping,
    pressure_doubts,
    unheld,
    unmeasured,
)
from faying.study.keys.measurements import measured_curves
from faying.study.results.validation_record import ValidationRecord
from faying.study.results.values import BoltRecord, CaseResult, Results, interface_record
from faying.study.stages.offline import Models, PreparedJoint, TrainedBases
from faying.study.stages.reference import Reference

Kept = Mapping[str, Mapping[int, ReducedModel]]

ALWAYS = (False, True)
"""Residual compliance of the classic models that are always stored: without, and with."""


def kept_models(model: Model, models: Models, classic: Basis, title: str) -> Kept:
    """Return the reduced models of a run that have a basis, always with the classic ones.

    They have the matrices of recovery and exports, computed once for all.
    """
    chosen = {
        (name, count): rom
        for name, sizes in models.items()
        for count, rom in sizes.items()
        if isinstance(rom, ReducedModel)
    }
    for compliance in ALWAYS:
        rom = projected(model, classic, compliance=compliance)
        if rom.method not in models:
            chosen[rom.method, 0] = rom
    models_by_method: dict[str, dict[int, ReducedModel]] = {}
    for (name, count), rom in zip(chosen, completed(model, list(chosen.values())), strict=True):
        models_by_method.setdefault(name, {})[count] = replace(rom, name=title)
    return models_by_method


def record(
    joint: PreparedJoint,
    recoverable: Kept,
    trained: TrainedBases,
    cases: Mapping[str, CaseResult],
    validation: ValidationRecord,
    warnings: Sequence[str],
    reference: Reference,
) -> Results:
    """Return the results of a run without its timings."""
    study, model, mesh = joint.study, joint.model, joint.model.assembly.mesh
    tightened = any(joint.tightening.initial_forces.values())
    return Results(
        title=study.title or study.path.stem,
        units=model.units,
        study_text=study.text,
        nodes=mesh.nodes,
        node_ids=mesh.node_ids,
        body=mesh.bodies,
        blocks=mesh.blocks,
        mass=mass_properties(model.assembly).mass,
        dofs=model.structure.n_dof,
        normal_modes=trained.mode_count,
        factor_bytes=model.structure.interior_factor.memory,
        interfaces={
            name: interface_record(surface, joint.preload.pressure[slice(*surface.slice)])
            for name, surface in contact_surfaces(model).items()
        },
        bolts={name: _bolt(joint, name) for name in model.bolts},
        tightening_stages=joint.tightening.stages,
        cases=cases,
        timings={},
        provenance={
            "faying": __version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "scipy": scipy.__version__,
            "platform": platform.platform(),
            "factorization": model.structure.interior_factor.backend,
            "date": datetime.now(UTC).isoformat(timespec="seconds"),
        },
        warnings=tuple(warnings),
        omissions=tuple(joint.books.failed),
        doubts=(
            *open_interfaces(model.contact.slices if tightened else {}, joint.preload.pressure),
            *unmeasured(study, cases),
            *filter(None, [tangled(model.assembly)]),
            *doubts(model.assembly.materials, study.units),
            *bolt_doubts(study, joint.loaded),
            *pressure_doubts(cases, model.assembly.materials, study.units),
        ),
        notes=(*unheld(model), *overlapping(model)),
        measurements=measured_curves(study),
        validation=validation,
        reduced=recoverable,
        reference=reference.kind,
        reference_reason=reference.reason,
    )


def _bolt(joint: PreparedJoint, name: str) -> BoltRecord:
    column = joint.tightening.bolts.index(name)
    spec = next(spec for spec in joint.loaded.bolts if spec.name == name)
    return BoltRecord(
        preload=joint.loaded.preloads.get(name, float(joint.preload.bolt_force(name))),
        initial_force=joint.model.bolts[name].initial_force,
        history=joint.tightening.bolt_forces[:, column],
        axis=bolt_ends(joint.model.assembly, spec),
    )
