"""``*INITIAL CONDITIONS, TYPE=TEMPERATURE``, ``*TEMPERATURE`` and ``*EXPANSION``: free strains."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.dofs import Dofs
from faying.io.abaqus.fields import optional_real, parameter, real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.loads import Amplitudes
from faying.io.left_out import IGNORABLE, request
from faying.model.assembly import Assembly
from faying.model.body_forces import UNSEEN, expansion_forces, stretching_forces


@dataclass(frozen=True, eq=False, kw_only=True)
class Temperatures:
    """Temperatures of the nodes at the start and at the end of each step, from 0.

    Attributes
    ----------
    initial : (n_node,)
    steps
        One field (n_node,) for each step; the initial one where nothing changes it.
    first
        The first *TEMPERATURE, if any.
    """

    initial: Vector
    steps: Sequence[Vector]
    first: Keyword | None

    def uniform(self, nodes: Indices) -> float | None:
        """Return the temperature of nodes at the end of the last step; None if it differs."""
        values = np.unique(self.steps[-1][nodes])
        return float(values[0]) if len(values) == 1 else None


def without_temperatures(deck: Deck) -> Deck:
    """Leave out the temperatures of steps as asked; the initial ones choose material constants."""
    if "temperature" not in deck.ignore or not deck.of("TEMPERATURE"):
        return deck
    deck.ignored.append(f"*TEMPERATURE: {IGNORABLE['temperature']} (ignore = temperature)")
    return deck.without("TEMPERATURE")


def _initial(deck: Deck) -> list[Keyword]:
    conditions = deck.of("INITIAL CONDITIONS")
    return [keyword for keyword in conditions if keyword.choice("TYPE") == "TEMPERATURE"]


def read_temperatures(deck: Deck, dofs: Dofs, amplitudes: Amplitudes) -> Temperatures:
    """Read the temperatures at the start and in each step."""
    initial = np.zeros(len(dofs.nodes.ids))
    for keyword in _initial(deck):
        keyword.check()
        for nodes, value in _lines(keyword, dofs):
            initial[nodes] = value
    current, steps = initial, []
    keywords = deck.of("TEMPERATURE")
    for step in range(deck.n_step + 1):
        current = current.copy()
        for keyword in (candidate for candidate in keywords if candidate.step == step):
            if keyword.choice("OP") == "NEW":
                current = initial.copy()
            factor = amplitudes.factor(keyword, step)
            for nodes, value in _lines(keyword, dofs):
                # With an amplitude CalculiX goes from the initial temperature; at 1 none matters.
                current[nodes] = factor * value
        steps.append(current)
    return Temperatures(initial=initial, steps=steps, first=keywords[0] if keywords else None)


def _lines(keyword: Keyword, dofs: Dofs) -> Iterator[tuple[Indices, float]]:
    for row, fields in enumerate(keyword.rows()):
        if len(fields) < 2:
            keyword.refuse(
                f"found {len(fields)} fields, expected node or node set and temperature", row
            )
        value = real(keyword, row, fields[1], "a temperature")
        for column in range(2, len(fields)):
            if optional_real(keyword, row, fields, column, 0.0, "a gradient") != 0.0:
                keyword.refuse(
                    "gradients through a section are not supported; temperatures of solids are "
                    "those of their nodes",
                    row,
                )
        yield dofs.find(keyword, row, fields[0]), value


@dataclass(frozen=True, eq=False, kw_only=True)
class Expansion:
    """Coefficients of expansion over temperature, from the temperature without strain."""

    temperatures: Vector
    coefficients: Vector
    zero: float

    def strain(self, temperature: Matrix) -> Matrix:
        """Return the strain from the temperature without any to another."""
        coefficient = np.interp(temperature, self.temperatures, self.coefficients)
        return np.asarray(coefficient * (temperature - self.zero))


def read_expansion(keyword: Keyword) -> Expansion:
    """Read *EXPANSION."""
    keyword.check()
    rows = keyword.rows()
    wrong = next((row for row, fields in enumerate(rows) if len(fields) > 2), None)
    if not rows or wrong is not None:
        keyword.refuse("expected a coefficient of expansion and a temperature on each line", wrong)
    table = np.array(
        [
            [
                optional_real(keyword, row, fields, 1, 0.0, "a temperature"),
                real(keyword, row, fields[0], "a coefficient of expansion"),
            ]
            for row, fields in enumerate(rows)
        ]
    )
    if (np.diff(table[:, 0]) <= 0).any():
        keyword.refuse("the temperatures do not increase; sort them")
    zero = parameter(keyword, "ZERO", 0.0)
    return Expansion(temperatures=table[:, 0], coefficients=table[:, 1], zero=zero)


def constant_expansion(keyword: Keyword) -> float | None:
    """Return the coefficient of *EXPANSION; None where it differs in directions or temperatures."""
    rows = keyword.rows()
    isotropic = keyword.choice("TYPE") in ("ISO", "ISOTROPIC")
    return real(keyword, 0, rows[0][0], "a coefficient") if isotropic and len(rows) == 1 else None


def thermal_forces(
    assembly: Assembly,
    temperatures: Temperatures,
    expansions: Mapping[str, Expansion],
    origin: Indices,
    bolts: Collection[int | None],
    ignored: list[str],
) -> list[Matrix]:
    """Return the forces (n_node, 6) of the free strains at the end of each step.

    Expansions are those of materials, named in upper case. Each node of the assembly has the
    temperature of a node of the deck, its origin (n_node,). Bolts are beams that are tightened.
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
            f"shells of material '{expanding[0]}' do not expand here; leave its *EXPANSION out, or "
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


def check_constant(keyword: Keyword, temperature: float | None) -> float:
    """Return the temperature that constants are taken at."""
    if temperature is None:
        keyword.refuse(
            "constants that depend on temperature are not supported where it differs between "
            f"nodes; give one line, or {request('temperature')}",
            1,
        )
    return temperature
