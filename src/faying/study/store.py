"""Results in one self-describing HDF5 file, readable without faying.

Layout
------
The file mirrors :class:`faying.study.results.Results`: a value is a group, a mapping is a group
with one member per key, an array, number or text is a dataset of the same name::

    /                                  attributes: format, format_version, faying, title, units,
                                       description, unit_of_force, unit_of_pressure
    /study_text, /title, /units        text
    /nodes, /node_ids, /body           mesh; /blocks/0/{kind, nodes, ids, properties}, /blocks/1 …
    /interfaces/NAME/…                 points, weights, averaging, faces/0/{kind, minus, plus}, …
    /bolts/NAME/…                      preload, initial_force, history
    /cases/NAME/…                      kind, times, components/BOUNDARY
    /cases/NAME/reference/…            pressure, gap, displacements/BOUNDARY, bolt_forces/BOLT, …
    /cases/NAME/methods/METHOD/N/…     N joint modes: n_modes, response/…, accuracy/…
    /cases/NAME/half_step/…            as reference
    /ports/…                           compliance between ports, interpolation, boundaries
    /reduced/METHOD/N/…                mass, damping, stiffness, recovery matrices, …
    /timings/…, /provenance/…          numbers and text by name

Every dataset and group says what it is in the attribute ``description``; datasets of numbers also
have ``unit`` (as ``MPa``), ``dimension`` (as ``force/length²``) and ``shape`` (names of the axes).
Optional entries that do not exist are absent. Members keep their order (HDF5 creation order).
``/`` and ``%`` in names are written ``%2F`` and ``%25``. Numbers are float64, int64 or bool, larger
arrays shuffled, gzipped and check-summed.
"""

import types
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from pathlib import Path
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints
from urllib.parse import unquote

import h5py
import numpy as np

from faying import __version__
from faying.exceptions import FormatError
from faying.files.atomic import replacing
from faying.files.hdf5 import open_hdf5
from faying.study.errors import shown
from faying.study.recovery_results import RecoveredRecord
from faying.study.results import Results
from faying.study.results_check import check_results
from faying.study.store_fields import MEANINGS, Meaning
from faying.units import Units, units_of

FORMAT = "faying results"
RECOVERED_FORMAT = "faying recovered pressures"
FORMAT_VERSION = 1
DESCRIPTION = (
    "Contact pressures of a jointed structure by its full finite element model (reference) and by "
    "reduced models (methods). Pressure is positive in compression, gap where open; errors are "
    "relative to the largest reference pressure of the load case."
)
RECOVERED_DESCRIPTION = (
    "Contact pressures of a jointed structure, recovered from a history that another program made. "
    "Pressure is positive in compression, gap where open; points are those of results.h5."
)
SMALL = 64
"""Arrays of up to this many numbers are not worth a compressed chunk."""


def write_results(results: Results, path: Path) -> None:
    """Write the results of a run, atomically.

    Parameters
    ----------
    path
        HDF5 file; replaced once the new one is complete.

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    _write_file(path, results, FORMAT, DESCRIPTION)


def write_recovered(recovered: RecoveredRecord, path: Path) -> None:
    """Write recovered pressures in the same manner, atomically.

    Raises
    ------
    FormatError
        If the file cannot be written.
    """
    _write_file(path, recovered, RECOVERED_FORMAT, RECOVERED_DESCRIPTION)


def _write_file(path: Path, value: Results | RecoveredRecord, kind: str, description: str) -> None:
    # In memory first: HDF5 cannot close a file whose disk is full, and complains of it for ever.
    options = {"driver": "core", "backing_store": False, "block_size": 2**20}
    with replacing(path) as temporary:
        with h5py.File(temporary, "w", track_order=True, **options) as file:
            _write_header(file, value, kind, description)
            _write_value(file, value, units_of(value.units))
            file.flush()
            image = file.id.get_file_image()
        temporary.write_bytes(image)


def read_results(path: Path) -> Results:
    """Read what :func:`write_results` wrote.

    Raises
    ------
    FormatError
        If the file is missing, is not a results file of faying, or is damaged.
    """
    if not path.is_file():
        message = f"{path} does not exist; name the results.h5 of a finished run"
        raise FormatError(message)
    remedy = "run the study again"
    with open_hdf5(path, "the results.h5 of a finished run", remedy) as file:
        _check_header(file, path)
        results: Results = _read_value(file, Results)
        check_results(results)
    return results


def _write_header(
    file: h5py.File, results: Results | RecoveredRecord, kind: str, description: str
) -> None:
    units = units_of(results.units)
    file.attrs["format"] = kind
    file.attrs["format_version"] = FORMAT_VERSION
    file.attrs["faying"] = __version__
    file.attrs["title"] = results.title
    file.attrs["units"] = results.units
    file.attrs["unit_of_force"] = units.force
    file.attrs["unit_of_pressure"] = units.pressure
    file.attrs["description"] = description


def _check_header(file: h5py.File, path: Path) -> None:
    if file.attrs.get("format") != FORMAT:
        message = f"{path} is an HDF5 file but not one of faying's results; name a run's results.h5"
        raise FormatError(message)
    version = file.attrs.get("format_version", 0)
    if version != FORMAT_VERSION:
        message = (
            f"{path} has results format {shown(version)}, this faying reads {FORMAT_VERSION}; "
            f"use faying {shown(file.attrs.get('faying', ''))} or run the study again"
        )
        raise FormatError(message)


def _write_value(group: h5py.Group, value: Any, units: Units) -> None:
    """Write a dataclass, one member per field."""
    for name, meaning in MEANINGS[type(value)].items():
        _write(group, name, getattr(value, name), meaning, units)


def _write(group: h5py.Group, name: str, value: Any, meaning: Meaning, units: Units) -> None:
    """Write a member, by what it is."""
    if value is None:
        return
    members = _members(value)
    if members is None:
        _write_data(group, name, value, meaning, units)
        return
    inner = group.create_group(member_name(name), track_order=True)
    inner.attrs["description"] = meaning.description
    if is_dataclass(value):
        _write_value(inner, value, units)
        return
    for key, member in members.items():
        _write(inner, key, member, meaning, units)


def _members(value: Any) -> Mapping[str, Any] | None:
    """Return the members of a group; None for data."""
    if is_dataclass(value):
        return {}
    if isinstance(value, Mapping):
        return {str(key): member for key, member in value.items()}
    if isinstance(value, tuple) and all(is_dataclass(member) for member in value):
        return {str(i): member for i, member in enumerate(value)} if value else None
    return None


def _write_data(group: h5py.Group, name: str, value: Any, meaning: Meaning, units: Units) -> None:
    if isinstance(value, str) or (isinstance(value, tuple) and _is_text(value)):
        data = group.create_dataset(member_name(name), data=value, dtype=h5py.string_dtype())
    else:
        array = np.asarray(value)
        packed: dict[str, Any] = (
            {"compression": "gzip", "shuffle": True, "fletcher32": True}
            if array.size > SMALL
            else {}
        )
        data = group.create_dataset(member_name(name), data=array, **packed)
        data.attrs["dimension"] = meaning.dimension
        data.attrs["unit"] = units.of(meaning.dimension)
    data.attrs["shape"] = meaning.shape
    data.attrs["description"] = meaning.description


def _is_text(value: tuple[Any, ...]) -> bool:
    return all(isinstance(entry, str) for entry in value)


def member_name(name: str) -> str:
    """Return a name as HDF5 takes it for a member of a group."""
    quoted = name.replace("%", "%25").replace("/", "%2F")
    return "%2E" if quoted == "." else quoted


def _read_value(group: h5py.Group, kind: type) -> Any:
    """Read a dataclass; the annotations of its fields say how."""
    hints = get_type_hints(kind)
    defaulted = {
        field.name
        for field in fields(kind)
        if field.default is not MISSING or field.default_factory is not MISSING
    }
    values: dict[str, Any] = {}
    for name in MEANINGS[kind]:
        if name in group:
            values[name] = _read(group[name], hints[name])
        elif types.NoneType in get_args(hints[name]):
            values[name] = None
        elif name not in defaulted:
            message = f"{group.name.rstrip('/')}/{name} is missing"
            raise KeyError(message)
    return kind(**values)


def _read(node: h5py.Group | h5py.Dataset, hint: Any) -> Any:
    """Read a member as the type it is annotated with."""
    origin, arguments = get_origin(hint), get_args(hint)
    if origin in (types.UnionType, Union):
        return _read(node, arguments[0])
    if hint is Any:
        return _read_any(node)
    if is_dataclass(hint):
        return _read_value(node, hint)  # type: ignore[arg-type]
    if origin is np.ndarray:
        _check_kind(node, "fiub", "numbers")
        return np.asarray(node[()], dtype=get_args(arguments[1])[0])
    if origin is tuple:
        return _read_tuple(node, arguments)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        key: Callable[[str], Any] = arguments[0]
        return {key(unquote(name)): _read(node[name], arguments[1]) for name in node}
    if hint is str or origin is Literal:
        _check_kind(node, "OS", "a text", ndim=0)
        return node.asstr()[()]
    _check_kind(node, "fiub", "one number", ndim=0)
    return hint(node[()])


def _check_kind(
    node: h5py.Group | h5py.Dataset, kinds: str, expected: str, ndim: int | None = None
) -> None:
    """Refuse a member that is of another kind."""
    found = isinstance(node, h5py.Dataset) and node.dtype.kind in kinds
    if not found or ndim not in (None, node.ndim):
        message = f"'{node.name}' does not hold {expected}"
        raise ValueError(message)


def _read_tuple(node: h5py.Group | h5py.Dataset, arguments: tuple[Any, ...]) -> tuple[Any, ...]:
    if isinstance(node, h5py.Group):
        return tuple(_read_value(node[name], arguments[0]) for name in node)
    if node.size == 0:  # written as texts, whatever it would hold
        return ()
    _check_kind(node, "OS" if arguments[0] is str else "fiub", "a list", ndim=1)
    return tuple(node.asstr()[()]) if arguments[0] is str else tuple(node[()].tolist())


def _read_any(node: h5py.Group | h5py.Dataset) -> Any:
    if isinstance(node, h5py.Group):
        return {unquote(name): _read_any(node[name]) for name in node}
    if h5py.check_string_dtype(node.dtype) is not None:
        return node.asstr()[()]
    return node[()].item() if node.shape == () else node[()]
