"""``*CONTACT``: interfaces between bodies that face each other, or between listed surfaces."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import product

from faying._typing import Indices
from faying.exceptions import ModelError
from faying.interface.facing import facing_bodies
from faying.interface.mortar import find_couplings
from faying.interface.selection import DEFAULT_TOLERANCE
from faying.io.abaqus.contact import Pair
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.fields import lines
from faying.io.abaqus.interactions import Interaction
from faying.io.abaqus.surfaces import Surfaces, find_surface, slave_and_master
from faying.io.solid_cuts import Cut
from faying.model.assembly import Assembly
from faying.model.bodies import body_names
from faying.model.specs import GapRule, InterfaceSpec

EVERYTHING = (
    "general contact: an interface for each pair of bodies whose faces touch, or face each other "
    "within half a facet; bodies that are tied or in a contact pair with each other have none"
)

LISTED = (
    "general contact of listed surfaces: an interface for each pair, whose first surface has the "
    "contact points; overlaps start in contact without strain, as Abaqus adjusts them"
)


def read_general_contact(
    deck: Deck,
    assembly: Assembly,
    interactions: Mapping[str, Interaction],
    surfaces: Surfaces,
    joined: Collection[frozenset[int]],
) -> tuple[InterfaceSpec, ...]:
    """Return the interfaces of ``*CONTACT INCLUSIONS, ALL EXTERIOR``; none without it.

    ``joined`` bodies are tied, cut from each other or in a contact pair.
    """
    everything = [k for k in deck.of("CONTACT INCLUSIONS") if k.has("ALL EXTERIOR")]
    if not everything:
        return ()
    chosen, interaction = _assigned(deck, interactions, surfaces)
    for keyword in everything:
        if keyword.rows():
            keyword.refuse("ALL EXTERIOR includes all surfaces; list surfaces without it")
    if interaction is None or chosen:
        everything[0].refuse(
            "it needs *CONTACT PROPERTY ASSIGNMENT with one *SURFACE INTERACTION for all pairs; "
            "define *CONTACT PAIR where surfaces differ"
        )
    deck.ignored.append(EVERYTHING)
    names = body_names(assembly.mesh)
    specs = (
        replace(
            interaction.spec,
            name=f"{interaction.spec.name} {names[pair.minus]} {names[pair.plus]}",
            minus=f"body {pair.minus}",
            plus=f"body {pair.plus}",
            meshes="matching" if pair.matching else "non-matching",
            search_distance=None if pair.touching else (1 + DEFAULT_TOLERANCE) * pair.gap[1],
        )
        for pair in facing_bodies(assembly)
        if frozenset((pair.minus, pair.plus)) not in joined
    )
    return tuple(spec for spec in specs if _meet(assembly, spec, deck.ignored))


def _meet(assembly: Assembly, spec: InterfaceSpec, ignored: list[str]) -> bool:
    """Return whether two bodies share some area, rather than only an edge."""
    if spec.meshes == "matching":
        return True
    try:
        find_couplings(assembly, spec)
    except ModelError as error:
        ignored.append(f"general contact leaves out two bodies close to each other: {error}")
        return False
    return True


def read_listed(
    deck: Deck, interactions: Mapping[str, Interaction], surfaces: Surfaces
) -> list[Pair]:
    """Return the pairs of surfaces listed in ``*CONTACT INCLUSIONS``."""
    pairs = []
    chosen, everywhere = _assigned(deck, interactions, surfaces)
    for keyword in deck.of("CONTACT INCLUSIONS"):
        if keyword.has("ALL EXTERIOR"):
            continue
        for line in lines(keyword):
            slave, master = slave_and_master(surfaces, line)
            sides = frozenset((slave.name, master.name))
            interaction = chosen.pop(sides, everywhere)
            if interaction is None:
                line.refuse("*CONTACT PROPERTY ASSIGNMENT gives this pair no *SURFACE INTERACTION")
            pairs.append(
                Pair(
                    line=line,
                    slave=slave,
                    master=master,
                    interaction=interaction,
                    adjusted=GapRule(closed_up_to=0.0),
                )
            )
    if pairs:
        deck.ignored.append(LISTED)
    if pairs and chosen:
        names = " and ".join(sorted(next(iter(chosen))))
        deck.of("CONTACT PROPERTY ASSIGNMENT")[0].refuse(
            f"surfaces {names} have a property, but are not a pair of *CONTACT INCLUSIONS"
        )
    return pairs


def _assigned(
    deck: Deck, interactions: Mapping[str, Interaction], surfaces: Surfaces
) -> tuple[dict[frozenset[str], Interaction], Interaction | None]:
    """Return the interactions of pairs of surfaces by name, and of all other pairs."""
    chosen: dict[frozenset[str], Interaction] = {}
    everywhere = None
    for keyword in deck.of("CONTACT PROPERTY ASSIGNMENT"):
        for line in lines(keyword):
            fields = line.texts[:2]
            name = line.text(2).strip("\"' ").upper() if len(line) == 3 else ""
            twice = everywhere is not None and not any(fields)
            if twice or name not in interactions or any(fields) != all(fields):
                line.refuse(
                    f"found '{', '.join(line.texts)}', expected two surfaces, or none on one line "
                    "for all pairs, and the name of a *SURFACE INTERACTION"
                )
            if interactions[name].tied:
                line.refuse("general contact that is TIED is not supported; give *TIE")
            if any(fields):
                sides = [find_surface(surfaces, keyword, text, line.row).name for text in fields]
                chosen[frozenset(sides)] = interactions[name]
            else:
                everywhere = interactions[name]
    return chosen, everywhere


def joined_bodies(
    assembly: Assembly, cuts: Sequence[Cut], sides: Sequence[tuple[Indices, Indices]]
) -> set[frozenset[int]]:
    """Return the pairs of bodies on both sides of cuts, or of pairs of node sets."""
    labels = assembly.mesh.bodies
    both = [*sides, *((cut.originals, cut.copies) for cut in cuts)]
    return {
        frozenset(pair)
        for minus, plus in both
        for pair in product(set(labels[minus].tolist()), set(labels[plus].tolist()))
    }
