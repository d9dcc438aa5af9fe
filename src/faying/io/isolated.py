"""Compiled readers of other programs' files, each run in its own process.

Such a reader trusts the file: a damaged file can crash or stall the process that reads it, so this
must not be the user's process.
"""

import subprocess
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from faying.exceptions import FormatError, refuse
from faying.files.child_python import (
    SLOWEST_READING,
    STARTUP_SECONDS,
    python_command,
    python_environment,
)
from faying.linalg.memory import free_memory, gigabytes, physical_memory

ROOM = 10**9
"""Bytes of address space that the libraries of a reader may take, beyond the free memory.

The libraries for Ansys archives take 0.4 GB.
"""

_NOT_INSTALLED = 3

_LIMITED = """
try:
    import numpy, resource
    with open("/proc/self/statm") as file:
        limit = resource.getpagesize() * int(file.read().split()[0]) + {room}
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
except (ImportError, OSError, ValueError):
    pass
"""


def read_isolated(
    script: str, path: Path, what: str, extra: str = ""
) -> dict[str, npt.NDArray[Any]]:
    """Let a script read a file and return the arrays it saves.

    The script takes the file from ``sys.argv[1]``, calls ``numpy.savez`` on ``sys.argv[2]``, and
    exits with status 3 if its reader is not installed. Messages name what is read and the extra
    of faying that installs the reader.
    """
    if not path.is_file():
        refuse(f"{what}: '{path}' does not exist; check the path")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "arrays.npz"
        limit = STARTUP_SECONDS + path.stat().st_size / SLOWEST_READING
        room = ROOM + (free_memory() or physical_memory())
        limited = _LIMITED.format(room=room) + script
        command = python_command("-c", limited, str(path.resolve()), str(target))
        try:
            done = subprocess.run(
                command,
                capture_output=True,
                text=True,
                errors="replace",
                timeout=limit,
                env=python_environment(),
                check=False,
            )
        except subprocess.TimeoutExpired:
            message = f"{what}: '{path}' could not be read in {limit:.0f} s; it is damaged"
            raise FormatError(message) from None
        if done.returncode == _NOT_INSTALLED:
            refuse(f"{what}: reading '{path}' needs an extra; pip install 'faying[{extra}]'")
        if done.returncode != 0 or not target.is_file():
            said = done.stderr.strip().splitlines()
            reason = said[-1][:200] if said else f"its reader ended with status {done.returncode}"
            if "MemoryError" in reason or "bad_alloc" in reason:
                reason = f"its reader asked for more than {gigabytes(room)}"
            refuse(f"{what}: '{path}' cannot be read ({reason}); write it again")
        with np.load(target) as file:
            return {key: file[key] for key in file.files}
