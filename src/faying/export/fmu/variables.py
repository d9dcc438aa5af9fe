"""The variables of an FMU: names, value references and descriptions."""

from collections.abc import Iterator, Sequence
from itertools import chain, product

import numpy as np

from faying.contact.laws import Law
from faying.contact.laws.coulomb import LARGEST_FRICTION
from faying.exceptions import refuse_model
from faying.export.fmu.variable import (
    ANGLE,
    ENERGY,
    FORCE,
    LENGTH,
    MOMENT,
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


def variables(rom: ReducedModel, step_size: float, *, arrays: bool) -> tuple[Variable, ...]:
    """Return all variables of an FMU with a default time step [s].

    With ``arrays``, which FMI 2.0 lacks, they include pressures, tractions and motion.

    Raises
    ------
    ModelError
        If two variables have the same name.
    """
    fields = _fields(rom) if arrays else ()
    all_variables = (*_ports(rom, step_size), *fields, *_motion(rom, arrays=arrays))
    names = set()
    for variable in all_variables:
        if variable.name in names:
            refuse_model(
                f"two variables of the FMU are called '{variable.name}'; give boundaries, "
                "bolts, loads and interfaces different names"
            )
        names.add(variable.name)
    return all_variables


POSITIVE = (0.0, None)

_COMMON = (
    Variable(
        Kind.STEP_SIZE,
        "step_size",
        "parameter",
        "longest internal time step; communication steps are divided equally",
        TIME,
        limits=POSITIVE,
    ),
    Variable(
        Kind.INTEGRATOR,
        "integrator",
        "parameter",
        "0 implicit Euler, 1 generalized-alpha, 2 energy-decaying",
        limits=(0, 2),
        type="integer",
        start=0,
    ),
    Variable(
        Kind.RHO,
        "rho_infinity",
        "parameter",
        "spectral radius at infinite frequency of schemes of second order",
        limits=(0.0, 1.0),
        start=0.8,
    ),
    Variable(
        Kind.START_LOADED,
        "start_loaded",
        "parameter",
        "start in equilibrium with the boundary forces at initialization (true), or under the "
        "bolts alone, with these forces applied suddenly (false)",
        type="boolean",
        start=True,
    ),
    Variable(
        Kind.PENALTY,
        "{}.penalty",
        "parameter",
        "contact stiffness of interface {}",
        STIFFNESS,
        limits=POSITIVE,
    ),
    Variable(
        Kind.FRICTION,
        "{}.friction",
        "parameter",
        "coefficient of friction of interface {}",
        limits=(0.0, LARGEST_FRICTION),
    ),
    Variable(
        Kind.TANGENTIAL_PENALTY,
        "{}.tangential_penalty",
        "parameter",
        "tangential stiffness of interface {}",
        STIFFNESS,
        limits=POSITIVE,
    ),
    Variable(
        Kind.INITIAL_FORCE,
        "{}.initial_force",
        "input",
        "force of bolt '{}' at zero elongation, as set by tightening; not its final force",
        FORCE,
    ),
    Variable(Kind.FACTOR, "{}.factor", "input", "factor on load {} of the deck"),
    Variable(
        Kind.BOLT_FORCE, "{}.force", "output", "axial force of bolt '{}', tension positive", FORCE
    ),
    Variable(
        Kind.CONTACT_FORCE, "{}.contact_force", "output", "normal force through interface {}", FORCE
    ),
    Variable(
        Kind.MAX_PRESSURE,
        "{}.max_pressure",
        "output",
        "largest contact pressure in interface {}",
        PRESSURE,
    ),
    Variable(
        Kind.OPEN_FRACTION,
        "{}.open_fraction",
        "output",
        "share of the area of interface {} without pressure",
    ),
    Variable(
        Kind.MAX_TRACTION,
        "{}.max_traction",
        "output",
        "largest tangential traction in interface {}",
        PRESSURE,
    ),
    Variable(
        Kind.STICK_FRACTION,
        "{}.stick_fraction",
        "output",
        "share of the area of interface {} that sticks",
    ),
    Variable(
        Kind.SLIP_FRACTION,
        "{}.slip_fraction",
        "output",
        "share of the area of interface {} that slipped in the last internal step",
    ),
    Variable(
        Kind.DISSIPATED_ENERGY,
        "{}.dissipated_energy",
        "output",
        "energy dissipated by friction in interface {} since initialization",
        ENERGY,
    ),
    Variable(
        Kind.PRESSURE,
        "{}.pressure",
        "output",
        "contact pressure at the points of interface {}",
        PRESSURE,
    ),
    Variable(
        Kind.TRACTION,
        "{}.traction",
        "output",
        "magnitude of the tangential traction at the points of interface {}",
        PRESSURE,
    ),
    Variable(Kind.Q, "modal.q{}", "local", "generalized coordinates; for pressure recovery"),
    Variable(
        Kind.Q_VELOCITY, "modal.v{}", "local", "velocities of q, per second; for pressure recovery"
    ),
    Variable(
        Kind.Q_ACCELERATION,
        "modal.a{}",
        "local",
        "accelerations of q, per second squared; for pressure recovery",
    ),
)
"""Templates of all variables but forces and motion at boundaries."""

FAMILIES = {variable.kind: variable for variable in _COMMON}

SMOOTH = (Kind.CONTACT_FORCE, Kind.MAX_PRESSURE, Kind.OPEN_FRACTION)
RUBBED = (Kind.MAX_TRACTION, Kind.STICK_FRACTION, Kind.SLIP_FRACTION, Kind.DISSIPATED_ENERGY)
"""Outputs of every interface, and of those with friction."""


def _ports(rom: ReducedModel, step_size: float) -> Iterator[Variable]:
    """Yield parameters, forces, motion of the boundaries, and outputs of bolts and interfaces."""
    yield FAMILIES[Kind.STEP_SIZE].of("", 0, step_size)
    yield from (FAMILIES[kind] for kind in (Kind.INTEGRATOR, Kind.RHO, Kind.START_LOADED))
    numbers = {name: index for index, name in enumerate(rom.contact.slices)}
    for name, index in numbers.items():
        for kind, value in _of_law(rom.contact.laws[name]):
            yield FAMILIES[kind].of(name, index, value)
    yield from _at_boundaries(
        rom, Kind.FORCE, "input", FORCE_NAMES, (FORCE, "force on"), (MOMENT, "moment on")
    )
    for index, (name, bolt) in enumerate(rom.bolts.items()):
        yield FAMILIES[Kind.INITIAL_FORCE].of(name, index, float(bolt.initial_force))
    for index, name in enumerate(rom.load_patterns):
        yield FAMILIES[Kind.FACTOR].of(name, index, 0.0)
    moved, rate = "displacement, from the unloaded joint, of", "velocity of"
    yield from _at_boundaries(
        rom, Kind.DISPLACEMENT, "output", DISPLACEMENT_NAMES, (LENGTH, moved), (ANGLE, moved)
    )
    yield from _at_boundaries(
        rom, Kind.VELOCITY, "output", VELOCITY_NAMES, (VELOCITY, rate), (SPIN, rate)
    )
    for index, name in enumerate(rom.bolts):
        yield FAMILIES[Kind.BOLT_FORCE].of(name, index)
    for kinds, names in ((SMOOTH, numbers), (RUBBED, rom.contact.rubbing_interfaces)):
        for kind, name in product(kinds, names):
            yield FAMILIES[kind].of(name, numbers[name])


def _of_law(law: Law) -> Iterator[tuple[Kind, float]]:
    """Yield the finite, positive coefficients and stiffnesses of a contact law."""
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
    """Yield the variables of forces or motion of all boundary degrees of freedom."""
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
            yield FAMILIES[kind].of("", WHOLE_ARRAY, size=count)
            continue
        for index in range(count):
            yield FAMILIES[kind].of(f"[{index + 1}]", index)


def _fields(rom: ReducedModel) -> Iterator[Variable]:
    """Yield pressures, and tractions where there is friction, as arrays over contact points."""
    slices = rom.contact.slices
    for kind, names in ((Kind.PRESSURE, slices), (Kind.TRACTION, rom.contact.rubbing_interfaces)):
        for index, (name, points) in enumerate(slices.items()):
            count = points.stop - points.start
            if count and name in names:
                yield FAMILIES[kind].of(name, index, size=count)
