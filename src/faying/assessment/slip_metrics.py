"""What is told of friction in load cases and instants, beside the metrics without it."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.case_metrics import PRESSURE, Metric, case_metrics
from faying.assessment.growth import DEFAULT_INCREMENTS
from faying.assessment.slip import ON_THE_BOUND, SLIP, slip_states
from faying.interface.surface import ContactSurface
from faying.joint.model import Model
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import InputRow
from faying.simulation.path import solve_path
from faying.simulation.solution import Solution
from faying.simulation.static import solve_static_inputs

SLIP_DISTANCE = "largest distance slipped, tightening included"


def friction_metrics(interfaces: Iterable[str]) -> list[Metric]:
    """Return the metrics of interfaces of a joint with friction."""
    traction = "largest tangential traction of a contact point"
    bound = "area in contact whose traction is at its friction bound"
    return [
        metric
        for name in interfaces
        for metric in (
            Metric(f"max_traction.{name}", traction, PRESSURE, "largest"),
            Metric(f"area_at_bound.{name}", bound, "length²", "largest"),
            Metric(f"max_slip.{name}", SLIP_DISTANCE, "length", "largest"),
        )
    ]


def friction_figures(solution: Solution, interfaces: Mapping[str, ContactSurface]) -> Matrix:
    """Return the metrics (n_case, n_metric) of many cases or instants of a joint with friction."""
    contact, normal = solution.system.contact, np.atleast_2d(solution.contact_forces)
    force = np.linalg.norm(solution.shear_forces, axis=-2).reshape(normal.shape)
    bound = (normal > 0) & (force >= (1 - ON_THE_BOUND) * contact.coefficients * normal)
    far = np.linalg.norm(solution.shear_slip, axis=-2).reshape(normal.shape)
    traction = force / contact.weights
    columns: list[Vector] = []
    for record in interfaces.values():
        points = slice(*record.slice)
        columns += [
            traction[:, points].max(axis=1),
            bound[:, points] @ record.weights,
            far[:, points].max(axis=1),
        ]
    return np.array(columns).reshape(-1, len(normal)).T


def slip_metrics(interfaces: Iterable[str]) -> list[Metric]:
    """Return what is told of interfaces beside the metrics of cases without friction."""
    area = "area that slips at the end of the load"
    return [
        metric
        for name in interfaces
        for metric in (
            Metric(f"slip_area.{name}", area, "length²", "largest"),
            Metric(f"max_slip.{name}", SLIP_DISTANCE, "length", "largest"),
        )
    ]


def scattered_metrics(
    system: Model | ReducedModel,
    interfaces: Mapping[str, ContactSurface],
    inputs: Matrix,
    coefficients: Sequence[Mapping[str, float]],
    name: str,
) -> Matrix:
    """Return the metrics (n_case, n_metric) at the end of cases, slip where there is friction.

    Inputs (n_case, n_input) [force] are boundary forces and initial bolt forces: the bolts act
    first, all of them together. Each case has its coefficients of friction, by interface.

    Raises
    ------
    ConvergenceError
        If a case is not solved.

    Notes
    -----
    Where slip is remembered every case is a path of its own, some 10 ms an increment at 100 contact
    points.
    """
    if system.contact.forgets:
        return case_metrics(solve_static_inputs(system, inputs, name), interfaces)
    return np.array(
        [
            _case(_with_coefficients(system, frictions), interfaces, row, name)
            for row, frictions in zip(inputs, coefficients, strict=True)
        ]
    )


def _case(
    system: Model | ReducedModel,
    interfaces: Mapping[str, ContactSurface],
    inputs: Vector,
    name: str,
) -> Vector:
    load, count = InputRow(name=name, row=inputs), DEFAULT_INCREMENTS
    path = solve_path(system, [load.scaled(step / count) for step in range(count + 1)], name=name)
    return np.concatenate([case_metrics(path, interfaces)[-1], _slip(path, interfaces)])


def _slip(path: Solution, interfaces: Mapping[str, ContactSurface]) -> Vector:
    slips = slip_states(path).status[-1] == SLIP
    far = np.linalg.norm(path.shear_slip[-1], axis=0)
    metrics = [
        (slips[slice(*interface.slice)] @ interface.weights, far[slice(*interface.slice)].max())
        for interface in (interfaces[name] for name in path.system.contact.rubbing_interfaces)
    ]
    return np.ravel(metrics)


def _with_coefficients(
    system: Model | ReducedModel, coefficients: Mapping[str, float]
) -> Model | ReducedModel:
    """Return a full or reduced model with other coefficients of friction."""
    laws = {
        name: system.contact.laws[name].with_coefficient(friction)
        for name, friction in coefficients.items()
    }
    if all(laws[name] == system.contact.laws[name] for name in laws):
        return system
    if isinstance(system, ReducedModel):
        contact = replace(system.contact, laws={**system.contact.laws, **laws})
        return replace(system, contact=contact)
    return system.with_interfaces(
        {
            name: interface.with_law(laws.get(name, interface.law))
            for name, interface in system.interfaces.items()
        }
    )
