"""Bolts of solids: the mesh is cut across the shank and a stiff spring closes the cut.

Abaqus, CalculiX and Nastran duplicate the nodes of a section and let the two sides move apart along
its normal by a common distance. The pretension force determines it, and then it is locked.
Here the distance is the elongation of a spring in the bolt, far stiffer than the adjacent solids.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices, Mask, Matrix, Vector
from faying.interface.facets import area_vectors, gauss_rule
from faying.model.assembly import Assembly, Equation, Spring, Support
from faying.model.deck_bolt import CUT_STIFFNESS
from faying.model.elements import SOLIDS
from faying.model.mesh import Mesh
from faying.model.surface import WIDTH, corner_keys, nodes_by_kind, padded, unique_rows


@dataclass(frozen=True, eq=False, kw_only=True)
class Section:
    """A section where solids are to be cut.

    Attributes
    ----------
    name
        Of the bolt.
    shown
        Name of the section in messages.
    facets : (n_facet, 8)
        Nodes of facets, seen from outside the owning side, with -1 behind them.
    elements : (n_element,)
        Ids of the solids that own these facets.
    refuse
        Function that raises an error with the place in the deck.
    direction
        Normal in the deck; without one, the mean normal of the facets.
    """

    name: str
    shown: str
    facets: Indices
    elements: Indices
    refuse: Callable[[str], NoReturn]
    direction: tuple[float, ...] | None = None

    @property
    def nodes(self) -> Indices:
        """Sorted nodes of the facets, without duplicates."""
        return np.unique(self.facets[self.facets >= 0])


@dataclass(frozen=True, eq=False, kw_only=True)
class Cut:
    """A section through solids, cut open.

    Attributes
    ----------
    name
        Of the bolt.
    originals, copies : (n,)
        Nodes of the section, which the elements beyond it keep, and new nodes of the elements
        that own the surface, in the same order (as in CalculiX).
    normal : (3,)
        Unit vector from the owning side of the surface to the other side.
    area : [length²]
    sense
        1 if a positive force in the deck is tensile, -1 if compressive.
    ends
        Two new nodes; their relative displacement along ``component`` is that of the sides.
    component
        Coordinate direction nearest to the normal.
    owner
        Id of an element beside the section.
    owners : (n_element,)
        Ids of all elements beside the section that use the copies.
    touching
        Number of owners that touch the section only with an edge or a corner.
    """

    name: str
    originals: Indices
    copies: Indices
    normal: Vector
    area: float
    sense: float
    ends: tuple[int, int]
    component: int
    owner: int
    owners: Indices
    touching: int


def cut_mesh(mesh: Mesh, section: Section) -> tuple[Mesh, Cut]:
    """Give new nodes to the elements that own the facets of a section."""
    owners = _owning_side(mesh, section)
    n_node = len(mesh.nodes)
    originals = section.nodes
    copy_of = np.arange(n_node)
    copy_of[originals] = n_node + np.arange(len(originals))
    ends = (n_node + len(originals), n_node + len(originals) + 1)
    blocks = []
    for block in mesh.blocks:
        touching = np.isin(block.ids, owners)
        blocks.append(
            replace(block, nodes=np.where(touching[:, None], copy_of[block.nodes], block.nodes))
        )
    vector, moment, total = np.zeros(3), np.zeros(3), 0.0
    for kind, facets in nodes_by_kind(section.facets).items():
        rule = gauss_rule(kind)
        vectors = area_vectors(kind, mesh.nodes[facets], rule.points)
        of_facets = np.einsum("fqd,q->fd", vectors, rule.weights)
        vector += of_facets.sum(axis=0)
        sizes = np.linalg.norm(of_facets, axis=1)
        moment += sizes @ mesh.nodes[facets].mean(axis=1)
        total += float(sizes.sum())
    area = float(np.linalg.norm(vector))
    if not area > 0:
        section.refuse(f"{section.shown} has no area as a whole; a section is nearly flat")
    normal, sense = _direction(section, vector / area)
    centre = moment / total
    added = np.vstack([mesh.nodes[originals], centre, centre])
    return replace(mesh, blocks=tuple(blocks)).with_nodes(added), Cut(
        name=section.name,
        originals=originals,
        copies=copy_of[originals],
        normal=normal,
        area=area,
        sense=sense,
        ends=ends,
        component=int(np.abs(normal).argmax()),
        owner=int(section.elements[0]),
        owners=owners,
        touching=len(np.setdiff1d(owners, section.elements)),
    )


def origins(mesh: Mesh, cuts: Sequence[Cut]) -> Indices:
    """Return the node of the deck that each node of a cut mesh (n_node,) copies."""
    origin = np.arange(len(mesh.nodes))
    for cut in cuts:
        origin[cut.copies] = origin[cut.originals]
        origin[list(cut.ends)] = origin[cut.originals[0]]
    return origin


def _direction(section: Section, normal: Vector) -> tuple[Vector, float]:
    """Return the direction on the data line, turned to the mean normal, and the sense of forces.

    Without a direction it is the mean normal. Forces along an opposite direction compress.
    """
    if section.direction is None:
        return normal, 1.0
    direction = np.array(section.direction)
    length = float(np.linalg.norm(direction))
    cosine = float(direction @ normal) / length if length > 0 else 0.0
    if not abs(cosine) > 0.5:
        section.refuse("the direction is zero or lies in the section; give the axis of the bolt")
    sense = float(np.sign(cosine))
    return direction / length * sense, sense


def _owning_side(mesh: Mesh, section: Section) -> Indices:
    """Return the ids of the elements at the section, on the side that owns its facets."""
    at_section = [np.isin(block.nodes, section.nodes) for block in mesh.blocks]
    touching: list[Mask] = [np.asarray(nodes.any(axis=1)) for nodes in at_section]
    faces, ids, _ = faces_of(mesh, touching)
    cut = section.facets
    _, group, _ = unique_rows(corner_keys(np.concatenate([cut, faces])))
    is_cut = np.isin(group[len(cut) :], group[: len(cut)])
    elements, position = np.unique(ids, return_inverse=True)
    joins = sp.csr_array(
        (np.ones(int((~is_cut).sum())), (position[~is_cut], group[len(cut) :][~is_cut])),
        shape=(len(elements), int(group.max()) + 1),
    )
    count, part = connected_components(joins @ joins.T, directed=False)
    owners = np.unique(part[np.isin(elements, section.elements)])
    across = elements[np.setdiff1d(position[is_cut], np.flatnonzero(np.isin(part, owners)))]
    if not len(across) or np.intersect1d(part[np.isin(elements, across)], owners).size:
        section.refuse(
            f"{section.shown} does not cut fully through its solids; take "
            "all element faces of one cross-section of the shank, seen from one side"
        )
    others = np.setdiff1d(np.arange(count), [*owners, *part[np.isin(elements, across)]])
    if others.size:
        section.refuse(
            f"element {elements[part == others[0]][0]} touches {section.shown} only "
            "at an edge or a corner, so its side is ambiguous; place the section elsewhere"
        )
    return elements[np.isin(part, owners)]


def faces_of(mesh: Mesh, chosen: Sequence[Mask]) -> tuple[Indices, Indices, Matrix]:
    """Return faces (n_face, 8) of elements chosen by masks per block, element ids, and centres."""
    tables, ids = [np.zeros((0, WIDTH), dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    centres = [np.zeros((0, 3))]
    for block, mask in zip(mesh.blocks, chosen, strict=True):
        cells = block.nodes[mask]
        for _, local in SOLIDS[block.kind].faces:
            tables.append(padded(cells[:, list(local)]))
            ids.append(block.ids[mask])
            centres.append(mesh.nodes[cells].mean(axis=1))
    return np.concatenate(tables), np.concatenate(ids), np.concatenate(centres)


def on_their_sides(mesh: Mesh, cuts: Sequence[Cut], facets: Indices) -> Indices:
    """Return facets (n_facet, 8) beside cuts with their nodes on the cut mesh.

    Facets are given with the nodes before the cuts, padded with -1; the mesh has all cuts.
    """
    for cut in cuts:
        position = np.full(len(mesh.nodes) + 1, -1, dtype=np.int64)
        position[cut.originals] = np.arange(len(cut.originals))
        owned = np.zeros(len(mesh.nodes) + 1, dtype=bool)
        owned[mesh.element_nodes(cut.owners)] = True
        adjacent: Mask = np.asarray(owned[facets].any(axis=1))
        moved = (position[facets] >= 0) & adjacent[:, None]
        facets = np.where(moved, cut.copies[position[facets]], facets)
    return facets


def close_cuts(assembly: Assembly, cuts: Sequence[Cut]) -> Assembly:
    """Tie the two sides of every cut and put its spring between them."""
    equations: list[Equation] = []
    springs: list[Spring] = []
    supports: list[Support] = []
    spring_id = assembly.largest_id
    for cut in cuts:
        fixed, moving = cut.ends
        for original, copy in zip(cut.originals.tolist(), cut.copies.tolist(), strict=True):
            for c in range(3):
                terms = (
                    (copy, c, 1.0),
                    (original, c, -1.0),
                    (moving, cut.component, float(cut.normal[c])),
                )
                equations.append(
                    Equation(id=0, terms=tuple(term for term in terms if term[2] != 0.0))
                )
        spring_id += 1
        # Only direction and place of the shank are known: its length is the width of the section.
        centre, half = assembly.mesh.nodes[fixed], np.sqrt(cut.area / np.pi) * cut.normal
        springs.append(
            Spring(
                id=spring_id,
                ends=((fixed, cut.component), (moving, cut.component)),
                stiffness=CUT_STIFFNESS * _layer_stiffness(assembly, cut),
                axis=(tuple((centre - half).tolist()), tuple((centre + half).tolist())),
            )
        )
        supports.append(
            Support(
                id=len(assembly.supports) + len(supports) + 1,
                nodes=np.array([fixed]),
                components=(cut.component,),
            )
        )
    return replace(
        assembly,
        equations=(*assembly.equations, *equations),
        springs=(*assembly.springs, *springs),
        supports=(*assembly.supports, *supports),
    )


def _layer_stiffness(assembly: Assembly, cut: Cut) -> float:
    """Return E A / h of the layer of elements beside a cut, with h along its normal."""
    for block in assembly.mesh.blocks:
        row = np.flatnonzero(block.ids == cut.owner)
        if row.size:
            heights = assembly.mesh.nodes[block.nodes[row[0]]] @ cut.normal
            material = assembly.materials[int(block.properties[row[0]])]
            return material.youngs_modulus * cut.area / float(np.ptp(heights))
    raise KeyError(cut.owner)
