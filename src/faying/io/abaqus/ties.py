"""``*TIE``: surfaces that move together."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying.io.abaqus.contact import Pair, with_mixed_sides
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import real
from faying.io.abaqus.keyword import Keyword
from faying.io.abaqus.surfaces import DeckSurface, Surfaces, slave_and_master
from faying.io.tied_surfaces import moving_together
from faying.model.assembly import Assembly
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
            "position tolerance, node by node where meshes match and else in the mean (mortar), "
            "which gives way some percent more on coarse meshes; no node is adjusted"
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
    specs = [
        InterfaceSpec(
            name=tie.name,
            minus=tie.slave.name,
            plus=tie.master.name,
            meshes="non-matching",
            search_distance=_tolerance(assembly, tie),
        )
        for tie in ties
    ]
    equations, partial = moving_together(named, specs)
    ignored += [
        f"*TIE {name}: {share:.0%} of the smaller surface is tied" for name, share in partial
    ]
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
