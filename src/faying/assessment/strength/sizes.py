"""Sizes of bolts by name: thread, hexagon head, washer and hole.

Facts of ISO 261 (pitch), ISO 4014 (washer face d_w of hexagon heads), ISO 4762 (of socket heads),
ISO 7089 (plain washers) and ISO 273 (clearance holes, medium series); names of inch sizes contain
diameter and threads an inch.
"""

import re
from dataclasses import dataclass
from difflib import get_close_matches

from faying.display.plane import ROUND
from faying.exceptions import ModelError, refuse_model

MILLIMETRE, INCH = 1e-3, 0.0254
"""Units of length in metres."""

UNIFIED = re.compile(
    r"(?:(?P<whole>\d+)[ -])?(?P<top>\d+)/(?P<bottom>\d+)-(?P<threads>\d+)(?: UN[CFJRS]*)?"
    r"|(?P<full>\d+)-(?P<coarse>\d+)(?: UN[CFJRS]*)?"
    r"|#(?P<number>\d+)-(?P<fine>\d+)(?: UN[CFJRS]*)?"
)

METRIC = re.compile(r"M(?P<diameter>\d+(?:\.\d+)?)(?:\s*[x×]\s*(?P<pitch>\d+(?:\.\d+)?))?")

# d: pitch, face under the head d_w, clearance hole, washer outside [mm]
HEXAGON: dict[float, tuple[float, float, float, float]] = {
    1.6: (0.35, 2.27, 1.8, 4.0),
    2.0: (0.4, 3.07, 2.4, 5.0),
    2.5: (0.45, 4.07, 2.9, 6.0),
    3.0: (0.5, 4.57, 3.4, 7.0),
    4.0: (0.7, 5.88, 4.5, 9.0),
    5.0: (0.8, 6.88, 5.5, 10.0),
    6.0: (1.0, 8.88, 6.6, 12.0),
    8.0: (1.25, 11.63, 9.0, 16.0),
    10.0: (1.5, 14.63, 11.0, 20.0),
    12.0: (1.75, 16.63, 13.5, 24.0),
    14.0: (2.0, 19.64, 15.5, 28.0),
    16.0: (2.0, 22.49, 17.5, 30.0),
    18.0: (2.5, 25.34, 20.0, 34.0),
    20.0: (2.5, 28.19, 22.0, 37.0),
    22.0: (2.5, 31.71, 24.0, 39.0),
    24.0: (3.0, 33.61, 26.0, 44.0),
    27.0: (3.0, 38.0, 30.0, 50.0),
    30.0: (3.5, 42.75, 33.0, 56.0),
    33.0: (3.5, 46.55, 36.0, 60.0),
    36.0: (4.0, 51.11, 39.0, 66.0),
    39.0: (4.0, 55.86, 42.0, 72.0),
    42.0: (4.5, 59.95, 45.0, 78.0),
    45.0: (4.5, 64.7, 48.0, 85.0),
    48.0: (5.0, 69.45, 52.0, 92.0),
    52.0: (5.0, 74.2, 56.0, 98.0),
    56.0: (5.5, 78.66, 62.0, 105.0),
    60.0: (5.5, 83.41, 66.0, 110.0),
    64.0: (6.0, 88.16, 70.0, 115.0),
}

SOCKET: dict[float, float] = {
    3.0: 5.07, 4.0: 6.53, 5.0: 8.03, 6.0: 9.38, 8.0: 12.33, 10.0: 15.33, 12.0: 17.23, 14.0: 20.17,
    16.0: 23.17, 20.0: 28.87, 24.0: 34.81, 30.0: 43.61, 36.0: 52.54,
}  # fmt: skip
"""d to the face under a socket head [mm]."""

HEADS = ("ISO 4014", "ISO 4762", "ISO 7089")
"""Hexagon head, socket head, and a hexagon head on a plain washer."""


@dataclass(frozen=True, kw_only=True)
class Size:
    """Dimensions of a thread size, and of its usual head and hole.

    Attributes
    ----------
    diameter, pitch : [m]
        d and P.
    unified
        Whether it is an inch thread, which has another stress area.
    face : [m]
        d_w, outer diameter of the face under the head; None where the table has none.
    hole : [m]
        d_h of the clearance hole.
    bearing : [m]
        Outer diameter of the bearing area: that of the face, or of a washer.
    """

    diameter: float
    pitch: float
    unified: bool = False
    face: float | None = None
    hole: float | None = None
    bearing: float | None = None


def size_named(name: str, head: str = HEADS[0]) -> Size:
    """Return a size by its name, as ``"M8"``, ``"M8x1"`` or ``"3/8-24 UNF"``."""
    text = " ".join(name.split())
    if head not in HEADS:
        refuse_model(f"head '{head}' is not known; give one of {', '.join(HEADS)}")
    if metric := METRIC.fullmatch(text):
        return _metric(name, float(metric["diameter"]), metric["pitch"], head)
    if unified := UNIFIED.fullmatch(text):
        return _unified(unified)
    suggested = get_close_matches(text.upper(), [f"M{d:g}" for d in HEXAGON], n=1)
    hint = f"; did you mean '{suggested[0]}'?" if suggested else ""
    message = f"no size is called '{name}': give it as 'M8', 'M8x1' or '3/8-24 UNF'{hint}"
    raise ModelError(message)


def size_through(hole: float) -> str | None:
    """Return the metric size for a clearance hole of a diameter [m]; None if there is none."""
    nearest = min(HEXAGON, key=lambda size: abs(HEXAGON[size][2] * MILLIMETRE - hole))
    # Pipe flanges (EN 1092) have 14 mm for M12 and 18 mm for M16, 3.6 and 2.8 % wider than here;
    # holes of neighbouring sizes differ by 6 % or more.
    fits = abs(HEXAGON[nearest][2] * MILLIMETRE / hole - 1) < 2 * ROUND
    return f"M{nearest:g}" if fits else None


def _metric(name: str, diameter: float, pitch: str | None, head: str) -> Size:
    listed = HEXAGON.get(diameter)
    if listed is None and pitch is None:
        sizes = ", ".join(f"M{d:g}" for d in HEXAGON)
        refuse_model(f"the coarse pitch of '{name}' is not listed ({sizes}); add it, as in 'M7x1'")
    if listed is None:
        return Size(diameter=diameter * MILLIMETRE, pitch=float(pitch or 0) * MILLIMETRE)
    coarse, face, hole, washer = listed
    if head == "ISO 4762":
        if diameter not in SOCKET:
            refuse_model(f"{head} lists no face of '{name}' here; give washer_radius and hole")
        face = SOCKET[diameter]
    bearing = washer if head == "ISO 7089" else face
    return Size(
        diameter=diameter * MILLIMETRE,
        pitch=(coarse if pitch is None else float(pitch)) * MILLIMETRE,
        face=face * MILLIMETRE,
        hole=hole * MILLIMETRE,
        bearing=bearing * MILLIMETRE,
    )


def _unified(text: re.Match[str]) -> Size:
    if text["number"]:
        diameter, threads = 0.060 + 0.013 * int(text["number"]), int(text["fine"])
    elif text["full"]:
        diameter, threads = float(text["full"]), int(text["coarse"])
    else:
        diameter = int(text["whole"] or 0) + int(text["top"]) / int(text["bottom"])
        threads = int(text["threads"])
    return Size(diameter=diameter * INCH, pitch=INCH / threads, unified=True)
