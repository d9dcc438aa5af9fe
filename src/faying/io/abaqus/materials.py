"""``*MATERIAL``: elasticity, the same in all directions or not, and density."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np

from faying._typing import Matrix
from faying.exceptions import ModelError
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import numbers, optional_real, real
from faying.io.abaqus.keyword import READ, Keyword, add
from faying.io.abaqus.left_out import KEYWORDS
from faying.io.abaqus.temperatures import (
    Expansion,
    check_constant,
    constant_expansion,
    read_expansion,
)
from faying.model.assembly import Material
from faying.model.elastic_law import orthotropic_law

HARMLESS = frozenset(("CONDUCTIVITY", "SPECIFIC HEAT", "LATENT HEAT", "INELASTIC HEAT FRACTION"))
"""Properties without effect at constant temperature."""

MEMBERS = ("ELASTIC", "DENSITY", "DAMPING", "EXPANSION", *sorted(HARMLESS))


def without_unused(deck: Deck) -> Deck:
    """Leave out the materials that no section names, whatever is in them.

    A block ends at the next keyword that is read for something else.
    """
    used = {keyword.value("MATERIAL").upper() for keyword in deck.keywords}
    keywords, unused = [], False
    for keyword in deck.keywords:
        if keyword.name == "MATERIAL":
            name = keyword.value("NAME")
            unused = bool(name) and name.upper() not in used
            if unused:
                deck.ignored.append(f"material {name}, which no section names")
        elif keyword.name in READ | KEYWORDS.harmless.keys() and keyword.name not in MEMBERS:
            unused = False
        if not unused:
            keywords.append(keyword)
    return replace(deck, keywords=keywords)


def read_materials(deck: Deck, temperature: float | None) -> dict[str, Material]:
    """Read all *MATERIAL with *ELASTIC and *DENSITY: upper-case name to material.

    Tables over temperature count at the temperature given; None where it differs.
    """
    materials: dict[str, Material] = {}
    for head, members in deck.groups("MATERIAL", *MEMBERS):
        name = head.required("NAME")
        elastic, law, density, expansion = None, None, 0.0, None
        for member in members:
            if _is_anisotropic(member):
                law = read_law(member, partial(check_constant, member, temperature))
            elif member.name == "ELASTIC":
                elastic = _elastic(member, temperature)
            elif member.name == "DENSITY":
                density = _density(member, temperature)
            elif member.name == "EXPANSION":
                expansion = constant_expansion(member)
            elif member.name in HARMLESS:
                deck.ignored.append(f"*{member.name} of material {name} (no temperatures)")
        tables = [m for m in members if m.name in ("ELASTIC", "DENSITY") and len(m.data) > 1]
        if any(not _is_anisotropic(member) for member in tables):
            deck.ignored.append(
                f"tables of material {name}: taken at the temperature {temperature:g}"
            )
        if elastic is None and law is None:
            head.refuse(
                f"material '{name}' has no *ELASTIC; add Young's modulus and Poisson's ratio"
            )
        try:
            material = (
                Material(
                    name=name,
                    youngs_modulus=elastic[0],
                    poissons_ratio=elastic[1],
                    density=density,
                    expansion=expansion,
                )
                if elastic is not None
                else Material.anisotropic(np.asarray(law), density=density, name=name)
            )
        except ModelError as error:
            raise head.error(str(error)) from None
        add(materials, head, name, material, "materials")
    return materials


def _is_anisotropic(member: Keyword) -> bool:
    return member.name == "ELASTIC" and member.choice("TYPE", "ISOTROPIC") not in ISOTROPIC


def read_expansions(deck: Deck) -> dict[str, Expansion]:
    """Read all *EXPANSION, upper-case name of the material to what it expands by."""
    expansions = {}
    for head, members in deck.groups("MATERIAL", *MEMBERS):
        name = head.required("NAME")
        for member in (entry for entry in members if entry.name == "EXPANSION"):
            if deck.of("TEMPERATURE") and any(map(_is_anisotropic, members)):
                member.refuse(f"material '{name}' is anisotropic; only isotropic ones expand here")
            if deck.of("TEMPERATURE"):
                expansions[name.upper()] = read_expansion(member)
            else:
                deck.ignored.append(f"*EXPANSION of material {name} (no temperature changes)")
    return expansions


def _elastic(keyword: Keyword, temperature: float | None) -> tuple[float, float]:
    rows = keyword.rows()
    _check_rows(keyword, rows, 3, "E, nu")
    modulus = [real(keyword, i, row[0], "Young's modulus") for i, row in enumerate(rows)]
    ratio = [optional_real(keyword, i, row, 1, 0.0, "nu") for i, row in enumerate(rows)]
    return _at(keyword, temperature, rows, 2, modulus), _at(keyword, temperature, rows, 2, ratio)


def _density(keyword: Keyword, temperature: float | None) -> float:
    rows = keyword.rows()
    _check_rows(keyword, rows, 2, "the density")
    values = [real(keyword, i, row[0], "the density") for i, row in enumerate(rows)]
    return _at(keyword, temperature, rows, 1, values)


def _at(
    keyword: Keyword,
    temperature: float | None,
    rows: list[list[str]],
    column: int,
    values: list[float],
) -> float:
    """Return the value of a table at the temperature that counts."""
    if len(rows) == 1:
        return values[0]
    degrees = check_constant(keyword, temperature)
    places = [
        optional_real(keyword, i, row, column, 0.0, "a temperature") for i, row in enumerate(rows)
    ]
    if any(upper <= lower for lower, upper in pairwise(places)):
        keyword.refuse("the temperatures do not increase; sort them", 1)
    return float(np.interp(degrees, places, values))


def _check_rows(keyword: Keyword, rows: list[list[str]], width: int, expected: str) -> None:
    if not rows:
        keyword.refuse(f"expected {expected} on a data line")
    wide = next((i for i, row in enumerate(rows) if len(row) > width), None)
    if wide is not None:
        keyword.refuse(f"found {len(rows[wide])} fields, expected {expected}", wide)


ISOTROPIC = ("ISOTROPIC", "ISO")
_COUNTS = {"ORTHOTROPIC": 9, "ENGINEERINGCONSTANTS": 9, "ANISOTROPIC": 21}
_ORDER = np.array([0, 1, 2, 3, 5, 4])
"""Decks have 11, 22, 33, 12, 13, 23; see :mod:`faying.model.elastic_law`."""


def read_law(keyword: Keyword, temperature: Callable[[], float]) -> Matrix:
    """Return the stiffness (6, 6) along the axes of the material.

    ``temperature`` tells at which one a table over temperature counts.
    """
    wished = keyword.choice("TYPE").replace(" ", "")
    kind = next((name for name in _COUNTS if len(wished) > 2 and name.startswith(wished)), "")
    if not kind:
        keyword.refuse(
            f"TYPE={keyword.choice('TYPE')} is not supported; ISOTROPIC, ORTHO, ENGINEERING "
            "CONSTANTS and ANISOTROPIC are"
        )
    count = _COUNTS[kind]
    values = [
        value
        for i, row in enumerate(keyword.rows())
        for value in numbers(keyword, i, row, "an elastic constant")
    ]
    # A temperature may stand behind the last constant, and must in a table.
    if len(values) < count or (len(values) > count and len(values) % (count + 1)):
        keyword.refuse(
            f"found {len(values)} numbers, expected {count}, or as many and a temperature for each "
            "temperature of a table"
        )
    if len(values) > count + 1:
        table = np.array(values).reshape(-1, count + 1)
        if (np.diff(table[:, -1]) <= 0).any():
            keyword.refuse("the temperatures do not increase; sort them")
        degrees = temperature()
        values = [float(np.interp(degrees, table[:, -1], column)) for column in table[:, :-1].T]
    if kind == "ENGINEERINGCONSTANTS":
        shear = np.array([values[6], values[8], values[7]])
        try:
            return orthotropic_law(values[:3], values[3:6], shear)
        except ValueError as error:
            raise keyword.error(str(error)) from None
    law = np.zeros((6, 6))
    if kind == "ORTHOTROPIC":
        law[[0, 0, 1, 0, 1, 2, 3, 4, 5], [0, 1, 1, 2, 2, 2, 3, 4, 5]] = values[:9]
    else:
        rows, columns = np.array([(i, j) for j in range(6) for i in range(j + 1)]).T
        law[rows, columns] = values[:21]
    law = law + np.triu(law, 1).T
    return np.asarray(law[np.ix_(_ORDER, _ORDER)])
