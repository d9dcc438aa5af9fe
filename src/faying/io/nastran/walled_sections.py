"""Sections of PBARL and PBEAML made of rectangles, by the names of MSCBML0.

Dimensions as in the MSC Nastran Quick Reference Guide, PBARL; y is up, z to the side.
"""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from faying.digits import SOLVED
from faying.model.assembly import BeamSection

Rectangle = tuple[float, float, float, float]
"""Width along z, height along y, and centre (y, z)."""


def _i(
    h: float, below: float, above: float, web: float, low: float, high: float
) -> list[Rectangle]:
    return [
        (below, low, low / 2, 0.0),
        (above, high, h - high / 2, 0.0),
        (web, h - low - high, (h + low - high) / 2, 0.0),
    ]


def _i1(overhang: float, web: float, within: float, h: float) -> list[Rectangle]:
    flange = (h - within) / 2
    return _i(h, overhang + web, overhang + web, web, flange, flange)


def _h(bar: float, sides: float, h: float, t: float) -> list[Rectangle]:
    distance = bar / 2 + sides / 4
    return [(bar, t, 0.0, 0.0), (sides / 2, h, 0.0, distance), (sides / 2, h, 0.0, -distance)]


def _cross(arms: float, web: float, h: float, t: float) -> list[Rectangle]:
    distance = web / 2 + arms / 4
    return [(web, h, 0.0, 0.0), (arms / 2, t, 0.0, distance), (arms / 2, t, 0.0, -distance)]


def _t(w: float, h: float, flange: float, web: float) -> list[Rectangle]:
    return [(w, flange, h - flange / 2, 0.0), (web, h - flange, (h - flange) / 2, 0.0)]


def _t1(h: float, length: float, flange: float, web: float) -> list[Rectangle]:
    return [(flange, h, 0.0, flange / 2), (length, web, 0.0, flange + length / 2)]


def _chan(w: float, h: float, web: float, flange: float) -> list[Rectangle]:
    arm, middle = w - web, (h - flange) / 2
    distance = web + arm / 2
    return [
        (web, h, 0.0, web / 2),
        (arm, flange, middle, distance),
        (arm, flange, -middle, distance),
    ]


def _chan1(arm: float, web: float, within: float, h: float) -> list[Rectangle]:
    return _chan(arm + web, h, web, (h - within) / 2)


def _hat(h: float, t: float, w: float, brim: float) -> list[Rectangle]:
    distance, out, rise = (w - t) / 2, w / 2 + brim / 2, h - t
    return [
        (w, t, h - t / 2, 0.0),
        *((t, rise, rise / 2, side * distance) for side in (1, -1)),
        *((brim, t, t / 2, side * out) for side in (1, -1)),
    ]


SHAPES: Mapping[str, tuple[int, Callable[..., list[Rectangle]]]] = {
    **{"I": (6, _i), "I1": (4, _i1), "H": (4, _h), "CROSS": (4, _cross), "HAT": (4, _hat)},
    **{"T": (4, _t), "T1": (4, _t1), "T2": (4, _t)},
    **{"CHAN": (4, _chan), "CHAN1": (4, _chan1)},
}
"""Number of dimensions, and function that returns the rectangles."""
ESTIMATED = (
    "sections of PBARL and PBEAML made of thin walls: torsion is the sum of b t^3 / 3, some per "
    "cent off Nastran's for thick walls, and only walls along the shear carry it"
)


def walled_section(kind: str, sizes: Sequence[float]) -> tuple[BeamSection, bool]:
    """Return a section, and whether it is symmetric about both axes.

    Notes
    -----
    Torsion is that of open thin walls, the sum of b t³/3 over the rectangles. Shear factors are the
    area of rectangles that are longer along the shear than across it, over the total area.
    """
    width, height, y, z = np.array(SHAPES[kind][1](*sizes)).T
    if not min(width.min(), height.min()) > 0:
        message = "a wall has no length or thickness"
        raise ValueError(message)
    area = width * height
    total = area.sum()
    up, side = y - area @ y / total, z - area @ z / total
    upright = float(area[height > width].sum() / total)
    low, high = (y - height / 2).min(), (y + height / 2).max()
    left, right = (z - width / 2).min(), (z + width / 2).max()
    middle = (area @ y / total - (low + high) / 2, area @ z / total - (left + right) / 2)
    section = BeamSection(
        area=float(total),
        inertia_z=float((width * height**3 / 12 + area * up**2).sum()),
        inertia_y=float((height * width**3 / 12 + area * side**2).sum()),
        torsion=float((np.maximum(width, height) * np.minimum(width, height) ** 3).sum() / 3),
        shear_factor_y=upright or math.inf,
        shear_factor_z=1 - upright or math.inf,
    )
    return section, max(map(abs, middle)) <= SOLVED * (high - low)
