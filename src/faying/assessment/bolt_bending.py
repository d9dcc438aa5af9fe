"""How far load cases bend a bolt."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Matrix


@final
@dataclass(frozen=True, kw_only=True)
class BoltBending:
    """Bending of a bolt over all load cases, the larger of those where its beams begin and end.

    Attributes
    ----------
    most : [force·length]
        Largest moment M_b, what tightening leaves included.
    most_case
        Load case it belongs to.
    added : [force·length]
        Largest change from the tightened joint.
    added_case
        Load case it belongs to.
    """

    most: float
    most_case: str
    added: float
    added_case: str


def bending_of(preload: Matrix, cases: Mapping[str, Matrix]) -> BoltBending:
    """Judge the bending moments of a bolt [force·length], by end and component across the axis.

    Those at rest are (2, 2), those of a load case (n_instant, 2, 2).
    """
    peaks = {case: _largest(moments) for case, moments in cases.items()}
    added = {case: _largest(moments - preload) for case, moments in cases.items()}
    worst, farthest = max(peaks, key=peaks.__getitem__), max(added, key=added.__getitem__)
    return BoltBending(
        most=peaks[worst], most_case=worst, added=added[farthest], added_case=farthest
    )


def _largest(moments: Matrix) -> float:
    return float(np.linalg.norm(moments, axis=-1).max())
