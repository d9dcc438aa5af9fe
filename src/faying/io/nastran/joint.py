"""Nastran decks with their contact and bolts."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike

import numpy as np

from faying._typing import Indices
from faying.exceptions import refuse
from faying.io.deck_lines import naming
from faying.io.left_out import IGNORABLE, checked_ignore
from faying.io.nastran.bolts import cut_bolts, read_bolts
from faying.io.nastran.contact_msc import friction_of_all_bodies, read_msc_pairs
from faying.io.nastran.contact_pairs import (
    Pair,
    check_distinct,
    glue_distance,
    spec_of,
    with_shell_sides,
)
from faying.io.nastran.contact_simcenter import read_simcenter_pairs
from faying.io.nastran.free_strains import with_free_strains
from faying.io.nastran.reader import Deck, read_parts
from faying.io.nastran.regions import Region, read_regions
from faying.io.solid_cuts import close_cuts, origins
from faying.io.tied_surfaces import moving_together
from faying.model.assembly import Assembly
from faying.model.deck_bolt import axial_stiffness, bolt_axis_element
from faying.model.description import JointDescription
from faying.model.specs import InterfaceSpec


def read_joint(
    path: str | PathLike[str], *, subcase: int | None = None, ignore: Sequence[str] = ()
) -> JointDescription:
    """Read a deck, its contact definitions as interfaces and its bolts with their pretension.

    Contact is BCTSET (Simcenter, selected by BCSET) or BCTABLE, BCTABL1, BCONECT (MSC, selected by
    BCONTACT); interfaces are named ``contact-<source>-<target>`` after ids of regions or bodies,
    with the source (secondary, slave) as minus side, or ``contact`` if all bodies may touch
    (BCONTACT = ALLBODY). Glue (BGSET, IGLUE, TIED) becomes equations. Bolts are BOLT of CBAR and
    CBEAM, or of cut solids, with BOLTFOR, selected by BOLTLD, or MSC's with a force on
    their control grids; they are named ``bolt-<id>``.

    Parameters
    ----------
    path
        The deck; see :func:`faying.io.nastran.read_deck` for what is read.
    subcase
        Subcase whose selections count; the first unless given.
    ignore
        Features of the deck to leave out of the model: words of
        :data:`faying.io.left_out.IGNORABLE`, which explains each.

    Raises
    ------
    FormatError
        With file and line: see :func:`faying.io.nastran.read_deck`, or if the contact or a bolt has
        unsupported features (interference).

    Notes
    -----
    A deck with case control but without BCSET or BCONTACT has no active contact; its contact
    is then named in ``assembly.ignored``. The study sets the penalty factors.
    """
    with naming(path):
        return _described(read_parts(path, subcase, checked_ignore(ignore)))


def _described(deck: Deck) -> JointDescription:
    thin = [np.empty(0, dtype=np.int64), *(block.ids for block in deck.assembly.shells)]
    regions = read_regions(deck, deck.assembly.mesh.blocks, np.concatenate(thin))
    cut = cut_bolts(deck, deck.assembly, deck.moved)
    cuts = [*cut.cuts.values()]
    parents = deck.parents[origins(cut.assembly.mesh, cuts)]
    deck = replace(deck, assembly=cut.assembly, parents=parents)
    regions = {
        number: item.on_sides_of(cut.assembly.mesh, cuts) for number, item in regions.items()
    }
    notes: dict[str, None] = {}
    pairs = [
        *read_simcenter_pairs(deck, regions, notes),
        *read_msc_pairs(deck, regions, notes),
    ]
    check_distinct(pairs)
    pairs = with_shell_sides(pairs, deck.assembly, deck.thicknesses, notes)
    ids = deck.assembly.mesh.element_ids
    everything = friction_of_all_bodies(deck, regions, ids, notes)
    if everything is not None and cuts:
        refuse(
            "BCONTACT of all bodies and bolts of solids: the sides of their cuts would touch too; "
            "name the pairs (BCTABL1, BCONECT)"
        )
    assembly = close_cuts(_with_regions(deck, regions, pairs), cuts)
    springs = assembly.springs[len(assembly.springs) - len(cuts) :]
    closing = {number: item.id for number, item in zip(cut.cuts, springs, strict=True)}
    bolts, preloads = read_bolts(deck, assembly.beams, closing)
    preloads |= cut.preloads
    assembly = with_free_strains(replace(deck, assembly=assembly), bolts)
    deck = replace(deck, assembly=assembly)
    assembly = with_glue(assembly, [pair for pair in pairs if pair.glued], notes)
    has_joined_faces = bool(cuts) or any(pair.glued for pair in pairs)
    pairs = [pair for pair in pairs if not pair.glued]
    interfaces = [spec_of(pair, assembly, notes) for pair in pairs]
    if everything is not None:
        interfaces.append(InterfaceSpec(name="contact", friction=everything))
        notes["contact of all bodies across gaps: name these pairs (BCTABL1, BCONECT)"] = None
    if "friction" in deck.ignore and any(spec.friction for spec in interfaces):
        interfaces = [replace(spec, friction=0.0) for spec in interfaces]
        notes[f"coefficients of friction: {IGNORABLE['friction']} (ignore = friction)"] = None
    ignored = (*deck.ignored, *_grouped(notes))
    # Loads that case control selects, if they could be read.
    chosen = str(deck.control.set_of("LOAD"))
    others = (name for name in deck.assembly.loads if not name.isdigit())
    return JointDescription(
        assembly=replace(assembly, ignored=ignored),
        interfaces=tuple(interfaces),
        bolts=bolts,
        preloads=preloads,
        initial_forces={
            spec.name: axial_stiffness(assembly, bolt_axis_element(assembly, spec))
            * cut.shortened[spec.name]
            for spec in bolts
            if spec.name in cut.shortened
        },
        selected_load=chosen if chosen in deck.assembly.loads else next(others, None),
        has_joined_faces=has_joined_faces,
    )


def read_deck(path: str | PathLike[str], *, subcase: int | None = None) -> Assembly:
    """Read the structure of a deck: Nastran bulk data (small, large, free field) with INCLUDE.

    The page on decks lists supported cards; :func:`read_joint` reads contact and bolts.

    Case control selects SPC, MPC and LOAD (global level and one subcase). Sets that it does not
    select constrain nothing; in a deck without case control all SPC and MPC sets apply. All load
    sets are returned, the selected one first; loads that are not read are named in ``ignored``.

    PSOLID decides the formulation of eight-node CHEXA: ``"incompatible"`` when IN and ISOP are
    left at their defaults (bubble functions), ``"standard"`` for ISOP = FULL with IN = TWO or
    THREE.

    Parameters
    ----------
    path
        The deck. INCLUDE is relative to the including file.
    subcase
        Subcase whose selections count; the first unless given.

    Returns
    -------
    Assembly
        The structure in the basic frame. ``element_sets`` has ``pid:<n>`` for solid properties;
        ``ignored`` names all harmless omissions.

    Raises
    ------
    FormatError
        With file and line: a missing file or include, a malformed field, a reference to something
        that does not exist, a duplicate id, or an unsupported card that changes the physics.

    Notes
    -----
    About 0.5 s for 50 000 nodes and bricks; 400 bytes of memory a line at most.
    """
    return read_joint(path, subcase=subcase).assembly


def _grouped(notes: Mapping[str, None]) -> list[str]:
    """Join the parameters of a card into one note."""
    groups: dict[str, list[str]] = {}
    for note in notes:
        name, _, subject = note.partition(" ")
        single = subject.isalnum() and subject.isupper()
        groups.setdefault(name if single else note, []).append(subject)
    return [
        f"{name} {', '.join(subject)} (the study's penalty and tolerance count)"
        if " " not in name
        else name
        for name, subject in groups.items()
    ]


def _with_regions(deck: Deck, regions: Mapping[int, Region], pairs: list[Pair]) -> Assembly:
    """Add contact regions as face sets and element sets.

    Raises
    ------
    FormatError
        If a region in contact has no exterior face, or a face inside a body.
    """
    mesh = deck.assembly.mesh
    element_sets, face_sets = dict(mesh.element_sets), dict[str, Indices]()
    every = {region.name: region for region in regions.values() if region.shells is None}
    every |= {region.name: region for pair in pairs for region in (pair.minus, pair.plus)}
    used = {region.name for pair in pairs for region in (pair.minus, pair.plus)}
    for name, region in every.items():
        if region.elements is not None:
            element_sets[name] = region.elements
            if name in used and not len(region.elements):
                region.card.refuse(
                    "no solid of the deck belongs to this contact region; correct its ids"
                )
        elif region.facets is not None:
            face_sets[name] = region.facets
            if name in used and region.shells is None:
                positions = mesh.exterior.positions(region.facets)
                if not len(positions) or positions.min() < 0:
                    region.card.refuse(
                        "a face of this contact region lies inside a body; name exterior faces"
                    )
    mesh = replace(mesh, element_sets=element_sets)
    return replace(deck.assembly, mesh=mesh, face_sets=face_sets)


def with_glue(assembly: Assembly, pairs: Sequence[Pair], ignored: dict[str, None]) -> Assembly:
    """Add the equations of glued pairs, whose regions are sets of the assembly."""
    if not pairs:
        return assembly
    specs = [
        InterfaceSpec(
            name=pair.name,
            minus=pair.minus.name,
            plus=pair.plus.name,
            meshes="non-matching",
            search_distance=glue_distance(pair, assembly.mesh),
        )
        for pair in pairs
    ]
    equations, partial = moving_together(assembly, specs)
    for name, share in partial:
        ignored[f"{name}: {share:.0%} of the smaller surface is glued"] = None
    ignored[
        "glued surfaces move together where they face each other within the search distance, node "
        "to node where meshes match and else in the mean (mortar); Nastran's glue is a stiff "
        "penalty or holds node by node"
    ] = None
    return replace(assembly, equations=(*assembly.equations, *equations))
