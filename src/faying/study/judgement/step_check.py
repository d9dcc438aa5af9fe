"""Whether time steps resolve the pressures of a load case: at half of them, or as chosen."""

from dataclasses import dataclass, replace

import numpy as np

from faying.assessment.accuracy import Accuracy
from faying.study.judgement.comparison import accuracy, dissipation_error
from faying.study.results.values import CaseResult, Response


@dataclass(frozen=True, eq=False, kw_only=True)
class StepCheck:
    """How a transient of the full model changes with half the time step.

    Fields are compared: pressures at every contact point and every instant that both runs have.

    Attributes
    ----------
    peak, half_peak : [force/length²]
        Largest pressure over points and instants with the study's step and with half of it.
    change
        Of pressures, tractions and boundary translations, over the largest of the study's step.
    dissipation
        Of the energy that friction took, over the same.
    """

    peak: float
    half_peak: float
    change: Accuracy
    dissipation: float | None

    @property
    def peak_change(self) -> float:
        """Change of the largest pressure as a fraction of the one at the study's step."""
        return self.half_peak / self.peak - 1.0

    @property
    def largest(self) -> float:
        """Largest change of pressure at a point and instant as a fraction of the peak."""
        return self.change.max_relative_error


def step_check(case: CaseResult) -> StepCheck | None:
    """Return the time-step check of a transient case; None where it was not run."""
    half, times = case.half_step, case.times
    if half is None or times is None or len(times) < 2:
        return None
    count = min(len(times), len(half.pressure[::2]))  # half a step more or less at the end
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
    """Return a transient at some of its instants."""
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
    """Steps divided until the pressures of a transient hold its tolerance.

    Attributes
    ----------
    tolerance : [1]
        Largest pressure error over the peak that was asked for.
    error : [1]
        Errors of all intervals together: 5 times (first order; else 2.5 times)
        what half their steps change.
    count : [1]
        Steps in all.
    most : [1]
        Steps between two instants at most.
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
    """Return the steps that the reference of a case took; None where a study gave them."""
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
    """Say what steps were chosen, whether they do, and what that was judged by."""
    reached = "within" if choice.met else "which is more than"
    more = "" if choice.met else ": let the load rise more slowly, or take more instants"
    return (
        f"{name}: time steps were chosen, {choice.count} in all and up to {choice.most} between "
        f"two instants; pressures are estimated to be off by {choice.error:.2%} of the peak from "
        f"them, {reached} the tolerance of {choice.tolerance:.2%}{more}. The half-step check is "
        "replaced by this estimate, for which every interval was also solved in half as many steps."
    )
