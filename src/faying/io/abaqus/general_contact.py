"""``*CONTACT``: contact of everything, as interfaces between the bodies that face each other."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import product

import numpy as np

from faying._typing import Indices
from faying.interface.facing import facing_bodies
from faying.io.abaqus.contact import Interaction
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.keyword import Keyword
from faying.io.solid_cuts import Cut
from faying.model.assembly import Assembly
from faying.model.bodies import bodies, body_names
from faying.model.specs import InterfaceSpec

EVERYTHING = (
    "general contact: an interface for each pair of bodies whose faces touch, or face each other "
    "within half a facet; bodies that are tied or in a contact pair with each other have none"
)

SEEN_ACROSS = 1.01
"""Search distance over the largest gap that was found, so that none is lost by rounding."""


def read_general_contact(
    deck: Deck,
    assembly: Assembly,
    interactions: Mapping[str, Interaction],
    joined: Collection[frozenset[int]],
    ignored: list[str],
) -> tuple[InterfaceSpec, ...]:
    """Return the interfaces of ``*CONTACT INCLUSIONS, ALL EXTERIOR``; none without it.

    Parameters
    ----------
    joined
        Pairs of bodies that are tied, cut from one another or in a contact pair.

    Raises
    ------
    FormatError
        If the contact is of some surfaces only, or has properties that differ among them.
    """
    everything = deck.of("CONTACT INCLUSIONS")
    assigned = deck.of("CONTACT PROPERTY ASSIGNMENT")
    for keyword in everything:
        keyword.allow("ALL EXTERIOR")
        if not keyword.has("ALL EXTERIOR") or keyword.rows():
            message = "only ALL EXTERIOR is read; define *CONTACT PAIR for surfaces"
            raise keyword.error(message)
    if not everything:
        return ()
    found = _interaction(assigned, interactions)
    if found is None:
        message = "it needs *CONTACT PROPERTY ASSIGNMENT with one *SURFACE INTERACTION"
        raise everything[0].error(message)
    ignored.append(EVERYTHING)
    names = body_names(assembly.mesh)
    return tuple(
        InterfaceSpec(
            name=f"{found.name} {names[one.minus]} {names[one.plus]}",
            minus=f"body {one.minus}",
            plus=f"body {one.plus}",
            penalty=found.penalty,
            meshes="matching" if one.matching else "non-matching",
            friction=found.friction.coefficient,
            tangential_penalty=found.friction.tangential_penalty,
            search_distance=None if one.touching else SEEN_ACROSS * one.gap[1],
        )
        for one in facing_bodies(assembly)
        if frozenset((one.minus, one.plus)) not in joined
    )


def _interaction(
    assigned: list[Keyword], interactions: Mapping[str, Interaction]
) -> Interaction | None:
    """Return the one interaction that holds everywhere."""
    found = None
    for keyword in assigned:
        keyword.allow()
        for row, fields in enumerate(keyword.rows()):
            name = fields[2].strip("\"' ").upper() if len(fields) == 3 else ""
            if found is not None or any(fields[:2]) or name not in interactions:
                message = (
                    f"found '{', '.join(fields)}', expected one line ' , , name' of a *SURFACE "
                    "INTERACTION; define *CONTACT PAIR where surfaces differ"
                )
                raise keyword.error(message, row)
            found = interactions[name]
            if found.tied:
                message = "general contact that is TIED is not supported; give *TIE"
                raise keyword.error(message, row)
    return found


def joined_bodies(
    assembly: Assembly, cuts: Sequence[Cut], sides: Sequence[tuple[Indices, Indices]]
) -> set[frozenset[int]]:
    """Return the pairs of bodies on both sides of cuts, or of pairs of surfaces by their nodes."""
    labels = bodies(assembly.mesh)
    both = [*sides, *((cut.kept, cut.copies) for cut in cuts)]
    return {pair for one, other in both for pair in _pairs(labels[one], labels[other])}


def _pairs(one: Indices, other: Indices) -> Iterator[frozenset[int]]:
    for a, b in product(np.unique(one).tolist(), np.unique(other).tolist()):
        yield frozenset((a, b))
