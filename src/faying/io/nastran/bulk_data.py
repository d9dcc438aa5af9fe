"""What readers of bulk data share."""

from collections.abc import Mapping
from dataclasses import dataclass

from faying.io.nastran.cards import Cards
from faying.io.nastran.case_control import CaseControl
from faying.io.nastran.grids import Grids


@dataclass(frozen=True, eq=False, kw_only=True)
class BulkData:
    """Cards of a deck by name, with the grid points they refer to.

    Attributes
    ----------
    control
        What case control selects.
    mass_factor
        By which densities and masses are multiplied (PARAM,WTMASS).
    ignored
        Notes so far; readers append theirs.
    """

    cards: Mapping[str, Cards]
    control: CaseControl
    grids: Grids
    mass_factor: float
    ignored: list[str]
