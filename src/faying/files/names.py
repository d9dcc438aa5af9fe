"""File names from names a user chose."""

import re
from collections.abc import Iterable

LONGEST_STEM = 120
"""Bytes of a stem; names of files end at 255, and others stand before and behind it."""


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
        # Some file systems do not tell cases apart.
        while stem.casefold() in used:
            number += 1
            stem = f"{plain}-{number}"
        used.add(stem.casefold())
        stems[name] = stem
    return stems
