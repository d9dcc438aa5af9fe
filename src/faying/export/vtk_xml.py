"""VTK's XML files: unstructured grids (``.vtu``) and series of them (``.pvd``).

Format: VTK XML UnstructuredGrid 1.0, arrays inline in base64 and compressed by zlib in blocks, each
preceded by the sizes of its blocks as UInt64
(https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html).
"""

import base64
import os
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from faying._typing import Indices, Matrix
from faying.files.atomic import replacing
from faying.model.elements import FACES, SOLIDS

CELL_TYPES = {
    "line2": 3,
    **{kind: face.vtk for kind, face in FACES.items()},
    **{kind: element.elsewhere.vtk for kind, element in SOLIDS.items()},
}
"""VTK's numbers of the cell kinds."""

VTK_TYPES = {"f8": "Float64", "i8": "Int64", "u1": "UInt8"}

BLOCK_BYTES = 32768
"""Bytes that are compressed together, as VTK's own writers choose it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Grid:
    """An unstructured grid with data.

    Attributes
    ----------
    points : (n_point, 3)
    cells
        Cell kind and node indices (n_cell, n_node_per_cell), block by block.
    point_data, cell_data
        Name to (n_point,) or (n_point, k), and to the same of the cells.
    time
        Instant the data belong to, which viewers show.
    """

    points: Matrix
    cells: Sequence[tuple[str, Indices]]
    point_data: Mapping[str, Matrix | Indices] = field(default_factory=dict)
    cell_data: Mapping[str, Matrix | Indices] = field(default_factory=dict)
    time: float | None = None


def write_vtu(grid: Grid, path: Path) -> None:
    """Write a grid as ``.vtu``, atomically.

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    _write(_grid_document(grid), path)


def write_pvd(entries: Sequence[tuple[float, Path]], path: Path) -> None:
    """Write a series of grids as ``.pvd``, atomically.

    Entries are times and files in or below the folder of ``path``.

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    root = ET.Element("VTKFile", type="Collection", version="1.0", byte_order="LittleEndian")
    collection = ET.SubElement(root, "Collection")
    for time, file in entries:
        source = Path(os.path.relpath(file, path.parent)).as_posix()
        ET.SubElement(collection, "DataSet", timestep=repr(float(time)), part="0", file=source)
    _write(root, path)


def _write(root: ET.Element, path: Path) -> None:
    ET.indent(root)
    with replacing(path) as temporary:
        ET.ElementTree(root).write(temporary, encoding="utf-8", xml_declaration=True)


def _grid_document(grid: Grid) -> ET.Element:
    blocks = [
        (CELL_TYPES[kind], SOLIDS[kind].elsewhere.theirs(nodes) if kind in SOLIDS else nodes)
        for kind, nodes in grid.cells
    ]
    lengths = _joined([np.full(len(nodes), nodes.shape[1]) for _, nodes in blocks])
    root = ET.Element(
        "VTKFile",
        type="UnstructuredGrid",
        version="1.0",
        byte_order="LittleEndian",
        header_type="UInt64",
        compressor="vtkZLibDataCompressor",
    )
    body = ET.SubElement(root, "UnstructuredGrid")
    if grid.time is not None:
        instant = _add_array(
            ET.SubElement(body, "FieldData"), "TimeValue", np.array([grid.time]), "f8"
        )
        instant.set("NumberOfTuples", "1")
    element = ET.SubElement(
        body, "Piece", NumberOfPoints=str(len(grid.points)), NumberOfCells=str(len(lengths))
    )
    _add_array(ET.SubElement(element, "Points"), "Points", grid.points, "f8")
    cells = ET.SubElement(element, "Cells")
    _add_array(cells, "connectivity", _joined([nodes.ravel() for _, nodes in blocks]), "i8")
    _add_array(cells, "offsets", np.cumsum(lengths), "i8")
    types = _joined([np.full(len(nodes), kind) for kind, nodes in blocks])
    _add_array(cells, "types", types, "u1")
    for name, data in (("PointData", grid.point_data), ("CellData", grid.cell_data)):
        holder = ET.SubElement(element, name)
        for label, values in data.items():
            _add_array(holder, label, values, _kind(values))
    return root


def _kind(values: Matrix | Indices) -> str:
    if values.dtype.kind == "f":
        return "f8"
    return "u1" if values.dtype.itemsize == 1 else "i8"


def _joined(parts: Sequence[Indices]) -> Indices:
    return np.concatenate([*parts, np.empty(0, dtype=np.int64)])


def _add_array(parent: ET.Element, name: str, values: Matrix | Indices, kind: str) -> ET.Element:
    array = np.ascontiguousarray(values, dtype=f"<{kind}")
    element = ET.SubElement(parent, "DataArray", type=VTK_TYPES[kind], Name=name, format="binary")
    if array.ndim == 2:
        element.set("NumberOfComponents", str(array.shape[1]))
    element.text = _encoded(array.tobytes())
    return element


def _encoded(content: bytes) -> str:
    """Compress in blocks; their sizes are encoded apart from them."""
    blocks = [content[start : start + BLOCK_BYTES] for start in range(0, len(content), BLOCK_BYTES)]
    packed = [zlib.compress(block) for block in blocks]
    last = len(blocks[-1]) if blocks else 0
    sizes = np.array([len(blocks), BLOCK_BYTES, last, *map(len, packed)], dtype="<u8")
    return "".join(
        base64.b64encode(part).decode("ascii") for part in (sizes.tobytes(), b"".join(packed))
    )
