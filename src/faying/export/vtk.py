"""Pictures for ParaView: deformed shapes, modes, and interface pressures and gaps over time.

A folder with

* ``structure.vtu``: the solids; displacements of each static load case, full and reduced;
* ``modes.vtu``: vibration modes of the joint linearized under its bolts, scaled to one unit of
  length at most, by the trial vectors alone (their names say so where the model also keeps a
  residual compliance, which moves the interface beyond them);
* ``trial_vectors.vtu``: displacements per coordinate q of the reduced model;
* ``bolts.vtu``: the bolts as lines, with their forces;
* ``interface_NAME.vtu``: facets of the minus side with normals, the pressure of the preload, and
  pressure and gap of each static load case as nodal averages;
* ``interface_NAME_CASE.pvd`` and the instants it lists in a folder of the same name: the same for
  each transient, with the recovered pressure.
"""

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path

import numpy as np
import scipy.linalg as la

from faying._typing import Indices, Matrix
from faying.export.hand_over import HandOver
from faying.export.linearized import linearized
from faying.export.vtk_xml import Grid, write_pvd, write_vtu
from faying.export.vtu import averaged, static_fields, surface
from faying.files.names import file_names
from faying.study.results import CaseResult, InterfaceRecord, Response
from faying.units import Units, units_of

MOST_MODES = 10
"""Vibration modes that are drawn."""

MOST_INSTANTS = 400
"""Instants of a transient that are written; of more, evenly chosen ones and the last."""


def write(hand_over: HandOver, path: Path) -> tuple[Path, ...]:
    """Write the pictures of a hand-over into a folder.

    Parameters
    ----------
    path
        Folder; made if need be, files in it are replaced atomically.

    Raises
    ------
    FormatError
        If a file cannot be written.
    """
    path.mkdir(parents=True, exist_ok=True)
    return (*_structure(hand_over, path), *_bolts(hand_over, path), *_interfaces(hand_over, path))


def _structure(hand_over: HandOver, folder: Path) -> Iterator[Path]:
    """Write what is shown on the solids."""
    units = units_of(hand_over.units)
    contents = {"structure": _static_shapes(hand_over, units)}
    if hand_over.modes is not None:
        contents["modes"] = _vibration_modes(hand_over, hand_over.modes, units)
        contents["trial_vectors"] = {
            f"q{number} {kind}": shape
            for number, (kind, shape) in enumerate(
                zip(hand_over.record.kinds, hand_over.modes, strict=True), start=1
            )
        }
    for stem, fields in contents.items():
        yield _written(_solids(hand_over, fields), folder / f"{stem}.vtu")


def _solids(hand_over: HandOver, fields: Mapping[str, Matrix]) -> Grid:
    blocks, results = hand_over.blocks, hand_over.results
    numbers: dict[str, Indices] = {"node id": hand_over.node_ids}
    if results is not None:
        numbers["body"] = results.body
    return Grid(
        points=hand_over.nodes,
        cells=[(block.kind, block.nodes) for block in blocks],
        point_data={**fields, **numbers},
        cell_data={
            "element id": _joined([block.ids for block in blocks]),
            "property": _joined([block.properties for block in blocks]),
        },
    )


def _joined(parts: list[Indices]) -> Indices:
    return np.concatenate([*parts, np.empty(0, dtype=np.int64)])


def _static_shapes(hand_over: HandOver, units: Units) -> dict[str, Matrix]:
    return {
        f"{case.name}{label} displacement [{units.length}]": response.nodal_displacement
        for case in _cases(hand_over, static=True)
        for label, response in _responses(hand_over, case)
        if response.nodal_displacement is not None
    }


def _vibration_modes(hand_over: HandOver, shapes: Matrix, units: Units) -> dict[str, Matrix]:
    """Return the lowest modes (n_node, 3) by number and frequency."""
    model = linearized(hand_over)
    # K is definite, M need not be.
    inverse, vectors = la.eigh(model.M, model.K)
    # The displacements behind a residual compliance need the finite elements.
    part = " of trial vectors" if hand_over.record.compliance else ""
    unit = "Hz" if units.time == "s" else f"1/{units.time}"
    modes = {}
    for number in range(min(MOST_MODES, len(inverse))):
        frequency = 1 / (2 * np.pi * np.sqrt(inverse[-1 - number]))
        shape = np.tensordot(vectors[:, -1 - number], shapes, axes=1)
        largest = np.linalg.norm(shape, axis=1).max(initial=0.0)
        modes[f"mode {number + 1:02d}{part}, {frequency:.5g} {unit}"] = shape / (largest or 1.0)
    return modes


def _bolts(hand_over: HandOver, folder: Path) -> Iterator[Path]:
    """Write the bolts of a run as lines."""
    results = hand_over.results
    bolts = {} if results is None else results.bolts
    drawn = {name: bolt.axis for name, bolt in bolts.items() if bolt.axis is not None}
    if not drawn:
        return
    unit = units_of(hand_over.units).force
    forces = {f"preload [{unit}]": np.array([bolts[name].preload for name in drawn])}
    for case in _cases(hand_over, static=True):
        values = [float(case.reference.bolt_forces[name]) for name in drawn]
        forces[f"{case.name} force [{unit}]"] = np.array(values)
    grid = Grid(
        points=np.concatenate(list(drawn.values())),
        cells=[("line2", np.arange(2 * len(drawn)).reshape(-1, 2))],
        cell_data=forces,
    )
    yield _written(grid, folder / "bolts.vtu")


def _interfaces(hand_over: HandOver, folder: Path) -> Iterator[Path]:
    units = units_of(hand_over.units)
    stems = file_names(hand_over.interfaces)
    moving = [case for case in _cases(hand_over, static=False) if case.times is not None]
    labels = file_names([case.name for case in moving])
    for name, record in hand_over.interfaces.items():
        stem = f"interface_{stems[name]}"
        static = _cases(hand_over, static=True)
        fields = static_fields(record, static, partial(_responses, hand_over), units)
        yield _written(surface(record, fields, None), folder / f"{stem}.vtu")
        for case in moving:
            yield from _series(hand_over, record, case, folder / f"{stem}_{labels[case.name]}")


def _series(
    hand_over: HandOver, record: InterfaceRecord, case: CaseResult, stem: Path
) -> Iterator[Path]:
    """Write one file per instant of a transient, and the series."""
    stem.mkdir(exist_ok=True)
    times = np.asarray(case.times)
    instants = np.unique(
        np.linspace(0, len(times) - 1, min(len(times), MOST_INSTANTS)).round().astype(np.int64)
    )
    responses, units = _responses(hand_over, case), units_of(hand_over.units)
    fields = averaged(record, responses, units, instants)
    entries = []
    for number, time in enumerate(times[instants].tolist()):
        now = {name: values[number] for name, values in fields.items()}
        file = stem / f"{number:04d}.vtu"
        yield _written(surface(record, now, time), file)
        entries.append((time, file))
    series = stem.parent / f"{stem.name}.pvd"
    write_pvd(entries, series)
    yield series


def _cases(hand_over: HandOver, *, static: bool) -> list[CaseResult]:
    cases = () if hand_over.results is None else hand_over.results.cases.values()
    return [case for case in cases if (case.times is None) == static]


def _responses(hand_over: HandOver, case: CaseResult) -> Iterator[tuple[str, Response]]:
    """Yield the full model's response, then that of the model that is handed over."""
    yield "", case.reference
    own = case.methods.get(hand_over.method, {}).get(hand_over.joint_modes)
    if own is not None:
        yield f" {hand_over.method}", own.response


def _written(grid: Grid, path: Path) -> Path:
    write_vtu(grid, path)
    return path
