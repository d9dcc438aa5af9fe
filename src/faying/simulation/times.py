"""Time steps that can be taken."""

from faying.exceptions import ModelError

MOST_STEPS = 10**9
"""Steps of a response; even instants alone are eight gigabytes of them."""


def check_times(step: float, duration: float) -> None:
    """Refuse steps that are none."""
    if not 0 < step <= duration:
        message = (
            f"the time step is {step:g} and the duration {duration:g}; "
            "the step must be positive and no longer than the duration"
        )
        raise ModelError(message)
    if not duration / step <= MOST_STEPS:
        message = (
            f"the duration {duration:g} takes {duration / step:.4g} steps of {step:g}, and "
            f"{MOST_STEPS} are the most; enlarge the step"
        )
        raise ModelError(message)
