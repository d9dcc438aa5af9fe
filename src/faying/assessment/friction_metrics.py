"""What is told of friction in every load case or instant, beside the metrics without it."""

from collections.abc import Iterable, Mapping

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.case_metrics import Metric
from faying.assessment.slip import ON_THE_BOUND
from faying.interface.surface import ContactSurface
from faying.simulation.solution import Solution


def friction_metrics(interfaces: Iterable[str]) -> list[Metric]:
    """Return the metrics of interfaces of a joint with friction."""
    return [metric for name in interfaces for metric in _of_interface(name)]


def largest_slip(name: str) -> Metric:
    """Return the metric of how far an interface slips."""
    return Metric(
        name=f"max_slip.{name}",
        description="largest distance slipped, tightening included",
        dimension="length",
        worst="largest",
    )


def _of_interface(name: str) -> tuple[Metric, ...]:
    return (
        Metric(
            name=f"max_traction.{name}",
            description="largest tangential traction of a contact point",
            dimension="force/length²",
            worst="largest",
        ),
        Metric(
            name=f"area_at_bound.{name}",
            description="area in contact whose traction is at its friction bound",
            dimension="length²",
            worst="largest",
        ),
        largest_slip(name),
    )


def friction_figures(solution: Solution, interfaces: Mapping[str, ContactSurface]) -> Matrix:
    """Return the metrics (n_case, n_metric) of many cases or instants of a joint with friction."""
    contact, normal = solution.system.contact, np.atleast_2d(solution.contact_forces)
    friction = np.zeros(contact.n_points)
    friction[contact.rubbing] = contact.friction
    none = np.zeros((len(normal), 2, contact.n_points))
    shear = none if solution.shear_forces is None else solution.shear_forces
    slip = none if solution.shear_slip is None else solution.shear_slip
    force = np.linalg.norm(shear, axis=1)
    bound = (normal > 0) & (force >= (1 - ON_THE_BOUND) * friction * normal)
    traction, far = force / contact.weights, np.linalg.norm(slip, axis=1)
    columns: list[Vector] = []
    for record in interfaces.values():
        points = slice(*record.slice)
        columns += [
            traction[:, points].max(axis=1),
            bound[:, points] @ record.weights,
            far[:, points].max(axis=1),
        ]
    return np.column_stack(columns)
