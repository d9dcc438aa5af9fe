"""Interfaces with pressures and gaps of the static cases as VTK files (``.vtu``) for ParaView."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from faying._typing import Matrix
from faying.files.names import file_names
from faying.io.vtk_xml import Grid, write_vtu
from faying.study.interface_surface import nodal_average, pair_facets
from faying.study.results import CaseResult, InterfaceRecord, Response, Results
from faying.units import Units, units_of


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
    grid = Grid(points=record.pair_points, cells=pair_facets(record), point_data=fields, time=time)
    write_vtu(grid, path)


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
