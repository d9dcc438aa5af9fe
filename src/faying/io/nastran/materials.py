"""MAT1: isotropic material."""

import math
from collections.abc import Mapping

from faying.exceptions import ModelError
from faying.io.nastran.cards import Card, Cards
from faying.model.assembly import Material

# Nastran itself warns when E, G and ν disagree by more than one per cent.
_CONTRADICTION = 0.01


def read_materials(
    cards: Mapping[str, Cards], mass_factor: float, ignored: list[str]
) -> dict[int, Material]:
    """Return materials by id; densities are multiplied by PARAM,WTMASS.

    Two of E, G, NU must be given. All three may be, within one per cent of G = E / (2 (1 + NU)).

    Raises
    ------
    FormatError
        If constants are missing, contradict each other or are out of range; or an id occurs twice.
    """
    found: dict[int, Material] = {}
    origin: dict[int, str] = {}
    damped = 0
    for card in cards.get("MAT1", ()):
        number = card.integer(0)
        if number in found:
            text = f"material {number} is already defined at {origin[number]}; renumber one"
            raise card.error(text)
        youngs, poisson = _constants(card, number)
        if not math.isfinite(youngs + poisson):
            text = f"material {number}: E, G and NU are too large for a number; check the units"
            raise card.error(text)
        try:
            found[number] = Material(
                youngs_modulus=youngs,
                poissons_ratio=poisson,
                density=card.real(4, 0.0) * mass_factor,
                name=str(number),
            )
        except ModelError as error:
            raise card.error(str(error)) from error
        origin[number] = card.where()
        damped += card.real(7, 0.0) != 0.0
    if damped:
        ignored.append(f"structural damping GE of {damped} MAT1 (give [damping] in the study)")
    return found


def _constants(card: Card, number: int) -> tuple[float, float]:
    given = [bool(card.text(j)) for j in (1, 2, 3)]
    youngs, shear, poisson = (card.real(j, 0.0) for j in (1, 2, 3))
    if sum(given) < 2:
        text = f"material {number} gives {sum(given)} of E, G, NU; two are needed"
        raise card.error(text)
    if not given[0]:
        return 2 * shear * (1 + poisson), poisson
    if not given[2]:
        if not shear > 0:
            text = f"material {number} has G = {shear:g}; it must be positive"
            raise card.error(text)
        return youngs, youngs / (2 * shear) - 1
    if given[1] and poisson > -1:
        consistent = youngs / (2 * (1 + poisson))
        if abs(shear - consistent) > _CONTRADICTION * abs(consistent):
            text = (
                f"material {number} has G = {shear:g}, but E and NU give {consistent:g}; an "
                "isotropic material has only two constants, leave G blank or correct it"
            )
            raise card.error(text)
    return youngs, poisson
