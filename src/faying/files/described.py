"""Values in self-describing HDF5 files: every member has a description and a unit.

A value is a group, a mapping is a group with one member per key, an array, number or text is a
dataset. Every member has the attribute ``description``; datasets of numbers also have ``unit`` (as
``MPa``), ``dimension`` (as ``force/length²``) and ``shape`` (names of the axes). Optional entries
that do not exist are absent. Members keep their order (HDF5 creation order). ``/`` and ``%`` in
names are written ``%2F`` and ``%25``. Numbers are float64, int64 or bool, complex ones pairs of
them along a last axis, larger arrays shuffled, gzipped and check-summed; sparse matrices are groups
in compressed row form.
"""

import inspect
import types
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import MISSING, dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints
from urllib.parse import unquote

import h5py
import numpy as np
import scipy.sparse as sp

from faying._typing import Indices, Matrix, SparseMatrix
from faying.exceptions import refuse, refuse_value
from faying.files.atomic import replacing
from faying.files.hdf5 import open_hdf5
from faying.files.meanings import Meaning, Table
from faying.units import Units

Node = Any
"""A group or dataset of a file, or the mapping or array in memory that corresponds to it."""

PARTS = "real and imaginary part"
"""Name of the last axis of complex numbers."""

SMALL_ARRAY = 64
"""Number of values up to which an array is stored uncompressed."""


SPARSE: Table = {
    "values": Meaning("entries", "1", "(n_entry,)"),
    "columns": Meaning("column of each entry", "1", "(n_entry,)"),
    "row_starts": Meaning("first entry of each row; last is n_entry", "1", "(n_row + 1,)"),
    "shape": Meaning("rows and columns", "1", "(2,)"),
}
"""Members of a sparse matrix."""


@dataclass(frozen=True, kw_only=True)
class Format:
    """A kind of file.

    Attributes
    ----------
    name, version
        The attributes ``format``, "faying " and the name, and ``format_version``.
    wanted
        What the user should give instead, for messages.
    remedy
        What to do about a file of another version, or a damaged one.
    description
        Description of the whole file.
    """

    name: str
    version: int
    wanted: str
    remedy: str
    description: str


@contextmanager
def new_file(
    path: Path, kind: Format, attributes: Mapping[str, str], units: Units
) -> Iterator[h5py.File]:
    """Yield a new file that is moved to its path once it is complete.

    Its root has the attributes, and also the format and the units.
    """
    from faying import __version__

    # Built in memory: HDF5 cannot close a file on a full disk, and repeats the error for ever.
    options = {"driver": "core", "backing_store": False, "block_size": 2**20}
    with replacing(path) as temporary:
        with h5py.File(temporary, "w", track_order=True, **options) as file:
            file.attrs["format"] = f"faying {kind.name}"
            file.attrs["format_version"] = kind.version
            file.attrs["faying"] = __version__
            for name, text in attributes.items():
                file.attrs[name] = text
            file.attrs["unit_of_force"] = units.force
            file.attrs["unit_of_pressure"] = units.pressure
            file.attrs["description"] = kind.description
            yield file
            file.flush()
            image = file.id.get_file_image()
        temporary.write_bytes(image)


@contextmanager
def described_file(path: Path, kind: Format) -> Iterator[h5py.File]:
    """Yield a file of a format, opened for reading; errors inside become one message."""
    if not path.is_file():
        refuse(f"{path} does not exist; give {kind.wanted}")
    with open_hdf5(path, kind.wanted, kind.remedy) as file:
        _check_header(file, kind, path)
        yield file


def _check_header(file: h5py.File, kind: Format, path: Path) -> None:
    if file.attrs.get("format") != f"faying {kind.name}":
        refuse(f"{path} is an HDF5 file, but holds no faying {kind.name}; give {kind.wanted}")
    version = file.attrs.get("format_version", 0)
    if version != kind.version:
        refuse(
            f"{path} has {kind.name} format {str(version)[:60]}, this faying reads {kind.version}; "
            f"{kind.remedy}, or read it with the faying that wrote it "
            f"({str(file.attrs.get('faying', 'version not said'))[:60]})"
        )


def _new_group(group: h5py.Group, name: str, meaning: Meaning) -> h5py.Group:
    """Return a new group that keeps the order of its members."""
    inner = group.create_group(member_name(name), track_order=True)
    inner.attrs["description"] = meaning.description
    return inner


def write_members(
    group: h5py.Group, value: Any, units: Units, tables: Mapping[type, Table]
) -> None:
    """Write the members of a dataclass to a group, in the order of its table.

    None and members equal to their default are left out. ``tables`` describe the dataclass, and all
    dataclasses within it.
    """
    table = next(tables[kind] for kind in inspect.getmro(type(value)) if kind in tables)
    for name, meaning in table.items():
        if not is_default(value, name):
            _write(group, name, getattr(value, name), meaning, units, tables)


def _write(
    group: h5py.Group,
    name: str,
    value: Any,
    meaning: Meaning,
    units: Units,
    tables: Mapping[type, Table],
) -> None:
    """Write a member as a group or dataset, by its type."""
    if value is None:
        return
    if sp.issparse(value):
        rows, inner = sp.csr_array(value), _new_group(group, name, meaning)
        parts = (rows.data, rows.indices, rows.indptr, rows.shape)
        for (part, told), array in zip(SPARSE.items(), parts, strict=True):
            _write_data(inner, part, np.asarray(array), told, units)
    elif is_dataclass(value):
        write_members(_new_group(group, name, meaning), value, units, tables)
    elif isinstance(value, Mapping) or _is_list_of_values(value):
        inner = _new_group(group, name, meaning)
        items = value.items() if isinstance(value, Mapping) else enumerate(value)
        for key, member in items:
            _write(inner, str(key), member, meaning, units, tables)
    else:
        _write_data(group, name, value, meaning, units)


def is_default(value: Any, name: str) -> bool:
    """Return whether a field holds its default dataclass, which a file may leave out."""
    member = getattr(value, name)
    return is_dataclass(member) and member is getattr(type(value), name, None)


def _is_list_of_values(value: Any) -> bool:
    return isinstance(value, tuple) and bool(value) and all(map(is_dataclass, value))


def _write_data(group: h5py.Group, name: str, value: Any, meaning: Meaning, units: Units) -> None:
    shape = meaning.shape
    if isinstance(value, str) or (isinstance(value, tuple) and _is_text(value)):
        data = group.create_dataset(member_name(name), data=value, dtype=h5py.string_dtype())
    else:
        array = np.asarray(value)
        if array.dtype.kind in "iu":
            array = array.astype(np.int64)
        if array.dtype.kind == "c":
            array = np.stack([array.real, array.imag], axis=-1)
            shape = f"{shape.rstrip(',)') or '('}{', ' if shape else ''}{PARTS})"
        packed: dict[str, Any] = (
            {"compression": "gzip", "shuffle": True, "fletcher32": True}
            if array.size > SMALL_ARRAY
            else {}
        )
        data = group.create_dataset(member_name(name), data=array, **packed)
        data.attrs["dimension"] = meaning.dimension
        data.attrs["unit"] = units.of(meaning.dimension)
    data.attrs["shape"] = shape
    data.attrs["description"] = meaning.description


def _is_text(value: tuple[Any, ...]) -> bool:
    return all(isinstance(entry, str) for entry in value)


def member_name(name: str) -> str:
    """Return the HDF5 name of a member, with slashes and percent signs escaped."""
    quoted = name.replace("%", "%25").replace("/", "%2F")
    return "%2E" if quoted == "." else quoted


def items(group: h5py.Group) -> Iterator[tuple[str, Any]]:
    """Yield the members of a group with their original, unescaped names."""
    for name in group:
        yield unquote(name), group[name]


def member(group: Node, name: str) -> Any:
    """Return a member of a group."""
    if name not in group:
        message = f"{getattr(group, 'name', '').rstrip('/')}/{name} is missing"
        raise KeyError(message)
    return group[name]


def read_value(group: Node, kind: type, tables: Mapping[type, Table]) -> Any:
    """Read a dataclass by the annotations of its fields.

    The members of its table are read; all fields where it has no table.
    """
    hints = get_type_hints(kind)
    defaulted = {
        field.name
        for field in fields(kind)
        if field.default is not MISSING or field.default_factory is not MISSING
    }
    values: dict[str, Any] = {}
    for name in tables[kind] if kind in tables else [field.name for field in fields(kind)]:
        if name in group or not (name in defaulted or types.NoneType in get_args(hints[name])):
            values[name] = read_member(member(group, name), hints[name], tables)
        elif name not in defaulted:
            values[name] = None
    return kind(**values)


def read_member(node: Node, hint: Any, tables: Mapping[type, Table]) -> Any:
    """Read a member as the type of its annotation."""
    origin, arguments = get_origin(hint), get_args(hint)
    if origin in (types.UnionType, Union):
        values = filter(is_dataclass, arguments if isinstance(node, Mapping) else ())
        return read_member(node, next(values, arguments[0]), tables)
    if hint is Any:
        return _in_memory(node)
    if hint is sp.csr_array:
        return _sparse_matrix(node)
    if is_dataclass(hint):
        return read_value(node, hint, tables)  # type: ignore[arg-type]
    if origin is np.ndarray:
        _check_kind(node, "fiubc", "numbers")
        kind = get_args(arguments[1])[0]
        if np.issubdtype(kind, np.complexfloating) and node.dtype.kind != "c":
            parts = np.asarray(node[()], dtype=float)
            return parts[..., 0] + 1j * parts[..., 1]
        return np.asarray(node[()], dtype=kind)
    if origin is tuple:
        return _read_tuple(node, arguments, tables)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        key: Callable[[str], Any] = arguments[0]
        return {key(name): read_member(entry, arguments[1], tables) for name, entry in items(node)}
    if hint is str or origin is Literal:
        _check_kind(node, "OSU", "a text", ndim=0)
        return str(_texts(node))
    if hint is complex and node.dtype.kind != "c":
        _check_kind(node, "fiub", "a complex number", ndim=1)
        return complex(*node[()])
    _check_kind(node, "fiubc", "one number", ndim=0)
    return hint(node[()])


def _in_memory(node: Node) -> Any:
    """Return a member whose type nothing says: nested mappings of arrays."""
    if isinstance(node, Mapping):
        return {name: _in_memory(entry) for name, entry in items(node)}
    return _texts(node) if node.dtype.kind in "OSU" else np.asarray(node[()])


def _sparse_matrix(node: Node) -> SparseMatrix:
    values, *rows = (
        read_member(member(node, name), kind, {})
        for name, kind in zip(SPARSE, (Matrix, Indices, Indices, Indices), strict=True)
    )
    columns, starts, shape = rows
    matrix = sp.csr_array((values, columns, starts), shape=tuple(shape.tolist()))
    matrix.check_format(full_check=True)
    return matrix


def _read_tuple(
    node: Node, arguments: tuple[Any, ...], tables: Mapping[type, Table]
) -> tuple[Any, ...]:
    if isinstance(node, Mapping):
        return tuple(read_value(entry, arguments[0], tables) for _, entry in items(node))
    if node.size == 0:  # empty tuples of any type are written as texts
        return ()
    _check_kind(node, "OSU" if arguments[0] is str else "fiub", "a list", ndim=1)
    return tuple((_texts(node) if arguments[0] is str else node[()]).tolist())


def _texts(node: Node) -> Any:
    return np.asarray((node.asstr() if isinstance(node, h5py.Dataset) else node)[()])


def _check_kind(node: Node, kinds: str, expected: str, ndim: int | None = None) -> None:
    """Refuse a member of another kind of data or number of axes."""
    matches = not isinstance(node, Mapping) and node.dtype.kind in kinds
    if not matches or ndim not in (None, node.ndim):
        refuse_value(f"'{getattr(node, 'name', '')}' does not hold {expected}")
