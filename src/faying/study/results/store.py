"""Results in one self-describing HDF5 file, readable without faying.

The file has the members of :class:`faying.study.results.values.Results` in the format of
:mod:`faying.files.described`; ``python docs/stored_groups.py`` prints its groups.
"""

from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from faying.exceptions import refuse_value
from faying.files.described import (
    Format,
    described_file,
    new_file,
    read_value,
    write_members,
)
from faying.files.meanings import Table, tables_within
from faying.files.shapes import Axes, ShapeRules
from faying.reduction.model_check import check_geometry, without_own
from faying.reduction.model_data import MeshShapes
from faying.reduction.model_reader import models_of_run
from faying.reduction.model_writer import write_models
from faying.reduction.reduced_model import ReducedModel
from faying.reduction.stored_model import TABLES, StoredModels
from faying.study.results.path_record import SlipRecord
from faying.study.results.solved_fields import RecoveredRecord
from faying.study.results.values import CaseResult, InterfaceRecord, Response, Results
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


def write_results(value: Results | RecoveredRecord, path: Path) -> None:
    """Write the results of a run, or what is recovered from one, to an HDF5 file, atomically."""
    kind = RESULTS if isinstance(value, Results) else RECOVERED
    units, attributes = units_of(value.units), {"title": value.title, "units": value.units}
    with new_file(path, kind, attributes, units) as file:
        write_members(file, value, units, STORED)
        if isinstance(value, Results):
            write_models(file, value.reduced, units)


def read_results(path: Path) -> Results:
    """Read the results of a run from a file of :func:`write_results`.

    Raises
    ------
    FormatError
        If the file is missing, is not a results file of faying, or is damaged.
    """
    with described_file(path, RESULTS) as file:
        results: Results = read_value(file, Results, STORED)
        check_results(results)
        return replace(results, reduced=_reduced(file, results))


def _reduced(file: h5py.File, results: Results) -> dict[str, dict[int, ReducedModel]]:
    """Return the reduced models of a run; empty where the port compliance was not stored."""
    if "ports" not in file:  # shapes of a large model are not read in vain
        return {}
    run: StoredModels = read_value(file, StoredModels, TABLES)
    mesh = MeshShapes(nodes=results.nodes, node_ids=results.node_ids, blocks=results.blocks)
    forces = {name: bolt.initial_force for name, bolt in results.bolts.items()}
    return models_of_run(run, results.interfaces, forces, mesh, results.title, results.units)


MEANINGS: dict[type, Table] = tables_within(Results, RecoveredRecord, without=(ReducedModel,))
"""Meanings of the members of every stored dataclass, except for reduced models."""

STORED: dict[type, Table] = {
    **MEANINGS,
    Results: {name: told for name, told in MEANINGS[Results].items() if name != "reduced"},
}
"""Meanings of what is stored in a group of its name; reduced models are stored as others."""


def check_results(results: Results) -> None:
    """Refuse results that are inconsistent.

    Raises
    ------
    ValueError
        With the path of the entry in the file.
    """
    _check_names(results)
    axes: Axes = {
        "n_node": len(results.nodes),
        "n_stage": len(results.tightening_stages),
        "n_bolt": len(results.bolts),
        "n_point": _n_points(results.interfaces),
    }
    RULES.check(results, axes)


def _axes_within(value: Any, entry: str, axes: Axes) -> Axes:
    """Return the known axes within a value of a run."""
    if isinstance(value, InterfaceRecord):
        return without_own(axes)
    if isinstance(value, CaseResult):
        half = value.half_step_times
        return {**axes, "n_half_time": 0 if half is None else len(half)}
    if isinstance(value, Response) and entry.endswith("/half_step"):
        return {**axes, "n_time": axes["n_half_time"]}
    if isinstance(value, SlipRecord) and "n_time" in axes:
        return {**axes, "n_increment": axes["n_time"]}
    return axes


RULES = ShapeRules(tables=STORED, axes_within=_axes_within, check_relations=check_geometry)
"""Rules for the arrays of results."""


def _check_names(results: Results) -> None:
    """Check that responses have the bolts, interfaces and boundaries of the results."""
    for name, case in results.cases.items():
        responses = {"reference": case.reference, "half_step": case.half_step}
        for method, sizes in case.methods.items():
            responses |= {f"methods/{method}/{n}": result.response for n, result in sizes.items()}
        if case.half_step is not None and (case.times is None) != (case.half_step_times is None):
            refuse_value(f"'/cases/{name}/half_step' has no instants")
        for what, response in responses.items():
            if response is not None:
                _check_response(results, case, response, f"/cases/{name}/{what}")


def _check_response(results: Results, case: CaseResult, response: Response, entry: str) -> None:
    _check_same(response.bolt_forces, results.bolts, f"{entry}/bolt_forces")
    _check_same(response.contact_forces, results.interfaces, f"{entry}/contact_forces")
    _check_same(response.open_fraction, results.interfaces, f"{entry}/open_fraction")
    _check_same(response.displacements, case.components, f"{entry}/displacements")
    for name, values in response.displacements.items():
        if np.shape(values)[-1:] != (len(case.components[name]),):
            refuse_value(f"'{entry}/displacements/{name}' has shape {np.shape(values)}")


def _check_same(names: Collection[str], expected: Collection[str], entry: str) -> None:
    if set(names) != set(expected):
        refuse_value(f"'{entry}' has {', '.join(names)}, expected {', '.join(expected)}")


def _n_points(interfaces: Mapping[str, InterfaceRecord]) -> int:
    """Return the number of contact points; refuse interfaces whose slices do not adjoin."""
    end = 0
    for name, record in interfaces.items():
        if record.slice != (end, end + len(record.weights)):
            message = f"'/interfaces/{name}/slice' is {record.slice}, expected to begin at {end}"
            raise ValueError(message)
        end = record.slice[1]
    return end
