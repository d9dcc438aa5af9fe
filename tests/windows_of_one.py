"""The windows of one response, where a test has one alone."""

from faying.simulation.transient_windows import transient_windows


def windows_of_one(steps, load, *, restart=None, **options):
    """Yield each window of a response, and where it stands then."""
    restarts = None if restart is None else [restart]
    for (window,), (end,) in transient_windows(steps, [load], restarts=restarts, **options):
        yield window, end
