"""Check of an untrusted HDF5 file by a separate process, which may crash or stall.

Such a file may refer to other files by links, external or virtual storage, or contain
circular groups; and a few bytes may announce terabytes. All of this is refused.
"""

import json
import signal
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py

from faying.exceptions import refuse_value
from faying.files.contents import check_fits

MOST_PACKED = 1100
"""Largest number of bytes per compressed byte: deflate reaches 1032."""

AT_ONCE = 2**28
"""Bytes of texts read together; each text is at most as long as the file."""


def serve() -> None:
    """Answer requests, one line of JSON each, until the input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent process
    for line in sys.stdin:
        request = json.loads(line)
        if hasattr(signal, "setitimer"):
            # Ends the process: no handler of Python's would run inside a loop of HDF5.
            signal.setitimer(signal.ITIMER_PROF, request["seconds"])
        sys.stdout.write(json.dumps(_answer(request)) + "\n")
        sys.stdout.flush()


def _answer(request: Mapping[str, Any]) -> dict[str, str]:
    path = Path(request["path"])
    try:
        file = h5py.File(path, "r")
    except Exception:  # HDF5 and h5py raise whatever a damaged file meets
        return {"closed": "it cannot be opened"}
    try:
        with file:
            _check(file, path, request["room"], whole=request["whole"])
    except Exception as error:
        return {"wrong": str(error) or type(error).__name__}
    return {}


def _check(file: h5py.File, path: Path, room: int | None, *, whole: bool) -> None:
    """Check links and names of all groups, and the size of all data if ``whole``."""
    total, groups = 0, [file]
    dict(file.attrs)
    while groups:
        group = groups.pop()
        for name in group:
            entry = f"'{group.name.rstrip('/')}/{name}'"
            if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                message = f"{entry} is a link to another place; only its own data are read"
                raise ValueError(message)
            node = group[name]
            if h5py.h5o.get_info(node.id).rc > 1:
                refuse_value(f"{entry} has a second name, so its groups may go round in circles")
            dict(node.attrs)
            if isinstance(node, h5py.Group):
                groups.append(node)
                continue
            _require_own_data(node, entry)
            if whole:
                total += _size(node, entry, path, room)
    check_fits(total, room, path)


def _require_own_data(node: h5py.Dataset | h5py.Datatype, entry: str) -> None:
    if not isinstance(node, h5py.Dataset) or node.is_virtual or node.external:
        refuse_value(f"{entry} is not a dataset that holds its own data")


def _size(node: h5py.Dataset, entry: str, path: Path, room: int | None) -> int:
    """Return the bytes of a dataset in memory."""
    announced, stored = node.size * node.dtype.itemsize, node.id.get_storage_size()
    if announced > MOST_PACKED * stored:
        refuse_value(f"{entry} has shape {node.shape}, {announced:.3g} bytes, but stores {stored}")
    text = h5py.check_string_dtype(node.dtype)
    if (text is None and node.dtype.kind not in "fiub") or (text is not None and node.ndim > 1):
        refuse_value(f"{entry} holds neither numbers nor a list of texts")
    if text is None or text.length is not None:
        return int(announced)
    return int(announced) + _text_size(node, path, room)


def _text_size(node: h5py.Dataset, path: Path, room: int | None) -> int:
    """Return the bytes of texts, many of which may be stored once in the file."""
    if node.shape == ():
        return len(node[()])
    total, step = 0, max(AT_ONCE // path.stat().st_size, 1)
    for first in range(0, len(node), step):
        total += sum(map(len, node[first : first + step]))
        if first:
            check_fits(total, room, path)
    return total


if __name__ == "__main__":
    serve()
