"""Metrics of load cases with friction, each tightened and loaded on its own."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.case_metrics import Metric, case_metrics
from faying.assessment.friction_metrics import largest_slip
from faying.assessment.slip import SLIP, slip_states
from faying.contact.laws import Coulomb
from faying.interface.surface import ContactSurface
from faying.joint.model import Model
from faying.joint.system import System
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.path import assembled, follow, moved_alone, path_start
from faying.simulation.solution import Solution

INCREMENTS = 10
"""Of the load, after one of the bolts."""


def slip_metrics(interfaces: Iterable[str]) -> list[Metric]:
    """Return what is told of interfaces beside the metrics of cases without friction."""
    return [
        metric
        for name in interfaces
        for metric in (
            Metric(
                name=f"slip_area.{name}",
                description="area that slips at the end of the load",
                dimension="length²",
                worst="largest",
            ),
            largest_slip(name),
        )
    ]


def rubbed_metrics(
    system: System,
    interfaces: Mapping[str, ContactSurface],
    inputs: Matrix,
    coefficients: Sequence[Mapping[str, float]],
    name: str,
) -> Matrix:
    """Return the metrics (n_case, n_metric) at the end of cases with friction.

    Parameters
    ----------
    inputs : (n_case, n_input) [force]
        Boundary forces and initial bolt forces: the bolts act first, all of them together.
    coefficients
        Of each case, interface to μ.

    Raises
    ------
    ConvergenceError
        If a case is not solved.

    Notes
    -----
    Every case is a path of its own, some 10 ms an increment at 100 contact points.
    """
    return np.array(
        [
            _case(_with_coefficients(system, frictions), interfaces, row, name)
            for row, frictions in zip(inputs, coefficients, strict=True)
        ]
    )


def _case(
    system: System, interfaces: Mapping[str, ContactSurface], inputs: Vector, name: str
) -> Vector:
    tightened, bolts = np.zeros_like(inputs), system.port_compliance.bolts
    tightened[bolts] = inputs[bolts]
    shares = np.arange(INCREMENTS + 1)[:, None] / INCREMENTS
    rows = tightened + shares * (inputs - tightened)
    moved = moved_alone(system, rows)
    steps = list(follow(system.static_contact.increments, moved, path_start(system, None)))
    path = assembled(system, rows, steps, name)
    return np.concatenate([case_metrics(path, interfaces)[-1], _slip(path, interfaces)])


def _slip(path: Solution, interfaces: Mapping[str, ContactSurface]) -> Vector:
    slips = slip_states(path).status[-1] == SLIP
    far = np.zeros(slips.shape)
    if path.shear_slip is not None:
        far = np.linalg.norm(path.shear_slip[-1], axis=0)
    metrics = [
        (slips[slice(*interface.slice)] @ interface.weights, far[slice(*interface.slice)].max())
        for interface in interfaces.values()
    ]
    return np.ravel(metrics)


def _with_coefficients(system: System, coefficients: Mapping[str, float]) -> System:
    """Return a full or reduced model with other coefficients of friction."""
    laws = {
        name: replace(law, friction=coefficients[name]) if isinstance(law, Coulomb) else law
        for name, law in system.contact.laws.items()
        if name in coefficients
    }
    if all(laws[name] == system.contact.laws[name] for name in laws):
        return system
    if isinstance(system, Model):
        return system.with_interfaces(
            {
                name: interface.with_law(laws.get(name, interface.law))
                for name, interface in system.interfaces.items()
            }
        )
    if isinstance(system, ReducedModel):
        contact = replace(system.contact, laws={**system.contact.laws, **laws})
        return replace(system, contact=contact)
    return system
