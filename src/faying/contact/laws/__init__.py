"""Contact laws: one frozen value each, the same for full and reduced models."""

from collections.abc import Mapping

from faying.contact.laws.coulomb import Coulomb
from faying.contact.laws.curve import Curve
from faying.contact.laws.exponential import ExponentialClosure
from faying.contact.laws.gasket import GasketClosure
from faying.contact.laws.hard import Hard
from faying.contact.laws.law import Law
from faying.contact.laws.penalty import Penalty
from faying.contact.laws.power import PowerClosure
from faying.contact.laws.table import TableClosure

__all__ = [
    "CLOSURES",
    "LAWS",
    "Coulomb",
    "Curve",
    "ExponentialClosure",
    "GasketClosure",
    "Hard",
    "Law",
    "Penalty",
    "PowerClosure",
    "TableClosure",
    "law_with_friction",
    "normal_law",
]

CLOSURES: Mapping[str, type[Curve]] = {
    "table": TableClosure,
    "exponential": ExponentialClosure,
    "power": PowerClosure,
    "gasket": GasketClosure,
}
"""Curves of pressure over closure by their names in studies and files."""

LAWS: Mapping[str, type[Law]] = {
    "hard": Hard,
    "penalty": Penalty,
    "coulomb": Coulomb,
    **CLOSURES,
}
"""All laws by their names in files."""


def normal_law(penalty: float) -> Hard | Penalty:
    """Return the frictionless law of a contact stiffness [force/length³]; ``inf`` is hard.

    Raises
    ------
    ModelError
        If it is not positive.
    """
    return Hard() if penalty == float("inf") else Penalty(float(penalty))


def law_with_friction(normal: Law, friction: float, tangential_penalty: float) -> Law:
    """Return a normal law with Coulomb friction, or the normal law where the coefficient is zero.

    Raises
    ------
    ModelError
        If a number is not in its range.
    """
    return Coulomb(normal, friction, tangential_penalty) if friction else normal
