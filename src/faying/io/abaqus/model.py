"""All families of keywords together: a deck as an assembly, and what belongs to it."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices
from faying.io.abaqus import contact, materials, pretension
from faying.io.abaqus.deck import Deck
from faying.io.abaqus.dofs import read_dofs
from faying.io.abaqus.elements import read_elements
from faying.io.abaqus.equations import read_equations, read_mpcs
from faying.io.abaqus.harmless import HARMLESS, REMEDIES
from faying.io.abaqus.loads import nodal_forces, read_concentrated
from faying.io.abaqus.nodes import Nodes, read_nodes
from faying.io.abaqus.rigid_bodies import read_rigid_bodies, rotation_nodes
from faying.io.abaqus.sets import NamedSets, read_element_sets, read_node_sets
from faying.io.abaqus.solid_sections import formulation, read_solid_sections
from faying.io.abaqus.springs import read_springs
from faying.io.abaqus.supports import read_supports
from faying.io.abaqus.surfaces import DeckSurface, read_surfaces
from faying.model.assembly import Assembly, FaceSet, NodalLoads
from faying.model.description import JointDescription
from faying.model.mesh import Mesh

_READ = frozenset(
    (
        *("NODE", "SYSTEM", "ELEMENT", "NSET", "ELSET", "SURFACE", "MATERIAL", "SOLID SECTION"),
        *("SPRING", "TRANSFORM", "BOUNDARY", "CLOAD", "EQUATION", "MPC", "RIGID BODY"),
        *("CONTACT PAIR", "SURFACE INTERACTION", "PRE-TENSION SECTION"),
        *contact.MEMBERS,
        *materials.MEMBERS,
    )
)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Geometry:
    """Mesh, sets and surfaces."""

    mesh: Mesh
    surfaces: Mapping[str, DeckSurface]


def description(deck: Deck, ignored: list[str]) -> JointDescription:
    """Read everything a deck says in the step it has been cut to.

    Raises
    ------
    FormatError
        With file and line.
    """
    check_supported(deck, ignored)
    nodes = read_nodes(deck)
    elements = read_elements(deck, nodes)
    by_element = read_element_sets(deck, elements)
    by_node = read_node_sets(deck, nodes, elements, by_element)
    solids, used = read_solid_sections(
        deck, elements, by_element, materials.read_materials(deck, ignored)
    )
    mesh = Mesh(
        nodes=nodes.coordinates,
        node_ids=nodes.ids,
        blocks=solids,
        node_sets=_node_sets(by_node, nodes),
        element_sets={by_element.names[key]: ids for key, ids in by_element.ids.items()},
    )
    surfaces = read_surfaces(deck, mesh, by_element, by_node)
    dofs = read_dofs(deck, nodes, by_node, rotation_nodes(deck, nodes, by_node))
    sections = pretension.read_sections(deck, dofs, elements, by_element)
    apart = frozenset(section.node for section in sections)
    forces = read_concentrated(deck, dofs, ignored)
    equations = list(read_equations(deck, dofs))
    more, rigid = read_mpcs(deck, dofs, len(equations) + 1)
    bodies = read_rigid_bodies(deck, dofs, elements, by_element, len(rigid) + len(equations) + 1)
    pairs = contact.read_pairs(deck, surfaces, ignored)
    assembly = Assembly(
        mesh=mesh,
        materials=used,
        element=formulation(elements.solids, ignored),
        springs=tuple(read_springs(deck, elements, by_element, nodes.coordinates)),
        rigid_couplings=(*rigid, *bodies),
        equations=(*equations, *more),
        supports=read_supports(deck, dofs, apart),
        face_sets=_face_sets(surfaces),
        loads=_loads(
            deck, nodal_forces({p: f for p, f in forces.items() if p[0] not in apart}, dofs)
        ),
        name=deck.path.stem,
        ignored=tuple(ignored),
    )
    return JointDescription(
        assembly=assembly,
        interfaces=contact.specs(pairs),
        bolts=pretension.bolts(sections),
        preloads=pretension.preloads(sections, forces),
    )


def check_supported(deck: Deck, ignored: list[str]) -> None:
    """Refuse keywords that may change the structure; count the harmless ones.

    Raises
    ------
    FormatError
        Naming the keyword, its line and what to do instead.
    """
    counts: dict[str, int] = {}
    for keyword in deck.keywords:
        if keyword.name in _READ:
            continue
        if keyword.name not in HARMLESS:
            remedy = REMEDIES.get(keyword.name, "remove it, or model it with supported keywords")
            message = f"the keyword is not supported and may change the structure; {remedy}"
            raise keyword.error(message)
        counts[keyword.name] = counts.get(keyword.name, 0) + 1
    ignored += [f"{count} *{name}" for name, count in counts.items()]


def _node_sets(by_node: NamedSets, nodes: Nodes) -> dict[str, Indices]:
    return {by_node.names[key]: np.searchsorted(nodes.ids, ids) for key, ids in by_node.ids.items()}


def _face_sets(surfaces: Mapping[str, DeckSurface]) -> dict[str, FaceSet]:
    found = {}
    for surface in surfaces.values():
        if len(surface.facets) == 1:
            kind, nodes = next(iter(surface.facets.items()))
            found[surface.name] = FaceSet(kind=kind, nodes=nodes)
    return found


def _loads(deck: Deck, forces: np.typing.NDArray[np.float64]) -> dict[str, NodalLoads]:
    loaded = np.flatnonzero((forces != 0).any(axis=1))
    if not loaded.size:
        return {}
    return {f"step {deck.n_step}": NodalLoads(nodes=loaded, forces=forces[loaded])}
