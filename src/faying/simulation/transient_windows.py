"""Transients in windows of their instants: memory holds one window."""

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

from faying.joint.system import System
from faying.simulation.energy_guard import warn_of_gain
from faying.simulation.instants import check_times, require_history_room
from faying.simulation.load import Load
from faying.simulation.restart import Restart
from faying.simulation.solution import Solution
from faying.simulation.start import starting_states

Progress = Callable[[int], object]


class Steps(Protocol):
    """Solver that advances transients of a system from instant to instant."""

    @property
    def system(self) -> System:
        """Full or reduced model."""

    @property
    def step(self) -> float:
        """Time between two instants [time]."""

    def begun(self, loads: Sequence[Load], starts: Sequence[Solution]) -> list[Restart]:
        """Return restarts of transients that begin at static solutions."""

    def advanced(
        self,
        here: Sequence[Restart],
        loads: Sequence[Load],
        starts: Sequence[Solution],
        *,
        end: int,
        last: int,
        progress: Progress | None,
    ) -> tuple[list[Solution], list[Restart]]:
        """Return the instants up to ``end``, with the starts if there are any, and the restarts.

        ``end`` and ``last`` are numbers of the last instant of the window, and of the run.
        """


def transient_windows(
    steps: Steps,
    loads: Sequence[Load],
    *,
    duration: float,
    length: int | None,
    initial: Sequence[Solution] | None = None,
    restarts: Sequence[Restart] | None = None,
    progress: Progress | None = None,
) -> Iterator[tuple[list[Solution], list[Restart]]]:
    """Integrate responses side by side, a window of their instants at a time.

    A window has ``length`` intervals, by default all. Responses start from static solutions, one
    for each load, or from the joint under its bolts; continued from restarts, they omit the start.
    ``progress`` is called with the number of steps of all loads done since the last call.

    Yields the instants of the window for each load, and the restarts after them. Windows of a
    resumed run are the same, to the bit, as those without interruption. Spurious gains of energy
    are logged.
    """
    check_times(steps.step, duration)
    last = round(duration / steps.step)
    starts: list[Solution] = []
    if restarts is None:
        starts = starting_states(steps.system, loads, initial)
        restarts = steps.begun(loads, starts)
    standing = list(restarts)
    size = max(last - standing[0].done, 1) if length is None else min(length, last)
    require_history_room(len(loads), size + 1, steps.system)
    while standing[0].done < last:
        end = min(standing[0].done + size, last)
        before = standing
        solutions, standing = steps.advanced(
            before, loads, starts, end=end, last=last, progress=progress
        )
        for load, earlier, later in zip(loads, before, standing, strict=True):
            warn_of_gain(load.name, earlier.ledger, later.ledger)
        starts = []
        yield solutions, standing
