"""One variable of an FMU, and the kinds that there are.

References are 2²⁰ times a kind plus an index, as ``sources/variables.c`` reads them.
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
"""Quantities to exponents of kg, m, s and rad, and to their unit in those of a unit set."""


@dataclass(frozen=True, kw_only=True)
class Unit:
    """A unit by name.

    Attributes
    ----------
    exponents
        Of kg, m, s, rad.
    factor
        SI units in one of it; None where the unit set is not a known one.
    """

    name: str
    exponents: tuple[int, int, int, int]
    factor: float | None


def seconds(label: str) -> float:
    """Return the seconds in one unit of time of a unit set; 1 where the set is not known."""
    return TIMES.get(units_of(label).time, 1.0)


def fmu_units(label: str) -> dict[str, Unit]:
    """Return the unit of every quantity that an FMU has variables of."""
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
"""Of a value reference that number a variable of its kind, as in ``sources/variables.c``."""
WHOLE_ARRAY = 2**INDEX_BITS - 1
"""Index that means all of an array."""


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


@dataclass(frozen=True)
class Variable:
    """One variable of a model description, or what all of a kind have in common.

    Attributes
    ----------
    type
        ``"real"``, ``"integer"`` or ``"boolean"``.
    causality
        ``"parameter"``, ``"input"``, ``"output"`` or ``"local"``.
    quantity
        Of :mod:`faying.export.fmu.variable`; empty for a number.
    start
        None where the FMU computes it.
    size
        Elements of an array; None for a scalar.
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
        """Return the variable of a part of the joint, for which braces stand in the texts."""
        name, description = self.name.format(part), self.description.format(part)
        return replace(
            self, name=name, description=description, index=index, start=start, size=size
        )

    @property
    def reference(self) -> int:
        """Value reference."""
        return (int(self.kind) << INDEX_BITS) + self.index

    @property
    def variability(self) -> str:
        """What FMI demands of its causality."""
        return "fixed" if self.causality == "parameter" else "continuous"
