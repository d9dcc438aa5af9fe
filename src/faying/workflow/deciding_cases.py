"""The cases that decide among many: found by what is cheap, and judged one by one as a run does.

A case decides where some metric is worst, or where a joint opens or slides first. The factors of
the latter are estimated of all cases; those that come first are followed, then twice as many as
before are tried again and again, until none of them opens or slides before.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.assessment.growth import LARGEST_FACTOR
from faying.assessment.opening import Openings, opening_factors, opening_margins
from faying.assessment.slip_reserve import SlipReserve, growing_reserve
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.solution import Solution
from faying.study.inputs.load_set import LoadSet
from faying.study.keys.tables import DEFAULT_INCREMENTS

TRIED = 8
"""Cases that are tried first beside the one that is followed, which costs eight times as much.

Of 1000 random loads on a roof joint the first to open was the first or second by estimates; of 24
on a coarse lap joint that opens at three times the load it was among the first nine, and not five.
"""

TRIED_BY_PATHS = 2
"""The same where each is followed in increments."""


def least_factor(
    estimates: Vector,
    exact: Callable[[int], float],
    sooner: Callable[[Indices, float], Indices],
    tried: int,
) -> None:
    """Follow the cases of the least factors of something that happens.

    Parameters
    ----------
    estimates : (n_case,)
        Of the factors; NaN of cases that are not judged.
    exact
        Follows a case to its factor.
    sooner
        Of some cases those in which it may happen before a factor, the first first.
    tried
        Cases that are tried first.
    """
    order = np.argsort(estimates, kind="stable")[: np.count_nonzero(~np.isnan(estimates))]
    if not len(order):
        return
    least, done = exact(int(order[0])), 1
    while done < len(order):
        batch, before = order[done : done + tried], least
        while len(left := sooner(batch, least)):
            least = min(least, exact(int(left[0])))
            batch = left[1:]
        done, tried = done + tried, 2 * tried
        if not least < before:
            break


@dataclass(frozen=True, eq=False, kw_only=True)
class Deciding:
    """Static cases of a joint, judged as a run judges them.

    Attributes
    ----------
    rom
    loads
        With the static cases.
    areas
        Name to the points (n_point,) of what opens.
    open_below
        Share of the area pressed at rest below which it is open.
    """

    rom: ReducedModel
    loads: LoadSet
    areas: Mapping[str, Mask]
    open_below: float

    def openings(self, estimates: Matrix) -> dict[str, Openings]:
        """Return the openings of the cases that open an area before all others do.

        Parameters
        ----------
        estimates : (n_case, n_area)
        """
        found: dict[str, Openings] = {}
        for (name, points), column in zip(self.areas.items(), estimates.T, strict=True):
            area = {name: points}

            def exact(row: int, area: Mapping[str, Mask] = area) -> float:
                followed = self.opened(self.loads.inputs[row], area)
                case = self.loads.names[row]
                opened = {**found[case].opened, **followed.opened} if case in found else None
                found[case] = replace(followed, opened=opened or followed.opened)
                return min(followed.opened.values(), default=np.inf)

            def sooner(rows: Indices, factor: float, area: Mapping[str, Mask] = area) -> Indices:
                if not len(rows):
                    return rows
                inputs, largest = self.loads.inputs[rows], min(factor, LARGEST_FACTOR)
                margins = opening_margins(
                    self.rom.joint, inputs, area, largest, open_below=self.open_below
                )
                first = np.argsort(margins, kind="stable")
                return rows[first[margins[first] < 0]]

            least_factor(column, exact, sooner, TRIED)
        return found

    def opened(self, inputs: Vector, areas: Mapping[str, Mask] | None = None) -> Openings:
        """Return the openings of one load, of all areas unless some are given."""
        asked = self.areas if areas is None else areas
        return opening_factors(self.rom.joint, inputs, asked, open_below=self.open_below)

    def reserves(self, rest: Solution, slides: Matrix, opens: Matrix) -> dict[str, SlipReserve]:
        """Return the slip reserves of the cases that slide or open before all others do.

        Parameters
        ----------
        rest
            The preloaded joint with friction.
        slides : (n_case, n_interface), opens : (n_case, n_area)
            Estimated factors.
        """
        found: dict[str, SlipReserve] = {}
        begun = np.atleast_2d(rest.inputs)[-1]

        def reserve(row: int) -> SlipReserve:
            name = self.loads.names[row]
            if name not in found:
                found[name] = growing_reserve(
                    self.rom,
                    np.array([begun, self.loads.inputs[row]]),
                    rest,
                    increments=DEFAULT_INCREMENTS,
                    open_below=self.open_below if self.areas else None,
                )
            return found[name]

        def slid(row: int) -> float:
            one = reserve(row)
            return one.largest if one.gross_slip is None else one.gross_slip

        def every(rows: Indices, _: float) -> Indices:
            return rows

        for column in slides.T:
            least_factor(column, slid, every, TRIED_BY_PATHS)
        for area, column in zip(self.areas, opens.T, strict=True):

            def opened(row: int, area: str = area) -> float:
                one = reserve(row)
                return dict(zip(one.areas, one.openings, strict=True)).get(area, np.inf)

            least_factor(column, opened, every, TRIED_BY_PATHS)
        return found
