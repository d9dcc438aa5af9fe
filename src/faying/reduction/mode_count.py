"""The number of vibration modes below a frequency, as a check that none was missed.

Lanczos finds eigenvalues but cannot tell whether it has missed one, least of all among multiple
eigenvalues. The signs of the pivots of K − ω²M can (:mod:`faying.linalg.backends`).
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from faying.digits import DECK_DIGITS
from faying.exceptions import ConvergenceError
from faying.joint.model import Model
from faying.joint.structure import Structure
from faying.linalg.backends import count_negative
from faying.linalg.memory import NotEnoughMemoryError
from faying.linalg.singular import InertiaError
from faying.reduction.normal_modes import NormalModes


@dataclass(frozen=True, kw_only=True)
class ModeCount:
    """Fixed-interface normal modes below a frequency that lies in a gap between two.

    Attributes
    ----------
    below : [1/time]
        Frequency in a gap between modes.
    found : [1]
        Number of modes computed below it.
    counted : [1]
        Number of modes that exist, by the inertia of K − ω² M; None if it could not be counted.
    reason
        Why they could not be counted.
    """

    below: float
    found: int
    counted: int | None = None
    reason: str = ""


def count_modes_below(model: Model, frequency: float) -> int:
    """Return the number of fixed-interface normal modes below a frequency [1/time].

    The boundary is held and contact absent, as for :func:`faying.craig_bampton`. The number tells
    which ``normal_modes`` covers a frequency, and proves that no mode was missed.

    Raises
    ------
    InertiaError
        If the frequency is so close to a natural frequency that round-off decides.

    Notes
    -----
    One factorization of K − ω²M, by Sylvester's law of inertia; no modes are computed. Backend and
    memory as in :func:`faying.factorize`.

    Examples
    --------
    >>> import faying as fy
    >>> fy.count_modes_below(fy.lap_joint(element_size=5.0), 10e3)
    7
    """
    return _count(model.structure, frequency)


def check_modes(structure: Structure, modes: NormalModes) -> ModeCount | None:
    """Return the number of normal modes of a structure that exist and that were computed.

    None where the frequencies leave no gap to count in.
    """
    gap = _last_gap([*modes.frequencies.tolist(), modes.next_frequency])
    if gap is None:
        return None
    count, below = gap
    try:
        counted = _count(structure, below)
    except (InertiaError, NotEnoughMemoryError) as error:
        return ModeCount(below=below, found=count, reason=str(error))
    if counted != count:
        message = (
            f"{count} fixed-interface normal modes were computed below {below:g}, where there are "
            f"{counted}: the eigenvalue solver missed some; ask for a few more normal modes, and "
            "if that does not help for fewer"
        )
        raise ConvergenceError(message)
    return ModeCount(below=below, found=count, counted=counted)


def _last_gap(frequencies: list[float]) -> tuple[int, float] | None:
    """Return the number of frequencies below the last gap between them, and its middle."""
    gaps = list(enumerate(pairwise(frequencies), start=1))
    for below, (lower, upper) in reversed(gaps):
        # Round-off moves frequencies by 1e-10 on meshes of 50 000 degrees of freedom.
        if upper > lower * (1 + DECK_DIGITS):
            return below, (lower + upper) / 2 if np.isfinite(upper) else 1.1 * lower
    return None


def _count(structure: Structure, frequency: float) -> int:
    inner = structure.interior
    K, M = structure.interior_stiffness, structure.M[inner][:, inner]
    return count_negative(K - (2 * np.pi * frequency) ** 2 * M)
