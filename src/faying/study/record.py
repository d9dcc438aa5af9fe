"""From what a run computed to the values it leaves behind."""

import platform
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime

import numpy as np
import scipy

from faying import __version__
from faying._typing import Vector
from faying.joint.model import Model
from faying.joint.system import System
from faying.model.bodies import bodies
from faying.model.bolt_axis import bolt_ends
from faying.model.matrices import mass_properties
from faying.study.extras import Extras
from faying.study.offline import PreparedJoint, TrainedBases
from faying.study.portable_records import kept_models, ports_record, reduced_records
from faying.study.progress import Stages
from faying.study.recovery_results import ReducedRecord
from faying.study.results import BoltRecord, CaseResult, InterfaceRecord, Results, ValidationRecord
from faying.study.tables import Study


def record(
    study: Study,
    joint: PreparedJoint,
    models: Mapping[str, Mapping[int, System]],
    trained: TrainedBases,
    cases: Mapping[str, CaseResult],
    validation: ValidationRecord,
    stages: Stages,
    extras: Extras,
    warnings: Sequence[str],
) -> Results:
    """Collect the results of a run, all but its timings."""
    model, mesh = joint.model, joint.model.assembly.mesh
    ports, shapes = None, None
    reduced: Mapping[str, Mapping[int, ReducedRecord]] = {}
    with stages.stage("recovery matrices"), extras.attempt("matrices for recovery and export"):
        ports = ports_record(model)
        kept = kept_models(model, models, trained.bases["classic"])
        reduced, shapes = reduced_records(model, kept)
    return Results(
        title=study.title or study.path.stem,
        units=model.units,
        study_text=study.text,
        nodes=mesh.nodes,
        node_ids=mesh.node_ids,
        body=bodies(mesh),
        blocks=mesh.blocks,
        mass=mass_properties(model.assembly).mass,
        dofs=model.structure.n_dof,
        normal_modes=trained.mode_count,
        factor_bytes=model.structure.interior_factor.memory,
        interfaces=interface_records(model, joint.preload.pressure),
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
        omissions=tuple(extras.failed),
        validation=validation,
        ports=ports,
        reduced=reduced,
        shapes=shapes,
    )


def interface_records(model: Model, preload_pressure: Vector) -> dict[str, InterfaceRecord]:
    """Return geometry and law of the interfaces of a model, with their pressures (n_point,)."""
    return {name: _interface(model, name, preload_pressure) for name in model.interfaces}


def _interface(model: Model, name: str, preload_pressure: Vector) -> InterfaceRecord:
    interface, points = model.interfaces[name], model.contact.slices[name]
    coupling = interface.coupling
    return InterfaceRecord(
        points=interface.points,
        normals=interface.normals,
        weights=interface.weights,
        initial_gap=interface.initial_gap,
        slice=(points.start, points.stop),
        pairs=interface.pairs,
        pair_points=interface.pair_points(model.assembly.mesh.nodes),
        averaging=interface.averaging.toarray(),
        faces=interface.faces,
        penalty=interface.penalty,
        quadrature=interface.quadrature,
        stuck=model.stuck.get(name, np.zeros(len(interface.pairs), dtype=bool)),
        preload_pressure=preload_pressure[points],
        face_coverage=None if coupling is None else coupling.face_coverage,
        overlap=None if coupling is None else coupling.segments.partial,
        declared_area=interface.declared_area,
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
