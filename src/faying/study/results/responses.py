"""Stored responses of solutions."""

from collections.abc import Mapping

import numpy as np

from faying._typing import Matrix
from faying.assessment.backbone import Backbone
from faying.assessment.case_metrics import bent_bolts, weak_share
from faying.assessment.tresca import IncrementCertificate
from faying.joint.model import Model
from faying.reduction.projection import full_displacement
from faying.simulation.solution import Solution
from faying.study.results.nodal_motion import NodalMotion, nodal_motion
from faying.study.results.path_record import CycleRecord, PathRecord, slip_over_time
from faying.study.results.values import Response

Seen = dict[str, dict[str, Matrix]]
"""Quantities from displacements, by member of a response and name of a boundary or bolt."""


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
    """Return the response of a solution, with its path, cycles, backbones and certificate.

    For a solution without states ``seen`` is the result of :func:`seen_of`. Displacements of all
    nodes are stored for pictures of a transient if ``moves``.
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
        friction=slip_over_time(solution),
        increment_error=None if certificate is None else float(certificate.energy_error.max()),
        law_residual=None if certificate is None else float(certificate.residual.max()),
        path=path,
        cycles=cycles or {},
        backbones=backbones or {},
    )


def seen_of(solution: Solution, model: Model) -> Seen:
    """Return the stored quantities from displacements: by member of a response, then by name."""
    return {
        "displacements": {name: solution.displacement(name) for name in model.boundaries},
        "bolt_forces": {name: np.asarray(solution.bolt_force(name)) for name in model.bolts},
        "bolt_moments": {
            name: solution.bolt_bending(name) for name in bent_bolts(solution.system.bolts)
        },
        "weak_shares": {body: weak_share(solution, body) for body in solution.system.weak_supports},
    }
