"""``*DLOAD`` and ``*DSLOAD``: pressures and body forces as consistent nodal forces."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.io.abaqus.amplitudes import Amplitudes
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import check_count, integer, numbers, real
from faying.io.abaqus.in_force import in_force
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.sets import NamedSets
from faying.io.abaqus.surfaces import Surfaces, facets_of_faces, find_surface
from faying.io.element_faces import face_areas, nodal_forces
from faying.model.assembly import Assembly
from faying.model.body_forces import body_forces, centrifugal

Key = tuple[str, str]


def read_distributed(
    deck: Deck, assembly: Assembly, sets: NamedSets, surfaces: Surfaces, amplitudes: Amplitudes
) -> Iterator[Matrix]:
    """Yield the forces (n_node, 6) of all distributed loads in force, step by step from 0.

    As of :func:`~.in_force.in_force`, of the same kind on the same set or surface. The assembly has
    all elements, whose mass gravity acts on.
    """
    for keyword in deck.of("DLOAD", "DSLOAD"):
        amplitudes.note(keyword, deck.ignored)
    read = partial(_lines, assembly=assembly, sets=sets, surfaces=surfaces)
    for step, loads in enumerate(in_force(deck, ("DLOAD", "DSLOAD"), read)):
        total = np.zeros((len(assembly.mesh.nodes), 6))
        for forces, keyword in (load for loads_of_key in loads.values() for load in loads_of_key):
            total += amplitudes.factor(keyword, step) * forces
        yield total


def _lines(
    keyword: Keyword, assembly: Assembly, sets: NamedSets, surfaces: Surfaces
) -> Iterator[tuple[Key, Matrix]]:
    for row, fields in enumerate(keyword.rows()):
        if len(fields) < 3:
            keyword.refuse(
                f"found {len(fields)} fields, expected a set, a kind of load and its value", row
            )
        kind = fields[1].upper()
        key = (f"{keyword.name} {fields[0].upper()}", kind)
        if keyword.name == "DSLOAD":
            if kind != "P" or len(fields) != 3:
                keyword.refuse(f"load {kind} is not supported; P (pressure) is", row)
            surface = find_surface(surfaces, keyword, fields[0], row)
            if not surface.facets:
                keyword.refuse(f"surface '{fields[0]}' has no facets for a pressure", row)
            value = real(keyword, row, fields[2], "a pressure")
            yield key, _pressure(assembly, surface.facets, value)
        elif kind in _BODY_FORCES:
            yield key, _body_force(keyword, row, fields, assembly, sets)
        elif kind == "P" and len(fields) == 3:
            value = real(keyword, row, fields[2], "a pressure")
            yield key, _on_shells(keyword, row, fields[0], assembly, sets, value)
        elif len(kind) == 2 and kind[0] == "P" and len(fields) == 3:
            face = integer(keyword, row, kind[1], "a face P1 … P6")
            ids = sets.members(keyword, fields[0], row)
            facets = facets_of_faces(
                keyword, assembly.mesh, ids, np.full(len(ids), face), np.full(len(ids), row)
            )
            yield key, _pressure(assembly, facets, real(keyword, row, fields[2], "a pressure"))
        else:
            keyword.refuse(
                f"load {kind} is not supported; P1 … P6 (pressure), P on shells, GRAV and CENTRIF "
                "are",
                row,
            )


def _pressure(assembly: Assembly, facets: Mapping[str, Indices], value: float) -> Matrix:
    """Return forces -p ∫ N n dA; pressure pushes against the outward normal."""
    nodes = assembly.mesh.nodes
    forces = np.zeros((len(nodes), 6))
    for kind, table in facets.items():
        of_faces = nodal_forces(kind, -value * face_areas(kind, nodes[table]))
        np.add.at(forces[:, :3], table, of_faces)
    return forces


def _on_shells(
    keyword: Keyword, row: int, label: str, assembly: Assembly, sets: NamedSets, value: float
) -> Matrix:
    """Return the forces of a pressure on shells, which pushes along their normal."""
    ids = sets.members(keyword, label, row)
    parts = [(block.kind, block.nodes[np.isin(block.ids, ids)]) for block in assembly.shells]
    if sum(len(nodes) for _, nodes in parts) != len(ids):
        keyword.refuse(
            f"{label} is not of shells alone; P is a pressure on shells, P1 … P6 on solids", row
        )
    forces = np.zeros((len(assembly.mesh.nodes), 6))
    for kind, nodes in parts:
        forces += _pressure(assembly, {kind: nodes}, -value)
    return forces


def _body_force(
    keyword: Keyword, row: int, fields: list[str], assembly: Assembly, sets: NamedSets
) -> Matrix:
    """Return forces M a of an acceleration, consistent with the mass of every element."""
    kind = fields[1].upper()
    width, expected, acceleration = _BODY_FORCES[kind]
    check_count(keyword, row, fields, (width,), expected)
    values = np.array(numbers(keyword, row, fields[2:], "a number"))
    direction, length = values[-3:], float(np.linalg.norm(values[-3:]))
    if not length > 0:
        keyword.refuse(f"the direction of {kind} is zero", row)
    chosen = assembly
    if fields[0]:
        ids = sets.members(keyword, fields[0], row)
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
    return body_forces(chosen, acceleration(values[:-3], direction / length, nodes))


def _gravity(amount: Vector, direction: Vector, nodes: Matrix) -> Matrix:
    return np.tile(amount[0] * direction, (len(nodes), 1))


def _centrifugal(amount: Vector, direction: Vector, nodes: Matrix) -> Matrix:
    return centrifugal(float(amount[0]), amount[1:], direction, nodes)


_BODY_FORCES: Mapping[str, tuple[int, str, Callable[[Vector, Vector, Matrix], Matrix]]] = {
    "GRAV": (6, "set, GRAV, acceleration, x, y, z", _gravity),
    "CENTRIF": (
        9,
        "set, CENTRIF, square of the angular velocity, point of the axis, its direction",
        _centrifugal,
    ),
}
"""Number of fields, what they are, and the acceleration (n_node, 3) they give nodes."""
