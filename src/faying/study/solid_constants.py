"""Whether material constants can be those of a solid in the unit set of a study."""

from collections.abc import Iterator, Mapping

from faying.model.assembly import Material

# In m, kg and s; pound and slug by the international pound, foot and inch (NIST SP 811, App. B).
LENGTHS = {"m": 1.0, "dm": 0.1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "ft": 0.3048}
MASSES = {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "Mg": 1e3, "slug": 14.5939, "slinch": 175.127}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0}
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
    length, mass, time = units.split("-") if units.count("-") == 2 else ("", "", "")
    if length not in LENGTHS or mass not in MASSES or time not in TIMES:
        return
    metre, kilogram, second = LENGTHS[length], MASSES[mass], TIMES[time]
    pascal, density = kilogram / (metre * second**2), kilogram / metre**3
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
