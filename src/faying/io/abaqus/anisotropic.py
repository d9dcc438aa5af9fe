"""``*ELASTIC`` with a TYPE: constants that differ between directions."""

from collections.abc import Callable

import numpy as np

from faying._typing import Matrix
from faying.io.abaqus.fields import numbers
from faying.io.abaqus.keyword import Keyword
from faying.model.elastic_law import orthotropic_law

ISOTROPIC = ("ISOTROPIC", "ISO")
_COUNTS = {"ORTHOTROPIC": 9, "ENGINEERINGCONSTANTS": 9, "ANISOTROPIC": 21}
_ORDER = np.array([0, 1, 2, 3, 5, 4])
"""Decks have 11, 22, 33, 12, 13, 23; see :mod:`faying.model.elastic_law`."""


def read_law(keyword: Keyword, temperature: Callable[[], float]) -> Matrix:
    """Return the stiffness (6, 6) along the axes of the material.

    Parameters
    ----------
    temperature
        Tells at which one a table over temperature counts.
    """
    wished = keyword.choice("TYPE").replace(" ", "")
    kind = next((name for name in _COUNTS if len(wished) > 2 and name.startswith(wished)), "")
    if not kind:
        keyword.refuse(
            f"TYPE={keyword.choice('TYPE')} is not supported; ISOTROPIC, ORTHO, ENGINEERING "
            "CONSTANTS and ANISOTROPIC are"
        )
    count = _COUNTS[kind]
    values = [
        value
        for i, row in enumerate(keyword.rows())
        for value in numbers(keyword, i, row, "an elastic constant")
    ]
    # A temperature may stand behind the last constant, and must in a table.
    if len(values) < count or (len(values) > count and len(values) % (count + 1)):
        keyword.refuse(
            f"found {len(values)} numbers, expected {count}, or as many and a temperature for each "
            "temperature of a table"
        )
    if len(values) > count + 1:
        table = np.array(values).reshape(-1, count + 1)
        if (np.diff(table[:, -1]) <= 0).any():
            keyword.refuse("the temperatures do not increase; sort them")
        degrees = temperature()
        values = [float(np.interp(degrees, table[:, -1], column)) for column in table[:, :-1].T]
    if kind == "ENGINEERINGCONSTANTS":
        shear = np.array([values[6], values[8], values[7]])
        try:
            return orthotropic_law(values[:3], values[3:6], shear)
        except ValueError as error:
            raise keyword.error(str(error)) from None
    law = np.zeros((6, 6))
    if kind == "ORTHOTROPIC":
        law[[0, 0, 1, 0, 1, 2, 3, 4, 5], [0, 1, 1, 2, 2, 2, 3, 4, 5]] = values[:9]
    else:
        rows, columns = np.array([(i, j) for j in range(6) for i in range(j + 1)]).T
        law[rows, columns] = values[:21]
    law = law + np.triu(law, 1).T
    return np.asarray(law[np.ix_(_ORDER, _ORDER)])
