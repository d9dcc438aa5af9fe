"""Memory of this machine and of factorizations, and checks before memory is allocated."""

import logging
import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from faying.exceptions import ModelError

VARIABLE = "FAYING_MEMORY"
"""Environment variable for the free memory [bytes], to override the system's value."""

FALLBACK = 8 * 2**30
"""Physical memory assumed where the system does not report it [bytes]."""

UNLIMITED = 2**60
"""Limits from this value on mean no limit."""

SYSTEM = Path("/")
"""Root of the files of the Linux kernel."""


class Limit(NamedTuple):
    """Memory limit of a control group of the Linux kernel [bytes]."""

    most: int
    free: int


def physical_memory() -> int:
    """Return the physical memory within the limits of control groups [bytes]."""
    try:
        physical = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        physical = FALLBACK
    return min([physical, *(limit.most for limit in control_group_limits())])


def free_memory() -> int | None:
    """Return the available memory [bytes]; None where the system does not report it.

    Raises
    ------
    ModelError
        If the environment variable ``FAYING_MEMORY`` is no number of bytes.
    """
    setting = os.environ.get(VARIABLE)
    if setting:
        return _parsed_bytes(setting)
    try:
        facts = (SYSTEM / "proc/meminfo").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    # Swap is not counted: factorizations that swap do not end.
    free = [1024 * int(line.split()[1]) for line in facts if line.startswith("MemAvailable:")]
    return min([*free, *(limit.free for limit in control_group_limits())], default=None)


def _parsed_bytes(text: str) -> int:
    try:
        return int(float(text))
    except (ValueError, OverflowError):
        message = f"{VARIABLE} = {text!r}: a number of bytes was expected, as 16e9"
        raise ModelError(message) from None


def control_group_limits(system: Path | None = None) -> list[Limit]:
    """Return the memory limits of this process, of both versions of control groups."""
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
            limits += _group_limits(root / "sys/fs/cgroup", path, *files)
        elif "memory" in controllers.split(","):
            files = ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")
            limits += _group_limits(root / "sys/fs/cgroup/memory", path, *files)
    return limits


def _group_limits(base: Path, path: str, ceiling: str, used: str, idle: str) -> Iterator[Limit]:
    """Yield the limits of a group and of its parents; missing files set none."""
    folder_of_group = base / path.lstrip("/")
    # Inside a container, its group appears as the base itself, whatever the path says.
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


_log = logging.getLogger("faying")

NEGLIGIBLE = 1e7
"""Size of arrays [bytes] below which free memory is not checked, since that takes time too."""


class NotEnoughMemoryError(ModelError):
    """Factors or arrays would not fit into the free memory."""


@dataclass(frozen=True, kw_only=True)
class FactorMemory:
    """Memory of a factorization.

    Attributes
    ----------
    backend
        Name of the library.
    order
        Order of the matrix.
    factor
        Memory of the factors [bytes].
    peak
        Peak memory during the factorization [bytes], without the matrix.
    counted
        Whether the entries of the factor were counted; else a law fitted to measurements was used,
        which may be off by a factor of two.
    one_by_one
        Whether ports are solved one by one, because all at once would not fit.
    """

    backend: str
    order: int
    factor: int
    peak: int
    counted: bool
    one_by_one: bool = False

    def beside(self, count: int) -> "FactorMemory":
        """Return the memory with this number of equal factors added, at the same time."""
        return replace(self, peak=self.peak + count * self.factor)

    def with_ports(self, elimination: float, dense: float) -> "FactorMemory":
        """Return the memory with the solution for ports added.

        ``elimination`` are bytes of the elimination of all but the ports, which is done if it fits;
        ``dense`` those of dense matrices between them.
        """
        free = free_memory()
        fits = free is None or not elimination or self.factor + elimination <= free
        peak_bytes = self.factor + max(dense, elimination if fits else 0.0)
        return replace(self, peak=max(self.peak, int(peak_bytes)), one_by_one=not fits)


def require_memory(expected: FactorMemory) -> None:
    """Refuse a factorization that will not fit into memory, before it begins.

    Raises
    ------
    NotEnoughMemoryError
        If the entries were counted. An estimate is logged on ``"faying"`` instead.
    """
    free = free_memory()
    if free is None or expected.peak <= free:
        return
    message = (
        f"factors of {expected.order} degrees of freedom take about {gigabytes(expected.peak)} "
        f"({expected.backend}), and {gigabytes(free)} of memory are free; use a coarser mesh, "
        "close other programs, or a machine with more memory (FAYING_MEMORY overrules what is free)"
    )
    if expected.counted:
        raise NotEnoughMemoryError(message)
    _log.warning("%s", message)


def require_room(n_bytes: float, what: str, remedy: str) -> None:
    """Refuse arrays that will not fit into memory, before they are allocated.

    The message has ``what`` as its subject, in the plural, and the remedy.
    """
    if n_bytes < NEGLIGIBLE and VARIABLE not in os.environ:
        return
    free = free_memory()
    if free is not None and n_bytes > free:
        message = (
            f"{what} take {gigabytes(n_bytes)}, and {gigabytes(free)} of memory are free; {remedy} "
            "(FAYING_MEMORY overrules what is free)"
        )
        raise NotEnoughMemoryError(message)


def gigabytes(n_bytes: float) -> str:
    """Return a number of bytes as text in GB."""
    return f"{n_bytes / 1e9:.2g} GB" if n_bytes < 9.95e9 else f"{n_bytes / 1e9:.0f} GB"
