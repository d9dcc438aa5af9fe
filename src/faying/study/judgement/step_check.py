"""Check of time steps: the change of pressures with half the step, or the estimated error."""

from dataclasses import dataclass, replace

import numpy as np

from faying.assessment.accuracy import Accuracy
from faying.study.judgement.comparison import accuracy, dissipation_error
from faying.study.results.values import CaseResult, Response


@dataclass(frozen=True, eq=False, kw_only=True)
class StepCheck:
    """Change of a transient of the full model with half the time step.

    Pressures are compared at every contact point and every instant of both runs.

    Attributes
    ----------
    peak, half_peak : [force/length²]
        Largest pressure over points and instants with the study's step and with half of it.
    change
        Change of pressures, tractions and boundary translations, over their largest value.
    dissipation
        Relative change of the energy dissipated by friction.
    """

    peak: float
    half_peak: float
    change: Accuracy
    dissipation: float | None

    @property
    def peak_change(self) -> float:
        """Relative change of the largest pressure."""
        return self.half_peak / self.peak - 1.0

    @property
    def largest(self) -> float:
        """Largest change of pressure at a point and instant, over the peak."""
        return self.change.max_relative_error


def step_check(case: CaseResult) -> StepCheck | None:
    """Return the time-step check of a transient; None where half the step was not run."""
    half, times = case.half_step, case.times
    if half is None or times is None or len(times) < 2:
        return None
    count = min(len(times), len(half.pressure[::2]))  # the ends may differ by half a step
    fine, coarse = _at(half, 2, count), _at(case.reference, 1, count)
    if not coarse.pressure.max(initial=0.0) > 0:
        return None
    return StepCheck(
        peak=float(case.reference.pressure.max()),
        half_peak=float(half.pressure.max()),
        change=accuracy(case.components, fine, coarse),
        dissipation=dissipation_error(fine, coarse),
    )


def _at(response: Response, every: int, count: int) -> Response:
    """Return a transient at every so many of its instants."""
    chosen, slip = slice(0, every * count, every), response.friction
    return replace(
        response,
        pressure=response.pressure[chosen],
        displacements={name: moved[chosen] for name, moved in response.displacements.items()},
        friction=replace(
            slip,
            traction=slip.traction[chosen],
            dissipation=slip.dissipation[: every * (count - 1) + 1],
        ),
    )


@dataclass(frozen=True, kw_only=True)
class StepChoice:
    """Time steps that were divided until the pressures of a transient met its tolerance.

    Attributes
    ----------
    tolerance : [1]
        Required largest pressure error over the peak.
    error : [1]
        Sum of the errors of all intervals: 5 times (first order; else 2.5 times)
        the change with half as many steps.
    count : [1]
        Total number of steps.
    most : [1]
        Largest number of steps between two instants.
    """

    tolerance: float
    error: float
    count: int
    most: int

    @property
    def met(self) -> bool:
        """Whether the estimated error is within the tolerance."""
        return self.error <= self.tolerance


def step_choice(case: CaseResult) -> StepChoice | None:
    """Return the chosen time steps of a case's reference; None where the study gave the step."""
    steps, errors = case.reference.substeps, case.reference.step_error
    if steps is None or errors is None or case.tolerance is None:
        return None
    return StepChoice(
        tolerance=case.tolerance,
        error=float(np.sum(errors)),
        count=int(np.sum(steps)),
        most=int(np.max(steps)),
    )


def choice_sentence(name: str, choice: StepChoice) -> str:
    """Return a sentence about the chosen time steps and their estimated error."""
    reached = "within" if choice.met else "more than"
    more = "" if choice.met else ": let the load rise more slowly, or give more instants"
    return (
        f"{name}: {choice.count} time steps were chosen in total, up to {choice.most} between "
        f"two instants; their estimated pressure error is {choice.error:.2%} of the peak, "
        f"{reached} the tolerance of {choice.tolerance:.2%}{more}. The half-step check is "
        "replaced by this estimate, for which every interval was also solved with half the steps."
    )
