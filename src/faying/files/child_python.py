"""A separate Python process for reading untrusted files, which may crash or stall it."""

import os
import sys
from collections.abc import Mapping

STARTUP_SECONDS = 120.0
"""Seconds of wall time that a process may take to start on a busy machine; 2 to 20 are usual."""

SLOWEST_READING = 1e6
"""Bytes a second below which reading counts as stalled; healthy files take a hundredth of that."""


def python_command(*arguments: str) -> list[str]:
    """Return the command that runs this Python; it takes no modules from the current folder."""
    return [sys.executable, "-P", *arguments]


def python_environment() -> Mapping[str, str]:
    """Return the environment in which a child process finds the modules of this process."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
