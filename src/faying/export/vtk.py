"""Files for ParaView: deformed shapes, modes, and interface pressures and gaps over time.

A folder with

* ``structure.vtu``: the solids; displacements of each static load case, full and reduced;
* ``modes.vtu``: vibration modes of the joint linearized under its bolts, scaled to one unit of
  length, from the trial vectors alone (as their names say if the model also has a
  residual compliance, which adds displacements at the interface);
* ``trial_vectors.vtu``: displacements per coordinate q of the reduced model;
* ``bolts.vtu``: the bolts as lines, with their forces;
* ``interface_NAME.vtu``: facets of the minus side with normals, the pressure of the preload, and
  pressure and gap of each static load case as nodal averages;
* ``interface_NAME_CASE.pvd`` and its instants in a folder of the same name: these fields of
  each transient, with the recovered pressure.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path

import numpy as np

from faying._typing import Indices, Matrix
from faying.assessment.recovery import solve_cases_at_ports
from faying.export.linearized import linearize
from faying.export.vtk_files import write_pvd, write_vtu
from faying.files.names import file_names
from faying.interface.surface import ContactSurface, nodal_average, pair_facets
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.static import AT_REST
from faying.study.results.values import (
    CaseResult,
    InterfaceRecord,
    Response,
    Results,
    interface_record,
)
from faying.units import Units


def write_interface_vtu(results: Results, folder: Path) -> tuple[Path, ...]:
    """Write ``interface_NAME.vtu`` of each interface, atomically: the facets of its minus side.

    Point data are nodal averages: pressure and gap of each static case by the full model and by
    each method, the pressure of the preload, the initial gap, normals, and 1 where pairs stick.

    Raises
    ------
    FormatError
        If a file cannot be written.
    """
    units = results.unit_set
    stems = file_names(results.interfaces)
    return tuple(
        write_fields_vtu(
            record,
            static_fields(record, results.cases.values(), _every_response, units),
            folder / f"interface_{stems[name]}.vtu",
        )
        for name, record in results.interfaces.items()
    )


def write_fields_vtu(
    record: ContactSurface, fields: Mapping[str, Matrix], path: Path, *, time: float | None = None
) -> Path:
    """Write point data (n_pair,) by name on the facets of the minus side of an interface.

    Normals, and 1 where pairs stick, are written too. Viewers show the time of the
    fields.

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    fixed = {"normal": _pair_normals(record), "sticking": record.stuck.astype("u1")}
    point_data = {**fields, **fixed}
    cells = pair_facets(record)
    return write_vtu(path, record.pair_points, cells, point_data=point_data, time=time)


def _pair_normals(record: ContactSurface) -> Matrix:
    """Return the normals (n_pair, 3) of node pairs, averaged from the contact points."""
    mean = record.nodal_average(record.normals)
    length = np.linalg.norm(mean, axis=1, keepdims=True)
    return mean / np.where(length > 0, length, 1.0)


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


def _every_response(case: CaseResult) -> Iterator[tuple[str, Response]]:
    yield "reference", case.reference
    for method, sizes in case.methods.items():
        for count, result in sizes.items():
            yield f"{method} {count}" if count else method, result.response


MOST_MODES = 10
"""Largest number of vibration modes that are written."""

MOST_INSTANTS = 400
"""Most instants of a transient; of more, evenly spaced ones and the last are written."""


def write(rom: ReducedModel, path: Path, run: Results | None = None) -> tuple[Path, ...]:
    """Write the files of a reduced model to a folder, atomically; it is made if missing.

    Load cases and bolts are read from the run.

    Raises
    ------
    FormatError
        If a file cannot be written.
    """
    path.mkdir(parents=True, exist_ok=True)
    written = (_structure(rom, run, path), _bolts(run, path), _interfaces(rom, run, path))
    return tuple(file for files in written for file in files)


def _structure(rom: ReducedModel, run: Results | None, folder: Path) -> Iterator[Path]:
    """Write the fields on the solids; yield the paths."""
    units = rom.unit_set
    contents = {"structure": _static_shapes(rom, run, units)}
    modes = rom.mesh.modes
    if modes is not None:
        contents["modes"] = _vibration_modes(rom, modes, units)
        contents["trial_vectors"] = {
            f"q{number} {kind}": shape
            for number, (kind, shape) in enumerate(
                zip(rom.basis.kinds, modes, strict=True), start=1
            )
        }
    cells = [(block.kind, block.nodes) for block in rom.mesh.blocks]
    numbers: dict[str, Indices] = {"node id": rom.mesh.node_ids}
    if run is not None:
        numbers["body"] = run.body
    nothing = np.empty(0, dtype=np.int64)
    of_cells = {
        "element id": np.concatenate([nothing, *(block.ids for block in rom.mesh.blocks)]),
        "property": np.concatenate([nothing, *(block.properties for block in rom.mesh.blocks)]),
    }
    for stem, fields in contents.items():
        data: dict[str, Matrix | Indices] = {**fields, **numbers}
        file = folder / f"{stem}.vtu"
        yield write_vtu(file, rom.mesh.nodes, cells, point_data=data, cell_data=of_cells)


def _static_shapes(rom: ReducedModel, run: Results | None, units: Units) -> dict[str, Matrix]:
    return {
        f"{case.name}{label} displacement [{units.length}]": response.nodal_displacement
        for case in _cases(run, static=True)
        for label, response in _responses(rom, run, case)
        if response.nodal_displacement is not None
    }


def _vibration_modes(rom: ReducedModel, shapes: Matrix, units: Units) -> dict[str, Matrix]:
    """Return the lowest modes (n_node, 3) by number and frequency."""
    model = linearize(rom)
    frequencies, vectors = model.modes(MOST_MODES)
    # Displacements by the residual compliance would need the finite elements.
    part = " of trial vectors" if rom.contact.residual_compliance is not None else ""
    unit = units.frequency
    modes = {}
    for number in range(len(frequencies)):
        frequency = frequencies[number]
        shape = np.tensordot(vectors[:, number], shapes, axes=1)
        largest = np.linalg.norm(shape, axis=1).max(initial=0.0)
        modes[f"mode {number + 1:02d}{part}, {frequency:.5g} {unit}"] = shape / (largest or 1.0)
    return modes


def _bolts(run: Results | None, folder: Path) -> Iterator[Path]:
    """Write the bolts of a run as lines; yield the path."""
    bolts = {} if run is None else run.bolts
    drawn = {name: bolt.axis for name, bolt in bolts.items() if bolt.axis is not None}
    if run is None or not drawn:
        return
    unit = run.unit_set.force
    forces = {f"preload [{unit}]": np.array([bolts[name].preload for name in drawn])}
    for case in _cases(run, static=True):
        values = [float(case.reference.bolt_forces[name]) for name in drawn]
        forces[f"{case.name} force [{unit}]"] = np.array(values)
    ends = np.concatenate(list(drawn.values()))
    lines = np.arange(2 * len(drawn)).reshape(-1, 2)
    yield write_vtu(folder / "bolts.vtu", ends, [("line2", lines)], cell_data=forces)


def _interfaces(rom: ReducedModel, run: Results | None, folder: Path) -> Iterator[Path]:
    units = rom.unit_set
    stems = file_names(rom.interfaces)
    preloaded = solve_cases_at_ports(rom.joint, [AT_REST]).pressure[0]
    moving = [case for case in _cases(run, static=False) if case.times is not None]
    labels = file_names([case.name for case in moving])
    for name, record in rom.interfaces.items():
        stem = f"interface_{stems[name]}"
        records = (
            record
            if isinstance(record, InterfaceRecord)
            else interface_record(record, preloaded[slice(*record.slice)])
        )
        responses = partial(_responses, rom, run)
        fields = static_fields(records, _cases(run, static=True), responses, units)
        yield write_fields_vtu(record, fields, folder / f"{stem}.vtu")
        for case in moving:
            yield from _series(rom, run, record, case, folder / f"{stem}_{labels[case.name]}")


def _series(
    rom: ReducedModel, run: Results | None, record: ContactSurface, case: CaseResult, stem: Path
) -> Iterator[Path]:
    """Write a file per instant of a transient, and the series; yield the paths."""
    stem.mkdir(exist_ok=True)
    times = np.asarray(case.times)
    instants = np.unique(
        np.linspace(0, len(times) - 1, min(len(times), MOST_INSTANTS)).round().astype(np.int64)
    )
    fields = averaged(record, _responses(rom, run, case), rom.unit_set, instants)
    entries = []
    for number, time in enumerate(times[instants].tolist()):
        now = {name: values[number] for name, values in fields.items()}
        file = stem / f"{number:04d}.vtu"
        yield write_fields_vtu(record, now, file, time=time)
        entries.append((time, file))
    series = stem.parent / f"{stem.name}.pvd"
    write_pvd(entries, series)
    yield series


def _cases(run: Results | None, *, static: bool) -> list[CaseResult]:
    cases = () if run is None else run.cases.values()
    return [case for case in cases if (case.times is None) == static]


def _responses(
    rom: ReducedModel, run: Results | None, case: CaseResult
) -> Iterator[tuple[str, Response]]:
    """Yield the response of the reference, then that of the exported model."""
    yield "", case.reference
    sizes = {} if run is None else run.reduced.get(rom.method, {})
    count = next((count for count, model in sizes.items() if model is rom), None)
    errors = case.methods.get(rom.method, {}).get(-1 if count is None else count)
    if errors is not None:
        yield f" {rom.method}", errors.response
