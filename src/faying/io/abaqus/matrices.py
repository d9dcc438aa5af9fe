"""Matrices of Abaqus (``.mtx``) and CalculiX (``.sti``, ``.mas``), and the mesh of their deck."""

import io
import re
from collections.abc import Mapping
from dataclasses import replace
from os import PathLike
from pathlib import Path

import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix, Vector
from faying.exceptions import FormatError, refuse
from faying.files.contents import file_bytes
from faying.io.abaqus.deck import check_parameters, read_keyword_deck, with_distinct_ids
from faying.io.abaqus.deck_data import read_data
from faying.io.abaqus.mesh import LINE_TYPES, SOLID_TYPES
from faying.io.abaqus.solid_sections import cells
from faying.io.abaqus.surfaces import face_sets, read_surfaces
from faying.io.matrix_labels import LabelledMatrix
from faying.model.mesh import Mesh

_GEOMETRY = frozenset(("NODE", "SYSTEM", "ELEMENT", "NSET", "ELSET", "SURFACE"))


def read_geometry(path: str | PathLike[str]) -> tuple[Mesh, Mapping[str, Indices]]:
    """Read nodes, solids, sets and surfaces of a deck whose other content is in matrices.

    Elements of other kinds, and their sets and surfaces, are skipped.
    """
    deck = read_keyword_deck(Path(path))
    supported = (*SOLID_TYPES, *LINE_TYPES)
    keywords = [
        keyword
        for keyword in with_distinct_ids(deck.keywords, deck.ignored)
        if keyword.name in _GEOMETRY
        and (keyword.name != "ELEMENT" or keyword.value("TYPE").upper() in supported)
    ]
    deck = replace(deck, keywords=keywords)
    check_parameters(deck)
    data = read_data(deck)
    ids = sum(len(block.ids) for block in data.elements.solids)
    mesh = Mesh(
        nodes=data.nodes.coordinates,
        node_ids=data.nodes.ids,
        blocks=tuple(cells(data.elements.solids, np.zeros(ids, dtype=np.int64))),
        node_sets=data.node_sets.indices(data.nodes),
    )
    return mesh, face_sets(read_surfaces(data, mesh), mesh)


_ALLOWED = re.compile(rb"[\d\s,.+\-EeDd]*")
_DOF = re.compile(rb"\s*(\d{1,15})\.([1-6])\s*")
# Abaqus writes this on the diagonal of held degrees of freedom.
_HELD = 1e36


def read_abaqus_matrix(path: Path, name: str) -> LabelledMatrix:
    """Read a matrix of Abaqus' *MATRIX OUTPUT.

    FORMAT=MATRIX INPUT and LABELS have lines of node, component, node, component, value; rows come
    in ascending order of node and component. FORMAT=COORDINATE has row, column, value and no
    labels. One triangle or both may be present. Rows of held degrees of freedom (1e36 on the
    diagonal of a stiffness) are left out.
    """
    table = _numbers(path, name, (3, 5))
    if table.shape[1] == 3:
        rows, columns = (_whole(table[:, i], path, name) - 1 for i in (0, 1))
        size = int(max(rows.max(initial=-1), columns.max(initial=-1))) + 1
        return LabelledMatrix(matrix=_symmetric(rows, columns, table[:, 2], size, path, name))
    ends = [_whole(table[:, i], path, name) for i in range(4)]
    first, second = np.column_stack(ends[:2]), np.column_stack(ends[2:])
    dofs, positions = np.unique(np.vstack([first, second]), axis=0, return_inverse=True)
    wrong = np.flatnonzero((dofs[:, 1] > 6) | (dofs[:, 1] < 1) | (dofs[:, 0] < 1))
    if wrong.size:
        refuse(
            f"matrix {name}: '{path}' has a row for node {dofs[wrong[0], 0]} component "
            f"{dofs[wrong[0], 1]}; expected nodes of the model and components 1 to 6 (no internal "
            "nodes, no temperatures)"
        )
    rows, columns = positions.ravel()[: len(table)], positions.ravel()[len(table) :]
    matrix = _symmetric(rows, columns, table[:, 4], len(dofs), path, name)
    fixed = matrix.diagonal() >= _HELD
    free = np.flatnonzero(~fixed)
    return LabelledMatrix(
        matrix=sp.csr_array(matrix[free][:, free]), dofs=dofs[free], fixed=dofs[fixed]
    )


def read_calculix_matrix(path: Path, name: str) -> LabelledMatrix:
    """Read a matrix of CalculiX' *FREQUENCY, SOLVER=MATRIXSTORAGE.

    Lines are row, column, value of the upper triangle; ``job.dof`` beside it has node.component of
    each row. Without that file the matrix has no labels.
    """
    table = _numbers(path, name, (3,))
    rows, columns = (_whole(table[:, i], path, name) - 1 for i in (0, 1))
    size = int(max(rows.max(initial=-1), columns.max(initial=-1))) + 1
    labels = path.with_suffix(".dof")
    dofs = _labels(labels) if labels.is_file() else None
    if dofs is not None and len(dofs) < size:
        refuse(f"matrix {name}: '{path}' has {size} rows but '{labels}' names {len(dofs)}")
    size = size if dofs is None else len(dofs)
    return LabelledMatrix(
        matrix=_symmetric(rows, columns, table[:, 2], size, path, name), dofs=dofs
    )


def _labels(path: Path) -> Indices:
    """Return node and component (n, 2) of each row."""
    labels = []
    for number, line in enumerate(file_bytes(path).splitlines(), start=1):
        match = _DOF.fullmatch(line)
        if match:
            labels.append((int(match.group(1)), int(match.group(2))))
        elif line.strip():
            shown = line.decode("latin-1").strip()[:40]
            refuse(f"{path}:{number}: found '{shown}', expected node.component (1 to 6)")
    return np.array(labels, dtype=np.int64).reshape(-1, 2)


def _numbers(path: Path, name: str, widths: tuple[int, ...]) -> Matrix:
    """Return the table of a file whose lines have one of some numbers of fields."""
    data = file_bytes(path)
    if b"*" in data:
        lines = data.splitlines()
        for number, line in enumerate(lines, start=1):
            text = line.lstrip()
            if text[:1] == b"*" and text[:2] != b"**":
                shown = text.decode("latin-1")[:40]
                refuse(
                    f"{path}:{number}: matrix {name}: found '{shown}'; expected a file written by "
                    "*MATRIX OUTPUT, which holds numbers only"
                )
        data = b"\n".join(b"" if line.lstrip()[:2] == b"**" else line for line in lines)
    if not _ALLOWED.fullmatch(data):
        raise _unreadable_row(path, name, data, widths)
    plain = data.translate(bytes.maketrans(b",Dd", b" EE"))
    if not plain.strip():
        refuse(f"matrix {name}: '{path}' holds no numbers; write it again")
    width = len(plain.lstrip().split(b"\n", 1)[0].split())
    expected = (width,) if width in widths else widths
    try:
        table = np.loadtxt(io.BytesIO(plain), comments=None, ndmin=2)
    except ValueError:
        raise _unreadable_row(path, name, data, expected) from None
    if table.shape[1] not in widths or not np.isfinite(table).all():
        raise _unreadable_row(path, name, data, widths)
    return table


def _unreadable_row(path: Path, name: str, data: bytes, widths: tuple[int, ...]) -> FormatError:
    """Return the error for the first line that is not a row of finite numbers."""
    wished = " or ".join(map(str, widths))
    for number, line in enumerate(data.splitlines(), start=1):
        texts = line.replace(b",", b" ").replace(b"D", b"E").replace(b"d", b"E").split()
        if texts and (len(texts) not in widths or not _finite(texts)):
            shown = line.decode("latin-1").strip()[:60]
            message = f"{path}:{number}: matrix {name}: found '{shown}', expected {wished} numbers"
            return FormatError(message)
    message = f"matrix {name}: '{path}' is not a table of {wished} columns; write it again"
    return FormatError(message)


def _finite(texts: list[bytes]) -> bool:
    try:
        return bool(np.isfinite([float(text) for text in texts]).all())
    except ValueError:
        return False


def _whole(column: Vector, path: Path, name: str) -> Indices:
    # Doubles hold whole numbers up to 2⁵³ exactly.
    wrong = np.flatnonzero((column != np.floor(column)) | (np.abs(column) >= 2.0**53))
    if wrong.size:
        refuse(
            f"matrix {name}: '{path}', entry {wrong[0] + 1}: {column[wrong[0]]:g} is no row, node "
            "or component; expected whole numbers"
        )
    return column.astype(np.int64)


def _symmetric(
    rows: Indices, columns: Indices, values: Vector, size: int, path: Path, name: str
) -> SparseMatrix:
    """Return the full matrix of entries in one triangle or both."""
    bad = np.flatnonzero((rows < 0) | (columns < 0))
    if bad.size or size > 10 * len(values) + 10:
        entry = int(bad[0]) + 1 if bad.size else int(np.maximum(rows, columns).argmax()) + 1
        refuse(f"matrix {name}: '{path}', entry {entry}: its row or column is out of range")
    keys, counts = np.unique(rows * np.int64(size) + columns, return_counts=True)
    if counts.max(initial=1) > 1:
        row, column = divmod(int(keys[counts > 1][0]), size)
        refuse(f"matrix {name}: '{path}' gives entry ({row + 1}, {column + 1}) twice")
    matrix = sp.csr_array((values, (rows, columns)), shape=(size, size))
    upper, lower = sp.triu(matrix, 1, format="csr"), sp.tril(matrix, -1, format="csr")
    if upper.nnz and lower.nnz:
        return matrix
    return sp.csr_array(matrix + upper.T + lower.T)
