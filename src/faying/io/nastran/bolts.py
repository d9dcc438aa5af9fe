"""BOLT, BOLTFOR, BOLTLD: bolts and their pretension.

MSC Nastran Quick Reference Guide, BOLT with TOP and BOTTOM: the mesh is cut across the shank; they
list the grids of both sides in pairs, whose relative displacement is that of the control grid.
The force on that grid is the pretension, its displacement (SPC, SPCD) the shortening of the shank.

Simcenter Nastran Quick Reference Guide: BOLT with ETYPE = 1 lists the CBAR and CBEAM elements of a
shank, with ETYPE = 2 and 3 solids to cut. BOLTFOR is the force of bolts; BOLTLD combines sets of
BOLTFOR like LOAD. MSC's BOLT of the same name has a control grid that carries the force.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from faying._typing import Indices, Vector
from faying.exceptions import refuse
from faying.io.nastran.cards import Card, by_id, each
from faying.io.nastran.grids import BulkData, Grids, chosen_sets
from faying.io.nastran.id_lists import element_list, id_list
from faying.io.nastran.solid_bolts import is_split, read_solid_bolts
from faying.io.nastran.supports import Moved
from faying.io.solid_cuts import Cut, cut_mesh
from faying.model.assembly import Assembly, Beam, NodalLoads
from faying.model.mesh import Mesh
from faying.model.specs import BoltSpec

SPLIT = (
    "BOLT with a control grid: its sides move apart only along the force on the grid or its "
    "displacement; the amount of the force is the tension, the amount of the displacement the "
    "shortening of the shank. Other data of the grid are ignored"
)


def _tension(
    card: Card, control: int, bulk: BulkData, loads: Mapping[str, NodalLoads], moved: Moved
) -> tuple[Vector, dict[str, float], bool]:
    """Return axis and tension by load set of a bolt, and whether the tension is a displacement."""
    forces = {
        name: load.forces[load.nodes == control][0, :3]
        for name, load in loads.items()
        if (load.nodes == control).any()
    }
    shortens = not any(force.any() for force in forces.values())
    if shortens:
        forces = moved.of_node(control, bulk.grids.systems.axes(control))
    nonzero = np.array([force for force in forces.values() if force.any()]).reshape(-1, 3)
    axis = nonzero[0] / np.linalg.norm(nonzero[0]) if len(nonzero) else np.zeros(3)
    across = nonzero - np.outer(nonzero @ axis, axis)
    # Directions are given with seven digits in small fields.
    if not len(nonzero) or np.abs(across).max() > 1e-5 * np.abs(nonzero).max():
        card.refuse(
            f"control grid {card.integer(1)} has no force or displacement along one line as "
            "tension; give it one by FORCE or SPCD",
            1,
        )
    return axis, {name: float(np.linalg.norm(force)) for name, force in forces.items()}, shortens


def _listed(card: Card, grids: Grids, side: str) -> Indices:
    texts = list(card.texts)
    first = texts.index(side) + 1 if side in texts else len(texts)
    others = [i for i, text in enumerate(texts) if text in ("TOP", "BOTTOM") and i >= first]
    listed = [text for text in texts[first : min(others, default=len(texts))] if text]
    return grids.several(card, id_list(card, listed))


def _cut_pairs(mesh: Mesh, number: int, card: Card, grids: Grids, axis: Vector) -> tuple[Mesh, Cut]:
    """Return the mesh with the nodes of the bolt's elongation, and the cut between paired grids."""
    top, bottom = (_listed(card, grids, side) for side in ("TOP", "BOTTOM"))
    if len(top) != len(bottom) or not len(top):
        card.refuse(f"{len(top)} grids on TOP and {len(bottom)} on BOTTOM; list them in pairs")
    (upper, _), (lower, owner) = (_centre(mesh, side) for side in (top, bottom))
    sense = 1.0 if (upper - lower) @ axis > 0 else -1.0
    n_node = len(mesh.nodes)
    centre = mesh.nodes[bottom].mean(axis=0)
    points = mesh.nodes[bottom] - centre
    normal = sense * axis
    flat = points - np.outer(points @ normal, normal)
    cut = Cut(
        name=f"bolt-{number}",
        originals=top,
        copies=bottom,
        normal=normal,
        # Area of a disc with the same spread; only for the stiffness of the closing spring.
        area=float(2 * np.pi * np.mean(np.sum(flat**2, axis=1))),
        sense=sense,
        ends=(n_node, n_node + 1),
        component=int(np.abs(normal).argmax()),
        owner=owner,
        owners=np.zeros(0, dtype=np.int64),
        touching=0,
    )
    return mesh.with_nodes(np.stack([centre, centre])), cut


def _centre(mesh: Mesh, nodes: Indices) -> tuple[Vector, int]:
    """Return the centre of the elements at nodes, and the id of one of them."""
    touching = [np.isin(block.nodes, nodes).any(axis=1) for block in mesh.blocks]
    chosen = [block.nodes[mask].ravel() for block, mask in zip(mesh.blocks, touching, strict=True)]
    ids = [block.ids[mask] for block, mask in zip(mesh.blocks, touching, strict=True)]
    centre: Vector = mesh.nodes[np.concatenate(chosen)].mean(axis=0)
    return centre, int(np.concatenate(ids)[0])


def _without(assembly: Assembly, controls: Sequence[int]) -> Assembly:
    """Return the assembly without the loads on control grids, which tighten bolts."""
    loads = {}
    for name, load in assembly.loads.items():
        others = ~np.isin(load.nodes, controls)
        if others.any():
            loads[name] = NodalLoads(nodes=load.nodes[others], forces=load.forces[others])
    return replace(assembly, loads=loads)


SOLIDS_ARE_CUT = (
    'solids are cut at BOLT: name the sides of interfaces, for minus = "auto" would find the '
    "cuts too"
)


class CutBolts(NamedTuple):
    """Structure with open cuts through bolts of solids.

    Cuts are given by bolt id. Forces on control grids (preloads) and the shortening of bolts with
    moved control grids are given by bolt name.
    """

    assembly: Assembly
    cuts: dict[int, Cut]
    preloads: dict[str, float]
    shortened: dict[str, float]


def cut_bolts(bulk: BulkData, assembly: Assembly, moved: Moved) -> CutBolts:
    """Cut the solids of a structure at its bolts."""
    mesh, loads = assembly.mesh, assembly.loads
    cuts, preloads, shortened = dict[int, Cut](), dict[str, float](), dict[str, float]()
    for number, section in read_solid_bolts(bulk, mesh).items():
        mesh, cuts[number] = cut_mesh(mesh, section)
    split = {number: card for number, card in by_id(bulk.cards, "BOLT").items() if is_split(card)}
    controls, notes = [], []
    for number, card in split.items():
        controls.append(int(bulk.grids.several(card, [card.integer(1)])[0]))
        axis, amounts, shortens = _tension(card, controls[-1], bulk, loads, moved)
        mesh, cuts[number] = _cut_pairs(mesh, number, card, bulk.grids, axis)
        amount = amounts.get(str(bulk.control.set_of("LOAD")))
        if amount is None and len({*amounts.values()}) == 1:
            amount = next(iter(amounts.values()))
        if amount is None:
            what = "displacements of" if shortens else "forces on"
            sets = ", ".join(amounts)
            notes.append(f"{what} the control grid of bolt {number} differ in sets {sets}")
        else:
            (shortened if shortens else preloads)[f"bolt-{number}"] = amount
    if split:
        bulk.ignored.append(SPLIT)
        assembly = _without(assembly, controls)
    if cuts:
        bulk.ignored.append(SOLIDS_ARE_CUT)
        bulk.ignored.extend(
            f"bolt {number}: {cut.touching} elements touch its section only with an edge or a "
            "corner and are cut off too"
            for number, cut in cuts.items()
            if cut.touching
        )
    bulk.ignored.extend(notes)
    return CutBolts(replace(assembly, mesh=mesh), cuts, preloads, shortened)


def read_bolts(
    bulk: BulkData, beams: tuple[Beam, ...], closing: Mapping[int, int]
) -> tuple[tuple[BoltSpec, ...], dict[str, float]]:
    """Return the bolts, named ``bolt-<id>``, and the forces that case control selects.

    Without a case control section the only set of BOLTFOR applies. ``closing`` has the ids of the
    springs that close the cuts through bolts.
    """
    bolts = {
        number: (closing[number],) if number in closing else _elements(card, beams)
        for number, card in by_id(bulk.cards, "BOLT").items()
    }
    for card in each(bulk.cards, "BOLTFRC", "BOLTSEQ"):
        if bulk.control.present and card.integer(0) != bulk.control.set_of("BOLTLD"):
            which = f"{card.cards.name} {card.integer(0)}"
            bulk.ignored.append(f"{which} (case control does not select it)")
        else:
            card.refuse("it is not supported; give the final force of the bolts by BOLTFOR")
    names = {number: f"bolt-{number}" for number in bolts}
    forces = _forces(bulk, names)
    specs = tuple(BoltSpec(name=names[number], elements=ids) for number, ids in bolts.items())
    return specs, {names[number]: force for number, force in forces.items()}


def _elements(card: Card, beams: tuple[Beam, ...]) -> tuple[int, ...]:
    kind = card.integer(1)
    if kind != 1:
        card.refuse(f"ETYPE = {kind}; it is 1 (beams), 2 or 3 (solids)", 1)
    beam_ids = np.array(sorted(beam.id for beam in beams), dtype=np.int64)
    return tuple(element_list(card, 2, beam_ids, "CBAR or CBEAM", "list the beams of the shank"))


def _forces(bulk: BulkData, names: dict[int, str]) -> dict[int, float]:
    """Return the force of each bolt in the selected set."""
    sets: dict[int, dict[int, float]] = {}
    for card in bulk.cards.get("BOLTFOR", ()):
        of_set = sets.setdefault(card.integer(0), {})
        force = card.real(1)
        for bolt in id_list(card, card.texts[2:], np.array(list(names))):
            card.find(names, 2, "bolt", "BOLT", bolt)
            if bolt in of_set:
                card.refuse(f"bolt {bolt} has two forces in set {card.integer(0)}; remove one", 2)
            of_set[bolt] = force
    combined = {
        number: _combination(card, sets) for number, card in by_id(bulk.cards, "BOLTLD").items()
    }
    both = set(sets) & set(combined)
    if both:
        refuse(f"{bulk.cards['BOLTLD'].where(0)}: set {min(both)} is also a BOLTFOR; renumber one")
    available = {**sets, **combined}
    what = "sets of bolt forces"
    chosen, note = chosen_sets(bulk.control, "BOLTLD", available, what)
    if len(chosen) == 1:
        return available[chosen[0]]
    if available:
        bulk.ignored.append(
            note or f"{what} {', '.join(map(str, chosen))} (give case control a BOLTLD)"
        )
    return {}


def _combination(card: Card, sets: dict[int, dict[int, float]]) -> dict[int, float]:
    """Add sets of BOLTFOR with factors."""
    total = dict[int, float]()
    for factor, member, fields in card.combination():
        for bolt, force in fields.find(sets, 1, "set", "BOLTFOR", member).items():
            total[bolt] = total.get(bolt, 0.0) + factor * force
    return total
