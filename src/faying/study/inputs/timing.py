"""Time step and length of transient runs, in time or by the longest period of the structure."""

from faying.study.keys.history import read_history
from faying.study.keys.tables import LoadCaseSection, Timed

DEFAULT_STEPS_PER_PERIOD = 100


def time_step(timed: Timed, period: float) -> float:
    """Return the time step [time], for a structure with the given longest period [time]."""
    if timed.step is not None:
        return timed.step
    return period / (timed.steps_per_period or DEFAULT_STEPS_PER_PERIOD)


def time_span(timed: Timed, period: float) -> float:
    """Return the length [time]; of a history without one, that of its shortest file."""
    if timed.duration is not None:
        return timed.duration
    if timed.periods is None and isinstance(timed, LoadCaseSection):
        files = [force.file for force in timed.forces if force.file]
        if files:
            return min(float(read_history(file).times[-1]) for file in files)
    # "At least one period of the dominant vibration" (seed §15.3.4.2).
    return period * (timed.periods or 1.0)


def instants(timed: Timed) -> tuple[float, ...]:
    """Return what is equal of runs with the same step and length, whatever the period is.

    Both grow in proportion to the period or not at all, so two periods tell.
    """
    return tuple(of(timed, period) for of in (time_step, time_span) for period in (1.0, 2.0))
