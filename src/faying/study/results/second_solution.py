"""What a transient was solved by beside what was asked for, and how that is told."""

from collections.abc import Mapping
from dataclasses import dataclass

SHAPES, PROJECTION = "attachment modes", "project compliance+inertia"
"""Stages of a run that make the shapes of the interface and reduce the model to them."""


@dataclass(frozen=True, kw_only=True)
class Tried:
    """A reduced model that a transient was solved by.

    Attributes
    ----------
    method
        A method of the study, or the reduced model that methods are compared with.
    estimate : [1]
        Its largest pressure error over the peak, estimated; None where that failed.
    seconds : [s]
        Wall time of the transient.
    """

    method: str
    estimate: float | None
    seconds: float


@dataclass(frozen=True, kw_only=True)
class Remedy:
    """A transient that was solved again because the first solution is estimated to be off.

    Attributes
    ----------
    first
        What was asked for.
    taken
        What was taken then.
    tolerance : [1]
        Largest estimated error that is left as it is.
    """

    first: Tried
    taken: Tried
    tolerance: float

    @property
    def helped(self) -> bool:
        """Whether what was taken is estimated to be nearer the truth."""
        first, second = self.first.estimate, self.taken.estimate
        return second is not None and first is not None and second < first


def shapes_seconds(stages: Mapping[str, float]) -> float:
    """Return the wall time of the reduced model with inertia, from that of the stages of a run."""
    return sum(stages.get(name, 0.0) for name in (SHAPES, PROJECTION))


def remedy_sentence(case: str, remedy: Remedy, shapes: float = 0.0) -> str:
    """Say of a load case what was first computed, what was taken then, and what that cost.

    All load cases of a run share the seconds of shapes, of :func:`shapes_seconds`.
    """
    first, second = remedy.first, remedy.taken
    judged = "could not be estimated"
    if second.estimate is not None:
        judged = f"is estimated at {second.estimate:.2%}"
        if second.estimate > remedy.tolerance:
            judged += ", still more than that" if remedy.helped else ", which is no better"
    once = f", and {shapes:.2g} s once for the shapes of the interface" if shapes else ""
    mark = f"{100 * remedy.tolerance:.3g}%"
    return (
        f"{case}: the pressure error of {first.method} is estimated at {first.estimate:.2%} of the "
        f"peak, more than {mark}; the case was solved again by {second.method}, "
        f"whose error {judged}. That took {second.seconds:.2g} s after {first.seconds:.2g} s{once}"
        "; [reduction] inertia = false leaves it out."
    )
