"""Histories of other programs: generalized coordinates, boundary forces, or both.

A CSV file names its columns in the first line: ``time``; ``q1, q2, …`` (and ``v1, …``, ``a1, …``)
for coordinates, velocities and accelerations in the order of the basis; ``BOUNDARY.COMPONENT``, as
``tip.Fz``, for boundary forces; the name of a load of the deck for its factor; ``frame.ax``,
``frame.wy``, ``frame.alphaz`` and so on for supports that move. An HDF5 file has the datasets
``times``, ``coordinates``, ``velocities``, ``accelerations`` (n_time, n_mode) and ``inputs``: a
group with one dataset ``BOUNDARY.COMPONENT`` or load (n_time,) each, or one array (n_time,
n_boundary [+ n_bolt [+ n_pattern]]) like the ``inputs`` of a faying solution; and ``frame``
(n_time, 9).
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from faying._typing import Matrix, Vector
from faying.digits import SOLVED
from faying.exceptions import FormatError, refuse
from faying.files.hdf5 import open_hdf5
from faying.files.number_table import check_times, read_numbers
from faying.joint.system import Joint, boundary_slices, initial_bolt_forces
from faying.model.boundary import FORCE_NAMES
from faying.simulation.frame_motion import FrameMotion
from faying.study.inputs.load_table import force_columns
from faying.study.keys.errors import nearest, quoted

MODAL = {"q": "coordinates", "v": "velocities", "a": "accelerations"}
"""Quantity by the first letter of a modal column; HDF5 datasets have the long name."""

MODAL_COLUMN = re.compile(r"([qva])([1-9]\d*)")
FRAME = tuple(f"frame.{kind}{axis}" for kind in ("a", "w", "alpha") for axis in "xyz")
"""Columns of acceleration, angular velocity and angular acceleration of moving supports."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ImportedHistory:
    """Contents of a history file.

    Attributes
    ----------
    path
        The file.
    times : (n_time,)
        Increasing instants.
    loads
        Forces or moments (n_time,) by ``"boundary.component"``, and factors by deck load.
    coordinates, velocities, accelerations : (n_time, n_mode) or None
    frame
        Motion of the supports; None where they are at rest.
    """

    path: Path
    times: Vector
    loads: Mapping[str, Vector] = field(default_factory=dict)
    coordinates: Matrix | None = None
    velocities: Matrix | None = None
    accelerations: Matrix | None = None
    frame: FrameMotion | None = None


def read_imported_history(path: Path, joint: Joint) -> ImportedHistory:
    """Read a modal or boundary-force history with loads of the joint."""
    if not path.is_file():
        refuse(f"history {path} does not exist; give a .csv or .h5 file")
    readers = {".csv": _read_csv, ".h5": _read_hdf5, ".hdf5": _read_hdf5}
    if path.suffix.lower() not in readers:
        refuse(f"{path}: a history cannot be read from '{path.suffix}'; give a .csv or .h5 file")
    history = readers[path.suffix.lower()](path, joint)
    if history.coordinates is None and not history.loads:
        refuse(
            f"{path} holds only times; give modal coordinates or boundary forces, such as "
            f"{quoted(force_columns(joint)[:3]) or 'q1'}"
        )
    return history


def _read_csv(path: Path, joint: Joint) -> ImportedHistory:
    table, names = read_numbers(path, "the history"), force_columns(joint)
    header = table.names
    _check_header(path, header, names)
    counts = _mode_counts(path, header)
    check_times(path, table.column("time"), table.place)
    modal = {
        MODAL[letter]: np.column_stack([table.column(f"{letter}{n + 1}") for n in range(count)])
        for letter, count in counts.items()
    }
    frame = None
    if not set(header).isdisjoint(FRAME):
        still = np.zeros(len(table.lines))
        moving = [table.column(name) if name in header else still for name in FRAME]
        frame = _frame(np.column_stack(moving))
    return ImportedHistory(
        path=path,
        times=table.column("time"),
        loads={name: table.column(name) for name in header if name in names},
        frame=frame,
        **modal,
    )


def _frame(values: Matrix) -> FrameMotion:
    return FrameMotion(
        acceleration=values[:, :3],
        angular_velocity=values[:, 3:6],
        angular_acceleration=values[:, 6:],
    )


def _check_header(path: Path, header: Sequence[str], loads: Sequence[str]) -> None:
    columns = ["time", "q1", "v1", "a1", *loads, *FRAME]
    for name in header:
        if name not in columns and not MODAL_COLUMN.fullmatch(name):
            refuse(
                f"{path}: unknown column '{name}'; {nearest(name, columns)} (columns are time; q1, "
                "q2, …, v1, …, a1, …; boundary forces; motion of the supports, as frame.ax)"
            )
    if "time" not in header:
        refuse(f"{path} has no column 'time'; add it")


def _mode_counts(path: Path, header: Iterable[str]) -> dict[str, int]:
    """Return the number of modal columns by their letter."""
    matches = [match for match in map(MODAL_COLUMN.fullmatch, header) if match]
    numbers_of = {letter: {int(m[2]) for m in matches if m[1] == letter} for letter in MODAL}
    counts = {letter: max(numbers) for letter, numbers in numbers_of.items() if numbers}
    largest = max(counts.values(), default=0)
    if counts and "q" not in counts:
        refuse(f"{path} has modal columns but no coordinates; add q1 to q{largest}")
    for letter in counts:
        missing = sorted(set(range(1, largest + 1)) - numbers_of[letter])
        if missing:
            message = (
                f"{path}: column '{letter}{missing[0]}' is missing, but there are modal columns "
                f"up to {largest}; give {MODAL[letter]} completely"
            )
            if letter != "q":
                message += " or not at all"
            raise FormatError(message)
    return counts


def _read_hdf5(path: Path, joint: Joint) -> ImportedHistory:
    with open_hdf5(path, "a history", "write it again") as file:
        return _members(path, file, joint)


def _members(path: Path, file: h5py.File, joint: Joint) -> ImportedHistory:
    names = ["times", *MODAL.values(), "inputs", "frame"]
    for name in file:
        if name not in names:
            refuse(f"{path}: unknown dataset '{name}'; {nearest(name, names)}")
    if "times" not in file:
        refuse(f"{path} has no dataset 'times'; add it")
    times = _array(path, file["times"])
    if times.ndim != 1:
        refuse(f"{path}: 'times' has shape {times.shape}, expected one number per instant")
    check_times(path, times, lambda row: f"{path}, row {row} of 'times'")
    modal = {name: _array(path, file[name]) for name in MODAL.values() if name in file}
    if modal and "coordinates" not in modal:
        refuse(f"{path} has '{next(iter(modal))}' but no 'coordinates'; add them")
    shape = (len(times), modal["coordinates"].shape[-1]) if modal else ()
    for name, values in modal.items():
        if values.shape != shape:
            refuse(
                f"{path}: '{name}' has shape {values.shape}, expected {shape}: a row per time, a "
                "column per coordinate"
            )
    loads = _hdf5_loads(path, file["inputs"], joint, len(times)) if "inputs" in file else {}
    frame = _array(path, file["frame"]) if "frame" in file else None
    if frame is not None and frame.shape != (len(times), len(FRAME)):
        refuse(
            f"{path}: 'frame' has shape {frame.shape}, expected {(len(times), len(FRAME))}: "
            "acceleration, angular velocity and angular acceleration, three columns each"
        )
    return ImportedHistory(
        path=path,
        times=times,
        loads=loads,
        frame=None if frame is None else _frame(frame),
        **modal,
    )


def _array(path: Path, data: h5py.Dataset | h5py.Group) -> Matrix:
    name = str(data.name).lstrip("/")
    if not isinstance(data, h5py.Dataset) or data.dtype.kind not in "fiu":
        refuse(f"{path}: '{name}' is not a dataset of numbers")
    values = np.asarray(data[()], dtype=np.float64)
    wrong = np.argwhere(~np.isfinite(values))
    if len(wrong):
        index = ", ".join(map(str, wrong[0].tolist()))
        refuse(
            f"{path}: '{name}' holds {values[tuple(wrong[0])]} at [{index}], expected finite "
            "numbers"
        )
    return values


def _hdf5_loads(
    path: Path, data: h5py.Dataset | h5py.Group, joint: Joint, n_time: int
) -> dict[str, Vector]:
    """Return boundary forces by name, from a group of datasets or an array of inputs."""
    if isinstance(data, h5py.Dataset):
        return _component_loads(path, _array(path, data), joint, n_time)
    names, loads = force_columns(joint), {}
    for name in data:
        if name not in names:
            refuse(f"{path}: unknown boundary force '{name}'; {nearest(name, names)}")
        values = _array(path, data[name])
        if values.shape != (n_time,):
            refuse(f"{path}: '{name}' has shape {values.shape}, expected ({n_time},)")
        loads[name] = values
    return loads


def _component_loads(path: Path, inputs: Matrix, joint: Joint, n_time: int) -> dict[str, Vector]:
    places = boundary_slices(joint.boundaries)
    n_boundary = max((columns.stop for columns in places.values()), default=0)
    bolts = initial_bolt_forces(joint)
    patterns, first = list(joint.load_patterns), n_boundary + len(bolts)
    widths = (n_boundary, first, first + len(patterns))
    if inputs.shape not in [(n_time, width) for width in widths]:
        more = f" and {len(patterns)} factors of deck loads" if patterns else ""
        refuse(
            f"{path}: 'inputs' has shape {inputs.shape}, expected {n_time} rows of {n_boundary} "
            f"boundary forces, or of these and {len(bolts)} initial bolt forces{more}"
        )
    pattern_values = inputs[:, n_boundary:first]
    if not np.allclose(pattern_values, bolts[: pattern_values.shape[1]], rtol=SOLVED, atol=0.0):
        refuse(
            f"{path}: the bolt forces of 'inputs' differ from the initial forces of this run "
            f"({', '.join(f'{force:g}' for force in bolts)}); run a study with that preload"
        )
    loads: dict[str, Vector] = {}
    for name, boundary in joint.boundaries.items():
        components = inputs[:, places[name]]
        for component in np.unique(boundary.components).tolist():
            shares = components[:, boundary.components == component]
            total = shares.sum(axis=1)
            even = total[:, None] / shares.shape[1]
            if np.abs(shares - even).max(initial=0.0) > SOLVED * np.abs(components).max(
                initial=0.0
            ):
                refuse(
                    f"{path}: 'inputs' do not spread {FORCE_NAMES[component]} evenly over nodes "
                    f"of boundary '{name}'; give its total in a group 'inputs'"
                )
            if total.any():
                loads[f"{name}.{FORCE_NAMES[component]}"] = total
    factors = dict(zip(patterns, inputs[:, first:].T, strict=False))  # the array may omit them
    return {**loads, **{name: values for name, values in factors.items() if values.any()}}
