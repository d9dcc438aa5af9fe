"""Long transients, written to HDF5 piece by piece to save memory.

Disk space is allocated before HDF5 writes. On a full disk, HDF5 repeats a failed write when the
file is closed and when the program ends, each time with an error report, and
damages the file.
"""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from pathlib import Path

import h5py
import numpy as np

from faying._typing import Matrix
from faying.exceptions import FayingError, refuse, refuse_model
from faying.files.atomic import writing
from faying.files.described import member_name
from faying.files.flattening import flattened, restored
from faying.files.hdf5 import check_hdf5, damaged
from faying.joint.system import System
from faying.simulation.compiled import warn_of_compiled
from faying.simulation.divided_steps import divided_steps
from faying.simulation.instants import check_times
from faying.simulation.integrators import ImplicitEuler, Integrator
from faying.simulation.load import Load
from faying.simulation.restart import Restart
from faying.simulation.solution import Solution
from faying.simulation.stepping import STEPS_AT_ONCE, transient_solver
from faying.simulation.transient_windows import Steps, transient_windows

SLACK = 2**20
"""Bytes for the metadata of HDF5: groups, attributes, and an index of the chunks."""


@contextmanager
def growing(path: Path, *, new: bool) -> Iterator[h5py.File]:
    """Yield an HDF5 file to write to, after allocating space; ``new`` empties the file.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    with path.open("wb" if new else "ab") as probe:
        size = os.fstat(probe.fileno()).st_size
        _allocate(probe.fileno(), size, SLACK)
        probe.truncate(size)
    used = None
    try:
        with h5py.File(path, "w" if new or not size else "r+", track_order=True) as file:
            reserve(file, 0)
            try:
                yield file
            finally:
                file.flush()
                used = file.id.get_filesize()
    finally:
        if used is not None:
            os.truncate(path, used)


def reserve(file: h5py.File, n_bytes: int) -> None:
    """Allocate disk space for more bytes, and for metadata of HDF5.

    Raises
    ------
    OSError
        If the disk is full; the file is unchanged.
    """
    _allocate(file.id.get_vfd_handle(), file.id.get_filesize(), n_bytes + SLACK)


def _allocate(handle: int, offset: int, n_bytes: int) -> None:
    # On other systems HDF5 itself reports a full disk.
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(handle, offset, n_bytes)


FORMAT = "faying transient"

HISTORY = "a history of fy.stream_transient"
ANEW = "start again without resume"

INSTANTS_PER_CHUNK = 1024
"""Instants per chunk of a dataset."""

ALWAYS = ("times", "max_pressure")
FIELDS = (
    *(*ALWAYS, "states", "velocities", "accelerations", "pressure", "gap", "iterations"),
    *("traction", "slip", "dissipation"),
)
"""Optional quantities of every instant; boundaries, bolts and interfaces are always stored."""

DIVIDED = ("substeps", "step_error")
"""Further quantities where steps are divided."""


def stream_transient(
    system: System,
    load: Load,
    path: str | PathLike[str],
    *,
    step: float,
    duration: float,
    integrator: Integrator | None = None,
    fields: tuple[str, ...] = ("states",),
    resume: bool = False,
    progress: Callable[[int], object] | None = None,
    compiled: bool | None = None,
    tolerance: float | None = None,
) -> Path:
    """Solve a transient as :func:`faying.solve_transient`, and write the history piece by piece.

    Parameters
    ----------
    system
        A preloaded model, full or reduced.
    load
        Load from t = 0⁺ on the joint at rest.
    path
        HDF5 file: ``times``, ``max_pressure``, ``displacements/BOUNDARY``,
        ``contact_forces/INTERFACE``, ``bolt_forces/BOLT`` and ``fields``, one row per instant.
        The attribute ``complete`` is true if the run reached its end; ``energy_gain`` is as in
        :class:`~faying.simulation.solution.Solution`.
    step, duration : [time]
        Time step, and duration of the transient.
    fields
        Quantities of :data:`FIELDS` to store. ``"pressure"`` of a thousand points takes
        8 GB for a million steps.
    resume
        Continue at the end of the file, with the same numbers as in one run, to the bit.
    compiled
        Deprecated, without effect.
    tolerance
        As in :func:`faying.solve_transient`; ``substeps`` and ``step_error`` are then stored too.

    Returns
    -------
    Path
        Path of the file.

    Raises
    ------
    ModelError
        As :func:`faying.solve_transient`, or if a field is unknown.
    FormatError
        If the file cannot be written, or the file to resume is of another kind,
        system or step.

    Notes
    -----
    The file stays readable when the run is stopped.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4), compliance=True)
    >>> with TemporaryDirectory() as folder:
    ...     path = fy.stream_transient(
    ...         rom, fy.Load({"tip.Fz": -50.0}), f"{folder}/history.h5", step=1e-5, duration=1e-3
    ...     )
    ...     path.name
    'history.h5'
    """
    warn_of_compiled(compiled)
    unknown = [name for name in fields if name not in FIELDS]
    if unknown:
        refuse_model(f"there is no field '{unknown[0]}'; fields are {', '.join(FIELDS)}")
    target = Path(path)
    scheme = ImplicitEuler() if integrator is None else integrator
    columns = dict.fromkeys((*ALWAYS, *fields, *(() if tolerance is None else DIVIDED)))
    check_times(step, duration)
    solver: Steps
    if tolerance is None:
        solver = transient_solver(system, step=step, integrator=scheme)
    else:
        solver = divided_steps(system, step=step, tolerance=tolerance, integrator=scheme)
    began = {
        "format": FORMAT,
        "integrator": scheme.name,
        "step": step,
        "tolerance": 0.0 if tolerance is None else tolerance,
    }
    if resume and target.is_file() and target.stat().st_size:
        check_hdf5(target, HISTORY, ANEW, whole=False)
    with writing(target), growing(target, new=not resume) as file:
        restart = _resumed(file, system, began) if resume and len(file) else None
        if restart is None:
            file.attrs.update({**began, "load": load.name, "complete": False})
        segments = transient_windows(
            solver,
            [load],
            duration=duration,
            length=STEPS_AT_ONCE,
            restarts=None if restart is None else [restart],
            progress=progress,
        )
        for (segment,), (end,) in segments:
            _append(file, segment, columns)
            _mark(file, end)
        file.attrs["complete"] = True
    return target


def _append(file: h5py.File, segment: Solution, columns: Iterable[str]) -> None:
    """Append the rows of a piece to every dataset."""
    rows: dict[str, Matrix] = {}
    for name in columns:
        values = np.asarray(getattr(segment, name))
        # A scalar applies to all instants.
        rows[name] = np.broadcast_to(values, (len(segment.states), *values.shape[1:]))
    system = segment.system
    for name in system.boundaries:
        rows[f"displacements/{member_name(name)}"] = segment.displacement(name)
    for name in system.contact.slices:
        rows[f"contact_forces/{member_name(name)}"] = segment.contact_force(name)
    for name in system.bolts:
        rows[f"bolt_forces/{member_name(name)}"] = segment.bolt_force(name)
    # One more chunk of each, because chunks are allocated whole.
    reserve(
        file, sum(table.nbytes + INSTANTS_PER_CHUNK * table[:1].nbytes for table in rows.values())
    )
    for name, values in rows.items():
        if name not in file:
            file.create_dataset(
                name,
                shape=(0, *values.shape[1:]),
                maxshape=(None, *values.shape[1:]),
                chunks=(INSTANTS_PER_CHUNK, *values.shape[1:]),
                dtype=values.dtype,
            )
        data = file[name]
        data.resize(len(data) + len(values), axis=0)
        data[-len(values) :] = values


def _mark(file: h5py.File, end: Restart) -> None:
    """Store the state of the run, and flush the file so that it is readable.

    Two slots alternate, so that one is complete if the process is killed while writing.
    """
    places = file.require_group("restart")
    slot = 1 - int(places.attrs.get("slot", 1))
    slot_group = places.require_group(str(slot))
    restart = {name.replace("/", "."): values for name, values in flattened(end).items()}
    reserve(file, sum(values.nbytes for values in restart.values()))
    for name, values in restart.items():
        if values.ndim == 0:
            slot_group.attrs[name] = values[()]
            continue
        if name not in slot_group:
            slot_group.create_dataset(name, data=values)
        slot_group[name][...] = values
    if end.ledger is not None:
        file.attrs["energy_gain"] = end.ledger.gain
    file.flush()
    places.attrs["slot"] = slot
    file.flush()


def _resumed(file: h5py.File, system: System, began: Mapping[str, object]) -> Restart | None:
    """Return the state at which to resume; raise a clear error if the file is damaged."""
    try:
        return _restart(file, system, began)
    except (FayingError, OSError):
        raise
    except Exception as error:  # HDF5 and h5py raise whatever a damaged file meets
        raise damaged(Path(file.filename), error, ANEW) from None


def _restart(file: h5py.File, system: System, began: Mapping[str, object]) -> Restart | None:
    for name, value in began.items():
        # Files of earlier versions have no tolerance.
        if file.attrs.get(name, 0.0) != value:
            refuse(
                f"{file.filename} has {name} {file.attrs.get(name)}, expected {value}; resume "
                "with the original options, or start again"
            )
    places = file.get("restart")
    if places is None or "slot" not in places.attrs:
        for name in list(file):
            del file[name]  # the run was stopped in its first piece
        return None
    slot_group = places[str(places.attrs["slot"])]
    n_dof, n_force = system.K.shape[0], system.contact.components * system.contact.n_points
    sizes = [data.size for data in slot_group.values()]
    fitting = slot_group["motion.u"].shape == (n_dof,)
    fitting = fitting and slot_group["motion.contact"].shape == (n_force,)
    # Of forces three components are stored, with friction or without.
    if not fitting or max(sizes) > 3 * max(n_dof, n_force):
        refuse(f"{file.filename} belongs to another model; {ANEW}")
    done = int(slot_group.attrs["done"])
    for data in _datasets(file):
        data.resize(done + 1, axis=0)  # drop rows of an incomplete piece
    file.attrs["complete"] = False
    parts = {name: data[()] for name, data in slot_group.items()} | dict(slot_group.attrs)
    arrays = {name.replace(".", "/"): np.asarray(part) for name, part in parts.items()}
    return restored(Restart, arrays)


def _datasets(file: h5py.File) -> list[h5py.Dataset]:
    datasets: list[h5py.Dataset] = []

    def visit(name: str, node: h5py.HLObject) -> None:
        if isinstance(node, h5py.Dataset) and not name.startswith("restart/"):
            datasets.append(node)

    file.visititems(visit)
    return datasets
