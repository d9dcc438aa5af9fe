"""What a run keeps of a solution, and how it is packed into named arrays until the run ends."""

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

import numpy as np

from faying._typing import Matrix
from faying.assessment.accuracy import Accuracy
from faying.assessment.backbone import Backbone
from faying.assessment.case_metrics import bent_bolts
from faying.assessment.tresca import IncrementCertificate
from faying.assessment.weak_share import weak_share
from faying.joint.model import Model
from faying.reduction.projection import full_displacement
from faying.simulation.solution import Solution
from faying.study.results.backbone_record import packed_backbone, unpacked_backbone
from faying.study.results.nodal_motion import NodalMotion, nodal_motion
from faying.study.results.path_record import (
    CycleRecord,
    PathRecord,
    packed_record,
    unpacked_cycles,
    unpacked_path,
)
from faying.study.results.slip_record import SlipRecord, slip_fields
from faying.study.results.values import Response

Seen = dict[str, dict[str, Matrix]]
"""What is seen of displacements, by member of a response and name of a boundary or bolt."""


def respond(
    solution: Solution,
    model: Model,
    seconds: float,
    *,
    path: PathRecord | None = None,
    cycles: Mapping[str, CycleRecord] | None = None,
    backbones: Mapping[str, Backbone] | None = None,
    motion: NodalMotion | None = None,
    certificate: IncrementCertificate | None = None,
    moves: bool = False,
    seen: Seen | None = None,
) -> Response:
    """Take from a solution what a run keeps, with what led to it or was found from it.

    Parameters
    ----------
    seen
        Result of :func:`seen_of`, of a solution without states.
    moves
        Whether the displacements of all nodes are kept of a transient, for pictures.
    """
    static = solution.times is None
    seen = seen_of(solution, model) if seen is None else seen
    return Response(
        pressure=solution.pressure,
        gap=solution.gap,
        displacements=seen["displacements"],
        bolt_forces=seen["bolt_forces"],
        bolt_moments=seen["bolt_moments"],
        weak_shares=seen["weak_shares"],
        contact_forces={name: solution.contact_force(name) for name in model.interfaces},
        open_fraction={name: solution.open_fraction(name) for name in model.interfaces},
        iterations=solution.iterations,
        seconds=seconds,
        energy_gain=solution.energy_gain,
        substeps=solution.substeps,
        step_error=solution.step_error,
        nodal_displacement=(
            model.dofs.nodal(full_displacement(model, solution))[:, :3] if static else None
        ),
        motion=nodal_motion(model, solution) if moves and not static else motion,
        friction=None
        if static or solution.shear_slip is None
        else SlipRecord(**slip_fields(solution, None)),
        increment_error=None if certificate is None else float(certificate.energy_error.max()),
        law_residual=None if certificate is None else float(certificate.residual.max()),
        path=path,
        cycles=cycles or {},
        backbones=backbones or {},
    )


def seen_of(solution: Solution, model: Model) -> Seen:
    """Return what a run keeps of displacements: by member of a response, then by name."""
    return {
        "displacements": {name: solution.displacement(name) for name in model.boundaries},
        "bolt_forces": {name: np.asarray(solution.bolt_force(name)) for name in model.bolts},
        "bolt_moments": {
            name: solution.bolt_bending(name) for name in bent_bolts(solution.system.bolts)
        },
        "weak_shares": {body: weak_share(solution, body) for body in solution.system.weak_supports},
    }


MAPPINGS = (
    "displacements",
    "bolt_forces",
    "bolt_moments",
    "weak_shares",
    "contact_forces",
    "open_fraction",
)
ARRAYS = (
    "pressure",
    "gap",
    "iterations",
    "seconds",
    "nodal_displacement",
    "recovered_pressure",
    "energy_gain",
    "substeps",
    "step_error",
    "increment_error",
    "law_residual",
)


PATH, CYCLES, BACKBONES = "path", "cycles", "backbones"
ESTIMATE, MOTION, FRICTION = "estimate", "motion", "friction"
"""Prefixes of the arrays of a path, of cycles, of backbones, of an estimated error, of a motion, of
friction in a motion."""

FAILED = "failed"
"""Name of the sentences about extras that failed, beside the arrays of a response."""


def packed(response: Response) -> dict[str, Matrix]:
    """Flatten a response to named arrays, as it is kept."""
    arrays = {
        f"{field}/{name}": value
        for field in MAPPINGS
        for name, value in getattr(response, field).items()
    }
    single = {field: getattr(response, field) for field in ARRAYS}
    arrays |= {field: np.asarray(value) for field, value in single.items() if value is not None}
    if response.estimate is not None:
        errors = asdict(response.estimate).items()
        arrays |= {f"{ESTIMATE}/{name}": np.asarray(one) for name, one in errors if one is not None}
    if response.motion is not None:
        arrays |= {
            f"{MOTION}/{one.name}": np.asarray(getattr(response.motion, one.name))
            for one in fields(NodalMotion)
        }
    if response.friction is not None:
        arrays |= packed_record(response.friction, FRICTION)
    if response.path is not None:
        arrays |= packed_record(response.path, PATH)
    for name, one in response.cycles.items():
        arrays |= packed_record(one, f"{CYCLES}/{name}")
    for name, curve in response.backbones.items():
        arrays |= packed_backbone(curve, f"{BACKBONES}/{name}")
    return arrays


def unpacked(arrays: Mapping[str, Matrix]) -> Response:
    """Return the response that :func:`packed` flattened."""
    mappings: dict[str, dict[str, Matrix]] = {field: {} for field in MAPPINGS}
    for key, value in arrays.items():
        field, _, name = key.partition("/")
        if name and field in mappings:
            mappings[field][name] = value
    amplitudes, modes = (
        dict.fromkeys(key.split("/")[1] for key in arrays if key.startswith(f"{prefix}/"))
        for prefix in (CYCLES, BACKBONES)
    )
    return Response(
        pressure=arrays["pressure"],
        gap=arrays["gap"],
        displacements=mappings["displacements"],
        bolt_forces=mappings["bolt_forces"],
        bolt_moments=mappings["bolt_moments"],
        weak_shares=mappings["weak_shares"],
        contact_forces=mappings["contact_forces"],
        open_fraction=mappings["open_fraction"],
        iterations=np.asarray(arrays["iterations"], dtype=np.int64),
        seconds=float(arrays["seconds"]),
        nodal_displacement=arrays.get("nodal_displacement"),
        motion=_unpacked_motion(arrays),
        friction=_unpacked_friction(arrays),
        recovered_pressure=arrays.get("recovered_pressure"),
        energy_gain=float(arrays["energy_gain"]),
        substeps=arrays["substeps"].astype(np.int64) if "substeps" in arrays else None,
        step_error=arrays.get("step_error"),
        estimate=_unpacked_estimate(arrays),
        increment_error=_number(arrays, "increment_error"),
        law_residual=_number(arrays, "law_residual"),
        path=unpacked_path(arrays, PATH) if f"{PATH}/factors" in arrays else None,
        cycles={name: unpacked_cycles(arrays, f"{CYCLES}/{name}") for name in amplitudes},
        backbones={name: unpacked_backbone(arrays, f"{BACKBONES}/{name}") for name in modes},
    )


def _number(arrays: Mapping[str, Matrix], name: str) -> float | None:
    return float(arrays[name]) if name in arrays else None


def _unpacked_estimate(arrays: Mapping[str, Matrix]) -> Accuracy | None:
    """Return the estimated errors of a response; None where there are none."""
    if f"{ESTIMATE}/max_relative_error" not in arrays:
        return None
    keys = {one.name: f"{ESTIMATE}/{one.name}" for one in fields(Accuracy)}
    return Accuracy(**{name: float(arrays[key]) for name, key in keys.items() if key in arrays})


def _unpacked_friction(arrays: Mapping[str, Matrix]) -> SlipRecord | None:
    """Return what friction does at each instant; None where there is none."""
    if f"{FRICTION}/traction" not in arrays:
        return None
    members: dict[str, Any] = {
        one.name: arrays[f"{FRICTION}/{one.name}"] for one in fields(SlipRecord)
    }
    return SlipRecord(**members)


def _unpacked_motion(arrays: Mapping[str, Matrix]) -> NodalMotion | None:
    """Return the displacements of all nodes in some states; None where there are none."""
    if f"{MOTION}/chosen" not in arrays:
        return None
    return NodalMotion(
        chosen=np.asarray(arrays[f"{MOTION}/chosen"], dtype=np.int64),
        amplitudes=arrays[f"{MOTION}/amplitudes"],
        shapes=arrays[f"{MOTION}/shapes"],
        missed=float(arrays[f"{MOTION}/missed"]),
    )
