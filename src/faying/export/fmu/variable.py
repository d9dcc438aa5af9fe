"""A variable of an FMU, and the kinds of variables.

References are 2²⁰ times a kind plus an index, as in ``sources/variables.c``.
"""

from dataclasses import dataclass, replace
from enum import IntEnum

from faying.units import LENGTHS, MASSES, TIMES, Units, units_of

FORCE, MOMENT, LENGTH, ANGLE = "force", "moment", "length", "angle"
VELOCITY, SPIN, PRESSURE, STIFFNESS = "velocity", "spin", "pressure", "stiffness"
ENERGY, TIME, NONE = "energy", "time", ""

DIMENSIONS = {
    FORCE: ((1, 1, -2, 0), "{force}"),
    MOMENT: ((1, 2, -2, 0), "{force}.{length}"),
    ENERGY: ((1, 2, -2, 0), "{force}.{length}"),
    LENGTH: ((0, 1, 0, 0), "{length}"),
    ANGLE: ((0, 0, 0, 1), "rad"),
    VELOCITY: ((0, 1, -1, 0), "{length}/s"),
    SPIN: ((0, 0, -1, 1), "rad/s"),
    PRESSURE: ((1, -1, -2, 0), "{pressure}"),
    STIFFNESS: ((1, -2, -2, 0), "{pressure}/{length}"),
    TIME: ((0, 0, 1, 0), "s"),
}
"""Exponents of kg, m, s and rad, and the unit in terms of a unit set, by quantity."""


@dataclass(frozen=True, kw_only=True)
class Unit:
    """A unit of an FMU.

    Attributes
    ----------
    exponents
        Exponents of kg, m, s, rad.
    factor
        Value of the unit in SI units; None where the unit set is unknown.
    """

    name: str
    exponents: tuple[int, int, int, int]
    factor: float | None


def seconds(label: str) -> float:
    """Return the unit of time of a unit set in seconds; 1 where it is unknown."""
    return TIMES.get(units_of(label).time, 1.0)


def fmu_units(label: str) -> dict[str, Unit]:
    """Return the units of all quantities of an FMU."""
    units = units_of(label)
    names = {"force": units.force, "length": units.length, "pressure": units.pressure}
    return {
        quantity: Unit(
            name=text.format(**names),
            exponents=exponents,
            factor=_factor(units, quantity, exponents),
        )
        for quantity, (exponents, text) in DIMENSIONS.items()
    }


def _factor(units: Units, quantity: str, exponents: tuple[int, int, int, int]) -> float | None:
    if quantity in (ANGLE, SPIN, TIME):
        return 1.0
    mass, length = MASSES.get(units.mass), LENGTHS.get(units.length)
    time = 1.0 if quantity == VELOCITY else TIMES.get(units.time)
    if mass is None or length is None or time is None:
        return None
    kg, m, s, _ = exponents
    return float(mass**kg * length**m * time**s)


INDEX_BITS = 20
"""Bits of a value reference for the index within a kind, as in ``sources/variables.c``."""
WHOLE_ARRAY = 2**INDEX_BITS - 1
"""Index of a whole array."""


class Kind(IntEnum):
    """Kinds of variables, as in ``sources/variables.c``."""

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


@dataclass(frozen=True)
class Variable:
    """A variable of a model description, or the template of a kind.

    Attributes
    ----------
    type
        ``"real"``, ``"integer"`` or ``"boolean"``.
    causality
        ``"parameter"``, ``"input"``, ``"output"`` or ``"local"``.
    quantity
        Quantity of :mod:`faying.export.fmu.variable`; empty for a number.
    start
        Start value; None where the FMU computes it.
    size
        Number of elements of an array; None for a scalar.
    limits
        Least and largest value of a parameter.
    """

    kind: Kind
    name: str
    causality: str
    description: str
    quantity: str = NONE
    index: int = 0
    type: str = "real"
    start: float | None = None
    size: int | None = None
    limits: tuple[float | None, float | None] = (None, None)

    def of(
        self, part: str, index: int, start: float | None = None, size: int | None = None
    ) -> "Variable":
        """Return the variable of a part of the joint, whose name replaces the braces in texts."""
        name, description = self.name.format(part), self.description.format(part)
        return replace(
            self, name=name, description=description, index=index, start=start, size=size
        )

    @property
    def reference(self) -> int:
        """The value reference."""
        return (int(self.kind) << INDEX_BITS) + self.index

    @property
    def variability(self) -> str:
        """The variability that FMI prescribes for the causality."""
        return "fixed" if self.causality == "parameter" else "continuous"
