"""``*TIE``: surfaces that move together."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, SparseMatrix
from faying.interface.across import declared_area, pairs_across
from faying.interface.mortar import find_couplings
from faying.io.abaqus.contact import Pair, with_mixed_sides
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.surfaces import DeckSurface, Surfaces, slave_and_master
from faying.model.assembly import Assembly, Equation
from faying.model.specs import InterfaceSpec
from faying.model.surface import N_CORNERS

DEFAULT_TOLERANCE = 0.05
"""Position tolerance over the mean edge of the master surface where a deck gives none (Abaqus)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Tie:
    """A tie: nodes of the slave follow the master where they lie within the tolerance."""

    keyword: Keyword
    name: str
    slave: DeckSurface
    master: DeckSurface
    tolerance: float | None


def read_ties(
    deck: Deck, surfaces: Surfaces, pairs: Sequence[Pair], ignored: list[str]
) -> list[Tie]:
    """Read all *TIE, behind the contact pairs that are tied.

    Raises
    ------
    FormatError
        Naming the line of a surface that is not there, or a master without facets.
    """
    found = [
        Tie(
            keyword=pair.keyword,
            name=pair.interaction,
            slave=pair.slave,
            master=pair.master,
            tolerance=None,
        )
        for pair in pairs
    ]
    for keyword in deck.of("TIE"):
        keyword.allow("NAME", "ADJUST", "POSITION TOLERANCE", "TYPE", "NO ROTATION", "NO THICKNESS",
                      "CONSTRAINT RATIO")  # fmt: skip
        tolerance = None
        if keyword.has("POSITION TOLERANCE"):
            tolerance = real(keyword, None, keyword.required("POSITION TOLERANCE"), "a tolerance")
        for row, fields in enumerate(keyword.rows()):
            slave, master = slave_and_master(surfaces, keyword, row, fields)
            name = keyword.value("NAME", f"{slave.name} {master.name}")
            found.append(
                Tie(keyword=keyword, name=name, slave=slave, master=master, tolerance=tolerance)
            )
    if found:
        ignored.append(
            "*TIE, TIED: slave and master move together where facets see each other within the "
            "position tolerance, node by node where meshes match and else in the mean (mortar); no "
            "node is adjusted"
        )
    return found


def with_ties(assembly: Assembly, ties: Sequence[Tie], ignored: list[str]) -> Assembly:
    """Add the equations of ties.

    Raises
    ------
    FormatError, ModelError
        If a surface cannot be told by its nodes, or the two see nothing of each other.
    """
    sides = [side for tie in ties for side in (tie.slave, tie.master)]
    named = replace(assembly, mesh=with_mixed_sides(assembly.mesh, sides))
    first = max((equation.id for equation in assembly.equations), default=0) + 1
    equations: list[Equation] = []
    for tie in ties:
        spec = InterfaceSpec(
            name=tie.name,
            minus=tie.slave.name,
            plus=tie.master.name,
            meshes="non-matching",
            search_distance=_tolerance(assembly, tie),
        )
        share = 1.0
        pairs = _pairs(named, spec)
        if len(pairs):
            motions = _node_on_node(pairs, len(assembly.mesh.nodes))
        else:
            (coupling,) = find_couplings(named, spec).values()
            motions = coupling.pairs[:, 0], coupling.motion
            share = float(coupling.weights.sum()) / (declared_area(named, spec) or np.inf)
        if share < 0.99:
            ignored.append(f"*TIE {tie.name}: {share:.0%} of the smaller surface is tied")
        equations += _equations(*motions, first + len(equations))
    return replace(assembly, equations=(*assembly.equations, *equations))


def _tolerance(assembly: Assembly, tie: Tie) -> float:
    if tie.tolerance is not None:
        return tie.tolerance
    edges = [
        np.linalg.norm(np.roll(corners, 1, axis=1) - corners, axis=2).ravel()
        for kind, facets in tie.master.facets.items()
        for corners in [assembly.mesh.nodes[facets[:, : N_CORNERS[kind]]]]
    ]
    return DEFAULT_TOLERANCE * float(np.concatenate(edges).mean())


def _pairs(assembly: Assembly, spec: InterfaceSpec) -> Indices:
    """Return the pairs of nodes (n, 2) of surfaces that match; none where they do not."""
    faces = pairs_across(assembly, spec)
    both = [np.column_stack([part.minus.ravel(), part.plus.ravel()]) for part in faces]
    pairs: Indices = np.unique(np.concatenate([np.empty((0, 2), dtype=np.int64), *both]), axis=0)
    return pairs


def _node_on_node(pairs: Indices, n_node: int) -> tuple[Indices, SparseMatrix]:
    rows = np.arange(len(pairs))
    ones = np.ones(len(pairs))
    plus = sp.csr_array((ones, (rows, pairs[:, 1])), shape=(len(pairs), n_node))
    return pairs[:, 0], plus - sp.csr_array((ones, (rows, pairs[:, 0])), shape=plus.shape)


def _equations(own: Indices, motion: SparseMatrix, first: int) -> Iterator[Equation]:
    """Yield the equations of the relative displacements, for the slave's own nodes first."""
    table = motion.tocsr()
    number = first
    for row, node in enumerate(own.tolist()):
        part = slice(table.indptr[row], table.indptr[row + 1])
        terms = dict(zip(table.indices[part].tolist(), table.data[part].tolist(), strict=True))
        mine = terms.pop(node, 0.0)
        for c in range(3 if mine else 0):  # nodes that see nothing are not tied
            yield Equation(
                id=number,
                terms=((node, c, mine), *((other, c, value) for other, value in terms.items())),
            )
            number += 1
