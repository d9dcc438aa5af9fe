"""The variables of an FMU: names, value references and what they mean."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from faying.contact.laws import Coulomb, Law
from faying.contact.laws.coulomb import LARGEST_FRICTION
from faying.exceptions import ModelError
from faying.export.fmu.variable import (
    ANGLE,
    ENERGY,
    FORCE,
    LENGTH,
    MOMENT,
    NONE,
    PRESSURE,
    SPIN,
    STIFFNESS,
    TIME,
    VELOCITY,
    WHOLE_ARRAY,
    Kind,
    Variable,
)
from faying.model.boundary import DISPLACEMENT_NAMES, FORCE_NAMES, Boundary
from faying.reduction.reduced_model import ReducedModel

VELOCITY_NAMES = ("vx", "vy", "vz", "wx", "wy", "wz")


@dataclass(frozen=True, kw_only=True)
class Defaults:
    """Start values of the parameters that are not the joint's.

    Attributes
    ----------
    step_size : [s]
    """

    step_size: float
    rho_infinity: float = 0.8
    integrator: int = 0
    start_loaded: bool = True


def scalars(rom: ReducedModel, defaults: Defaults) -> tuple[Variable, ...]:
    """Return all variables without arrays, which FMI 2.0 does not have.

    Raises
    ------
    ModelError
        If two of them have the same name.
    """
    variables = (
        *_parameters(rom, defaults),
        *_ports(rom),
        *interface_outputs(rom),
        *_motion(rom, arrays=False),
    )
    return _distinct(variables)


def with_arrays(rom: ReducedModel, defaults: Defaults) -> tuple[Variable, ...]:
    """Return all variables, pressures, tractions and motion as arrays.

    Raises
    ------
    ModelError
        If two of them have the same name.
    """
    variables = (
        *_parameters(rom, defaults),
        *_ports(rom),
        *interface_outputs(rom),
        *fields(rom),
        *_motion(rom, arrays=True),
    )
    return _distinct(variables)


def _distinct(variables: Sequence[Variable]) -> tuple[Variable, ...]:
    names = set()
    for variable in variables:
        if variable.name in names:
            message = (
                f"two variables of the FMU are both called '{variable.name}'; give boundaries, "
                "bolts, loads and interfaces different names"
            )
            raise ModelError(message)
        names.add(variable.name)
    return tuple(variables)


def _parameters(rom: ReducedModel, defaults: Defaults) -> Iterator[Variable]:
    yield Variable(
        name="step_size",
        kind=Kind.STEP_SIZE,
        index=0,
        causality="parameter",
        quantity=TIME,
        start=defaults.step_size,
        limits=(0.0, None),
        description="longest internal time step; communication steps are divided equally",
    )
    yield Variable(
        name="integrator",
        kind=Kind.INTEGRATOR,
        index=0,
        causality="parameter",
        type="integer",
        start=defaults.integrator,
        limits=(0, 2),
        description="0 implicit Euler, 1 generalized-alpha, 2 energy-decaying",
    )
    yield Variable(
        name="rho_infinity",
        kind=Kind.RHO,
        index=0,
        causality="parameter",
        start=defaults.rho_infinity,
        limits=(0.0, 1.0),
        description="spectral radius at infinite frequency of schemes of second order",
    )
    yield Variable(
        name="start_loaded",
        kind=Kind.START_LOADED,
        index=0,
        causality="parameter",
        type="boolean",
        start=float(defaults.start_loaded),
        description="start in equilibrium with the boundary forces at initialization (true), or "
        "under the bolts alone, with those forces applied at once (false)",
    )
    yield from law_parameters(rom)


def _ports(rom: ReducedModel) -> Iterator[Variable]:
    turning = (False, False, False, True, True, True)
    families = (
        (Kind.FORCE, FORCE_NAMES, "input", FORCE, MOMENT, "force on"),
        (
            Kind.DISPLACEMENT,
            DISPLACEMENT_NAMES,
            "output",
            LENGTH,
            ANGLE,
            "displacement, from the unloaded joint, of",
        ),
        (
            Kind.VELOCITY,
            VELOCITY_NAMES,
            "output",
            VELOCITY,
            SPIN,
            "velocity of",
        ),
    )
    for kind, names, causality, straight, turned, text in families:
        for index, (port, component) in enumerate(_places(rom.boundaries.values())):
            unit = turned if turning[component] else straight
            yield Variable(
                name=f"{port}.{names[component]}",
                kind=kind,
                index=index,
                causality=causality,
                quantity=unit,
                start=0.0 if causality == "input" else None,
                description=f"{'moment on' if unit is MOMENT else text} {port}",
            )
        if kind == Kind.FORCE:
            yield from _initial_forces(rom)
            yield from _factors(rom)
    for index, name in enumerate(rom.bolts):
        yield Variable(
            name=f"{name}.force",
            kind=Kind.BOLT_FORCE,
            index=index,
            causality="output",
            quantity=FORCE,
            description=f"axial force of bolt '{name}', tension positive",
        )


def _initial_forces(rom: ReducedModel) -> Iterator[Variable]:
    for index, (name, bolt) in enumerate(rom.bolts.items()):
        yield Variable(
            name=f"{name}.initial_force",
            kind=Kind.INITIAL_FORCE,
            index=index,
            causality="input",
            quantity=FORCE,
            start=float(bolt.initial_force),
            description=f"force that bolt '{name}' would have at zero elongation; what tightening "
            "set, not the force it ends with",
        )


def _factors(rom: ReducedModel) -> Iterator[Variable]:
    for index, name in enumerate(rom.load_patterns):
        yield Variable(
            name=f"{name}.factor",
            kind=Kind.FACTOR,
            index=index,
            causality="input",
            start=0.0,
            description=f"what load {name} of the deck is multiplied by",
        )


def _places(boundaries: Iterable[Boundary]) -> Iterator[tuple[str, int]]:
    """Name each boundary degree of freedom; by node where a boundary has several."""
    for boundary in boundaries:
        many_nodes = len(np.unique(boundary.nodes)) > 1
        for node, component in zip(
            boundary.nodes.tolist(), boundary.components.tolist(), strict=True
        ):
            yield (f"{boundary.name}.{node}" if many_nodes else boundary.name), component


def _motion(rom: ReducedModel, *, arrays: bool) -> Iterator[Variable]:
    count = len(rom.K)
    families = (
        (Kind.Q, "q", "generalized coordinates"),
        (Kind.Q_VELOCITY, "v", "their velocities, per second"),
        (Kind.Q_ACCELERATION, "a", "their accelerations, per second squared"),
    )
    for kind, label, text in families:
        for index in [WHOLE_ARRAY] if arrays else range(count):
            yield Variable(
                name=f"modal.{label}" if arrays else f"modal.{label}[{index + 1}]",
                kind=kind,
                index=index,
                causality="local",
                size=count if arrays else None,
                description=f"{text}; for pressure recovery",
            )


def law_parameters(rom: ReducedModel) -> Iterator[Variable]:
    """Yield coefficients and stiffnesses, as far as they are finite."""
    for index, name in enumerate(rom.contact.slices):
        yield from _of_law(name, index, rom.contact.laws[name])


def _of_law(name: str, index: int, law: Law) -> Iterator[Variable]:
    stiffnesses = [(Kind.PENALTY, "penalty", "contact", law.penalty)]
    if isinstance(law, Coulomb):
        yield Variable(
            name=f"{name}.friction",
            kind=Kind.FRICTION,
            index=index,
            causality="parameter",
            start=law.friction,
            limits=(0.0, LARGEST_FRICTION),
            description=f"coefficient of friction of interface {name}",
        )
        sticking = (Kind.TANGENTIAL_PENALTY, "tangential_penalty", "tangential")
        stiffnesses.append((*sticking, law.tangential_penalty))
    for kind, label, meaning, value in stiffnesses:
        if np.isfinite(value):
            yield Variable(
                name=f"{name}.{label}",
                kind=kind,
                index=index,
                causality="parameter",
                quantity=STIFFNESS,
                start=value,
                limits=(0.0, None),
                description=f"{meaning} stiffness of interface {name}",
            )


def interface_outputs(rom: ReducedModel) -> Iterator[Variable]:
    """Yield forces, largest stresses and shares of area; of friction where there is some."""
    smooth = (
        (Kind.CONTACT_FORCE, "contact_force", FORCE, "normal force through"),
        (Kind.MAX_PRESSURE, "max_pressure", PRESSURE, "largest contact pressure in"),
        (
            Kind.OPEN_FRACTION,
            "open_fraction",
            NONE,
            "part of the area without pressure of",
        ),
    )
    frictional = (
        (
            Kind.MAX_TRACTION,
            "max_traction",
            PRESSURE,
            "largest tangential traction in",
        ),
        (Kind.STICK_FRACTION, "stick_fraction", NONE, "part of the area that sticks of"),
        (
            Kind.SLIP_FRACTION,
            "slip_fraction",
            NONE,
            "part of the area that slipped in the last internal step of",
        ),
        (
            Kind.DISSIPATED_ENERGY,
            "dissipated_energy",
            ENERGY,
            "energy that friction took since initialization in",
        ),
    )
    numbers = {name: index for index, name in enumerate(rom.contact.slices)}
    groups = ((smooth, numbers), (frictional, rom.contact.rubbing_interfaces))
    for outputs, names in groups:
        for (kind, label, quantity, text), name in product(outputs, names):
            yield Variable(
                name=f"{name}.{label}",
                kind=kind,
                index=numbers[name],
                causality="output",
                quantity=quantity,
                description=f"{text} interface {name}",
            )


def fields(rom: ReducedModel) -> Iterator[Variable]:
    """Yield pressures, and tractions where there is friction, as arrays over contact points."""
    slices, rubbing = rom.contact.slices, rom.contact.rubbing_interfaces
    families = (
        (Kind.PRESSURE, "pressure", "contact pressure", list(slices)),
        (Kind.TRACTION, "traction", "length of the tangential traction", rubbing),
    )
    for kind, label, text, names in families:
        for index, (name, points) in enumerate(slices.items()):
            count = points.stop - points.start
            if count and name in names:
                yield Variable(
                    name=f"{name}.{label}",
                    kind=kind,
                    index=index,
                    causality="output",
                    quantity=PRESSURE,
                    size=count,
                    description=f"{text} at the points of interface {name}",
                )
