"""``*CONTACT PAIR``: interfaces, and slave surfaces of single nodes.

CalculiX (node-to-face penalty contact): the force of a node is its pressure times its share of the
exterior faces of solids around it, or, without any, the area of the master face that it
projects onto. Here the node and the point below it each carry a triangle of this area, which moves
with them without rotation.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from faying._typing import Indices, Vector
from faying.interface.gap_pairing import declared
from faying.interface.projection import nearest_places
from faying.interface.selection import select_facets
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.deck_data import DeckData
from faying.io.abaqus.fields import Line, lines, parameter
from faying.io.abaqus.interactions import Interaction
from faying.io.abaqus.keyword import Keyword, named
from faying.io.abaqus.sets import NamedSets
from faying.io.abaqus.surfaces import DeckSurface, Surfaces, removed_sides, slave_and_master
from faying.io.tied_surfaces import equal_motions
from faying.model.assembly import Assembly
from faying.model.elements import FACES
from faying.model.specs import GapRule, InterfaceSpec
from faying.model.surface import facet_area_vectors, facet_frames, padded, rows_by_kind


@dataclass(frozen=True, kw_only=True)
class Pair:
    """A contact pair; the slave is the minus side, which has the contact points and normals.

    ``lone`` pairs have a single contact point.
    """

    line: Line
    slave: DeckSurface
    master: DeckSurface
    interaction: Interaction
    adjusted: GapRule | None
    lone: bool = False

    def is_of(self, names: list[str]) -> bool:
        """Return whether the pair has this slave and master."""
        return [self.slave.name.upper(), self.master.name.upper()] == [n.upper() for n in names]


def read_pairs(
    data: DeckData, interactions: Mapping[str, Interaction], surfaces: Surfaces
) -> list[Pair]:
    """Read all *CONTACT PAIR."""
    pairs, ignored = [], data.deck.ignored
    for keyword in data.deck.of("CONTACT PAIR"):
        name = keyword.required("INTERACTION")
        interaction = named(keyword, name, interactions, "*SURFACE INTERACTION")
        adjusted = _adjust(keyword, data.node_sets)
        kind = keyword.choice("TYPE", "default")
        note = f"formulation of *CONTACT PAIR: small sliding, {kind}"
        if kind == "NODE TO SURFACE":
            note += (
                "; contact is over the common surface here, not at slave nodes alone, whose joints "
                "are softer with higher pressures where slave facets are coarse"
            )
        if note not in ignored:
            ignored.append(note)
        for line in lines(keyword):
            if removed := removed_sides(surfaces, line):
                ignored.append(
                    f"contact pair {', '.join(line.texts)}: *MODEL CHANGE removes all elements of "
                    f"{removed}"
                )
                continue
            slave, master = slave_and_master(surfaces, line)
            if not len(slave.facets):
                ignored.append(
                    f"slave surface {slave.name} of nodes: taken as the facets between these nodes"
                )
            pairs.append(
                Pair(
                    line=line,
                    slave=slave,
                    master=master,
                    interaction=interaction,
                    adjusted=adjusted,
                )
            )
    return pairs


def _adjust(keyword: Keyword, sets: NamedSets) -> GapRule | None:
    """Return the rule for slave nodes that start in contact: up to a gap, or of a set."""
    if not keyword.has("ADJUST"):
        return None
    text = keyword.value("ADJUST")
    try:
        return GapRule(closed_up_to=float(text or 0.0))
    except ValueError:
        members = sets.members(keyword, text)
        return GapRule(closed_nodes=tuple(members.tolist()))


def interface_names(pairs: list[Pair]) -> list[str]:
    """Return interface names: the interaction's, with both surfaces if it is used twice."""
    names = [pair.interaction.spec.name for pair in pairs]
    return [
        name if names.count(name) == 1 else f"{name} {pair.slave.name} {pair.master.name}"
        for name, pair in zip(names, pairs, strict=True)
    ]


def specs(assembly: Assembly, pairs: list[Pair], deck: Deck) -> tuple[InterfaceSpec, ...]:
    """Return the pairs as interfaces, marked where their meshes do not match."""
    interfaces, ignored = [], deck.ignored
    clearances = dict(_clearance(keyword, pairs) for keyword in deck.of("CLEARANCE"))
    for number, (name, pair) in enumerate(zip(interface_names(pairs), pairs, strict=True)):
        spec = replace(
            pair.interaction.spec,
            name=name,
            minus=pair.slave.name,
            plus=pair.master.name,
            search_distance=np.inf,
            gap=clearances[number] if number in clearances else _gap_rule(pair),
            quadrature="gauss" if pair.lone else None,
            order=1 if pair.lone else None,
        )
        spec = declared(assembly, spec)
        if spec.meshes == "non-matching":
            # Other faults are reported when the model is built.
            ignored.append(
                f"meshes of contact pair {name} do not match: coupled by projection, in the mean "
                "of facets instead of at each point; where contact is hard or far stiffer than the "
                "elements, coarse meshes are softer: by 4 to 9 % in most joints tried, 16 % in one"
            )
        if pair.slave.height or pair.master.height:
            ignored.append(
                f"contact pair {name}: shells are in contact at half their thickness off the nodes "
                f"({pair.slave.height:g}, {pair.master.height:g}); tangential motion there is that "
                "of the nodes, without the lever of the thickness"
            )
        if pair.adjusted is not None and pair.line.keyword.has("ADJUST"):
            ignored.append(
                f"ADJUST of contact pair {name}: gaps start closed there, the mesh is not changed"
            )
        interfaces.append(spec)
    return tuple(interfaces)


def _gap_rule(pair: Pair) -> GapRule | None:
    """Return the rule of ADJUST, or of shells, half of whose thickness is added to the gap."""
    height = pair.slave.height + pair.master.height
    if np.isnan(height) or (height and pair.adjusted is not None):
        problem = "ADJUST" if pair.adjusted is not None else "thicknesses that differ"
        pair.line.refuse(
            f"{problem} is not supported with surfaces of shells in contact; give *CLEARANCE, "
            "or each thickness a surface and a contact pair"
        )
    return GapRule(offset=-height) if height else pair.adjusted


def _clearance(keyword: Keyword, pairs: list[Pair]) -> tuple[int, GapRule]:
    """Return the number of the pair of a *CLEARANCE, and its initial gap."""
    if keyword.data:
        keyword.refuse("expected one VALUE; give other gaps as initial_gap in the study")
    value = parameter(keyword, "VALUE")
    surfaces = [keyword.required(name) for name in ("SLAVE", "MASTER")]
    for number, pair in enumerate(pairs):
        if pair.is_of(surfaces):
            return number, GapRule(value=value)
    message = "no *CONTACT PAIR has these surfaces as slave and master"
    raise keyword.error(message)


_SHARES = {"tri6": (1 / 999, 332 / 999), "quad8": (0.01, 0.24)}
"""Shares of a facet's area for corners and mid-side nodes, as in CalculiX."""

_LARGEST_DISTANCE = 1e-3
"""Largest distance of a node beside its facet, over the facet's size, as in CalculiX."""


def with_lone_nodes(
    assembly: Assembly, pairs: list[Pair], ignored: list[str]
) -> tuple[Assembly, list[Pair]]:
    """Replace pairs whose slave has no whole facet by a contact pair for each node."""
    replaced: list[Pair] = []
    for pair in pairs:
        if pair.slave.name in assembly.face_sets:
            replaced.append(pair)
            continue
        assembly, points = _points(assembly, pair)
        if not points:
            pair.line.refuse(
                f"no node of surface '{pair.slave.name}' lies above '{pair.master.name}'"
            )
        replaced += points
        ignored.append(
            f"slave surface {pair.slave.name} has no whole facet: {len(points)} of its "
            f"{len(pair.slave.nodes)} nodes are contact points, each an interface, with its share "
            "of all exterior facets around it, as in CalculiX (Abaqus takes an area of 1)"
        )
    return assembly, replaced


def _points(assembly: Assembly, pair: Pair) -> tuple[Assembly, list[Pair]]:
    nodes, slaves = assembly.mesh.nodes, pair.slave.nodes
    facets = select_facets(assembly, pair.master.name)
    apart, _ = cKDTree(nodes[np.unique(facets.corners)]).query(nodes[slaves])
    areas = np.linalg.norm(facet_area_vectors(nodes, facets), axis=1)
    reach = float(apart.max() + _LARGEST_DISTANCE * np.sqrt(areas.max()))
    places = nearest_places(nodes, slaves, facets, reach)
    frames = facet_frames(nodes, facets)
    shares = _shares(assembly)
    points = []
    for row, facet, columns, shape in zip(
        places.rows, places.facets, places.columns, places.shape, strict=True
    ):
        node, below = int(slaves[row]), shape @ nodes[columns]
        sideways = np.linalg.norm(frames[facet, :2] @ (nodes[node] - below))
        if sideways > _LARGEST_DISTANCE * np.sqrt(areas[facet]):
            continue
        triangle = _triangle(frames[facet], float(shares[node] or areas[facet]))
        of_place = sp.csr_array((shape, (np.zeros(len(shape), dtype=int), columns)))
        of_node = sp.csr_array(([1.0], ([0], [node])))
        assembly, minus = _carried(assembly, nodes[node] + triangle[::-1], of_node)
        assembly, plus = _carried(assembly, below + triangle, of_place)
        number = int(assembly.mesh.node_ids[node])
        sides = _sides(pair, number, minus, plus)
        named = {side.name: side.facets for side in sides}
        assembly = replace(assembly, face_sets={**assembly.face_sets, **named})
        spec = pair.interaction.spec
        interaction = Interaction(replace(spec, name=f"{spec.name} node {number}"))
        points.append(
            replace(pair, slave=sides[0], master=sides[1], interaction=interaction, lone=True)
        )
    return assembly, points


def _shares(assembly: Assembly) -> Vector:
    """Return the surface area of each node (n_node,), zero inside and off solids."""
    mesh = assembly.mesh
    exterior = mesh.exterior
    areas = np.linalg.norm(facet_area_vectors(mesh.nodes, exterior), axis=1)
    shares = np.zeros(len(mesh.nodes))
    for kind, rows in rows_by_kind(exterior.nodes).items():
        face = FACES[kind]
        corner, middle = _SHARES.get(kind, (1 / face.n_corners, 0.0))
        share = np.where(np.arange(face.n_nodes) < face.n_corners, corner, middle)
        np.add.at(shares, exterior.nodes[rows, : face.n_nodes], np.outer(areas[rows], share))
    return shares


def _triangle(frame: Vector, area: float) -> Vector:
    """Return the corners (3, 3) of an equilateral triangle about the origin."""
    angles = 2 * np.pi / 3 * np.arange(3)
    radius = np.sqrt(area / (0.75 * np.sqrt(3)))
    corners = radius * np.column_stack([np.cos(angles), np.sin(angles)]) @ frame[:2]
    return np.asarray(corners)


def _carried(assembly: Assembly, corners: Vector, motion: sp.csr_array) -> tuple[Assembly, Indices]:
    """Add three nodes that follow a point by shape functions (1, n_node); return their indices."""
    mesh = assembly.mesh
    added = len(mesh.nodes) + np.arange(3)
    follow = sp.csr_array((np.ones(3), (np.arange(3), np.zeros(3, dtype=int)))) @ motion
    follow.resize((3, len(mesh.nodes) + 3))
    minus = sp.csr_array((np.full(3, -1.0), (np.arange(3), added)), shape=follow.shape)
    return replace(
        assembly,
        mesh=mesh.with_nodes(corners),
        equations=(*assembly.equations, *equal_motions(added, follow + minus)),
    ), added


def _sides(pair: Pair, number: int, *ends: Indices) -> list[DeckSurface]:
    surfaces = (pair.slave, pair.master)
    return [
        replace(side, name=f"{side.name} at {number}", facets=padded(nodes[None]), nodes=nodes)
        for side, nodes in zip(surfaces, ends, strict=True)
    ]
