"""Results in one self-describing HDF5 file, readable without faying.

The file mirrors :class:`faying.study.results.values.Results` in the manner of
:mod:`faying.files.described`; ``python docs/stored_groups.py`` prints its groups.
"""

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np

from faying._typing import Matrix
from faying.files.described import (
    Format,
    described_file,
    items,
    new_file,
    numbers,
    read_value,
    write_members,
)
from faying.reduction.model_data import MeshShapes
from faying.reduction.model_reader import read_model, read_ports
from faying.reduction.model_writer import write_models
from faying.reduction.reduced_model import ReducedModel
from faying.study.results.check import MEANINGS, check_results
from faying.study.results.solved_fields import RecoveredRecord
from faying.study.results.values import Results
from faying.units import units_of

RESULTS = Format(
    name="results",
    version=4,
    wanted="the results.h5 of a finished run",
    remedy="run the study again",
    description=(
        "Contact pressures of a jointed structure by its full finite element model (reference) and "
        "by reduced models (methods). Pressure is positive in compression, gap where open; errors "
        "are relative to the largest reference pressure of the load case."
    ),
)
RECOVERED = Format(
    name="recovered pressures",
    version=1,
    wanted="a recovered_HISTORY.h5",
    remedy="recover again",
    description=(
        "Contact pressures of a jointed structure, recovered from a history that another program "
        "made. Pressure is positive in compression, gap where open; points are those of results.h5."
    ),
)


def write_results(results: Results, path: Path) -> None:
    """Write the results of a run to an HDF5 file, atomically.

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    _write_file(path, results, RESULTS)


def write_recovered(recovered: RecoveredRecord, path: Path) -> None:
    """Write recovered pressures in the same manner, atomically.

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    _write_file(path, recovered, RECOVERED)


def _write_file(path: Path, value: Results | RecoveredRecord, kind: Format) -> None:
    units, attributes = units_of(value.units), {"title": value.title, "units": value.units}
    table = {name: meaning for name, meaning in MEANINGS[type(value)].items() if name != "reduced"}
    with new_file(path, kind, attributes, units) as file:
        members = {name: getattr(value, name) for name in table}
        write_members(file, members, table, units, MEANINGS)
        if isinstance(value, Results):
            write_models(file, value.reduced, units)


def read_results(path: Path) -> Results:
    """Read what :func:`write_results` wrote.

    Raises
    ------
    FormatError
        If the file is missing, is not a results file of faying, or is damaged.
    """
    with described_file(path, RESULTS) as file:
        stored = {kind: table for kind, table in MEANINGS.items() if kind is not Results}
        without = {
            name: meaning for name, meaning in MEANINGS[Results].items() if name != "reduced"
        }
        results: Results = read_value(file, Results, {**stored, Results: without})
        check_results(results)
        return replace(results, reduced=_reduced(file, results))


def _reduced(file: h5py.File, results: Results) -> dict[str, dict[int, ReducedModel]]:
    """Return the reduced models of a run; none where it kept no compliance between its ports."""
    if "ports" not in file or "reduced" not in file:
        return {}
    forces = {name: bolt.initial_force for name, bolt in results.bolts.items()}
    shapes: Matrix | None = None
    if "shapes" in file:
        shapes = numbers(file, "shapes")
        shapes = shapes.reshape(len(shapes), 3 * len(results.nodes)).T
    mesh = MeshShapes(nodes=results.nodes, node_ids=results.node_ids, blocks=results.blocks)
    joint = read_ports(file["ports"], results.interfaces, forces, mesh)
    joint = replace(joint, name=results.title, units=results.units)
    models: dict[str, dict[int, ReducedModel]] = {}
    for method, sizes in items(file["reduced"]):
        models[method] = {}
        for count, group in items(sizes):
            rom = replace(read_model(group, joint), method=method)
            if shapes is not None and "shapes" in group:
                columns = numbers(group, "shapes", (len(rom.K),), np.int64)
                rom = replace(rom, mesh=replace(mesh, vectors=shapes, columns=columns))
            models[method][int(count)] = rom
    return models
