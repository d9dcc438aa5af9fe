"""File names from the names of users."""

import re
from collections.abc import Iterable

LONGEST_STEM = 120
"""Most bytes of a stem; file names have up to 255, with prefix and suffix."""


def file_names(names: Iterable[str]) -> dict[str, str]:
    """Return a distinct file name stem for each name; letters, digits, ``+``, ``-``, ``_`` stay.

    Examples
    --------
    >>> file_names(["joint 1", "joint/1"])
    {'joint 1': 'joint-1', 'joint/1': 'joint-1-2'}
    """
    stems: dict[str, str] = {}
    used: set[str] = set()
    for name in names:
        plain = re.sub(r"[^\w+-]+", "-", name).encode()[:LONGEST_STEM].decode(errors="ignore")
        plain = plain.strip("-") or "unnamed"
        stem, number = plain, 1
        # Some file systems ignore case.
        while stem.casefold() in used:
            number += 1
            stem = f"{plain}-{number}"
        used.add(stem.casefold())
        stems[name] = stem
    return stems
