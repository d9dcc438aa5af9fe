"""``*TIE``: tied surfaces."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Matrix
from faying.io.abaqus.contact import Pair
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import lines, parameter
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.surfaces import DeckSurface, Surfaces, slave_and_master
from faying.io.tied_surfaces import following, moving_together, with_elastic_layer
from faying.model.assembly import Assembly, Equation
from faying.model.specs import InterfaceSpec
from faying.model.surface import corner_nodes

DEFAULT_TOLERANCE = 0.05
"""Default position tolerance over the mean edge of the master surface, as in Abaqus."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Tie:
    """A tie: slave nodes within the tolerance follow the master."""

    keyword: Keyword
    name: str
    slave: DeckSurface
    master: DeckSurface
    tolerance: float | None
    stiffness: tuple[float, float] | None = None
    """Normal and tangential slopes [force/length³]; None is rigid."""


def read_ties(deck: Deck, surfaces: Surfaces, pairs: Sequence[Pair]) -> list[Tie]:
    """Return all *TIE, after the tied contact pairs."""
    ties = [
        Tie(
            keyword=pair.line.keyword,
            name=pair.interaction.spec.name,
            slave=pair.slave,
            master=pair.master,
            tolerance=None,
            stiffness=_stiffness(pair),
        )
        for pair in pairs
    ]
    for keyword in deck.of("TIE"):
        tolerance = None
        if keyword.has("POSITION TOLERANCE"):
            tolerance = parameter(keyword, "POSITION TOLERANCE")
        for line in lines(keyword):
            slave, master = slave_and_master(surfaces, line)
            name = keyword.value("NAME", f"{slave.name} {master.name}")
            ties.append(
                Tie(keyword=keyword, name=name, slave=slave, master=master, tolerance=tolerance)
            )
    if any(tie.stiffness is None for tie in ties):
        deck.ignored.append(
            "*TIE, TIED: slave and master move together where facets face each other within the "
            "position tolerance, node by node where meshes match, otherwise in the mean (mortar), "
            "which is softer on coarse meshes (0.1 % on blocks of two and three linear "
            "bricks, 4 % of quadratic ones); unless ADJUST=NO slave nodes are moved there"
        )
    return ties


def with_ties(assembly: Assembly, ties: Sequence[Tie], ignored: list[str]) -> Assembly:
    """Return the assembly with the equations of ties.

    Raises
    ------
    FormatError, ModelError
        If the two surfaces do not face each other.
    """
    of_nodes = [tie for tie in ties if not len(tie.slave.facets)]
    of_facets = [tie for tie in ties if len(tie.slave.facets)]
    for tie in ties:
        if not (tie.slave.height or tie.master.height):
            continue
        ignored.append(f"{tie.name}: ties of shells hold their nodes, half a thickness off")
        if tie.stiffness is None:
            tie.keyword.refuse(
                "ties of shells, which include rotations, are not supported; share nodes"
            )
    for tie in of_nodes:
        if tie.stiffness is not None:
            tie.keyword.refuse(
                f"slave surface '{tie.slave.name}' has nodes only; a TIED pair needs element faces"
            )
    specs = {
        tie: InterfaceSpec(
            name=tie.name,
            minus=tie.slave.name,
            plus=tie.master.name,
            meshes="non-matching",
            search_distance=_tolerance(assembly, tie) + tie.slave.height + tie.master.height,
        )
        for tie in of_facets
    }
    rigid = [spec for tie, spec in specs.items() if tie.stiffness is None]
    equations, partial = moving_together(assembly, rigid)
    ignored += [
        f"*TIE {name}: {share:.0%} of the smaller surface is tied" for name, share in partial
    ]
    all_equations = (*assembly.equations, *equations)
    for tie in of_nodes:
        all_equations += _following(assembly, tie, ignored)
    moved = _adjusted(assembly.mesh.nodes, ties, all_equations[len(assembly.equations) :])
    mesh = replace(assembly.mesh, nodes=moved)
    assembly = replace(assembly, equations=all_equations, mesh=mesh)
    for tie, spec in specs.items():
        if tie.stiffness is not None:
            assembly = with_elastic_layer(assembly, spec, *tie.stiffness)
    return assembly


def _adjusted(nodes: Matrix, ties: Sequence[Tie], equations: Sequence[Equation]) -> Matrix:
    """Return node coordinates (n_node, 3) with slave nodes adjusted, except for ADJUST=NO.

    Across a gap, equations between translations would prevent rigid rotations.
    """
    moving = [tie for tie in ties if tie.keyword.value("ADJUST", "YES").upper() != "NO"]
    slaves = {node for tie in moving for node in tie.slave.nodes.tolist()}
    places = nodes.copy()
    for equation in equations:
        (node, c, mine), *others = equation.terms
        if node in slaves:
            places[node, c] = -sum(value * places[other, c] for other, _, value in others) / mine
    return places


def _stiffness(pair: Pair) -> tuple[float, float] | None:
    normal, along = pair.interaction.spec.penalty, pair.interaction.spec.tangential_penalty
    return (normal, along) if isinstance(normal, float) and isinstance(along, float) else None


def _following(assembly: Assembly, tie: Tie, ignored: list[str]) -> tuple[Equation, ...]:
    """Return the equations of a tie with a slave surface of nodes, and note untied nodes."""
    tolerance = _tolerance(assembly, tie)
    equations, n_tied = following(assembly, tie.slave.nodes, tie.master.name, tolerance)
    if not n_tied:
        tie.keyword.refuse(
            f"no node of slave surface '{tie.slave.name}' lies within {tolerance:g} of master "
            f"surface '{tie.master.name}'; give POSITION TOLERANCE, or correct the surfaces"
        )
    note = f"*TIE {tie.name}: each slave node follows the nearest point of the master"
    beyond = len(tie.slave.nodes) - n_tied
    if beyond:
        note += f"; {beyond} of {len(tie.slave.nodes)} lie beyond {tolerance:g} of it and do not"
    ignored.append(note)
    return equations


def _tolerance(assembly: Assembly, tie: Tie) -> float:
    if tie.tolerance is not None:
        return tie.tolerance
    corners = assembly.mesh.nodes[corner_nodes(tie.master.facets)]
    edges = np.linalg.norm(np.roll(corners, 1, axis=1) - corners, axis=2)
    # A triangle repeats its last corner.
    return DEFAULT_TOLERANCE * float(edges[edges > 0].mean())
