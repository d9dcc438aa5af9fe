"""Interfaces with pressures and gaps of the static cases as VTK files (``.vtu``) for ParaView.

Format: VTK XML UnstructuredGrid 1.0, arrays inline in base64, each preceded by its length in bytes
as UInt64 (https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html).
"""

import base64
from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from faying._typing import Indices, Matrix
from faying.exceptions import FormatError
from faying.study.file_names import file_names
from faying.study.files import replacing
from faying.study.interface_surface import nodal_average, pair_facets
from faying.study.results import CaseResult, InterfaceRecord, Response, Results
from faying.study.units import Units, units_of

CELL_TYPES = {"tri3": 5, "tri6": 22, "quad4": 9, "quad8": 23}
"""VTK's numbers of the facet kinds; the node order is the same."""

VTK_TYPES = {"f8": "Float64", "i8": "Int64", "u1": "UInt8"}


def write_interface_vtu(results: Results, folder: Path) -> tuple[Path, ...]:
    """Write ``interface_NAME.vtu`` for each interface: the facets of its minus side.

    Point data are nodal averages: pressure and gap of each static case by the full model and by
    each method, the pressure of the preload, and 1 where pairs stick.

    Parameters
    ----------
    folder
        An existing folder; files in it are replaced atomically.

    Returns
    -------
    tuple of Path
        The files, in the order of the interfaces.

    Raises
    ------
    FormatError
        If a file cannot be written.
    """
    units = units_of(results.units)
    stems = file_names(results.interfaces)
    paths = []
    for name, record in results.interfaces.items():
        path = folder / f"interface_{stems[name]}.vtu"
        write_fields_vtu(record, dict(_fields(results, record, units)), path)
        paths.append(path)
    return tuple(paths)


def write_fields_vtu(
    record: InterfaceRecord, fields: Mapping[str, Matrix], path: Path, *, time: float | None = None
) -> None:
    """Write point data (n_pair,) by name on the facets of the minus side of an interface.

    Parameters
    ----------
    time
        Instant the fields belong to, which viewers show.

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    try:
        with replacing(path) as temporary:
            document = _document(record, fields, time)
            document.write(temporary, encoding="utf-8", xml_declaration=True)
    except OSError as error:
        message = f"cannot write {path}: {error.strerror}; check the folder and free space"
        raise FormatError(message) from None


def _fields(
    results: Results, record: InterfaceRecord, units: Units
) -> Iterator[tuple[str, Matrix]]:
    """Yield the point data by name."""
    yield f"preload pressure [{units.pressure}]", record.averaging @ record.preload_pressure
    yield "sticking", record.stuck.astype("u1")
    for case in results.cases.values():
        if case.times is not None:
            continue
        for label, response in _responses(case):
            pressure, gap = (nodal_average(record, v) for v in (response.pressure, response.gap))
            yield f"{case.name} {label} pressure [{units.pressure}]", pressure
            yield f"{case.name} {label} gap [{units.length}]", gap


def _responses(case: CaseResult) -> Iterator[tuple[str, Response]]:
    yield "reference", case.reference
    for method, sizes in case.methods.items():
        for count, result in sizes.items():
            yield f"{method} {count}" if count else method, result.response


def _document(
    record: InterfaceRecord, fields: Mapping[str, Matrix], time: float | None
) -> "ET.ElementTree[ET.Element]":
    facets = pair_facets(record)
    connectivity = [nodes.ravel() for _, nodes in facets]
    lengths = [np.full(len(nodes), nodes.shape[1]) for _, nodes in facets]
    kinds = [np.full(len(nodes), CELL_TYPES[kind]) for kind, nodes in facets]
    root = ET.Element(
        "VTKFile",
        type="UnstructuredGrid",
        version="1.0",
        byte_order="LittleEndian",
        header_type="UInt64",
    )
    grid = ET.SubElement(root, "UnstructuredGrid")
    if time is not None:
        _add_array(ET.SubElement(grid, "FieldData"), "TimeValue", np.array([time]), "f8")
        grid[0][0].set("NumberOfTuples", "1")
    count = str(sum(len(nodes) for _, nodes in facets))
    piece = ET.SubElement(
        grid, "Piece", NumberOfPoints=str(len(record.pair_points)), NumberOfCells=count
    )
    points = ET.SubElement(piece, "Points")
    _add_array(points, "Points", record.pair_points, "f8")
    cells = ET.SubElement(piece, "Cells")
    _add_array(cells, "connectivity", _joined(connectivity), "i8")
    _add_array(cells, "offsets", np.cumsum(_joined(lengths)), "i8")
    _add_array(cells, "types", _joined(kinds), "u1")
    data = ET.SubElement(piece, "PointData")
    for name, values in fields.items():
        _add_array(data, name, values, "u1" if values.dtype == np.uint8 else "f8")
    ET.indent(root)
    return ET.ElementTree(root)


def _joined(parts: list[Indices]) -> Indices:
    return np.concatenate([*parts, np.empty(0, dtype=np.int64)])


def _add_array(parent: ET.Element, name: str, values: Matrix | Indices, kind: str) -> None:
    array = np.ascontiguousarray(values, dtype=f"<{kind}")
    element = ET.SubElement(parent, "DataArray", type=VTK_TYPES[kind], Name=name, format="binary")
    if array.ndim == 2:
        element.set("NumberOfComponents", str(array.shape[1]))
    content = array.nbytes.to_bytes(8, "little") + array.tobytes()
    element.text = base64.b64encode(content).decode("ascii")
