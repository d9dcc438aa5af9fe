"""VTK files: unstructured grids (``.vtu``) by meshio, and series of grids (``.pvd``)."""

import os
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from faying._typing import Indices, Matrix
from faying.files.atomic import replacing, write_text
from faying.io.mesh_files import meshio_of_all_solids
from faying.model.elements import FACES, SOLIDS

_CELLS = {
    "line2": "line",
    **{kind: face.meshio for kind, face in FACES.items()},
    **{kind: element.elsewhere.meshio for kind, element in SOLIDS.items()},
}
"""Names of the cell kinds in meshio."""

_NO_DATA: Mapping[str, Matrix | Indices] = {}


def write_vtu(
    path: Path,
    points: Matrix,
    cells: Sequence[tuple[str, Indices]],
    *,
    point_data: Mapping[str, Matrix | Indices] = _NO_DATA,
    cell_data: Mapping[str, Matrix | Indices] = _NO_DATA,
    time: float | None = None,
) -> Path:
    """Write an unstructured grid as ``.vtu``, atomically; return its path.

    Parameters
    ----------
    points : (n_point, 3)
    cells
        Cell kind and node indices (n_cell, n_node_per_cell), block by block.
    point_data, cell_data
        Arrays (n_point,) or (n_point, k), and (n_cell,) or (n_cell, k), by name.
    time
        Time of the data, which viewers show.

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    meshio = meshio_of_all_solids()
    blocks = [(kind, nodes) for kind, nodes in cells if len(nodes)]
    ends = np.cumsum([len(nodes) for _, nodes in blocks], dtype=int)
    mesh = meshio.Mesh(
        points,
        [
            (_CELLS[kind], SOLIDS[kind].elsewhere.theirs(nodes) if kind in SOLIDS else nodes)
            for kind, nodes in blocks
        ],
        # meshio does not escape names.
        point_data={escape(name): np.asarray(data) for name, data in point_data.items()},
        cell_data={escape(name): np.split(data, ends)[:-1] for name, data in cell_data.items()},
    )
    with replacing(path) as temporary:
        meshio.vtu.write(temporary, mesh, header_type="UInt64")
        if time is not None:
            _add_time(temporary, time)
    return path


def _add_time(path: Path, time: float) -> None:
    """Add the time of the data, which meshio does not write."""
    array = '<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">'
    grid = "<UnstructuredGrid>"
    field = f"{grid}\n<FieldData>{array}{time!r}</DataArray></FieldData>"
    path.write_text(path.read_text().replace(grid, field, 1))


def write_pvd(entries: Sequence[tuple[float, Path]], path: Path) -> None:
    """Write a time series of grids as ``.pvd``, atomically.

    ``entries`` are times, and files in or below the folder of ``path``.

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
    ET.indent(root)
    write_text(path, ET.tostring(root, encoding="unicode"))
