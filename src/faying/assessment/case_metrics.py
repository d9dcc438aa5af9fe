"""Metrics of every load case or instant: a few numbers, not fields."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

import numpy as np

from faying._typing import Matrix, Vector
from faying.assessment.certificate import Certificate
from faying.assessment.sealing import Ring, ring_pressure
from faying.assessment.slip_demand import area_sums
from faying.digits import SHOWN_DIGITS, SOLVED
from faying.interface.surface import ContactSurface
from faying.joint.bolt_surroundings import contact_areas, surroundings
from faying.joint.system import System
from faying.joint.tangential import TangentialRows
from faying.model.bolt import Bolt
from faying.model.boundary import DISPLACEMENT_NAMES, FORCE_NAMES
from faying.simulation.solution import Solution

PRESSURE = "force/length²"

WEAK_SHARE = "weak_share."
"""Prefix of the names of metrics of weak springs."""


@dataclass(frozen=True)
class Metric:
    """A quantity with one value for every load case or instant.

    Attributes
    ----------
    name
        Quantity and interface, bolt or boundary, as in ``clamp_force.joint``.
    description
    dimension
        In words, as ``"force/length²"``.
    worst
        Whether the least or the largest values are the worst; None where none is.
    """

    name: str
    description: str
    dimension: str
    worst: Literal["largest", "smallest"] | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class _Cases:
    """Many solved cases or instants."""

    solution: Solution
    certificate: Certificate | None
    rings: Mapping[str, Ring]
    areas: Mapping[str, TangentialRows]


Group = tuple[list[Metric], Callable[[_Cases], Sequence[Vector]]]
"""Metrics, and the function from cases to their columns (n_case,)."""


def metrics_of(
    system: System,
    interfaces: Mapping[str, ContactSurface],
    *,
    certified: bool,
    rings: Collection[str] = (),
    areas: Collection[str] = (),
) -> list[Metric]:
    """Return the metrics of a system, in the order of :func:`case_metrics`.

    Areas are those with needed friction as a metric, for static cases; rings lie around holes.
    """
    groups = _groups(system, interfaces, rings, areas, certified=certified)
    return [metric for metrics, _ in groups for metric in metrics]


def case_metrics(
    solution: Solution,
    interfaces: Mapping[str, ContactSurface],
    certificate: Certificate | None = None,
    rings: Mapping[str, Ring] = MappingProxyType({}),
    areas: Mapping[str, TangentialRows] = MappingProxyType({}),
) -> Matrix:
    """Return the metrics (n_case, n_metric) of many load cases or instants.

    Areas have the tangential resultants for needed friction as a metric, for static cases.
    """
    cases = _Cases(solution=solution, certificate=certificate, rings=rings, areas=areas)
    certified = certificate is not None
    groups = _groups(solution.system, interfaces, rings, areas, certified=certified)
    return np.column_stack([column for _, columns in groups for column in columns(cases)])


def _groups(
    system: System,
    interfaces: Mapping[str, ContactSurface],
    rings: Collection[str],
    areas: Collection[str],
    *,
    certified: bool,
) -> Iterator[Group]:
    """Yield groups of a few metrics each, with the function that computes their columns."""
    for name, surface in interfaces.items():
        yield _of_interface(name, surface, certified=certified)
    force, about = "axial force, tension positive", "force"
    yield (
        [Metric(f"bolt_force.{name}", force, about, "largest") for name in system.bolts],
        lambda cases: [np.asarray(cases.solution.bolt_force(name)) for name in system.bolts],
    )
    surrounding = "normal force on the points of the interface nearest to the bolt"
    shared = _bolt_areas(interfaces, system.bolts)
    yield (
        [
            Metric(f"clamp_around.{interface}.{bolt}", surrounding, "force", "smallest")
            for interface, bolt in shared
        ],
        lambda cases: [cases.solution.pressure @ weights for weights in shared.values()],
    )
    bent = bent_bolts(system.bolts)
    moment = "larger of the bending moments where the beams of the bolt begin and end"
    yield (
        [Metric(f"bolt_bending.{name}", moment, "force·length", "largest") for name in bent],
        lambda cases: [
            np.linalg.norm(cases.solution.bolt_bending(name), axis=-1).max(axis=-1) for name in bent
        ],
    )
    moved = "displacement or rotation, average over the nodes of the boundary"
    components = [
        (name, boundary, component)
        for name, boundary in system.boundaries.items()
        for component in sorted(set(boundary.components.tolist()))
    ]
    yield (
        [
            Metric(
                f"displacement.{name}.{DISPLACEMENT_NAMES[component]}",
                moved,
                "length" if component < 3 else "1",
            )
            for name, _, component in components
        ],
        lambda cases: [
            cases.solution.displacement(name) @ boundary.pattern(FORCE_NAMES[component])
            for name, boundary, component in components
        ],
    )
    weak = "what weak springs between the bodies carry over the contact force"
    yield (
        [Metric(f"{WEAK_SHARE}{body}", weak, "1", "largest") for body in system.weak_supports],
        lambda cases: [weak_share(cases.solution, body) for body in system.weak_supports],
    )
    closed = "smallest pressure on the best closed ring around a hole"
    yield (
        [Metric(f"ring_pressure.{name}", closed, PRESSURE, "smallest") for name in rings],
        lambda cases: [
            ring_pressure(ring, cases.solution.pressure) for ring in cases.rings.values()
        ],
    )
    needed = "coefficient of friction that carries what acts along the area"
    yield (
        [Metric(f"needed_friction.{name}", needed, "1", "largest") for name in areas],
        lambda cases: [
            _needed_friction(cases.solution, interfaces, area) for area in cases.areas.values()
        ],
    )
    energy = "bound of the error of all contact forces in the energy norm"
    largest = "bound of the largest pressure error over the largest pressure"
    if certified:
        yield (
            [
                Metric("certified_energy_error", energy, "1", "largest"),
                Metric("certified_pressure_error", largest, "1"),
            ],
            lambda cases: (
                []
                if cases.certificate is None
                else [cases.certificate.energy_error, cases.certificate.max_relative_error]
            ),
        )
    for name in system.contact.rubbing_interfaces:
        yield _of_friction(name, interfaces[name])


def _of_interface(name: str, surface: ContactSurface, *, certified: bool) -> Group:
    between = "the full model's lies between low and high"
    average = "largest average pressure around a node"
    metrics = [
        Metric(f"max_pressure.{name}", "largest pressure of a contact point", PRESSURE, "largest"),
        *(Metric(f"max_pressure_{axis}.{name}", "where it is", "length") for axis in "xyz"),
        Metric(f"max_nodal_pressure.{name}", average, PRESSURE, "largest"),
        Metric(f"clamp_force.{name}", "total normal force", "force", "smallest"),
        *(
            Metric(f"clamp_force_{end}.{name}", between, "force")
            for end in (("low", "high") if certified else ())
        ),
        Metric(f"open_area.{name}", "area without pressure", "length²", "largest"),
        Metric(f"max_gap.{name}", "largest gap", "length", "largest"),
    ]

    def columns(cases: _Cases) -> list[Vector]:
        solution, points = cases.solution, slice(*surface.slice)
        pressure, gap = solution.pressure[:, points], solution.gap[:, points]
        bounds = cases.certificate
        largest = pressure.max(axis=1)
        # The first of symmetric points, independent of round-off.
        where = (pressure >= (1 - SOLVED) * largest[:, None]).argmax(axis=1)
        return [
            largest,
            *surface.points[where].T,
            surface.nodal_average(pressure.T).max(axis=0),
            np.asarray(solution.contact_force(name)),
            *([] if bounds is None else bounds.contact_force[name].T),
            (pressure <= 0) @ surface.weights,
            gap.max(axis=1),
        ]

    return metrics, columns


def _of_friction(name: str, surface: ContactSurface) -> Group:
    traction = "largest tangential traction of a contact point"
    at_bound = "area in contact whose traction is at its friction bound"
    distance = "largest distance slipped, tightening included"
    metrics = [
        Metric(f"max_traction.{name}", traction, PRESSURE, "largest"),
        Metric(f"area_at_bound.{name}", at_bound, "length²", "largest"),
        Metric(f"max_slip.{name}", distance, "length", "largest"),
    ]

    def columns(cases: _Cases) -> list[Vector]:
        solution, points = cases.solution, slice(*surface.slice)
        normal, shear = solution.contact_forces, solution.shear_forces
        at_bound = (normal > 0) & ~solution.system.contact.sticking(normal, shear)
        force, far = (
            np.linalg.norm(parts[..., points], axis=-2) for parts in (shear, solution.shear_slip)
        )
        return [
            (force / surface.weights).max(axis=1),
            at_bound[:, points] @ surface.weights,
            far.max(axis=1),
        ]

    return metrics, columns


def _needed_friction(
    solution: Solution, interfaces: Mapping[str, ContactSurface], area: TangentialRows
) -> Vector:
    forces, surface, joint = solution.contact_forces, interfaces[area.interface], solution.system
    carried = area.carried(solution.inputs, joint.contact.at_pairs(forces).T)
    points = np.arange(*surface.slice)
    if area.bolt:
        points = points[surroundings(interfaces, joint.bolts)[area.interface, area.bolt][points]]
    places, normals = (of[points - surface.slice[0]] for of in (surface.points, surface.normals))
    return area_sums(area, places, normals, forces[:, points], carried).needed_friction


def _bolt_areas(
    interfaces: Mapping[str, ContactSurface], bolts: Mapping[str, Bolt]
) -> dict[tuple[str, str], Vector]:
    """Return the weights around each of several bolts; a single one has the whole interface."""
    areas = contact_areas(interfaces, bolts) if len(bolts) > 1 else {}
    return {area: weights for area, weights in areas.items() if area[1]}


def bent_bolts(bolts: Mapping[str, Bolt]) -> list[str]:
    """Return the names of the bolts with known bending."""
    return [name for name, bolt in bolts.items() if bolt.bending is not None]


def weak_share(solution: Solution, bodies: str) -> Matrix:
    """Return the force of the weak springs between two bodies over the total contact force (...).

    The sum of magnitudes; infinite where only the springs carry force.

    Raises
    ------
    ModelError
        If there are no such springs.
    """
    carried = np.asarray(solution.weak_force(bodies))
    pressed = np.asarray(solution.contact_forces.sum(axis=-1))
    share = carried / np.where(pressed > 0, pressed, 1.0)
    return np.where(pressed > 0, share, np.where(carried > 0, np.inf, 0.0))


def weak_warnings(shares: Mapping[str, Mapping[str, float]]) -> list[str]:
    """Return warnings where weak springs alone hold a body; empty if there are none.

    Shares are the largest of a load case between two named bodies.
    """
    # The share is 1e-6 where contact or friction holds a body, and some percent where springs do.
    worst = [
        (share, bodies, case)
        for bodies, of_case in shares.items()
        for share, case in [max((share, case) for case, share in of_case.items())]
        if share > SHOWN_DIGITS
    ]
    if not worst:
        return []
    (share, bodies, case), *others = sorted(worst, reverse=True)
    also = "".join(
        f", those of {other} {less:.2g}" + (f" in {where}" if where != case else "")
        for less, other, where in others
    )
    return [
        f"{case}: the weak springs {bodies} carry {share:.2g} of the contact force{also}; bodies "
        "slide or lift off as wholes there, which neither contact nor friction stops, so that "
        "displacements, and what acts along the interfaces, mean nothing: give the interfaces "
        "their friction, or more clamp force, or support the free body"
    ]
