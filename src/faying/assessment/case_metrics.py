"""What an engineer asks of every load case or instant: a few numbers, not fields."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

from faying._typing import Mask, Matrix, Vector
from faying.assessment.certificate import Certificate
from faying.assessment.sealing import Ring, ring_pressure
from faying.assessment.slip_demand import area_sums
from faying.assessment.weak_share import weak_share
from faying.interface.surface import ContactSurface
from faying.joint.bolt_surroundings import surroundings
from faying.joint.system import System
from faying.joint.tangential import TangentialRows
from faying.model.bolt import Bolt
from faying.model.boundary import DISPLACEMENT_NAMES, FORCE_NAMES, Boundary
from faying.simulation.solution import Solution

WEAK_SHARE = "weak_share."
"""What names of metrics of weak springs begin with."""


@dataclass(frozen=True, kw_only=True)
class Metric:
    """One number of every load case or instant.

    Attributes
    ----------
    name
        As in ``clamp_force.joint``: what it is, and of which interface, bolt or boundary.
    description
    dimension
        In words, as ``"force/length²"``.
    worst
        Which of its values are the worst ones; None where none is.
    """

    name: str
    description: str
    dimension: str
    worst: Literal["largest", "smallest"] | None = None


def metrics_of(
    system: System,
    interfaces: Mapping[str, ContactSurface],
    *,
    certified: bool,
    rings: Collection[str] = (),
    areas: Collection[str] = (),
) -> list[Metric]:
    """Return the metrics of a system, in the order of :func:`case_metrics`.

    Parameters
    ----------
    interfaces
        Geometry of the contact points, by name.
    certified
        Whether there are certificates.
    rings
        Names of rings around holes.
    areas
        Names of areas whose needed friction is wanted, of static cases.
    """
    metrics: list[Metric] = []
    for name in interfaces:
        metrics += _of_interface(name, certified=certified)
    for name in system.bolts:
        metrics += [
            Metric(
                name=f"bolt_force.{name}",
                description="axial force, tension positive",
                dimension="force",
                worst="largest",
            )
        ]
    metrics += [
        Metric(
            name=f"clamp_around.{interface}.{bolt}",
            description="normal force on the points of the interface nearest to the bolt",
            dimension="force",
            worst="smallest",
        )
        for interface, bolt in _shared(interfaces, system.bolts)
    ]
    metrics += [
        Metric(
            name=f"bolt_bending.{name}",
            description="larger of the bending moments where the beams of the bolt begin and end",
            dimension="force·length",
            worst="largest",
        )
        for name in bent_bolts(system.bolts)
    ]
    for name, boundary in system.boundaries.items():
        metrics += [
            Metric(
                name=f"displacement.{name}.{DISPLACEMENT_NAMES[component]}",
                description="displacement or rotation, average over the nodes of the boundary",
                dimension="length" if component < 3 else "1",
            )
            for component in _components(boundary)
        ]
    metrics += [
        Metric(
            name=f"{WEAK_SHARE}{body}",
            description="what weak springs between the bodies carry over the contact force",
            dimension="1",
            worst="largest",
        )
        for body in system.weak_supports
    ]
    metrics += [
        Metric(
            name=f"ring_pressure.{name}",
            description="smallest pressure on the best closed ring around a hole",
            dimension="force/length²",
            worst="smallest",
        )
        for name in rings
    ]
    metrics += [
        Metric(
            name=f"needed_friction.{name}",
            description="coefficient of friction that carries what acts along the area",
            dimension="1",
            worst="largest",
        )
        for name in areas
    ]
    if certified:
        metrics += [
            Metric(
                name="certified_energy_error",
                description="bound of the error of all contact forces in the energy norm",
                dimension="1",
                worst="largest",
            ),
            Metric(
                name="certified_pressure_error",
                description="bound of the largest pressure error over the largest pressure",
                dimension="1",
            ),
        ]
    return metrics


def _of_interface(name: str, *, certified: bool) -> Iterator[Metric]:
    pressure, length = "force/length²", "length"
    yield Metric(
        name=f"max_pressure.{name}",
        description="largest pressure of a contact point",
        dimension=pressure,
        worst="largest",
    )
    for axis in "xyz":
        yield Metric(
            name=f"max_pressure_{axis}.{name}", description="where it is", dimension=length
        )
    yield Metric(
        name=f"max_nodal_pressure.{name}",
        description="largest average pressure around a node",
        dimension=pressure,
        worst="largest",
    )
    yield Metric(
        name=f"clamp_force.{name}",
        description="total normal force",
        dimension="force",
        worst="smallest",
    )
    if certified:
        for end in ("low", "high"):
            yield Metric(
                name=f"clamp_force_{end}.{name}",
                description="the full model's lies between low and high",
                dimension="force",
            )
    yield Metric(
        name=f"open_area.{name}",
        description="area without pressure",
        dimension="length²",
        worst="largest",
    )
    yield Metric(
        name=f"max_gap.{name}", description="largest gap", dimension=length, worst="largest"
    )


def case_metrics(
    solution: Solution,
    interfaces: Mapping[str, ContactSurface],
    certificate: Certificate | None = None,
    rings: Mapping[str, Ring] = MappingProxyType({}),
    areas: Mapping[str, TangentialRows] = MappingProxyType({}),
) -> Matrix:
    """Return the metrics (n_case, n_metric) of many load cases or instants.

    Parameters
    ----------
    solution
        With one entry per case or instant.
    certificate
        Of the same cases.
    rings
        Around holes, by name.
    areas
        What is carried along areas whose needed friction is wanted, of static cases.
    """
    columns: list[Vector] = []
    for name, surface in interfaces.items():
        columns += _interface_columns(name, surface, solution, certificate)
    columns += [np.asarray(solution.bolt_force(name)) for name in solution.system.bolts]
    for (name, _), points in _shared(interfaces, solution.system.bolts).items():
        span = slice(*interfaces[name].slice)
        columns.append(solution.pressure[:, span] @ (interfaces[name].weights * points[span]))
    for name in bent_bolts(solution.system.bolts):
        moments = np.linalg.norm(solution.bolt_bending(name), axis=-1)
        columns.append(moments.max(axis=-1))
    for name, boundary in solution.system.boundaries.items():
        moved = solution.displacement(name)
        columns += [moved @ boundary.pattern(FORCE_NAMES[c]) for c in _components(boundary)]
    columns += [weak_share(solution, body) for body in solution.system.weak_supports]
    columns += [ring_pressure(ring, solution.pressure) for ring in rings.values()]
    columns += [_needed_friction(solution, interfaces, area) for area in areas.values()]
    if certificate is not None:
        columns += [certificate.energy_error, certificate.max_relative_error]
    return np.column_stack(columns)


def _needed_friction(
    solution: Solution, interfaces: Mapping[str, ContactSurface], area: TangentialRows
) -> Vector:
    forces, surface, joint = solution.contact_forces, interfaces[area.interface], solution.system
    carried = area.carried(solution.inputs, joint.contact.at_pairs(forces).T)
    points = np.arange(*surface.slice)
    if area.bolt:
        points = points[surroundings(interfaces, joint.bolts)[area.interface, area.bolt][points]]
    places = surface.points[points - surface.slice[0]]
    return area_sums(area, places, forces[:, points], carried).needed_friction


def _shared(
    interfaces: Mapping[str, ContactSurface], bolts: Mapping[str, Bolt]
) -> dict[tuple[str, str], Mask]:
    """Return the points around each of several bolts; a single one has the whole interface."""
    return surroundings(interfaces, bolts) if len(bolts) > 1 else {}


def bent_bolts(bolts: Mapping[str, Bolt]) -> list[str]:
    """Return the names of the bolts whose bending is seen."""
    return [name for name, bolt in bolts.items() if bolt.bending is not None]


def _components(boundary: Boundary) -> list[int]:
    return sorted(set(boundary.components.tolist()))


def _interface_columns(
    name: str, surface: ContactSurface, solution: Solution, certificate: Certificate | None
) -> list[Vector]:
    points = slice(*surface.slice)
    pressure, gap = solution.pressure[:, points], solution.gap[:, points]
    peak = pressure.argmax(axis=1)
    bounds = [] if certificate is None else list(certificate.contact_force[name].T)
    return [
        pressure.max(axis=1),
        *surface.points[peak].T,
        surface.nodal_average(pressure.T).max(axis=0),
        np.asarray(solution.contact_force(name)),
        *bounds,
        (pressure <= 0) @ surface.weights,
        gap.max(axis=1),
    ]
