"""The deciding cases among many: found by cheap estimates, and judged one by one as in a run.

A case decides if a metric is worst in it, or if the joint opens or slides first in it. Load factors
of opening and sliding are estimated for all cases. The cases of the least estimates are followed,
then batches of doubling size, until none in a batch opens or slides earlier.
"""

from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from faying._typing import Indices, Mask, Matrix, Vector
from faying.assessment.growth import LARGEST_FACTOR
from faying.assessment.opening import Openings, opening_factors, opening_margins
from faying.assessment.slip_reserve import SlipReserve, slip_reserve
from faying.contact.increment import Increment
from faying.reduction.reduced_model import ReducedModel
from faying.simulation.load import InputRow
from faying.simulation.solution import Solution
from faying.study.inputs.load_set import LoadSet

TRIED_CASES = 8
"""Cases of the first batch beside the followed case, which costs eight times as much.

Among 1000 random loads on a roof joint the first to open was first or second by estimates; among
24 on a coarse lap joint that opens at three times the load it was among the first nine, not five.
"""

TRIED_BY_PATHS = 2
"""Cases of the first batch where each is followed in increments."""


def least_factor(
    estimates: Vector,
    exact: Callable[[int], float],
    sooner: Callable[[Indices, float], Indices],
    tried: int,
) -> None:
    """Follow the cases in which an event (opening, sliding) has the least load factors.

    Estimated factors (n_case,) are NaN for cases that are not judged. ``exact`` follows a case and
    returns its factor; ``sooner`` returns the cases among some whose event may come before a
    factor, the earliest first. The first batch has ``tried`` cases.
    """
    order = np.argsort(estimates, kind="stable")[: np.count_nonzero(~np.isnan(estimates))]
    if not len(order):
        return
    least, done = exact(int(order[0])), 1
    while done < len(order):
        batch, before = order[done : done + tried], least
        while len(batch) and len(left := sooner(batch, least)):
            least = min(least, exact(int(left[0])))
            batch = left[1:]
        done, tried = done + tried, 2 * tried
        if not least < before:
            break


@dataclass(frozen=True, eq=False, kw_only=True)
class Deciding:
    """Static cases of a joint, whose openings and slip reserves are computed as in a run.

    Attributes
    ----------
    rom
    loads
        Loads with the static cases.
    areas
        Contact points (n_point,) of each area that may open, by its name.
    open_below
        Share of an area's pressed part at rest below which it counts as open.
    along
        Whether openings are also followed on the paths of joints with friction.
    """

    rom: ReducedModel
    loads: LoadSet
    areas: Mapping[str, Mask]
    open_below: float
    along: bool

    def openings(self, estimates: Matrix) -> dict[str, Openings]:
        """Return the openings of the cases in which an area opens first.

        Estimated load factors are (n_case, n_area).
        """
        joint, loads, found = self.rom.joint, self.loads, dict[str, dict[str, float]]()
        # One case often opens several areas first.
        reached = defaultdict[int, dict[float, Increment]](dict)
        for (name, points), column in zip(self.areas.items(), estimates.T, strict=True):
            areas = {name: points}

            def exact(row: int, areas: Mapping[str, Mask] = areas) -> float:
                opened = opening_factors(
                    joint,
                    loads.inputs[row],
                    areas,
                    open_below=self.open_below,
                    reached=reached[row],
                ).opened
                found.setdefault(loads.names[row], {}).update(opened)
                return min(opened.values(), default=np.inf)

            def sooner(rows: Indices, at: float, areas: Mapping[str, Mask] = areas) -> Indices:
                factor = min(at, LARGEST_FACTOR)
                left = opening_margins(
                    joint, loads.inputs[rows], areas, factor, open_below=self.open_below
                )
                first = np.argsort(left, kind="stable")
                return rows[first[left[first] < 0]]

            least_factor(column, exact, sooner, TRIED_CASES)
        return {
            case: Openings(opened=opened, followed=LARGEST_FACTOR) for case, opened in found.items()
        }

    def reserves(self, rest: Solution, slides: Matrix, opens: Matrix) -> dict[str, SlipReserve]:
        """Return the slip reserves of the cases that slide or open first.

        Empty where no interface slides. Estimated load factors are (n_case, n_interface), NaN
        without friction, and (n_case, n_area).
        """
        found: dict[str, SlipReserve] = {}

        def reserve(row: int) -> SlipReserve:
            name = self.loads.names[row]
            if name not in found:
                load = InputRow(name=name, row=self.loads.inputs[row])
                below = self.open_below if self.along else None
                found[name] = slip_reserve(self.rom, load, rest, share=None, open_below=below)
            return found[name]

        def slid(row: int) -> float:
            reached = reserve(row)
            return reached.largest if reached.gross_slip is None else reached.gross_slip

        def every(rows: Indices, _: float) -> Indices:
            return rows

        for column in slides.T:
            least_factor(column, slid, every, TRIED_BY_PATHS)
        for area, column in zip(self.areas, opens.T, strict=True) if found and self.along else ():

            def opened(row: int, area: str = area) -> float:
                reached = reserve(row)
                return dict(zip(reached.areas, reached.openings, strict=True)).get(area, np.inf)

            least_factor(column, opened, every, TRIED_BY_PATHS)
        return found
