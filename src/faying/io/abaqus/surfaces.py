"""``*SURFACE``: facets of solids and shells, and surfaces of nodes."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices
from faying.io.abaqus.deck_data import DeckData
from faying.io.abaqus.fields import Line, is_integer, table
from faying.io.abaqus.keyword import Keyword, add, named
from faying.io.abaqus.sets import NamedSets
from faying.io.abaqus.shells import Shells
from faying.io.element_faces import numbered_faces
from faying.model.mesh import Mesh
from faying.model.surface import WIDTH


@dataclass(frozen=True, eq=False, kw_only=True)
class DeckSurface:
    """A surface of facets, or of nodes.

    Attributes
    ----------
    name
        Name as written.
    facets : (n_facet, 8)
        Nodes in faying's order seen from outside, -1 behind those of a facet; none of nodes alone.
    nodes : (n_node,)
        All nodes of the surface.
    elements : (n_element,)
        Ids of the solids of the facets.
    height : [length]
        Distance of a shell surface from its nodes; NaN where it varies.
    """

    name: str
    keyword: Keyword
    facets: Indices
    nodes: Indices
    elements: Indices
    height: float = 0.0


Surfaces = Mapping[str, DeckSurface]

_NO_SHELLS = Shells()
_FACES = {b"": 0, b"SNEG": 1, b"SPOS": 2}


def find_surface(surfaces: Surfaces, keyword: Keyword, name: str, row: int | None) -> DeckSurface:
    """Return a surface by name."""
    return named(keyword, name, surfaces, "surface", row)


def _named_surfaces(surfaces: Surfaces, line: Line) -> list[DeckSurface]:
    return [find_surface(surfaces, line.keyword, text, line.row) for text in line.texts if text]


def slave_and_master(surfaces: Surfaces, line: Line) -> tuple[DeckSurface, DeckSurface]:
    """Return the two surfaces of a data line of *CONTACT PAIR or *TIE."""
    filled = replace(line, texts=[text for text in line.texts if text])
    filled.check((2,), "the slave and the master surface")
    slave, master = _named_surfaces(surfaces, filled)
    if not len(master.facets):
        line.refuse(f"master surface '{master.name}' has no facets; give it TYPE=ELEMENT")
    return slave, master


def removed_sides(surfaces: Surfaces, line: Line) -> str:
    """Return the names of the surfaces of a data line whose elements were all removed."""
    sides = _named_surfaces(surfaces, line)
    return " and ".join(side.name for side in sides if not len(side.nodes))


def face_sets(surfaces: Surfaces, mesh: Mesh) -> dict[str, Indices]:
    """Return the facets of surfaces by name; of a surface of nodes those between them."""
    by_name = {}
    for surface in surfaces.values():
        of_nodes = not len(surface.facets)
        faces = mesh.exterior.within(surface.nodes).nodes if of_nodes else surface.facets
        if len(faces):
            by_name[surface.name] = faces
    return by_name


def read_surfaces(
    data: DeckData, mesh: Mesh, shells: Shells = _NO_SHELLS
) -> dict[str, DeckSurface]:
    """Read all *SURFACE: element faces S1 … S6, whole elements (their exterior), or nodes.

    Faces SPOS (2) and SNEG (1) of shells are the sides along and against their normal.
    """
    surfaces: dict[str, DeckSurface] = {}
    for keyword in data.deck.of("SURFACE"):
        label = keyword.required("NAME")
        name = f"{keyword.scope.name}.{label}" if keyword.scope.name else label
        if not keyword.data:
            continue  # meshers write empty surfaces; using one is refused
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
    none = np.empty((0, WIDTH), dtype=np.int64)
    nodes = np.unique(np.concatenate(parts))
    return DeckSurface(name=name, keyword=keyword, facets=none, nodes=nodes, elements=none[:, 0])


def _of_elements(
    keyword: Keyword, name: str, mesh: Mesh, by_element: NamedSets, shells: Shells
) -> DeckSurface:
    ids, faces, rows = _faces(keyword, by_element)
    thin = np.concatenate([np.empty(0, np.int64), *(block.ids for block in shells.blocks)])
    of_shells = np.isin(ids, thin) & np.isin(faces, (1, 2))
    tables, heights = [], []
    for side, number in ((-1.0, 1), (1.0, 2)):
        facets, off = shells.facets(ids[of_shells & (faces == number)], side)
        tables.append(facets)
        heights.append(off)
    ids, faces, rows = ids[~of_shells], faces[~of_shells], rows[~of_shells]
    height = np.unique(np.concatenate([*heights, np.zeros(min(len(ids), 1))]))
    whole = faces == 0
    owners = [ids[~whole]]
    if whole.any():
        _check_all_solid(keyword, mesh, ids[whole], rows[whole])
        exposed = mesh.exterior.taken(np.isin(mesh.exterior.elements, ids[whole]))
        tables.append(exposed.nodes)
        owners.append(exposed.elements)
    tables.append(faces_of_solids(keyword, mesh, ids[~whole], faces[~whole], rows[~whole]))
    nodes = np.concatenate(tables)
    return DeckSurface(
        name=name,
        keyword=keyword,
        facets=nodes,
        nodes=np.unique(nodes[nodes >= 0]),
        elements=np.unique(np.concatenate(owners)),
        height=float(height[0]) if len(height) == 1 else np.nan,
    )


def faces_of_solids(
    keyword: Keyword, mesh: Mesh, ids: Indices, faces: Indices, rows: Indices
) -> Indices:
    """Return faces 1 … 6 of solids as a table of facets (n, 8)."""
    _check_all_solid(keyword, mesh, ids, rows)
    facets = numbered_faces(mesh.blocks, ids, faces)
    missing = np.flatnonzero(facets[:, 0] < 0)
    if missing.size:
        bad = int(missing[0])
        keyword.refuse(f"element {ids[bad]} has no face {faces[bad]}", int(rows[bad]))
    return facets


def _faces(keyword: Keyword, by_element: NamedSets) -> tuple[Indices, Indices, Indices]:
    """Return element ids, face numbers (0 for all exterior ones) and data lines."""
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
            f"{ids[bad]} is not a solid element; surfaces need solids or shells",
            int(rows[bad]),
        )
