"""``*MATERIAL``: isotropic linear elasticity and density."""

from dataclasses import replace

from faying.exceptions import ModelError
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import optional_real, real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.keyword_names import READ
from faying.io.abaqus.left_out import KEYWORDS
from faying.model.assembly import Material

HARMLESS = frozenset(
    ("EXPANSION", "CONDUCTIVITY", "SPECIFIC HEAT", "LATENT HEAT", "INELASTIC HEAT FRACTION")
)
"""Properties without effect at constant temperature."""

MEMBERS = ("ELASTIC", "DENSITY", "DAMPING", *sorted(HARMLESS))


def without_unused(deck: Deck, ignored: list[str]) -> Deck:
    """Leave out the materials that no section names, whatever is in them.

    A block ends at the next keyword that is read for something else.
    """
    used = {keyword.value("MATERIAL").upper() for keyword in deck.keywords}
    kept, unused = [], False
    for keyword in deck.keywords:
        if keyword.name == "MATERIAL":
            name = keyword.value("NAME")
            unused = bool(name) and name.upper() not in used
            if unused:
                ignored.append(f"material {name}, which no section names")
        elif keyword.name in READ | KEYWORDS.harmless.keys() and keyword.name not in MEMBERS:
            unused = False
        if not unused:
            kept.append(keyword)
    return replace(deck, keywords=kept)


def read_materials(deck: Deck, ignored: list[str]) -> dict[str, Material]:
    """Read all *MATERIAL with *ELASTIC and *DENSITY: upper-case name to material.

    Raises
    ------
    FormatError
        Naming the line of a material that is not isotropic, depends on temperature, has impossible
        constants or is defined twice.
    """
    found: dict[str, Material] = {}
    for head, members in deck.groups("MATERIAL", *MEMBERS):
        head.allow("NAME")
        name = head.required("NAME")
        if name.upper() in found:
            message = f"there are two materials '{name}'; rename one of them"
            raise head.error(message)
        elastic, density = None, 0.0
        for member in members:
            if member.name == "ELASTIC":
                elastic = _elastic(member)
            elif member.name == "DENSITY":
                density = _density(member)
            elif member.name in HARMLESS:
                ignored.append(f"*{member.name} of material {name} (no temperatures)")
        if elastic is None:
            message = f"material '{name}' has no *ELASTIC; add Young's modulus and Poisson's ratio"
            raise head.error(message)
        try:
            found[name.upper()] = Material(
                name=name, youngs_modulus=elastic[0], poissons_ratio=elastic[1], density=density
            )
        except ModelError as error:
            raise head.error(str(error)) from None
    return found


def _elastic(keyword: Keyword) -> tuple[float, float]:
    keyword.allow("TYPE", "MODULI")
    kind = keyword.choice("TYPE", "ISOTROPIC")
    if kind not in ("ISOTROPIC", "ISO"):
        message = f"TYPE={kind} is not supported; only isotropic materials are"
        raise keyword.error(message)
    rows = keyword.rows()
    _check_one(keyword, rows, 3, "E, nu")
    modulus = real(keyword, 0, rows[0][0], "Young's modulus")
    return modulus, optional_real(keyword, 0, rows[0], 1, 0.0, "Poisson's ratio")


def _density(keyword: Keyword) -> float:
    keyword.allow()
    rows = keyword.rows()
    _check_one(keyword, rows, 2, "the density")
    return real(keyword, 0, rows[0][0], "the density")


def _check_one(keyword: Keyword, rows: list[list[str]], most: int, expected: str) -> None:
    """Refuse constants for several temperatures."""
    if not rows:
        message = f"expected {expected} on a data line"
        raise keyword.error(message)
    if len(rows) > 1:
        message = "constants that depend on temperature are not supported; give one line"
        raise keyword.error(message, 1)
    if len(rows[0]) > most:
        message = f"found {len(rows[0])} fields, expected {expected}"
        raise keyword.error(message, 0)
