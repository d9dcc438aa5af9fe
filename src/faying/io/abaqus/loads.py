"""Loads: amplitudes, ``*CLOAD``, ``*DLOAD`` and ``*DSLOAD``, step by step."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.deck_data import DeckData, component
from faying.io.abaqus.fields import Line, lines, parameter
from faying.io.abaqus.keyword import Keyword, add, named
from faying.io.abaqus.sets import NamedSets
from faying.io.abaqus.surfaces import Surfaces, faces_of_solids, find_surface
from faying.io.element_faces import face_areas, nodal_forces
from faying.model.assembly import Assembly
from faying.model.body_forces import body_forces, centrifugal
from faying.model.surface import WIDTH, nodes_by_kind, padded

_TIMED = ("STATIC", "DYNAMIC", "VISCO", "MODAL DYNAMIC")
"""Procedures whose data line has the length of the step, after its first increment."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Amplitudes:
    """The amplitudes of a deck, and the durations of its steps.

    Attributes
    ----------
    keywords
        Keywords by upper-case name.
    lengths
        Durations of the steps; entry 0 is before the first step.
    """

    keywords: Mapping[str, Keyword]
    lengths: Sequence[float]

    def factor(self, load: Keyword, step: int) -> float:
        """Return the factor on the loads of a keyword at the end of a step.

        An amplitude over step time keeps its last value in later steps; an amplitude
        over total time continues.
        """
        if not load.has("AMPLITUDE"):
            return 1.0
        keyword = named(load, load.value("AMPLITUDE"), self.keywords, "*AMPLITUDE")
        total = keyword.choice("TIME") == "TOTAL TIME"
        time = sum(self.lengths[: step + 1]) if total else self.lengths[load.step]
        times, values = _table(keyword)
        time -= parameter(load, "TIME DELAY", 0.0)
        return float(np.interp(time, times, values))

    def note(self, load: Keyword, ignored: list[str]) -> None:
        """Note the factor of an amplitude."""
        if load.has("AMPLITUDE"):
            factor = self.factor(load, load.step)
            name = load.value("AMPLITUDE")
            note = f"AMPLITUDE={name} of *{load.name}: times {factor:g}, its end in the step"
            if note not in ignored:
                ignored.append(note)


def read_amplitudes(deck: Deck) -> Amplitudes:
    """Read all *AMPLITUDE and the lengths of the steps."""
    amplitudes: dict[str, Keyword] = {}
    for keyword in deck.of("AMPLITUDE"):
        add(amplitudes, keyword, keyword.required("NAME"), keyword, "amplitudes")
    lengths = [0.0] + [1.0] * deck.n_step
    for keyword in deck.of(*_TIMED):
        for line in lines(keyword)[:1] if keyword.step else ():
            lengths[keyword.step] = line.real(1, "the length of the step", 1.0)
    return Amplitudes(keywords=amplitudes, lengths=lengths)


def _table(keyword: Keyword) -> tuple[Vector, Vector]:
    """Return times and values of an amplitude, shifted by SHIFTX and SHIFTY as in CalculiX."""
    keyword.check()
    numbers = [
        line.real(column, "a time or a value")
        for line in lines(keyword)
        for column, text in enumerate(line.texts)
        if text
    ]
    if len(numbers) < 2 or len(numbers) % 2:
        keyword.refuse(f"found {len(numbers)} numbers, expected pairs of a time and a value")
    table = np.array(numbers).reshape(-1, 2)
    if (np.diff(table[:, 0]) < 0).any():
        keyword.refuse("the times do not increase; sort them")
    shift = parameter(keyword, "SHIFTX", 0.0), parameter(keyword, "SHIFTY", 0.0)
    return table[:, 0] + shift[0], table[:, 1] + shift[1]


Key = TypeVar("Key")
Value = TypeVar("Value")


def in_force(
    deck: Deck,
    names: Sequence[str],
    read: Callable[[Keyword], Iterable[tuple[Key, Value]]],
) -> Iterator[dict[Key, list[tuple[Value, Keyword]]]]:
    """Yield the loads in force with their keywords, step by step from 0.

    A later step replaces loads that it defines again; within a step values add up. OP=NEW removes
    loads of earlier steps by keywords of that name; these do not act in linear perturbations.
    ``read`` yields target and value of each load of a keyword.
    """
    loads: dict[Key, list[tuple[Value, Keyword]]] = {}
    for step in range(deck.n_step + 1):
        loads = {} if step in deck.perturbations else loads
        new: dict[Key, list[tuple[Value, Keyword]]] = {}
        for keyword in (k for k in deck.of(*names) if k.step == step):
            if keyword.choice("OP") == "NEW":
                loads = {k: v for k, v in loads.items() if v[0][1].name != keyword.name}
            for key, value in read(keyword):
                new.setdefault(key, []).append((value, keyword))
        loads = {**loads, **new}
        yield loads


Forces = dict[tuple[int, int], float]


def read_concentrated(data: DeckData, amplitudes: Amplitudes) -> Iterator[Forces]:
    """Yield the *CLOAD in force, step by step from 0: values by (node, component) of the deck.

    Loads are in force as in :func:`in_force`.
    """
    deck = data.deck
    for load in deck.of("CLOAD"):
        amplitudes.note(load, deck.ignored)
        if _is_imaginary(load):
            deck.ignored.append(
                f"{load.where()}: *CLOAD, LOAD CASE=2: the imaginary part of a harmonic load; "
                "the load of the step is the real part"
            )
        if load.has("OMEGA0"):
            deck.ignored.append(f"{load.where()}: OMEGA0 of *CLOAD: static loads have no frequency")
    for step, forces in enumerate(in_force(deck, ("CLOAD",), partial(_concentrated, data=data))):
        yield {
            dof: sum(value * amplitudes.factor(keyword, step) for value, keyword in values)
            for dof, values in forces.items()
        }


def _is_imaginary(keyword: Keyword) -> bool:
    """Return whether forces are the imaginary part of a harmonic load."""
    return keyword.choice("LOAD CASE", "1") == "2"


def _concentrated(keyword: Keyword, data: DeckData) -> Iterator[tuple[tuple[int, int], float]]:
    if _is_imaginary(keyword):
        return
    for line in lines(keyword, (3,), "node or node set, degree of freedom, force"):
        c, value = component(line, 1), line.real(2, "a force")
        for node in data.find(line).tolist():
            yield (node, c), value


def concentrated_forces(forces: Forces, data: DeckData) -> Matrix:
    """Return forces and moments (n_node, 6) in the basic frame."""
    result = np.zeros((len(data.nodes.ids), 6))
    for dof, value in forces.items():
        for node, c, factor in data.parts(*dof):
            result[node, c] += value * factor
    return result


LoadKey = tuple[str, str]


def read_distributed(
    data: DeckData, assembly: Assembly, surfaces: Surfaces, amplitudes: Amplitudes
) -> Iterator[Matrix]:
    """Yield the forces (n_node, 6) of all distributed loads in force, step by step from 0.

    Loads are in force as in :func:`in_force`, by kind and set or surface. The assembly has
    all elements, for gravity.
    """
    for keyword in data.deck.of("DLOAD", "DSLOAD"):
        amplitudes.note(keyword, data.deck.ignored)
    read = partial(_lines, assembly=assembly, sets=data.element_sets, surfaces=surfaces)
    for step, loads in enumerate(in_force(data.deck, ("DLOAD", "DSLOAD"), read)):
        total = np.zeros((len(assembly.mesh.nodes), 6))
        for forces, keyword in (load for loads_of_key in loads.values() for load in loads_of_key):
            total += amplitudes.factor(keyword, step) * forces
        yield total


def _lines(
    keyword: Keyword, assembly: Assembly, sets: NamedSets, surfaces: Surfaces
) -> Iterator[tuple[LoadKey, Matrix]]:
    for line in lines(keyword):
        if len(line) < 3:
            line.refuse(f"found {len(line)} fields, expected a set, a kind of load and its value")
        label, kind = line.text(0), line.text(1).upper()
        key = (f"{keyword.name} {label.upper()}", kind)
        if keyword.name == "DSLOAD":
            if kind != "P" or len(line) != 3:
                line.refuse(f"load {kind} is not supported; P (pressure) is")
            surface = find_surface(surfaces, keyword, label, line.row)
            if not len(surface.facets):
                line.refuse(f"surface '{label}' has no facets for a pressure")
            yield key, _pressure(assembly, surface.facets, line.real(2, "a pressure"))
        elif kind in _BODY_FORCES:
            yield key, _body_force(line, assembly, sets)
        elif kind == "P" and len(line) == 3:
            yield key, _on_shells(line, assembly, sets)
        elif len(kind) == 2 and kind[0] == "P" and len(line) == 3:
            face = replace(line, texts=[kind[1]]).integer(0, "a face P1 … P6")
            ids = sets.members(keyword, label, line.row)
            facets = faces_of_solids(
                keyword, assembly.mesh, ids, np.full(len(ids), face), np.full(len(ids), line.row)
            )
            value = line.real(2, "a pressure")
            yield key, _pressure(assembly, facets, value)
        else:
            line.refuse(
                f"load {kind} is not supported; P1 … P6 (pressure), P on shells, GRAV and CENTRIF "
                "are"
            )


def _pressure(assembly: Assembly, facets: Indices, value: float) -> Matrix:
    """Return nodal forces -p ∫ N n dA; pressure acts against the outward normal."""
    nodes = assembly.mesh.nodes
    forces = np.zeros((len(nodes), 6))
    for kind, table in nodes_by_kind(facets).items():
        of_faces = nodal_forces(kind, -value * face_areas(kind, nodes[table]))
        np.add.at(forces[:, :3], table, of_faces)
    return forces


def _on_shells(line: Line, assembly: Assembly, sets: NamedSets) -> Matrix:
    """Return the nodal forces of a pressure on shells, which acts along their normal."""
    ids = sets.members(line.keyword, line.text(0), line.row)
    shells = [padded(block.nodes[np.isin(block.ids, ids)]) for block in assembly.shells]
    facets = np.concatenate([np.empty((0, WIDTH), dtype=np.int64), *shells])
    if len(facets) != len(ids):
        line.refuse(
            f"{line.text(0)} has not only shells; P is a pressure on shells, P1 … P6 on solids"
        )
    return _pressure(assembly, facets, -line.real(2, "a pressure"))


def _body_force(line: Line, assembly: Assembly, sets: NamedSets) -> Matrix:
    """Return nodal forces M a of an acceleration, consistent with the mass of every element."""
    label, kind = line.text(0), line.text(1).upper()
    expected = _BODY_FORCES[kind]
    line.check((len(expected.split(", ")),), expected)
    values = np.array(line.behind(2).reals("a number"))
    length = float(np.linalg.norm(values[-3:]))
    if not length > 0:
        line.refuse(f"the direction of {kind} is zero")
    direction = values[-3:] / length
    chosen = assembly
    if label:
        ids = sets.members(line.keyword, label, line.row)
        solids = [block.taken(np.isin(block.ids, ids)) for block in assembly.mesh.blocks]
        shells = [block.taken(np.isin(block.ids, ids)) for block in assembly.shells]
        loaded = set(ids.tolist())
        chosen = replace(
            assembly,
            mesh=replace(assembly.mesh, blocks=tuple(b for b in solids if len(b.ids))),
            beams=tuple(beam for beam in assembly.beams if beam.id in loaded),
            shells=tuple(block for block in shells if len(block.ids)),
            masses=tuple(mass for mass in assembly.masses if mass.id in loaded),
        )
    nodes = assembly.mesh.nodes
    if kind == "GRAV":
        return body_forces(chosen, np.tile(values[0] * direction, (len(nodes), 1)))
    return body_forces(chosen, centrifugal(float(values[0]), values[1:4], direction, nodes))


_BODY_FORCES = {
    "GRAV": "set, GRAV, acceleration, x, y, z",
    "CENTRIF": "set, CENTRIF, square of angular velocity, x, y, z of the axis, x, y, z along it",
}
"""Body forces and their fields."""
