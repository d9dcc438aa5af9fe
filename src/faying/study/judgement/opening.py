"""Areas that a load opens among those that the preload presses together."""

from dataclasses import dataclass

import numpy as np

from faying._typing import Frozen, Mask, Matrix, Vector
from faying.study.results.values import CaseResult, InterfaceRecord


@dataclass(frozen=True, eq=False, kw_only=True)
class Opening(Frozen):
    """Opening of an interface in a load case of the full model.

    Areas outside the pressure cones of the bolts are open before the load as well. They are
    excluded by the pressure after tightening.

    Attributes
    ----------
    opened, closed
        Area that was pressed after tightening and is open under the load, and the reverse, both
        over the area that was pressed; largest over time. Zero where no area was pressed.
    gap : [length]
        Largest gap, over points and instants; zero where all is closed.
    point : (3,) [length]
        Point of the largest gap.
    instant
        Index of the instant of the largest gap; None for static cases.
    """

    opened: float
    closed: float
    gap: float
    point: Vector
    instant: int | None


def opening(record: InterfaceRecord, case: CaseResult) -> Opening | None:
    """Return the opening against the preloaded state; None for an interface without points."""
    if not len(record.points):
        return None
    points = slice(*record.slice)
    pressure = np.atleast_2d(case.reference.pressure[..., points])
    gap = np.atleast_2d(case.reference.gap[..., points])
    pressed, now = record.preload_pressure > 0, pressure > 0
    instant, point = np.unravel_index(int(gap.argmax()), gap.shape)
    return Opening(
        opened=_share(record, pressed & ~now, pressed),
        closed=_share(record, ~pressed & now, pressed),
        gap=max(float(gap[instant, point]), 0.0),
        point=record.points[point],
        instant=None if case.times is None else int(instant),
    )


def _share(record: InterfaceRecord, changed: Mask, pressed_before: Mask) -> float:
    """Return the largest changed area (n_instant, n_point) over the area pressed before."""
    pressed = float(record.weights[pressed_before].sum())
    areas: Matrix = changed @ record.weights
    return float(areas.max()) / pressed if pressed > 0 else 0.0
