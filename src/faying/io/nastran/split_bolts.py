"""MSC's BOLT: pairs of grids where a shank is parted, and the grid that tightens it.

MSC Nastran Quick Reference Guide, BOLT: the mesh is parted across the shank; TOP and BOTTOM list
the grids of both sides in pairs, whose relative displacement is that of the control grid. The force
on that grid is the pretension, its displacement (SPC, SPCD) by how much the shank is shortened.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices, Vector
from faying.io.nastran.bulk_data import BulkData
from faying.io.nastran.cards import Card, by_id
from faying.io.nastran.grids import Grids
from faying.io.nastran.id_lists import id_list
from faying.io.nastran.moved_supports import Moved
from faying.io.nastran.solid_bolts import is_split
from faying.io.solid_cuts import Cut
from faying.model.assembly import Assembly, NodalLoads
from faying.model.mesh import Mesh

SPLIT = (
    "BOLT of a control grid: its sides move apart along the force on that grid only, or its "
    "displacement, and the amount of the force is the tension, that of the displacement by how "
    "much the shank is shortened; what else is said of the grid does not count"
)


@dataclass(frozen=True, eq=False, kw_only=True)
class SplitBolt:
    """A bolt of grids in pairs.

    Attributes
    ----------
    control
        Node whose load is the pretension.
    sets
        Load set to the force on it, where it has one, or to how far it is moved.
    shortens
        Whether it is moved.
    """

    card: Card
    top: Indices
    bottom: Indices
    control: int
    sets: Mapping[str, float]
    axis: Vector
    shortens: bool


def read_split_bolts(
    bulk: BulkData, loads: Mapping[str, NodalLoads], moved: Moved
) -> dict[int, SplitBolt]:
    """Return the bolts of control grids by id."""
    bolts = {}
    for number, card in by_id(bulk.cards, "BOLT").items():
        if not is_split(card):
            continue
        control = int(bulk.grids.several(card, [card.integer(1)])[0])
        top, bottom = (_listed(card, bulk.grids, side) for side in ("TOP", "BOTTOM"))
        if len(top) != len(bottom) or not len(top):
            card.refuse(f"{len(top)} grids on TOP and {len(bottom)} on BOTTOM; list them in pairs")
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
                f"control grid {card.integer(1)} has no force or displacement along one line, "
                "which would be the tension; give it one by FORCE or SPCD",
                1,
            )
        sets = {name: float(np.linalg.norm(force)) for name, force in forces.items()}
        bolts[number] = SplitBolt(
            card=card,
            top=top,
            bottom=bottom,
            control=control,
            sets=sets,
            axis=axis,
            shortens=shortens,
        )
    return bolts


def _listed(card: Card, grids: Grids, side: str) -> Indices:
    texts = list(card.texts)
    first = texts.index(side) + 1 if side in texts else len(texts)
    others = [i for i, text in enumerate(texts) if text in ("TOP", "BOTTOM") and i >= first]
    listed = [text for text in texts[first : min(others, default=len(texts))] if text]
    return grids.several(card, id_list(card, listed))


def parted(mesh: Mesh, number: int, bolt: SplitBolt) -> tuple[Mesh, Cut]:
    """Return a split bolt as a cut, and the mesh with the nodes that carry its elongation."""
    (upper, _), (lower, owner) = (_centre(mesh, side) for side in (bolt.top, bolt.bottom))
    sense = 1.0 if (upper - lower) @ bolt.axis > 0 else -1.0
    n_node, first_id = len(mesh.nodes), int(mesh.node_ids.max()) + 1
    centre = mesh.nodes[bolt.bottom].mean(axis=0)
    points = mesh.nodes[bolt.bottom] - centre
    normal = sense * bolt.axis
    flat = points - np.outer(points @ normal, normal)
    cut = Cut(
        name=f"bolt-{number}",
        originals=bolt.top,
        copies=bolt.bottom,
        normal=normal,
        # Of a disc with the same spread; it sets how stiff the closing spring is, no more.
        area=float(2 * np.pi * np.mean(np.sum(flat**2, axis=1))),
        sense=sense,
        ends=(n_node, n_node + 1),
        component=int(np.abs(normal).argmax()),
        owner=owner,
        owners=np.zeros(0, dtype=np.int64),
        touching=0,
    )
    nodes, ids = np.vstack([mesh.nodes, centre, centre]), first_id + np.arange(2)
    return replace(mesh, nodes=nodes, node_ids=np.append(mesh.node_ids, ids)), cut


def _centre(mesh: Mesh, nodes: Indices) -> tuple[Vector, int]:
    """Return the mean place of the elements at nodes, and the id of one of them."""
    touching = [np.isin(block.nodes, nodes).any(axis=1) for block in mesh.blocks]
    chosen = [block.nodes[mask].ravel() for block, mask in zip(mesh.blocks, touching, strict=True)]
    ids = [block.ids[mask] for block, mask in zip(mesh.blocks, touching, strict=True)]
    centre: Vector = mesh.nodes[np.concatenate(chosen)].mean(axis=0)
    return centre, int(np.concatenate(ids)[0])


def without_controls(assembly: Assembly, bolts: Mapping[int, SplitBolt]) -> Assembly:
    """Return the assembly without loads on control grids, which are the tension of bolts."""
    controls = [bolt.control for bolt in bolts.values()]
    uncontrolled = {name: ~np.isin(load.nodes, controls) for name, load in assembly.loads.items()}
    loads = {
        name: NodalLoads(
            nodes=load.nodes[uncontrolled[name]], forces=load.forces[uncontrolled[name]]
        )
        for name, load in assembly.loads.items()
        if uncontrolled[name].any()
    }
    return replace(assembly, loads=loads)
