"""``*MATERIAL`` and ``*TEMPERATURE``: elasticity, density, and free strains."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.exceptions import ModelError
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.deck_data import DeckData
from faying.io.abaqus.fields import lines, parameter
from faying.io.abaqus.keyword import READ, Keyword, add
from faying.io.abaqus.left_out import KEYWORDS
from faying.io.abaqus.loads import Amplitudes
from faying.io.left_out import IGNORABLE, request
from faying.model.assembly import Assembly, Material
from faying.model.body_forces import UNSEEN, expansion_forces, stretching_forces
from faying.model.elastic_law import orthotropic_law


@dataclass(frozen=True, eq=False, kw_only=True)
class Temperatures:
    """Temperatures of the nodes at the start, and at the end of each step from 0.

    Attributes
    ----------
    initial : (n_node,)
    steps
        Temperatures (n_node,) at the end of each step; initial ones if unchanged.
    first
        The first *TEMPERATURE keyword, if any.
    """

    initial: Vector
    steps: Sequence[Vector]
    first: Keyword | None

    def uniform(self, nodes: Indices) -> float | None:
        """Return the uniform temperature of nodes at the end of all steps; None if it varies."""
        values = np.unique(self.steps[-1][nodes])
        return float(values[0]) if len(values) == 1 else None


def without_temperatures(deck: Deck) -> Deck:
    """Return the deck without temperatures of steps; initial ones still select constants."""
    if "temperature" not in deck.ignore or not deck.of("TEMPERATURE"):
        return deck
    deck.ignored.append(f"*TEMPERATURE: {IGNORABLE['temperature']} (ignore = temperature)")
    return deck.without("TEMPERATURE")


def read_temperatures(data: DeckData, amplitudes: Amplitudes) -> Temperatures:
    """Read the temperatures at the start and in each step."""
    deck, initial = data.deck, np.zeros(len(data.nodes.ids))
    for keyword in deck.of("INITIAL CONDITIONS"):
        if keyword.choice("TYPE") != "TEMPERATURE":
            continue
        keyword.check()
        for nodes, value in _lines(keyword, data):
            initial[nodes] = value
    current, steps = initial, []
    keywords = deck.of("TEMPERATURE")
    for step in range(deck.n_step + 1):
        current = current.copy()
        for keyword in (candidate for candidate in keywords if candidate.step == step):
            if keyword.choice("OP") == "NEW":
                current = initial.copy()
            factor = amplitudes.factor(keyword, step)
            for nodes, value in _lines(keyword, data):
                # With an amplitude CalculiX starts at the initial temperature; at 1 both agree.
                current[nodes] = factor * value
        steps.append(current)
    return Temperatures(initial=initial, steps=steps, first=keywords[0] if keywords else None)


def _lines(keyword: Keyword, data: DeckData) -> Iterator[tuple[Indices, float]]:
    for line in lines(keyword):
        if len(line) < 2:
            line.refuse(f"found {len(line)} fields, expected node or node set and temperature")
        for column in range(2, len(line)):
            if line.real(column, "a gradient", 0.0) != 0.0:
                line.refuse(
                    "gradients through a section are not supported; temperatures of solids are "
                    "those of their nodes"
                )
        yield data.find(line), line.real(1, "a temperature")


@dataclass(frozen=True, eq=False, kw_only=True)
class Expansion:
    """Coefficients of thermal expansion over temperature, and the strain-free temperature."""

    temperatures: Vector
    coefficients: Vector
    zero: float

    def strain(self, temperature: Matrix) -> Matrix:
        """Return the thermal strain at a temperature."""
        coefficient = np.interp(temperature, self.temperatures, self.coefficients)
        return np.asarray(coefficient * (temperature - self.zero))


def read_expansion(keyword: Keyword) -> Expansion:
    """Read the coefficients of *EXPANSION."""
    keyword.check()
    rows = lines(keyword)
    wrong = next((line.row for line in rows if len(line) > 2), None)
    if not rows or wrong is not None:
        keyword.refuse("expected a coefficient of expansion and a temperature on each line", wrong)
    coefficients, temperatures = _table(keyword, ("a coefficient of expansion", "a temperature")).T
    _check_increasing(keyword, temperatures)
    zero = parameter(keyword, "ZERO", 0.0)
    return Expansion(temperatures=temperatures, coefficients=coefficients, zero=zero)


def constant_expansion(keyword: Keyword) -> float | None:
    """Return the coefficient of *EXPANSION; None if it depends on direction or temperature."""
    rows = lines(keyword)
    isotropic = keyword.choice("TYPE") in ("ISO", "ISOTROPIC")
    return rows[0].real(0, "a coefficient") if isotropic and len(rows) == 1 else None


def thermal_forces(
    assembly: Assembly,
    temperatures: Temperatures,
    expansions: Mapping[str, Expansion],
    origin: Indices,
    bolts: Collection[int | None],
    ignored: list[str],
) -> list[Matrix]:
    """Return the nodal forces (n_node, 6) of thermal strains at the end of each step.

    Expansions are given by upper-case material name. Each node of the assembly has the
    temperature of a node of the deck, its ``origin`` (n_node,). ``bolts`` are tightened beams.
    """
    shape = (len(assembly.mesh.nodes), 6)
    of_property = {number: section.name for number, section in assembly.materials.items()}
    of_property |= {beam.property: beam.material.name for beam in assembly.beams}
    used = {
        number: expansions[name.upper()].strain
        for number, name in of_property.items()
        if name.upper() in expansions
    }
    of_shells = {name for section in assembly.shell_sections.values() for name in section.materials}
    expanding = sorted(name for name in of_shells if name.upper() in expansions)
    if temperatures.first is not None and expanding:
        temperatures.first.refuse(
            f"shells of material '{expanding[0]}' cannot expand; remove its *EXPANSION, or "
            f"{request('temperature')}"
        )
    if temperatures.first is None or not used:
        return [np.zeros(shape)] * len(temperatures.steps)
    ignored.append(
        "*TEMPERATURE: free strains are part of the loads of the steps; apply them by deck_load"
    )
    ends = np.array([beam.nodes for beam in assembly.beams], dtype=np.int64).reshape(-1, 2)

    def forces(step: Vector) -> Matrix:
        start, end = temperatures.initial[origin], step[origin]
        stretch = np.zeros(len(ends))
        for i, beam in enumerate(assembly.beams):
            if beam.property in used:
                if beam.id in bolts and temperatures.first is not None:
                    temperatures.first.refuse(
                        f"element {beam.id} is a bolt: {UNSEEN}, or {request('temperature')}"
                    )
                strain = used[beam.property]
                change = strain(end[ends[i]].mean()) - strain(start[ends[i]].mean())
                stretch[i] = float(change)
        of_solids = expansion_forces(assembly, used, start, end)
        return of_solids + stretching_forces(assembly, stretch)

    return [
        np.zeros(shape) if np.array_equal(step, temperatures.initial) else forces(step)
        for step in temperatures.steps
    ]


HARMLESS = frozenset(("CONDUCTIVITY", "SPECIFIC HEAT", "LATENT HEAT", "INELASTIC HEAT FRACTION"))
"""Properties without effect at constant temperature."""

MEMBERS = ("ELASTIC", "DENSITY", "DAMPING", "EXPANSION", *sorted(HARMLESS))


def without_unused(deck: Deck) -> Deck:
    """Return the deck without materials that no section uses.

    The block of a material ends at the next keyword that is read for another purpose.
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


def read_materials(
    deck: Deck, temperature: float | None
) -> tuple[dict[str, Material], dict[str, Expansion]]:
    """Return the materials of all *MATERIAL, and their expansions, by upper-case name.

    Tables over temperature are evaluated at ``temperature``, None where it varies. Without
    temperatures of steps there are no expansions.
    """
    materials: dict[str, Material] = {}
    expansions: dict[str, Expansion] = {}
    for head, members in deck.groups("MATERIAL", *MEMBERS):
        name = head.required("NAME")
        by_name = {member.name: member for member in members}
        deck.ignored.extend(
            f"*{member} of material {name} (no temperatures)"
            for member in by_name
            if member in HARMLESS
        )
        elastic, density = by_name.get("ELASTIC"), by_name.get("DENSITY")
        expansion = by_name.get("EXPANSION")
        if elastic is None:
            head.refuse(
                f"material '{name}' has no *ELASTIC; add Young's modulus and Poisson's ratio"
            )
        anisotropic = elastic.choice("TYPE", "ISOTROPIC") not in ISOTROPIC
        mass = _constants(density, temperature, ("the density",)) if density else [0.0]
        constant = constant_expansion(expansion) if expansion else None
        try:
            if anisotropic:
                law = read_law(elastic, temperature)
                material = Material.anisotropic(law, density=float(mass[0]), name=name)
            else:
                modulus, ratio = _constants(elastic, temperature, ("Young's modulus", "nu"))
                material = Material(
                    name=name,
                    youngs_modulus=float(modulus),
                    poissons_ratio=float(ratio),
                    density=float(mass[0]),
                    expansion=constant,
                )
        except ModelError as error:
            raise head.error(str(error)) from None
        tables = [density, None if anisotropic else elastic]
        if any(keyword is not None and len(keyword.data) > 1 for keyword in tables):
            deck.ignored.append(
                f"tables of material {name}: taken at the temperature {temperature:g}"
            )
        if expansion and not deck.of("TEMPERATURE"):
            deck.ignored.append(f"*EXPANSION of material {name} (no temperature changes)")
        elif expansion:
            if anisotropic:
                expansion.refuse(
                    f"material '{name}' is anisotropic; only isotropic ones expand here"
                )
            expansions[name.upper()] = read_expansion(expansion)
        add(materials, head, name, material, "materials")
    return materials, expansions


def _constants(keyword: Keyword, temperature: float | None, names: Sequence[str]) -> Vector:
    """Return constants at a temperature; only the first is required.

    Each line has the constants in order, followed by their temperature.
    """
    expected = ", ".join(names)
    if not lines(keyword, range(len(names) + 2), expected):
        keyword.refuse(f"expected {expected} on a data line")
    return _at(keyword, temperature, _table(keyword, (*names, "a temperature")))


def _table(keyword: Keyword, names: Sequence[str]) -> Matrix:
    """Return the numbers of all data lines; only the first of each line is required."""
    return np.array(
        [
            [line.real(i, name, 0.0 if i else None) for i, name in enumerate(names)]
            for line in lines(keyword)
        ]
    )


def _at(keyword: Keyword, temperature: float | None, table: Matrix) -> Vector:
    """Return the constants of a table over temperature, which is its last column."""
    if len(table) == 1:
        return table[0, :-1]
    if temperature is None:
        keyword.refuse(
            "constants that depend on temperature are not supported where it varies between "
            f"nodes; give one line, or {request('temperature')}",
            1,
        )
    _check_increasing(keyword, table[:, -1])
    return np.array([np.interp(temperature, table[:, -1], c) for c in table[:, :-1].T])


def _check_increasing(keyword: Keyword, temperatures: Vector) -> None:
    """Refuse a table whose temperatures do not increase."""
    if (np.diff(temperatures) <= 0).any():
        keyword.refuse("the temperatures do not increase; sort them", 1)


ISOTROPIC = ("ISOTROPIC", "ISO")
_COUNTS = {"ORTHOTROPIC": 9, "ENGINEERINGCONSTANTS": 9, "ANISOTROPIC": 21}
_ORDER = np.array([0, 1, 2, 3, 5, 4])
"""Order of components: decks have 11, 22, 33, 12, 13, 23; see :mod:`faying.model.elastic_law`."""


def read_law(keyword: Keyword, temperature: float | None) -> Matrix:
    """Return the elasticity matrix (6, 6) along the axes of the material.

    A table over temperature is evaluated at the given one.
    """
    wished = keyword.choice("TYPE").replace(" ", "")
    kind = next((name for name in _COUNTS if len(wished) > 2 and name.startswith(wished)), "")
    if not kind:
        keyword.refuse(
            f"TYPE={keyword.choice('TYPE')} is not supported; ISOTROPIC, ORTHO, ENGINEERING "
            "CONSTANTS and ANISOTROPIC are"
        )
    count = _COUNTS[kind]
    values = [value for line in lines(keyword) for value in line.reals("an elastic constant")]
    # A temperature may follow the last constant, and must in a table.
    if len(values) == count:
        values.append(0.0)
    if not values or len(values) % (count + 1):
        keyword.refuse(
            f"found {len(values)} numbers, expected {count}, or as many and a temperature for each "
            "temperature of a table"
        )
    values = _at(keyword, temperature, np.array(values).reshape(-1, count + 1)).tolist()
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
