"""What a factorization will take, known before it begins, and whether there is as much."""

import logging
import os
from dataclasses import dataclass, replace

from faying.exceptions import ModelError
from faying.linalg.machine_memory import VARIABLE, free_memory

_log = logging.getLogger("faying")

NEGLIGIBLE = 1e7
"""Arrays [bytes] too small to ask the system for them, which takes as long as a small solution."""


class NotEnoughMemoryError(ModelError):
    """Factors or arrays would not fit into the memory that is free."""


@dataclass(frozen=True, kw_only=True)
class FactorMemory:
    """Memory of a factorization.

    Attributes
    ----------
    backend
        Name of the library.
    order
        Of the matrix.
    factor
        Held as long as the factors are [bytes].
    peak
        Most held at once while they are made [bytes]; the matrix is not counted.
    counted
        Whether the entries of the factor were counted; else a law fitted to measurements was used,
        which may be off by a factor of two.
    one_by_one
        Whether ports are solved for one by one, for all at once would not fit.
    """

    backend: str
    order: int
    factor: int
    peak: int
    counted: bool
    one_by_one: bool = False

    def with_ports(self, elimination: float, dense: float) -> "FactorMemory":
        """Add what ports take beside the factors, as it will be made.

        That are bytes of the elimination of all but the ports, if it fits, and of matrices between
        them.
        """
        free = free_memory()
        fits = free is None or not elimination or self.factor + elimination <= free
        peak_bytes = self.factor + max(dense, elimination if fits else 0.0)
        return replace(self, peak=max(self.peak, int(peak_bytes)), one_by_one=not fits)


def require_memory(expected: FactorMemory) -> None:
    """Say before a factorization begins that it will not fit.

    Raises
    ------
    NotEnoughMemoryError
        If the entries were counted. An estimate is announced on the logger ``"faying"`` instead.
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
    """Say before arrays are made that they will not fit.

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
    """Return a number of bytes in words."""
    return f"{n_bytes / 1e9:.2g} GB" if n_bytes < 9.95e9 else f"{n_bytes / 1e9:.0f} GB"
