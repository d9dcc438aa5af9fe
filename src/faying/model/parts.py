"""Parts of a structure: some bodies, properties or element sets, with their connections."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from faying._typing import Indices, Mask
from faying.display.facts import listed
from faying.exceptions import refuse_model
from faying.model.assembly import Assembly, NodalLoads, RigidCoupling, Support
from faying.model.bodies import body_names
from faying.model.description import JointDescription
from faying.model.links import LINKS, linked_nodes
from faying.model.mesh import Mesh
from faying.model.specs import BoltSpec, BoundarySpec, Selection


def part_of(
    described: JointDescription, parts: Sequence[str | int], without: Sequence[str | int]
) -> JointDescription:
    """Return a joint of some of the bodies, with notes on everything that is left out.

    Solids are chosen by names of bodies or element sets, or by property ids. Beams, shells,
    springs, masses, couplings and equations stay if they are connected to a solid that stays; those
    of a set in ``without`` are removed. Supports, loads, interfaces and bolts on removed parts are
    removed with them. Everything stays if ``parts`` is empty.

    Notes
    -----
    Linear in the size of the mesh.
    """
    if not parts and not without:
        return described
    assembly = described.assembly
    chosen = elements_named(assembly, parts) if parts else assembly.mesh.element_ids
    dropped = elements_named(assembly, without)
    solids = [
        np.isin(block.ids, chosen) & ~np.isin(block.ids, dropped) for block in assembly.mesh.blocks
    ]
    if not any(mask.any() for mask in solids):
        refuse_model("no solid remains of the model; correct parts and without of [model]")
    cut = _Cut(assembly, solids, dropped)
    cut.refuse_ties()
    remaining = cut.assembly()
    notes = [*cut.notes()]
    joint = remaining_joint(described, remaining, notes)
    note = f"left out by parts and without of [model]: {', '.join(notes)}"
    whole = replace(joint.assembly, ignored=(*assembly.ignored, note))
    return replace(joint, assembly=whole)


def elements_named(
    assembly: Assembly,
    names: Sequence[str | int],
    where: str = "parts and without of [model]",
) -> Indices:
    """Return the ids of elements from names of bodies or sets, or property ids.

    ``where`` tells in messages where the names come from.
    """
    mesh = assembly.mesh
    parts = [np.empty(0, dtype=np.int64)]
    bodies_named = body_names(mesh) if any(name not in mesh.element_sets for name in names) else []
    for name in names:
        if isinstance(name, int):
            ids = mesh.element_ids[mesh.element_properties == name]
            shells = [block.ids[block.properties == name] for block in assembly.shells]
            parts += [ids, *([] if len(ids) else shells)]
            if not sum(map(len, parts[-1 - len(shells) :])):
                refuse_model(f"no element has property {name}; correct {where}")
        elif name in mesh.element_sets:
            parts.append(mesh.element_sets[name])
        elif name in bodies_named:
            inside = np.flatnonzero(mesh.bodies == bodies_named.index(name))
            parts += [block.ids[np.isin(block.nodes[:, 0], inside)] for block in mesh.blocks]
        else:
            shown = ", ".join(
                f"'{name_shown}'"
                for name_shown in dict.fromkeys([*bodies_named, *mesh.element_sets])
            )
            refuse_model(f"there is no body or element set '{name}' to choose; known are {shown}")
    return np.unique(np.concatenate(parts))


@dataclass(frozen=True, eq=False)
class _Links:
    """Connections between nodes: number, name, and nodes of each, one pair a row."""

    link: Indices
    node: Indices
    names: Sequence[str]
    n: int


class _Cut:
    """The parts of a structure that are removed, and those that stay."""

    def __init__(self, whole: Assembly, solids: Sequence[Mask], dropped: Indices) -> None:
        self.whole, self.solids = whole, solids
        n_node = len(whole.mesh.nodes)
        inside, outside = np.zeros((2, n_node), dtype=bool)
        for block, mask in zip(whole.mesh.blocks, solids, strict=True):
            inside[block.nodes[mask]] = True
            outside[block.nodes[~mask]] = True
        self.gone = outside & ~inside
        self.through = int((inside & outside).sum())
        self.families = {name: getattr(whole, name) for name in LINKS}
        self.links = self._links()
        chosen = np.isin(self._ids(), dropped)
        touching = np.zeros(self.links.n, dtype=bool)
        touching[self.links.link[self.gone[self.links.node]]] = True
        self.held = self._held(inside, chosen) & ~chosen
        self.crossing = self.held & touching & ~self._trimmable()
        used = np.zeros(n_node, dtype=bool)
        used[self.links.node[self.held[self.links.link]]] = True
        touched = inside | outside
        touched[self.links.node] = True
        self.dead = touched & ~inside & ~(used & ~self.gone)

    def _links(self) -> _Links:
        tables = [
            linked_nodes(name, member)
            for name, family in self.families.items()
            for member in family
        ]
        names = [
            f"{LINKS[name]} {getattr(member, 'id', '')}".strip()
            for name, family in self.families.items()
            for member in family
        ]
        link = np.repeat(np.arange(len(tables)), [len(table) for table in tables])
        node = np.concatenate([np.empty(0, dtype=np.int64), *tables])
        n = len(tables)
        for block in self.whole.shells:
            link = np.append(link, n + np.repeat(np.arange(len(block.ids)), block.nodes.shape[1]))
            node = np.append(node, block.nodes.ravel())
            names += [f"shell {number}" for number in block.ids.tolist()]
            n += len(block.ids)
        return _Links(link=link, node=node, names=names, n=n)

    def _ids(self) -> Indices:
        """Element ids of the links; -1 for links that are not elements."""
        elements = ("beams", "bushes", "springs", "masses", "scalar_masses")
        ids = [
            member.id if name in elements else -1
            for name, family in self.families.items()
            for member in family
        ]
        return np.concatenate(
            [np.array(ids, dtype=np.int64), *(block.ids for block in self.whole.shells)]
        )

    def _held(self, inside: Mask, chosen: Mask) -> Mask:
        """Return the links connected to a solid that stays, through others but not through cuts."""
        n_node, links = len(inside), self.links
        rows, columns = [links.link + n_node], [links.node]
        for block, mask in zip(self.whole.mesh.blocks, self.solids, strict=True):
            cells = block.nodes[mask]
            rows.append(np.repeat(cells[:, 0], cells.shape[1]))
            columns.append(cells.ravel())
        row, column = np.concatenate(rows), np.concatenate(columns)
        passable = ~self.gone[column]
        passable[: len(links.link)] &= ~chosen[links.link]
        size = n_node + links.n
        ones = np.ones(int(passable.sum()), dtype=np.int8)
        graph = sp.coo_array((ones, (row[passable], column[passable])), shape=(size, size))
        _, label = connected_components(graph.tocsr(), directed=False)
        solid = np.zeros(size, dtype=bool)
        solid[label[:n_node][inside]] = True
        return np.asarray(solid[label[n_node:]])

    def _trimmable(self) -> Mask:
        """Return the rigid couplings that keep their reference and some other nodes."""
        first = sum(len(self.families[name]) for name in list(LINKS)[:5])
        result = np.zeros(self.links.n, dtype=bool)
        for i, coupling in enumerate(self.whole.rigid_couplings):
            stays = not self.gone[coupling.reference] and bool((~self.gone[coupling.nodes]).any())
            result[first + i] = stays
        return result

    def refuse_ties(self) -> None:
        """Refuse ties between nodes that stay and nodes that are removed."""
        ties = np.flatnonzero(self.crossing)
        if ties.size:
            shown = listed(self.links.names[i] for i in ties.tolist())
            refuse_model(
                f"{shown}: these hold together what remains and what parts and without of "
                "[model] leave out; keep both sides, or leave them out too by an element set"
            )

    def assembly(self) -> Assembly:
        """Return the assembly of all that stays."""
        whole, first = self.whole, 0
        families: dict[str, Any] = {}
        for name, family in self.families.items():
            stay = self.held[first : first + len(family)].tolist()
            families[name] = tuple(member for member, ok in zip(family, stay, strict=True) if ok)
            first += len(family)
        families["rigid_couplings"] = tuple(
            self._trim(member) for member in families["rigid_couplings"]
        )
        shells = []
        for block in whole.shells:
            shells.append(block.taken(self.held[first : first + len(block.ids)]))
            first += len(block.ids)
        return replace(
            whole,
            mesh=self._mesh(whole.mesh),
            shells=tuple(block for block in shells if len(block.ids)),
            supports=tuple(member for s in whole.supports for member in self._support(s)),
            face_sets=self._face_sets(whole.face_sets),
            loads=self._loads(whole.loads),
            **families,
        )

    def _trim(self, coupling: RigidCoupling) -> RigidCoupling:
        return replace(coupling, nodes=coupling.nodes[~self.gone[coupling.nodes]])

    def _mesh(self, mesh: Mesh) -> Mesh:
        blocks = [b.taken(mask) for b, mask in zip(mesh.blocks, self.solids, strict=True)]
        solid = np.concatenate([b.ids for b in blocks])
        removed = np.setdiff1d(mesh.element_ids, solid)
        sets = {name: ids[~np.isin(ids, removed)] for name, ids in mesh.element_sets.items()}
        nodes = {name: members[~self.dead[members]] for name, members in mesh.node_sets.items()}
        return replace(
            mesh,
            blocks=tuple(block for block in blocks if len(block.ids)),
            element_sets={name: ids for name, ids in sets.items() if len(ids)},
            node_sets={name: members for name, members in nodes.items() if len(members)},
        )

    def _support(self, support: Support) -> Sequence[Support]:
        nodes = support.nodes[~self.dead[support.nodes]]
        return [replace(support, nodes=nodes)] if len(nodes) else []

    def _face_sets(self, sets: Mapping[str, Indices]) -> dict[str, Indices]:
        dead = np.append(self.dead, False)  # for unused columns (-1)
        left = {name: faces[~dead[faces].any(axis=1)] for name, faces in sets.items()}
        return {name: faces for name, faces in left.items() if len(faces)}

    def _loads(self, loads: Mapping[str, NodalLoads]) -> dict[str, NodalLoads]:
        left = {}
        for name, load in loads.items():
            stay = ~self.dead[load.nodes]
            if stay.any():
                left[name] = NodalLoads(nodes=load.nodes[stay], forces=load.forces[stay])
        return left

    def notes(self) -> list[str]:
        """Return notes on the removed parts, with their numbers."""
        removed = sum(int((~mask).sum()) for mask in self.solids)
        lines = [f"{removed} of {self.whole.mesh.n_elements} solids"]
        if self.through:
            lines.append(f"cut through solids at {self.through} nodes, which stay")
        lost: dict[str, int] = {}
        for i in np.flatnonzero(~self.held).tolist():
            kind = self.links.names[i].rpartition(" ")[0]
            lost[kind] = lost.get(kind, 0) + 1
        lines += [f"{count} x {kind}" for kind, count in lost.items()]
        for name, load in self.whole.loads.items():
            if count := int(self.dead[load.nodes].sum()):
                lines.append(f"load '{name}' on {count} of {len(load.nodes)} nodes")
        return lines


def remaining_joint(
    described: JointDescription, assembly: Assembly, notes: list[str]
) -> JointDescription:
    """Return the description of a joint without its removed parts.

    ``assembly`` is the remaining structure of the whole joint; removed interfaces, bolts and others
    are appended to the notes.

    Raises
    ------
    ModelError
        If a part of a bolt is removed.
    """
    whole = described.assembly
    interfaces = []
    for spec in described.interfaces:
        lost = [side for side in (spec.minus, spec.plus) if not _has_side(side, whole, assembly)]
        if lost:
            notes.append(f"interface '{spec.name}'")
            continue
        interfaces.append(spec)
        for side in (spec.minus, spec.plus):
            faces = whole.face_sets.get(side) if isinstance(side, str) else None
            if faces is not None and isinstance(side, str):
                lost_faces = len(faces) - len(assembly.face_sets[side])
                if lost_faces:
                    notes.append(f"{lost_faces} of {len(faces)} faces of '{side}' ({spec.name})")
    bolts = [bolt for bolt in described.bolts if _has_bolt(bolt, assembly)]
    notes += [f"bolt '{bolt.name}'" for bolt in described.bolts if bolt not in bolts]
    boundaries = [boundary for boundary in described.boundaries if _has_set(boundary, assembly)]
    notes += [f"boundary '{b.name}'" for b in described.boundaries if b not in boundaries]
    tight = {bolt.name for bolt in bolts}
    selected = described.selected_load
    return replace(
        described,
        assembly=assembly,
        interfaces=tuple(interfaces),
        bolts=tuple(bolts),
        boundaries=tuple(boundaries),
        preloads={n: force for n, force in described.preloads.items() if n in tight},
        initial_forces={n: f for n, f in described.initial_forces.items() if n in tight},
        unlocked=described.unlocked & tight,
        selected_load=selected if selected in assembly.loads else None,
    )


def _has_side(side: Selection, whole: Assembly, assembly: Assembly) -> bool:
    """Return whether any part of an existing side remains."""
    mesh = assembly.mesh
    if isinstance(side, str):
        named_sets = (whole.face_sets, whole.mesh.element_sets, whole.mesh.node_sets)
        left = (assembly.face_sets, mesh.element_sets, mesh.node_sets)
        return not any(side in sets for sets in named_sets) or any(side in sets for sets in left)
    if isinstance(side, int):
        return bool((mesh.element_properties == side).any() or (mesh.element_ids == side).any())
    return bool(np.isin(mesh.element_ids, np.array(side)).any())


def _has_bolt(bolt: BoltSpec, assembly: Assembly) -> bool:
    """Return whether all elements of a bolt remain; refuse bolts in part."""
    if bolt.elements is None:
        return True
    ids = {beam.id for beam in assembly.beams} | {spring.id for spring in assembly.springs}
    left = [number for number in bolt.elements if number in ids]
    if left and len(left) < len(bolt.elements):
        refuse_model(
            f"bolt '{bolt.name}': {len(bolt.elements) - len(left)} of its {len(bolt.elements)} "
            "elements are left out by parts and without of [model]; keep or leave out all"
        )
    return bool(left)


def _has_set(boundary: BoundarySpec, assembly: Assembly) -> bool:
    if boundary.set is not None:
        return boundary.set in assembly.mesh.node_sets
    return True
