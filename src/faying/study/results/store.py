"""Results in one self-describing HDF5 file, readable without faying.

The file has the members of :class:`faying.study.results.values.Results` in the format of
:mod:`faying.files.described`; ``python docs/stored_groups.py`` prints its groups.
"""

import re
from collections.abc import Collection, Mapping
from dataclasses import is_dataclass, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from faying._typing import Matrix
from faying.exceptions import refuse_value
from faying.files.described import (
    Format,
    described_file,
    is_default,
    items,
    new_file,
    numbers,
    read_value,
    write_members,
)
from faying.files.meanings import Meaning, Table, tables_within
from faying.interface.interface import FacePairs
from faying.model.cells import CellBlock
from faying.model.elements import FACES, SOLIDS
from faying.reduction.model_data import MeshShapes
from faying.reduction.model_reader import read_model, read_ports
from faying.reduction.model_writer import write_models
from faying.reduction.reduced_model import ReducedModel
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
    table = {name: meaning for name, meaning in MEANINGS[type(value)].items() if name != "reduced"}
    with new_file(path, kind, attributes, units) as file:
        members = {name: getattr(value, name) for name in table}
        write_members(file, members, table, units, MEANINGS)
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
        stored = {kind: table for kind, table in MEANINGS.items() if kind is not Results}
        without = {
            name: meaning for name, meaning in MEANINGS[Results].items() if name != "reduced"
        }
        results: Results = read_value(file, Results, {**stored, Results: without})
        check_results(results)
        return replace(results, reduced=_reduced(file, results))


def _reduced(file: h5py.File, results: Results) -> dict[str, dict[int, ReducedModel]]:
    """Return the reduced models of a run; empty where the port compliance was not stored."""
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


MEANINGS: dict[type, Table] = tables_within(Results, RecoveredRecord, without=(ReducedModel,))
"""Meanings of the members of every stored dataclass, except for reduced models."""

Axes = dict[str, int]
"""Known lengths of axes by name."""

_OPTIONAL = re.compile(r"\[n_time,?\]")
_AXIS = re.compile(r"(?:(\d+) \+ )?(?:(\d+) )?([a-z]\w*)(?: \+ (\d+))?|(\d+)")

OWN = ("n_point", "n_pair", "n_face")
"""Axes whose lengths each interface has for itself."""


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
    _check(results, axes, "", timed=False)


def _check(value: Any, axis_lengths: Mapping[str, int], entry: str, *, timed: bool) -> None:
    """Check the fields of a record, which share axes of the same name."""
    axes = dict(axis_lengths)
    if isinstance(value, InterfaceRecord):
        axes = {name: length for name, length in axes.items() if name not in OWN}
    if isinstance(value, CaseResult):
        timed = value.times is not None
    for name, meaning in MEANINGS[type(value)].items():
        if is_default(value, name):
            continue
        inner, field = f"{entry}/{name}", getattr(value, name)
        if isinstance(value, CaseResult) and name == "half_step":
            count = 0 if value.half_step_times is None else len(value.half_step_times)
            _check_field(field, meaning, axes | {"n_time": count}, inner, timed=timed)
        elif isinstance(field, SlipRecord) and timed:
            count = axes.get("n_time", 0)
            _check_field(field, meaning, axes | {"n_increment": count}, inner, timed=timed)
        else:
            _check_field(field, meaning, axes, inner, timed=timed)
    _check_record(value, axes, entry)


def _check_field(value: Any, meaning: Meaning, axes: Axes, entry: str, *, timed: bool) -> None:
    """Check the value of a field; members of a mapping do not share new axes."""
    if value is None:
        return
    if is_dataclass(value):
        _check(value, axes, entry, timed=timed)
    elif isinstance(value, Mapping):
        for name, member in value.items():
            _check_field(member, meaning, dict(axes), f"{entry}/{name}", timed=timed)
    elif isinstance(value, tuple) and value and is_dataclass(value[0]):
        for number, member in enumerate(value):
            _check(member, axes, f"{entry}/{number}", timed=timed)
    elif meaning.shape:
        _check_shape(np.shape(value), meaning.shape, axes, entry, timed=timed)
        values = np.asarray(value)
        if meaning.index:
            length = axes[meaning.index]
            if values.size and (values.min() < 0 or values.max() >= length):
                span = f"from {values.min()} to {values.max()}"
                refuse_value(f"'{entry}' holds indices {span} into {length}")
        elif meaning.dimension not in ("", "1") and not np.isfinite(values).all():
            refuse_value(f"'{entry}' holds numbers that are not finite")


def _check_shape(
    shape: tuple[int, ...], meaning: str, axes: Axes, entry: str, *, timed: bool
) -> None:
    text = _OPTIONAL.sub("n_time," if timed else "", meaning.strip("()"))
    names = [name.strip() for name in text.split(",") if name.strip()]
    fits = len(shape) == len(names) and all(
        _fits(length, name, axes) for length, name in zip(shape, names, strict=True)
    )
    if not fits:
        lengths = ", ".join(f"{name} = {axes[name]}" for name in names if name in axes)
        message = f"'{entry}' has shape {shape}, expected {meaning}"
        raise ValueError(f"{message} with {lengths}" if lengths else message)


def _fits(length: int, name: str, axes: Axes) -> bool:
    """Return whether an axis has the length of its name, which the first such axis defines."""
    match = _AXIS.fullmatch(name)
    if match is None or match[5]:
        return name == str(length)
    more = int(match[1] or 0) + int(match[4] or 0)
    count, remainder = divmod(length - more, int(match[2] or 1))
    return remainder == 0 and count >= 0 and axes.setdefault(match[3], count) == count


def _check_record(value: Any, axes: Axes, entry: str) -> None:
    """Check relations between the fields of a record."""
    if isinstance(value, CellBlock):
        _check_known(value.kind, SOLIDS, f"{entry}/kind")
        _check_width(value.nodes, len(SOLIDS[value.kind].reference_nodes), f"{entry}/nodes")
    elif isinstance(value, FacePairs):
        _check_known(value.kind, FACES, f"{entry}/kind")
        _check_width(value.minus, FACES[value.kind].n_nodes, f"{entry}/minus")
    elif isinstance(value, InterfaceRecord):
        _check_interface(value, axes["n_node"], entry)


def _check_interface(record: InterfaceRecord, n_node: int, entry: str) -> None:
    n_face = sum(len(faces.minus) for faces in record.faces)
    if record.face_coverage is not None and len(record.face_coverage) != n_face:
        message = f"'{entry}/face_coverage' has {len(record.face_coverage)} entries, not {n_face}"
        raise ValueError(message)
    if (record.weights < 0).any() or not ((record.penalty or 0) > 0 or record.closure):
        refuse_value(f"'{entry}' has a negative weight or no positive penalty")
    pairs = record.pairs[:, 0] * n_node + record.pairs[:, 1]
    for faces in record.faces:
        if not np.isin(faces.minus * n_node + faces.plus, pairs).all():
            refuse_value(f"'{entry}/faces' has nodes that are not a pair of the interface")


def _check_width(nodes: np.ndarray[Any, Any], width: int, entry: str) -> None:
    if nodes.shape[1] != width:
        refuse_value(f"'{entry}' has {nodes.shape[1]} nodes each, expected {width}")


def _check_known(name: str, names: Collection[str], entry: str) -> None:
    if name not in names:
        refuse_value(f"'{entry}' is '{name}', expected one of {', '.join(names)}")


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
