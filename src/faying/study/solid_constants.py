"""Whether material constants can be those of a solid in the unit set of a study."""

from collections.abc import Iterator, Mapping

from faying.model.assembly import Material
from faying.units import LENGTHS, MASSES, pascals

MODULI = (1e4, 2e12)
"""Young's moduli [Pa] from gels to beyond diamond (1.2e12)."""
DENSITIES = (1.0, 3e4)
"""Densities [kg/m³] from the lightest foams to beyond osmium (2.26e4)."""


def doubts(materials: Mapping[int, Material], units: str) -> Iterator[str]:
    """Yield what cannot be right about material constants; nothing in units that are not known.

    A study in mm-t-s with Pa and kg/m³ runs without complaint and is wrong by powers of ten.

    Examples
    --------
    >>> steel = Material(name="steel", youngs_modulus=2.1e11, poissons_ratio=0.3, density=7.85e-9)
    >>> list(doubts({1: steel}, "mm-t-s"))
    ["material 'steel': E = 2.1e+11 is 2.1e+17 Pa in mm-t-s, as of no solid; check it and 'units'"]
    """
    pascal = pascals(units)
    if pascal is None:
        return
    length, mass, _ = units.split("-")
    density = MASSES[mass] / LENGTHS[length] ** 3
    told = set()
    for material in materials.values():
        for name, value, factor, unit, (least, most) in (
            ("E", material.youngs_modulus, pascal, "Pa", MODULI),
            ("rho", material.density, density, "kg/m³", DENSITIES),
        ):
            if value and not least <= value * factor <= most:
                told.add(
                    f"material '{material.name}': {name} = {value:g} is {value * factor:g} {unit} "
                    f"in {units}, as of no solid; check it and 'units'"
                )
    yield from sorted(told)
