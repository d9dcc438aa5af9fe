"""Gaps that grow as a power of the distance from a line: crowned and hollow surfaces."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from faying._typing import Vector
from faying.exceptions import ModelError
from faying.interface.interface import Interface


@final
@dataclass(frozen=True, kw_only=True)
class Crown:
    """Gap h (|s|/d)ⁿ at the distance s from a line.

    Attributes
    ----------
    origin : (3,) [length]
        A point of the line, s = 0.
    along : (3,)
        Where s grows, in the interface; the line is perpendicular to it.
    distance : [length]
        d, from the line to where the gap is h.
    height : [length]
        h; negative where the surfaces are hollow.
    exponent
        n; 2 is a cylinder.
    """

    origin: tuple[float, float, float]
    along: tuple[float, float, float]
    distance: float
    height: float
    exponent: float = 2.0


def crown_gap(interface: Interface, crowns: Sequence[Crown]) -> Vector:
    """Return the gap (n_point,) [length] that crowned surfaces leave where they touch first.

    Raises
    ------
    ModelError
        If a direction is no direction.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.lap_joint(element_size=5.0).interfaces["joint"]
    >>> middle = tuple(joint.points.mean(axis=0))
    >>> bowed = Crown(origin=middle, along=(1.0, 0.0, 0.0), distance=20.0, height=0.05)
    >>> gap = crown_gap(joint, [bowed])
    >>> float(gap.min()), bool(gap.max() > 0.02)
    (0.0, True)
    """
    total = np.zeros(interface.n_points)
    for crown in crowns:
        direction = np.asarray(crown.along, dtype=float)
        length = float(np.linalg.norm(direction))
        if not length > 0:
            message = (
                f"interface '{interface.name}': along = {list(crown.along)} is no direction; give "
                "where the gap of the crown grows"
            )
            raise ModelError(message)
        s = (interface.points - np.asarray(crown.origin)) @ direction / length
        total += crown.height * (np.abs(s) / crown.distance) ** crown.exponent
    return np.asarray(total - total.min())
