"""Python in a process of its own, for what a file of a stranger must not do to this one."""

import os
import sys
from collections.abc import Mapping

STARTUP_SECONDS = 120.0
"""Seconds by the clock that a process may take to begin on a busy machine; 2 to 20 are usual."""

SLOWEST_READING = 1e6
"""Bytes a second below which reading counts as stalled; healthy files take a hundredth of that."""


def python_command(*arguments: str) -> list[str]:
    """Return the command that runs this Python; it takes no modules from the current folder."""
    return [sys.executable, "-P", *arguments]


def python_environment() -> Mapping[str, str]:
    """Return the environment in which it finds the modules that this process finds."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
