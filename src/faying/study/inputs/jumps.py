"""Jumps in loads, and the rise time that would avoid their effects."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from faying.simulation.load import History
from faying.study.inputs.loads import case_load
from faying.study.keys.tables import DEFAULT_INSTANTS, LoadCaseSection

SUDDEN = 0.5
"""Change within the window, over the largest value of a load, above which the load jumps."""

RISE = 0.25
"""Rise time over the longest period that hardly excites shorter periods.

On three joints reduced transients were 12 to 98 % off after a jump where they were 6 to 10 % off
after a rise of this length (``benchmarks/transient_estimate.py``).
"""


@dataclass(frozen=True, kw_only=True)
class Jump:
    """The largest jump of one load.

    Attributes
    ----------
    load
        ``"boundary.component"`` or the name of a load of the deck.
    time : [time]
        Beginning of the jump.
    change : [force]
        Change of the load: force, moment or factor.
    share : [1]
        Change over the largest magnitude of the load.
    window : [time]
        Length of the jump; zero if instantaneous.
    rise : [time]
        Proposed rise time; None where the period is unknown.
    """

    load: str
    time: float
    change: float
    share: float
    window: float
    rise: float | None


def load_jumps(
    case: LoadCaseSection, *, step: float | None = None, period: float | None = None
) -> list[Jump]:
    """Return the jumps of a transient load case, the largest one of each load.

    Static load cases have none. The step [time] of the time integration and the longest period
    [time] of the structure may be unknown. A load jumps if it changes within the longer of
    the step and the default step, a hundredth of the period. If both are unknown, only a load
    that begins with a value other than zero jumps.
    """
    if not case.transient:
        return []
    if period == np.inf:
        period = None  # a structure without mass has none
    window = max(step or 0.0, (period or 0.0) / DEFAULT_INSTANTS)
    rise = None if period is None else RISE * period
    return list(_jumps(case, window, rise))


def _jumps(case: LoadCaseSection, window: float, rise: float | None) -> Iterator[Jump]:
    for load, value in case_load(case).forces.items():
        history = value if isinstance(value, History) else History(np.zeros(1), np.array([value]))
        time, change, threshold = _largest_change(history, window)
        largest = float(np.abs(history.values).max())
        if largest > 0 and abs(change) > SUDDEN * largest:
            yield Jump(
                load=load,
                time=time,
                change=change,
                share=abs(change) / largest,
                window=threshold,
                rise=rise,
            )


def _largest_change(history: History, window: float) -> tuple[float, float, float]:
    """Return time, value and duration of the largest change of a load that is zero before t = 0.

    The change of a piecewise linear function over a window is largest where one end is a
    sample.
    """
    start = float(history.at(np.zeros(1))[0])
    if window == 0 or abs(start) > SUDDEN * np.abs(history.values).max():
        return 0.0, start, 0.0
    knots = history.times
    begin = np.unique(np.clip(np.concatenate([knots, knots - window]), -window, None))
    level_before = np.where(begin < 0, 0.0, history.at(begin))
    changes = history.at(begin + window) - level_before
    largest = int(np.argmax(np.abs(changes)))
    return max(float(begin[largest]), 0.0), float(changes[largest]), window


def jump_sentence(case: str, jumps: Sequence[Jump], time_unit: str, *, history: bool) -> str:
    """Return a sentence about the jumps of a load case and a better rise time; empty without jumps.

    A load from a ``history`` must be changed in its file.
    """
    if not jumps:
        return ""
    loads = ", ".join(_describe_jump(jump, time_unit) for jump in jumps)
    said = (
        f"{case}: {loads} jump{'s' * (len(jumps) == 1)}. Real loads rise over some time. A jump "
        "excites vibrations faster than those that reduced models contain and the time step "
        "resolves, so pressures right after it are uncertain in every model."
    )
    rises = [jump.rise for jump in jumps if jump.rise is not None]
    if not rises:
        return f"{said} Let it rise over about a quarter of the longest period, which a run prints."
    rise = f"{max(rises):.3g}"
    there = "in its file" if history else f"with rise_time = {rise} in its [[load_case]]"
    span = f"{rise} {time_unit}".rstrip()
    return f"{said} Let it rise over a quarter of the longest period, {span}, {there}."


def _describe_jump(jump: Jump, time_unit: str) -> str:
    instant = f"{jump.time:.3g} {time_unit}".rstrip()
    within = f" within {jump.window:.3g} {time_unit}".rstrip() if jump.window else ""
    return f"{jump.load} (by {jump.change:.6g} at t = {instant}{within})"
