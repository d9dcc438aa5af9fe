"""The law of surfaces that rub, its tangential stiffness from the materials unless given."""

from typing import Literal, TypeAlias

from faying.contact.laws import Coulomb, Law
from faying.contact.laws.coulomb import automatic_tangential_penalty
from faying.exceptions import ModelError
from faying.model.assembly import Assembly

TangentialPenalty: TypeAlias = float | Literal["auto"]
"""c_t [force/length³], or what the materials give."""


def with_friction(
    normal: Law,
    friction: float,
    tangential_penalty: TangentialPenalty,
    assembly: Assembly,
) -> Law:
    """Return a normal law with Coulomb friction, or itself where the coefficient is zero.

    The tangential penalty c_t [force/length³] ``"auto"`` is c_n 2 (1 − ν)/(2 − ν) with the smallest
    ν of the assembly's materials, and infinite where normal contact is hard. For c_n of a curve
    stands its ``stiffness``, the slope at the pressure it is named by: Mindlin's ratio is one of
    slopes at one pressure, and c_t is one number.

    Raises
    ------
    ModelError
        If a number is out of range, or ``"auto"`` finds no material.
    """
    coefficient = _number(friction, "the coefficient of friction", "a number")
    if coefficient == 0:
        return normal
    if tangential_penalty == "auto":
        return Coulomb(normal, coefficient, _automatic(normal.stiffness, assembly))
    expected = "a positive number [force/length³] or 'auto'"
    return Coulomb(
        normal, coefficient, _number(tangential_penalty, "the tangential penalty", expected)
    )


def _number(value: object, what: str, expected: str) -> float:
    """Return what was given for a number."""
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        message = f"{what} is {value!r}; give {expected}"
        raise ModelError(message) from None


def _automatic(penalty: float, assembly: Assembly) -> float:
    ratios = [material.poissons_ratio for material in assembly.materials.values()]
    if not ratios:
        message = (
            "tangential_penalty = 'auto' needs materials, and the model has none; give the "
            "penalty as a number [force/length³] (0.8 times the normal one is usual)"
        )
        raise ModelError(message)
    return automatic_tangential_penalty(penalty, min(ratios))
