"""The law of surfaces that rub, its tangential stiffness from the materials unless given."""

from typing import Literal, TypeAlias

from faying.contact.laws import Coulomb, Hard, Law, Penalty
from faying.contact.laws.coulomb import automatic_tangential_penalty
from faying.exceptions import ModelError
from faying.model.assembly import Assembly

TangentialPenalty: TypeAlias = float | Literal["auto"]
"""c_t [force/length³], or what the materials give."""


def with_friction(
    normal: Hard | Penalty,
    friction: float,
    tangential_penalty: TangentialPenalty,
    assembly: Assembly,
) -> Law:
    """Return a normal law with Coulomb friction, or itself where the coefficient is zero.

    Parameters
    ----------
    friction
        Coefficient μ.
    tangential_penalty : [force/length³]
        c_t; ``"auto"`` is c_n 2 (1 − ν)/(2 − ν) with the smallest ν of the assembly's materials,
        and infinite where normal contact is hard.

    Raises
    ------
    ModelError
        If a number is out of range, or ``"auto"`` finds no material.
    """
    if friction == 0:
        return normal
    if tangential_penalty == "auto":
        return Coulomb(normal, float(friction), _automatic(normal.penalty, assembly))
    try:
        return Coulomb(normal, float(friction), float(tangential_penalty))
    except ValueError:
        message = (
            f"the tangential penalty is '{tangential_penalty}'; give a positive number "
            "[force/length³] or 'auto'"
        )
        raise ModelError(message) from None


def _automatic(penalty: float, assembly: Assembly) -> float:
    ratios = [one.poissons_ratio for one in assembly.materials.values()]
    if not ratios:
        message = (
            "tangential_penalty = 'auto' needs materials, and the model has none; give the "
            "penalty as a number [force/length³] (0.8 times the normal one is usual)"
        )
        raise ModelError(message)
    return automatic_tangential_penalty(penalty, min(ratios))
