"""Memory of this machine, or of the part of it that a container or a batch job may use."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from faying.exceptions import ModelError

VARIABLE = "FAYING_MEMORY"
"""Environment variable for the free memory [bytes], where the system's word does not hold."""

FALLBACK = 8 * 2**30
"""Physical memory assumed where the system does not tell [bytes]."""

UNLIMITED = 2**60
"""Limits from here on are none."""

SYSTEM = Path("/")
"""Where the files of the Linux kernel are looked for."""


class Limit(NamedTuple):
    """What a control group of the Linux kernel grants [bytes]."""

    most: int
    free: int


def physical_memory() -> int:
    """Return the memory there is [bytes], limits of control groups respected."""
    try:
        physical = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        physical = FALLBACK
    return min([physical, *(limit.most for limit in control_group_limits())])


def free_memory() -> int | None:
    """Return the memory still to be had [bytes], or None where the system does not tell.

    Raises
    ------
    ModelError
        If the environment variable ``FAYING_MEMORY`` is no number of bytes.
    """
    setting = os.environ.get(VARIABLE)
    if setting:
        return _told(setting)
    try:
        facts = (SYSTEM / "proc/meminfo").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    # Swap is not counted: factorizations that swap do not end.
    free = [1024 * int(line.split()[1]) for line in facts if line.startswith("MemAvailable:")]
    return min([*free, *(limit.free for limit in control_group_limits())], default=None)


def _told(text: str) -> int:
    try:
        return int(float(text))
    except (ValueError, OverflowError):
        message = f"{VARIABLE} = {text!r}: a number of bytes was expected, as 16e9"
        raise ModelError(message) from None


def control_group_limits(system: Path | None = None) -> list[Limit]:
    """Return the limits of memory on this process, of both versions of control groups."""
    root = SYSTEM if system is None else system
    try:
        lines = (root / "proc/self/cgroup").read_text(encoding="utf-8").splitlines()
    except OSError:
        return []
    limits: list[Limit] = []
    for line in lines:
        _, controllers, path = line.split(":", 2)
        if controllers == "":
            files = ("memory.max", "memory.current", "inactive_file")
            limits += _limits(root / "sys/fs/cgroup", path, *files)
        elif "memory" in controllers.split(","):
            files = ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")
            limits += _limits(root / "sys/fs/cgroup/memory", path, *files)
    return limits


def _limits(base: Path, path: str, ceiling: str, used: str, idle: str) -> Iterator[Limit]:
    """Yield the limits of a group and of those above it; files that are not there set none."""
    folder_of_group = base / path.lstrip("/")
    # In a container the own group appears as the base itself, whatever its path is called.
    for folder in dict.fromkeys([folder_of_group, *folder_of_group.parents]):
        if not folder.is_relative_to(base):
            return
        try:
            limit = int((folder / ceiling).read_text(encoding="ascii"))
            in_use = int((folder / used).read_text(encoding="ascii"))
            facts = (folder / "memory.stat").read_text(encoding="ascii").splitlines()
        except (OSError, ValueError):  # "max" is no number
            continue
        cache = sum(int(line.split()[1]) for line in facts if line.split()[0] == idle)
        if limit < UNLIMITED:
            yield Limit(limit, max(limit - in_use + cache, 0))
