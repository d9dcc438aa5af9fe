"""Ranges of the numbers and names of a study file, each with its reason.

Whatever a key means, a number outside is a slip of the pen or an attack, and would overflow, run
out of memory or never end.
"""

from typing import Any

from faying.study.keys.errors import refusal, shown

SMALLEST, LARGEST = 1e-30, 1e30
"""Magnitudes of measures: products of several, as a stiffness times an area times a length, must
stay between 1e-308 and 1e308, where double precision ends."""

LARGEST_COUNT = 1_000_000
"""Modes, levels, steps per period or loads: no memory holds a vector of a structure for each."""

MOST_SOLVED = 10_000
"""Increments, points of a sweep or samples: each is solved with what was found before it."""

LARGEST_ID = 2**53
"""Ids of nodes and elements: whole numbers that tables of numbers hold exactly."""

LONGEST_NAME = 200
"""Characters of a name: it becomes part of file names, which end at 255 bytes, and of tables."""

MOST_STEPS = 100_000_000
"""Time steps of a response: at a microsecond each, the least that a step takes, two minutes; at the
milliseconds of a full model, days."""


MOST_PRELOAD_FACTOR = 10.0
"""Initial force of a bolt over that it was tightened to: bolts that are tightened at all yield long
before, so that a larger number is meant as a force."""


def in_range(value: float) -> float:
    """Return a measure whose products with others can be computed."""
    if value != 0 and not SMALLEST <= abs(value) <= LARGEST:
        message = (
            f"found {shown(value)}, expected 0 or a magnitude from {SMALLEST:g} to {LARGEST:g}, "
            "for products with others must stay within double precision; correct it or use other "
            "units"
        )
        raise refusal(message)
    return value


def countable(value: int) -> int:
    """Return a number of things that can be kept in memory."""
    if value > LARGEST_COUNT:
        message = (
            f"found {shown(value)}, expected at most {LARGEST_COUNT}, for no memory holds a vector "
            "of a structure for each; lower it"
        )
        raise refusal(message)
    return value


def identifying(value: int) -> int:
    """Return an id that tables of numbers hold exactly."""
    if abs(value) > LARGEST_ID:
        message = f"found {shown(value)}, expected an id up to 2^53; correct it"
        raise refusal(message)
    return value


def showable(value: str) -> str:
    """Return a text that tables and terminals can show."""
    strange = next((c for c in value if not c.isprintable()), "")
    if strange:
        message = (
            f"found {value[:40]!a} with the character U+{ord(strange):04X}, which cannot be shown; "
            "remove it"
        )
        raise refusal(message)
    return value


def nameable(value: str) -> str:
    """Return a name that can be shown and be part of a file's name."""
    showable(value)
    if len(value) > LONGEST_NAME:
        message = f"found {len(value)} characters, expected at most {LONGEST_NAME}; shorten it"
        raise refusal(message)
    return value


def all_in_range(value: Any) -> None:
    """Refuse measures out of range in nested lists."""
    if isinstance(value, (list, tuple)):
        for entry in value:
            all_in_range(entry)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        in_range(value)
