"""The variables of an FMU: names, value references and what they mean."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, product

import numpy as np

from faying.contact.laws import Law
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
from faying.model.boundary import DISPLACEMENT_NAMES, FORCE_NAMES
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
    return _distinct([*_ports(rom, defaults), *_motion(rom, arrays=False)])


def with_arrays(rom: ReducedModel, defaults: Defaults) -> tuple[Variable, ...]:
    """Return all variables, pressures, tractions and motion as arrays.

    Raises
    ------
    ModelError
        If two of them have the same name.
    """
    return _distinct([*_ports(rom, defaults), *_fields(rom), *_motion(rom, arrays=True)])


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


@dataclass(frozen=True)
class _Family:
    """What all variables of a kind have in common; braces stand for the part of the joint."""

    name: str
    causality: str
    description: str
    quantity: str = NONE
    limits: tuple[float | None, float | None] = (None, None)
    type: str = "real"

    def variable(
        self,
        kind: Kind,
        index: int,
        part: str = "",
        start: float | None = None,
        size: int | None = None,
    ) -> Variable:
        """Return one of them."""
        return Variable(
            name=self.name.format(part),
            kind=kind,
            index=index,
            causality=self.causality,
            description=self.description.format(part),
            type=self.type,
            quantity=self.quantity,
            start=start,
            size=size,
            limits=self.limits,
        )


POSITIVE = (0.0, None)

FAMILIES = {
    Kind.STEP_SIZE: _Family(
        "step_size",
        "parameter",
        "longest internal time step; communication steps are divided equally",
        TIME,
        POSITIVE,
    ),
    Kind.INTEGRATOR: _Family(
        "integrator",
        "parameter",
        "0 implicit Euler, 1 generalized-alpha, 2 energy-decaying",
        limits=(0, 2),
        type="integer",
    ),
    Kind.RHO: _Family(
        "rho_infinity",
        "parameter",
        "spectral radius at infinite frequency of schemes of second order",
        limits=(0.0, 1.0),
    ),
    Kind.START_LOADED: _Family(
        "start_loaded",
        "parameter",
        "start in equilibrium with the boundary forces at initialization (true), or under the "
        "bolts alone, with those forces applied at once (false)",
        type="boolean",
    ),
    Kind.PENALTY: _Family(
        "{}.penalty", "parameter", "contact stiffness of interface {}", STIFFNESS, POSITIVE
    ),
    Kind.FRICTION: _Family(
        "{}.friction",
        "parameter",
        "coefficient of friction of interface {}",
        limits=(0.0, LARGEST_FRICTION),
    ),
    Kind.TANGENTIAL_PENALTY: _Family(
        "{}.tangential_penalty",
        "parameter",
        "tangential stiffness of interface {}",
        STIFFNESS,
        POSITIVE,
    ),
    Kind.INITIAL_FORCE: _Family(
        "{}.initial_force",
        "input",
        "force that bolt '{}' would have at zero elongation; what tightening set, not the force it "
        "ends with",
        FORCE,
    ),
    Kind.FACTOR: _Family("{}.factor", "input", "what load {} of the deck is multiplied by"),
    Kind.BOLT_FORCE: _Family(
        "{}.force", "output", "axial force of bolt '{}', tension positive", FORCE
    ),
    Kind.CONTACT_FORCE: _Family(
        "{}.contact_force", "output", "normal force through interface {}", FORCE
    ),
    Kind.MAX_PRESSURE: _Family(
        "{}.max_pressure", "output", "largest contact pressure in interface {}", PRESSURE
    ),
    Kind.OPEN_FRACTION: _Family(
        "{}.open_fraction", "output", "part of the area without pressure of interface {}"
    ),
    Kind.MAX_TRACTION: _Family(
        "{}.max_traction", "output", "largest tangential traction in interface {}", PRESSURE
    ),
    Kind.STICK_FRACTION: _Family(
        "{}.stick_fraction", "output", "part of the area that sticks of interface {}"
    ),
    Kind.SLIP_FRACTION: _Family(
        "{}.slip_fraction",
        "output",
        "part of the area that slipped in the last internal step of interface {}",
    ),
    Kind.DISSIPATED_ENERGY: _Family(
        "{}.dissipated_energy",
        "output",
        "energy that friction took since initialization in interface {}",
        ENERGY,
    ),
    Kind.PRESSURE: _Family(
        "{}.pressure", "output", "contact pressure at the points of interface {}", PRESSURE
    ),
    Kind.TRACTION: _Family(
        "{}.traction",
        "output",
        "length of the tangential traction at the points of interface {}",
        PRESSURE,
    ),
    Kind.Q: _Family("modal.q{}", "local", "generalized coordinates; for pressure recovery"),
    Kind.Q_VELOCITY: _Family(
        "modal.v{}", "local", "their velocities, per second; for pressure recovery"
    ),
    Kind.Q_ACCELERATION: _Family(
        "modal.a{}", "local", "their accelerations, per second squared; for pressure recovery"
    ),
}
"""What there is besides forces and motion at boundaries."""

SMOOTH = (Kind.CONTACT_FORCE, Kind.MAX_PRESSURE, Kind.OPEN_FRACTION)
RUBBED = (Kind.MAX_TRACTION, Kind.STICK_FRACTION, Kind.SLIP_FRACTION, Kind.DISSIPATED_ENERGY)
"""Outputs of every interface, and of those with friction."""


def _ports(rom: ReducedModel, defaults: Defaults) -> Iterator[Variable]:
    """Yield parameters, forces, motion of the boundaries, and what interfaces answer."""
    starts = {
        Kind.STEP_SIZE: defaults.step_size,
        Kind.INTEGRATOR: defaults.integrator,
        Kind.RHO: defaults.rho_infinity,
        Kind.START_LOADED: float(defaults.start_loaded),
    }
    for kind, start in starts.items():
        yield FAMILIES[kind].variable(kind, 0, start=start)
    numbers = {name: index for index, name in enumerate(rom.contact.slices)}
    for name, index in numbers.items():
        for kind, value in _of_law(rom.contact.laws[name]):
            yield FAMILIES[kind].variable(kind, index, name, value)
    yield from _at_boundaries(
        rom, Kind.FORCE, "input", FORCE_NAMES, (FORCE, "force on"), (MOMENT, "moment on")
    )
    for index, (name, bolt) in enumerate(rom.bolts.items()):
        kind = Kind.INITIAL_FORCE
        yield FAMILIES[kind].variable(kind, index, name, float(bolt.initial_force))
    for index, name in enumerate(rom.load_patterns):
        yield FAMILIES[Kind.FACTOR].variable(Kind.FACTOR, index, name, 0.0)
    moved, rate = "displacement, from the unloaded joint, of", "velocity of"
    yield from _at_boundaries(
        rom, Kind.DISPLACEMENT, "output", DISPLACEMENT_NAMES, (LENGTH, moved), (ANGLE, moved)
    )
    yield from _at_boundaries(
        rom, Kind.VELOCITY, "output", VELOCITY_NAMES, (VELOCITY, rate), (SPIN, rate)
    )
    for index, name in enumerate(rom.bolts):
        yield FAMILIES[Kind.BOLT_FORCE].variable(Kind.BOLT_FORCE, index, name)
    for kinds, names in ((SMOOTH, numbers), (RUBBED, rom.contact.rubbing_interfaces)):
        for kind, name in product(kinds, names):
            yield FAMILIES[kind].variable(kind, numbers[name], name)


def _of_law(law: Law) -> Iterator[tuple[Kind, float]]:
    """Yield coefficients and stiffnesses, as far as they are finite and not zero."""
    values = {
        Kind.FRICTION: law.friction,
        Kind.PENALTY: law.penalty,
        Kind.TANGENTIAL_PENALTY: law.tangential_penalty,
    }
    yield from ((kind, value) for kind, value in values.items() if 0 < value < np.inf)


def _at_boundaries(
    rom: ReducedModel,
    kind: Kind,
    causality: str,
    names: Sequence[str],
    straight: tuple[str, str],
    turned: tuple[str, str],
) -> Iterator[Variable]:
    """Yield forces or motion of each boundary degree of freedom, in a quantity and with a text."""
    places = chain.from_iterable(boundary.places for boundary in rom.boundaries.values())
    for index, (port, component) in enumerate(places):
        quantity, text = straight if component < 3 else turned
        yield Variable(
            name=f"{port}.{names[component]}",
            kind=kind,
            index=index,
            causality=causality,
            quantity=quantity,
            start=0.0 if causality == "input" else None,
            description=f"{text} {port}",
        )


def _motion(rom: ReducedModel, *, arrays: bool) -> Iterator[Variable]:
    count = len(rom.K)
    for kind in (Kind.Q, Kind.Q_VELOCITY, Kind.Q_ACCELERATION):
        if arrays:
            yield FAMILIES[kind].variable(kind, WHOLE_ARRAY, size=count)
            continue
        for index in range(count):
            yield FAMILIES[kind].variable(kind, index, f"[{index + 1}]")


def _fields(rom: ReducedModel) -> Iterator[Variable]:
    """Yield pressures, and tractions where there is friction, as arrays over contact points."""
    slices = rom.contact.slices
    for kind, names in ((Kind.PRESSURE, slices), (Kind.TRACTION, rom.contact.rubbing_interfaces)):
        for index, (name, points) in enumerate(slices.items()):
            count = points.stop - points.start
            if count and name in names:
                yield FAMILIES[kind].variable(kind, index, name, size=count)
