"""Meshes of code_aster in text, ``.mail``: nodes, cells and groups by name.

Sections begin with a keyword and end with FINSF; a percent sign begins a comment, and ``NOM=…``,
``NBOBJ=…`` and the like are headers. code_aster, document U3.01.00.
"""

import re
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NoReturn

import numpy as np
import numpy.typing as npt

from faying._typing import Indices, Matrix
from faying.exceptions import refuse
from faying.io.deck_lines import LONGEST_WORD
from faying.model.elements import SOLIDS

Names = npt.NDArray[np.str_]

_SOLIDS = {
    f"{name}{element.n_nodes}": element
    for name, kinds in {
        "HEXA": ("hex8", "hex20"),
        "PENTA": ("wedge6", "wedge15"),
        "TETRA": ("tet4", "tet10"),
        "PYRAM": ("pyramid5", "pyramid13"),
    }.items()
    for element in (SOLIDS[kind] for kind in kinds)
}
_FACES = {
    **{"TRIA3": "triangle", "TRIA6": "triangle6", "TRIA7": "triangle7"},
    **{"QUAD4": "quad", "QUAD8": "quad8", "QUAD9": "quad9"},
    **{"SEG2": "line", "SEG3": "line3", "SEG4": "line4", "POI1": "vertex"},
}
_CELLS = re.compile(r"(?:HEXA|PENTA|TETRA|PYRAM|TRIA|QUAD|SEG|POI)(\d+)")
_HEADER = re.compile(r"\b(NOM|NBOBJ|NOBJ|NBLIGE|NBLIGT|NUMIN|NUMAX|AUTEUR|DATE)[ \t]*=[ \t]*(\S*)")
_END = re.compile(r"^[ \t]*FIN[ \t]*$", re.MULTILINE)
_GROUPS = ("GROUP_MA", "GROUP_NO")


@dataclass(frozen=True, eq=False, kw_only=True)
class _Section:
    """The words between a keyword and FINSF."""

    path: Path
    line: int
    keyword: str
    name: str
    words: Names

    def refuse(self, text: str) -> NoReturn:
        """Raise the error that names file, line and section."""
        refuse(f"{self.path}:{self.line}: {self.keyword}: {text}")

    def rows(self, width: int) -> Names:
        """Return the words as rows: a name, then its numbers or nodes."""
        if len(self.words) % width:
            self.refuse(
                f"{len(self.words)} words; expected {width} each: a name, and its numbers or nodes"
            )
        return self.words.reshape(-1, width)

    def index(self, names: Names, labels: Names, what: str) -> Indices:
        """Return the index of each name among the labels; refuse unknown names."""
        order = np.argsort(names, kind="stable")
        positions = np.searchsorted(names, labels, sorter=order)
        indices: Indices = order[np.minimum(positions, len(order) - 1)] if len(order) else positions
        missing = names[indices] != labels if len(order) else np.ones(labels.shape, dtype=bool)
        if missing.any():
            self.refuse(
                f"there is no {what} '{labels[missing].flat[0]}'; define it or correct the name"
            )
        return indices


def read_mail(path: Path) -> Any:
    """Return the mesh as meshio would; solids without a group form the group ``"solids"``."""
    sections = _sections(path)
    nodes = [section for section in sections if section.keyword.startswith("COOR_")]
    if len(nodes) != 1 or nodes[0].keyword != "COOR_3D":
        shown = ", ".join(section.keyword for section in nodes) or "none"
        refuse(f"{path}: coordinate sections: {shown}; expected one COOR_3D")
    named, points = _nodes(nodes[0])
    cells: list[Any] = []
    owned: list[Names] = []
    for section in sections:
        if match := _CELLS.fullmatch(section.keyword):
            rows = section.rows(1 + int(match[1]))
            data = section.index(named, rows[:, 1:], "node")
            solid = _SOLIDS.get(section.keyword)
            kind = _FACES.get(section.keyword, section.keyword)
            if solid is not None:
                kind, data = solid.elsewhere.meshio, solid.elsewhere.theirs(data)
            cells.append(SimpleNamespace(type=kind, data=data))
            owned.append(rows[:, 0])
    cell_sets: dict[str, list[Indices]] = {}
    point_sets: dict[str, Indices] = {}
    start = np.concatenate([[0], np.cumsum([len(section) for section in owned])]).astype(np.int64)
    every = np.concatenate([np.empty(0, dtype="U1"), *owned])
    for section in sections:
        if section.keyword == "GROUP_NO":
            point_sets[section.name] = np.unique(section.index(named, section.words, "node"))
        elif section.keyword == "GROUP_MA":
            members = np.unique(section.index(every, section.words, "cell"))
            block = np.searchsorted(start, members, side="right") - 1
            cell_sets[section.name] = [members[block == k] - start[k] for k in range(len(owned))]
    return SimpleNamespace(
        points=points,
        cells=cells,
        cell_sets=_with_all_solids(cells, cell_sets),
        point_sets=point_sets,
        cell_data={},
        field_data={},
    )


def _sections(path: Path) -> list[_Section]:
    text = re.sub(r"%[^\n]*", "", path.read_text(encoding="latin-1"))
    if _END.search(text) is None:
        refuse(f"{path}: the file does not end with FIN, so it is incomplete; write it again")
    sections, line = [], 1
    for part in re.split(r"\bFINSF\b", _END.split(text)[0]):
        body = part.lstrip()
        first = line + part[: len(part) - len(body)].count("\n")
        line += part.count("\n")
        keyword = body.split(maxsplit=1)[0] if body else ""
        if keyword in ("", "TITRE"):
            continue
        headers = dict(_HEADER.findall(body))
        split = _HEADER.sub(" ", body).replace("=", " ").split()[1:]
        longest = max(map(len, split), default=0)
        if longest > LONGEST_WORD:
            refuse(
                f"{path}:{first}: {keyword[:LONGEST_WORD]}: a word of {longest} characters; "
                f"expected names and numbers of at most {LONGEST_WORD}"
            )
        words = np.array(split, dtype=np.str_)
        name = headers.get("NOM", "")
        if keyword in _GROUPS and not name and len(words):
            name, words = str(words[0]), words[1:]
        sections.append(_Section(path=path, line=first, keyword=keyword, name=name, words=words))
    return sections


def _nodes(section: _Section) -> tuple[Names, Matrix]:
    rows = section.rows(4)
    names = rows[:, 0]
    again = np.unique(names, return_counts=True)
    if (again[1] > 1).any():
        section.refuse(f"node '{again[0][again[1] > 1][0]}' occurs twice; rename one")
    try:
        points = np.char.replace(np.char.upper(rows[:, 1:]), "D", "E").astype(np.float64)
    except ValueError as error:
        section.refuse(
            f"a coordinate is not a number ({error}); expected a name and x, y, z of every node"
        )
    return names, points


def _with_all_solids(cells: list[Any], sets: dict[str, list[Indices]]) -> dict[str, list[Indices]]:
    """Put a group of all solids in front if the groups of the file leave some out."""
    everything = [np.arange(0 if b.type in _FACES.values() else len(b.data)) for b in cells]
    grouped = [
        np.concatenate([solids[:0], *(members[k] for members in sets.values())])
        for k, solids in enumerate(everything)
    ]
    if all(np.isin(solids, held).all() for solids, held in zip(everything, grouped, strict=True)):
        return sets
    return {"solids": everything, **sets}
