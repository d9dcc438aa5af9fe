"""The variables of an FMU: names, value references and what they mean.

References are 2²⁰ times a kind plus an index, as ``sources/variables.c`` reads them.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from faying.contact.laws import Coulomb, Law
from faying.contact.laws.coulomb import LARGEST_FRICTION
from faying.exceptions import ModelError
from faying.export.fmu import quantities
from faying.model.boundary import DISPLACEMENT_NAMES, FORCE_NAMES, Boundary
from faying.reduction.reduced_model import ReducedModel

INDEX_BITS = 20
WHOLE = 2**INDEX_BITS - 1
"""Index that means all of an array."""

VELOCITY_NAMES = ("vx", "vy", "vz", "wx", "wy", "wz")


class Kind(IntEnum):
    """As in ``sources/variables.c``."""

    TIME = 0
    STEP_SIZE = 1
    RHO = 2
    PENALTY = 3
    FRICTION = 4
    TANGENTIAL_PENALTY = 5
    INTEGRATOR = 6
    START_LOADED = 7
    FORCE = 8
    INITIAL_FORCE = 9
    FACTOR = 10
    DISPLACEMENT = 11
    VELOCITY = 12
    BOLT_FORCE = 13
    CONTACT_FORCE = 14
    MAX_PRESSURE = 15
    OPEN_FRACTION = 16
    MAX_TRACTION = 17
    STICK_FRACTION = 18
    SLIP_FRACTION = 19
    DISSIPATED_ENERGY = 20
    Q = 21
    Q_VELOCITY = 22
    Q_ACCELERATION = 23
    PRESSURE = 24
    TRACTION = 25


@dataclass(frozen=True, kw_only=True)
class Variable:
    """One variable of a model description.

    Attributes
    ----------
    type
        ``"real"``, ``"integer"`` or ``"boolean"``.
    causality
        ``"parameter"``, ``"input"``, ``"output"`` or ``"local"``.
    quantity
        Of :mod:`faying.export.fmu.quantities`; empty for a number.
    start
        None where the FMU computes it.
    size
        Elements of an array; None for a scalar.
    limits
        Least and largest value of a parameter.
    """

    name: str
    kind: Kind
    index: int
    causality: str
    description: str
    type: str = "real"
    quantity: str = quantities.NONE
    start: float | None = None
    size: int | None = None
    limits: tuple[float | None, float | None] = (None, None)

    @property
    def reference(self) -> int:
        """Value reference."""
        return (int(self.kind) << INDEX_BITS) + self.index

    @property
    def variability(self) -> str:
        """What FMI demands of its causality."""
        return "fixed" if self.causality == "parameter" else "continuous"


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
    found = (
        *_parameters(rom, defaults),
        *_ports(rom),
        *_of_interfaces(rom),
        *_motion(rom, arrays=False),
    )
    return _distinct(found)


def with_arrays(rom: ReducedModel, defaults: Defaults) -> tuple[Variable, ...]:
    """Return all variables, pressures, tractions and motion as arrays.

    Raises
    ------
    ModelError
        If two of them have the same name.
    """
    found = (
        *_parameters(rom, defaults),
        *_ports(rom),
        *_of_interfaces(rom),
        *_at_points(rom),
        *_motion(rom, arrays=True),
    )
    return _distinct(found)


def _distinct(found: Sequence[Variable]) -> tuple[Variable, ...]:
    names = set()
    for variable in found:
        if variable.name in names:
            message = (
                f"two variables of the FMU are both called '{variable.name}'; give boundaries, "
                "bolts, loads and interfaces different names"
            )
            raise ModelError(message)
        names.add(variable.name)
    return tuple(found)


def _parameters(rom: ReducedModel, defaults: Defaults) -> Iterator[Variable]:
    yield Variable(
        name="step_size",
        kind=Kind.STEP_SIZE,
        index=0,
        causality="parameter",
        quantity=quantities.TIME,
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
                quantity=quantities.STIFFNESS,
                start=value,
                limits=(0.0, None),
                description=f"{meaning} stiffness of interface {name}",
            )


def _ports(rom: ReducedModel) -> Iterator[Variable]:
    turning = (False, False, False, True, True, True)
    families = (
        (Kind.FORCE, FORCE_NAMES, "input", quantities.FORCE, quantities.MOMENT, "force on"),
        (
            Kind.DISPLACEMENT,
            DISPLACEMENT_NAMES,
            "output",
            quantities.LENGTH,
            quantities.ANGLE,
            "displacement, from the unloaded joint, of",
        ),
        (
            Kind.VELOCITY,
            VELOCITY_NAMES,
            "output",
            quantities.VELOCITY,
            quantities.SPIN,
            "velocity of",
        ),
    )
    for kind, names, causality, straight, turned, text in families:
        for index, (place, component) in enumerate(_places(rom.boundaries.values())):
            unit = turned if turning[component] else straight
            yield Variable(
                name=f"{place}.{names[component]}",
                kind=kind,
                index=index,
                causality=causality,
                quantity=unit,
                start=0.0 if causality == "input" else None,
                description=f"{'moment on' if unit is quantities.MOMENT else text} {place}",
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
            quantity=quantities.FORCE,
            description=f"axial force of bolt '{name}', tension positive",
        )


def _initial_forces(rom: ReducedModel) -> Iterator[Variable]:
    for index, (name, bolt) in enumerate(rom.bolts.items()):
        yield Variable(
            name=f"{name}.initial_force",
            kind=Kind.INITIAL_FORCE,
            index=index,
            causality="input",
            quantity=quantities.FORCE,
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
        several = len(np.unique(boundary.nodes)) > 1
        for node, component in zip(
            boundary.nodes.tolist(), boundary.components.tolist(), strict=True
        ):
            yield (f"{boundary.name}.{node}" if several else boundary.name), component


def _of_interfaces(rom: ReducedModel) -> Iterator[Variable]:
    smooth = (
        (Kind.CONTACT_FORCE, "contact_force", quantities.FORCE, "normal force through"),
        (Kind.MAX_PRESSURE, "max_pressure", quantities.PRESSURE, "largest contact pressure in"),
        (
            Kind.OPEN_FRACTION,
            "open_fraction",
            quantities.NONE,
            "part of the area without pressure of",
        ),
    )
    frictional = (
        (
            Kind.MAX_TRACTION,
            "max_traction",
            quantities.PRESSURE,
            "largest tangential traction in",
        ),
        (Kind.STICK_FRACTION, "stick_fraction", quantities.NONE, "part of the area that sticks of"),
        (
            Kind.SLIP_FRACTION,
            "slip_fraction",
            quantities.NONE,
            "part of the area that slipped in the last internal step of",
        ),
        (
            Kind.DISSIPATED_ENERGY,
            "dissipated_energy",
            quantities.ENERGY,
            "energy that friction took since initialization in",
        ),
    )
    for kind, label, quantity, text in (*smooth, *frictional):
        for index, name in enumerate(rom.contact.slices):
            if kind >= Kind.MAX_TRACTION and not _rubs(rom, name):
                continue
            yield Variable(
                name=f"{name}.{label}",
                kind=kind,
                index=index,
                causality="output",
                quantity=quantity,
                description=f"{text} interface {name}",
            )


def _rubs(rom: ReducedModel, interface: str) -> bool:
    return rom.contact.laws[interface].components > 1


def _at_points(rom: ReducedModel) -> Iterator[Variable]:
    families = (
        (Kind.PRESSURE, "pressure", "contact pressure"),
        (Kind.TRACTION, "traction", "length of the tangential traction"),
    )
    for kind, label, text in families:
        for index, (name, points) in enumerate(rom.contact.slices.items()):
            count = points.stop - points.start
            if count and (kind == Kind.PRESSURE or _rubs(rom, name)):
                yield Variable(
                    name=f"{name}.{label}",
                    kind=kind,
                    index=index,
                    causality="output",
                    quantity=quantities.PRESSURE,
                    size=count,
                    description=f"{text} at the points of interface {name}",
                )


def _motion(rom: ReducedModel, *, arrays: bool) -> Iterator[Variable]:
    count = len(rom.K)
    families = (
        (Kind.Q, "q", "generalized coordinates"),
        (Kind.Q_VELOCITY, "v", "their velocities, per second"),
        (Kind.Q_ACCELERATION, "a", "their accelerations, per second squared"),
    )
    for kind, label, text in families:
        for index in [WHOLE] if arrays else range(count):
            yield Variable(
                name=f"modal.{label}" if arrays else f"modal.{label}[{index + 1}]",
                kind=kind,
                index=index,
                causality="local",
                size=count if arrays else None,
                description=f"{text}; for pressure recovery",
            )
