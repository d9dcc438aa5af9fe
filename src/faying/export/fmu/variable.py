"""One variable of an FMU, and the kinds that there are.

References are 2²⁰ times a kind plus an index, as ``sources/variables.c`` reads them.
"""

from dataclasses import dataclass
from enum import IntEnum

from faying.export.fmu import quantities

INDEX_BITS = 20
WHOLE = 2**INDEX_BITS - 1
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
