"""The time steps that a run chose for a load case, and what they are worth."""

from dataclasses import dataclass

import numpy as np

from faying.study.results.values import CaseResult


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
