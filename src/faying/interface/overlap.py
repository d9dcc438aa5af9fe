"""Interfaces over the same faces: contact there would count twice."""

from collections.abc import Mapping

import numpy as np

from faying._typing import Indices
from faying.exceptions import ModelError
from faying.interface.interface import Interface
from faying.model.surface import WIDTH, unique_rows


def check_not_doubled(interfaces: Mapping[str, Interface]) -> None:
    """Refuse two interfaces that pair the same facets, in either order of the sides.

    Raises
    ------
    ModelError
        Naming both interfaces.

    Notes
    -----
    One sort of all paired facets.
    """
    names = list(interfaces)
    tables, owners = [], []
    for number, name in enumerate(names):
        for faces in interfaces[name].faces:
            tables.append(_keys(faces.minus, faces.plus))
            owners.append(np.full(len(faces.minus), number))
    if not tables:
        return
    owner = np.concatenate(owners)
    first, group, _ = unique_rows(np.concatenate(tables))
    again = np.flatnonzero(owner[first][group] != owner)
    if again.size:
        first, second = (
            names[number] for number in sorted((owner[first[group[again[0]]]], owner[again[0]]))
        )
        message = (
            f"interfaces '{first}' and '{second}' pair the same {again.size} facets, whose contact "
            "would count twice; remove one of them (a deck's contact definitions need no "
            "repetition in the study)"
        )
        raise ModelError(message)


def _keys(minus: Indices, plus: Indices) -> Indices:
    """Sorted nodes (n, 16) of both facets, -1 in front."""
    both = np.sort(np.hstack([minus, plus]), axis=1)
    return np.pad(both, ((0, 0), (2 * WIDTH - both.shape[1], 0)), constant_values=-1)
