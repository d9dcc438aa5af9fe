"""``*SURFACE``: facets of solids."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices
from faying.io.abaqus.deck_data import DeckData
from faying.io.abaqus.fields import check_count, is_integer, table
from faying.io.abaqus.keyword import Keyword, add, named
from faying.io.abaqus.sets import NamedSets
from faying.io.abaqus.shells import Shells
from faying.io.element_faces import on_blocks
from faying.model.assembly import FaceSet
from faying.model.elements import SOLIDS
from faying.model.mesh import Mesh


@dataclass(frozen=True, eq=False, kw_only=True)
class DeckSurface:
    """A surface of facets, or of nodes.

    Attributes
    ----------
    name
        As written.
    facets
        Facet kind to nodes (n_facet, n_node_per_facet), in our order, seen from outside.
    nodes : (n_node,)
        All of its nodes.
    elements : (n_element,)
        Ids of the solids its facets belong to.
    height : [length]
        How far it lies off its nodes, of shells; not a number where that differs.
    """

    name: str
    keyword: Keyword
    facets: Mapping[str, Indices]
    nodes: Indices
    elements: Indices
    height: float = 0.0


Surfaces = Mapping[str, DeckSurface]

_NO_SHELLS = Shells()
_FACES = {b"": 0, b"SNEG": 1, b"SPOS": 2}


def find_surface(surfaces: Surfaces, keyword: Keyword, name: str, row: int | None) -> DeckSurface:
    """Return a surface by name."""
    return named(keyword, name, surfaces, "surface", row)


def slave_and_master(
    surfaces: Surfaces, keyword: Keyword, row: int, fields: list[str]
) -> tuple[DeckSurface, DeckSurface]:
    """Return the two surfaces that a data line of *CONTACT PAIR or *TIE names."""
    filled = [text for text in fields if text]
    check_count(keyword, row, filled, (2,), "the slave and the master surface")
    slave, master = (find_surface(surfaces, keyword, text, row) for text in fields)
    if not master.facets:
        keyword.refuse(f"master surface '{master.name}' has no facets; give it TYPE=ELEMENT", row)
    return slave, master


def removed_sides(surfaces: Surfaces, keyword: Keyword, row: int, fields: list[str]) -> str:
    """Return the names of the surfaces of a data line that lost all of their elements."""
    sides = [find_surface(surfaces, keyword, text, row) for text in fields if text]
    return " and ".join(side.name for side in sides if not len(side.nodes))


def face_sets(surfaces: Surfaces) -> dict[str, FaceSet]:
    """Return surfaces whose facets are all of one kind as face sets."""
    by_name = {}
    for surface in surfaces.values():
        if len(surface.facets) == 1:
            kind, nodes = next(iter(surface.facets.items()))
            by_name[surface.name] = FaceSet(kind=kind, nodes=nodes)
    return by_name


def read_surfaces(
    data: DeckData, mesh: Mesh, shells: Shells = _NO_SHELLS
) -> dict[str, DeckSurface]:
    """Read all *SURFACE: element faces S1 … S6, whole elements (their exterior), or nodes.

    Faces SPOS (2) and SNEG (1) of shells are their sides along and against their normal.
    """
    surfaces: dict[str, DeckSurface] = {}
    for keyword in data.deck.of("SURFACE"):
        label = keyword.required("NAME")
        name = f"{keyword.scope.name}.{label}" if keyword.scope.name else label
        if not keyword.data:
            continue  # meshers write surfaces of nothing; whoever names one is told
        surface = (
            _of_nodes(keyword, name, mesh, data.node_sets)
            if keyword.choice("TYPE") == "NODE"
            else _of_elements(keyword, name, mesh, data.element_sets, shells)
        )
        add(surfaces, keyword, name, surface, "surfaces")
    return surfaces


def _of_nodes(keyword: Keyword, name: str, mesh: Mesh, by_node: NamedSets) -> DeckSurface:
    parts = []
    for row, fields in enumerate(keyword.rows()):
        ids = by_node.members(keyword, fields[0], row)
        unknown = ids[~np.isin(ids, mesh.node_ids)]
        if unknown.size:
            keyword.refuse(f"there is no node {unknown[0]}", row)
        parts.append(mesh.node_index(ids))
    empty = np.empty(0, dtype=np.int64)
    nodes = np.unique(np.concatenate(parts))
    return DeckSurface(name=name, keyword=keyword, facets={}, nodes=nodes, elements=empty)


def _of_elements(
    keyword: Keyword, name: str, mesh: Mesh, by_element: NamedSets, shells: Shells
) -> DeckSurface:
    ids, faces, rows = _faces(keyword, by_element)
    thin = np.concatenate([np.empty(0, np.int64), *(block.ids for block in shells.blocks)])
    facets: dict[str, list[Indices]] = {}
    heights = [np.empty(0)]
    for side, number in ((-1.0, 1), (1.0, 2)):
        on_side = np.isin(ids, thin) & (faces == number)
        parts, off = shells.facets(ids[on_side], side)
        heights.append(off)
        for kind, part in parts.items():
            facets.setdefault(kind, []).append(part)
        ids, faces, rows = ids[~on_side], faces[~on_side], rows[~on_side]
    height = np.unique(np.concatenate([*heights, np.zeros(min(len(ids), 1))]))
    whole = faces == 0
    owners = []
    if whole.any():
        exterior = mesh.exterior
        chosen = exterior.taken(np.isin(exterior.elements, ids[whole]))
        for kind, exposed in chosen.by_kind().items():
            facets.setdefault(kind, []).append(exposed)
        owners.append(chosen.elements)
        _check_all_solid(keyword, mesh, ids[whole], rows[whole])
    ids, faces, rows = ids[~whole], faces[~whole], rows[~whole]
    owners.append(ids)
    for kind, part in facets_of_faces(keyword, mesh, ids, faces, rows).items():
        facets.setdefault(kind, []).append(part)
    joined = {kind: np.concatenate(parts) for kind, parts in facets.items()}
    all_nodes = [np.empty(0, dtype=np.int64), *(part.ravel() for part in joined.values())]
    return DeckSurface(
        name=name,
        keyword=keyword,
        facets=joined,
        nodes=np.unique(np.concatenate(all_nodes)),
        elements=np.unique(np.concatenate(owners)),
        height=float(height[0]) if len(height) == 1 else np.nan,
    )


def facets_of_faces(
    keyword: Keyword, mesh: Mesh, ids: Indices, faces: Indices, rows: Indices
) -> dict[str, Indices]:
    """Return facet kind to nodes (n_facet, n_node_per_facet) of faces 1 … 6 of solids."""
    _check_all_solid(keyword, mesh, ids, rows)
    facets: dict[str, list[Indices]] = {}
    for block, members, nodes in on_blocks(mesh.blocks, ids):
        table_of_faces = SOLIDS[block.kind].faces
        over = members[(faces[members] > len(table_of_faces)) | (faces[members] < 1)]
        if over.size:
            bad = int(over[0])
            keyword.refuse(
                f"element {ids[bad]} ({block.kind}) has no face {faces[bad]}", int(rows[bad])
            )
        for number, (face, local) in enumerate(table_of_faces, start=1):
            of_face = faces[members] == number
            if of_face.any():
                facets.setdefault(face.name, []).append(nodes[of_face][:, list(local)])
    return {kind: np.concatenate(parts) for kind, parts in facets.items()}


def _faces(keyword: Keyword, by_element: NamedSets) -> tuple[Indices, Indices, Indices]:
    """Element ids, face numbers (0 for all exterior ones) and data lines."""
    columns, _ = table(keyword).columns(1, 2, "an element or element set and a face S1 … S6")
    rows = np.arange(len(keyword.data), dtype=np.int64)
    labels, row_of_label = np.unique(np.strings.upper(columns[1]), return_inverse=True)
    numbers = np.array([_face_number(keyword, t, row_of_label, i) for i, t in enumerate(labels)])
    faces = numbers[row_of_label]
    single = np.strings.isdigit(columns[0])
    numbered = np.asarray(columns[0][single], dtype=np.int64) + keyword.scope.offset
    there = ~np.isin(numbered, by_element.absent)
    ids = [numbered[there]]
    parts = [(faces[single][there], rows[single][there])]
    for row in np.flatnonzero(~single).tolist():
        label = columns[0][row].decode("latin-1")
        if not label or is_integer(label):
            keyword.refuse(f"found '{label}', expected an element id or an element set", row)
        members = by_element.members(keyword, label, row)
        ids.append(members)
        parts.append((np.full(len(members), faces[row]), np.full(len(members), row)))
    return (
        np.concatenate(ids),
        np.concatenate([face for face, _ in parts]),
        np.concatenate([row for _, row in parts]),
    )


def _face_number(keyword: Keyword, text: bytes, rows: Indices, which: int) -> int:
    if text in _FACES:
        return _FACES[text]
    if len(text) == 2 and text[:1] == b"S" and text[1:] in (b"1", b"2", b"3", b"4", b"5", b"6"):
        return int(text[1:])
    row = int(np.flatnonzero(rows == which)[0])
    message = (
        f"found '{text.decode('latin-1')}', expected a face S1 … S6 of a solid, or SPOS or SNEG of "
        "a shell"
    )
    raise keyword.error(message, row)


def _check_all_solid(keyword: Keyword, mesh: Mesh, ids: Indices, rows: Indices) -> None:
    unknown = np.flatnonzero(~np.isin(ids, mesh.element_ids))
    if unknown.size:
        bad = int(unknown[0])
        keyword.refuse(
            f"{ids[bad]} is no solid element; surfaces need solids or shells",
            int(rows[bad]),
        )
