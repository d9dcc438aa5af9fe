"""Interfaces with pressures and gaps of the static cases as VTK files (``.vtu``) for ParaView."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path

import numpy as np

from faying._typing import Indices, Matrix
from faying.export.vtk_xml import Grid, write_vtu
from faying.files.names import file_names
from faying.interface.surface import ContactSurface
from faying.study.results.interface_surface import nodal_average, pair_facets
from faying.study.results.values import CaseResult, InterfaceRecord, Response, Results
from faying.units import Units


def write_interface_vtu(results: Results, folder: Path) -> tuple[Path, ...]:
    """Write ``interface_NAME.vtu`` for each interface: the facets of its minus side.

    Point data are nodal averages: pressure and gap of each static case by the full model and by
    each method, the pressure of the preload, the initial gap, normals, and 1 where pairs stick.

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
    units = results.unit_set
    stems = file_names(results.interfaces)
    paths = []
    for name, record in results.interfaces.items():
        path = folder / f"interface_{stems[name]}.vtu"
        fields = static_fields(record, results.cases.values(), _responses, units)
        write_fields_vtu(record, fields, path)
        paths.append(path)
    return tuple(paths)


def write_fields_vtu(
    record: ContactSurface, fields: Mapping[str, Matrix], path: Path, *, time: float | None = None
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
    write_vtu(surface(record, fields, time), path)


def surface(record: ContactSurface, fields: Mapping[str, Matrix], time: float | None) -> Grid:
    """Return the facets of the minus side with point data, normals and 1 where pairs stick."""
    fixed = {"normal": _pair_normals(record), "sticking": record.stuck.astype("u1")}
    return Grid(
        points=record.pair_points,
        cells=pair_facets(record),
        point_data={**fields, **fixed},
        time=time,
    )


def _pair_normals(record: ContactSurface) -> Matrix:
    """Average the normals of the contact points to the pairs (n_pair, 3)."""
    mean = record.nodal_average(record.normals)
    length = np.linalg.norm(mean, axis=1, keepdims=True)
    normals: Matrix = mean / np.where(length > 0, length, 1.0)
    return normals


def static_fields(
    record: InterfaceRecord,
    cases: Iterable[CaseResult],
    responses: Callable[[CaseResult], Iterable[tuple[str, Response]]],
    units: Units,
) -> dict[str, Matrix]:
    """Return the nodal averages (n_pair,) of the preload and of static cases by name."""
    fields = {
        f"preload pressure [{units.pressure}]": record.nodal_average(record.preload_pressure),
        f"initial gap [{units.length}]": record.nodal_average(record.initial_gap),
    }
    for case in cases:
        if case.times is None:
            averages = averaged(record, responses(case), units)
            fields |= {f"{case.name} {name}": values[0] for name, values in averages.items()}
    return fields


def averaged(
    record: ContactSurface,
    responses: Iterable[tuple[str, Response]],
    units: Units,
    instants: Indices | slice = slice(None),
) -> dict[str, Matrix]:
    """Return nodal averages (n_instant, n_pair) by name; a static case is one instant."""
    fields = {}
    for label, response in responses:
        quantities = {
            f"pressure [{units.pressure}]": response.pressure,
            f"gap [{units.length}]": response.gap,
            f"recovered pressure [{units.pressure}]": response.recovered_pressure,
        }
        for name, values in quantities.items():
            if values is not None:
                average = nodal_average(record, np.atleast_2d(values)[instants])
                fields[f"{label} {name}".strip()] = average
    return fields


def _responses(case: CaseResult) -> Iterator[tuple[str, Response]]:
    yield "reference", case.reference
    for method, sizes in case.methods.items():
        for count, result in sizes.items():
            yield f"{method} {count}" if count else method, result.response
