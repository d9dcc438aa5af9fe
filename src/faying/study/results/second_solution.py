"""Transients that were solved again by a better reduced model, and sentences about them."""

from collections.abc import Mapping
from dataclasses import dataclass

SHAPES, PROJECTION = "attachment modes", "project compliance+inertia"
"""Stages of a run that compute shapes of the interface and project the model on them."""


@dataclass(frozen=True, kw_only=True)
class Tried:
    """A reduced model with which a transient was solved.

    Attributes
    ----------
    method
        Method of the study, or the reduced model that is the reference.
    estimate : [1]
        Estimated largest pressure error over the peak; None where the estimate failed.
    seconds : [s]
        Wall time of the transient.
    """

    method: str
    estimate: float | None
    seconds: float


@dataclass(frozen=True, kw_only=True)
class Remedy:
    """A transient that was solved again because of a large estimated error.

    Attributes
    ----------
    first
        First model.
    taken
        Second model.
    tolerance : [1]
        Estimated error above which a transient is solved again.
    """

    first: Tried
    taken: Tried
    tolerance: float

    @property
    def helped(self) -> bool:
        """Whether the second model has a smaller estimated error."""
        first, second = self.first.estimate, self.taken.estimate
        return second is not None and first is not None and second < first


def shapes_seconds(stages: Mapping[str, float]) -> float:
    """Return the wall time [s] of building the reduced model with inertia."""
    return sum(stages.get(name, 0.0) for name in (SHAPES, PROJECTION))


def remedy_sentence(case: str, remedy: Remedy, shapes: float = 0.0) -> str:
    """Return a sentence about both models of a load case, their errors and their wall times.

    All load cases of a run share ``shapes``, the seconds of :func:`shapes_seconds`.
    """
    first, second = remedy.first, remedy.taken
    judged = "could not be estimated"
    if second.estimate is not None:
        judged = f"is estimated at {second.estimate:.2%}"
        if second.estimate > remedy.tolerance:
            judged += ", still above it" if remedy.helped else ", which is no better"
    once = f", and {shapes:.2g} s once for the shapes of the interface" if shapes else ""
    mark = f"{100 * remedy.tolerance:.3g}%"
    return (
        f"{case}: the pressure error of {first.method} is estimated at {first.estimate:.2%} of the "
        f"peak, more than {mark}; the case was solved again by {second.method}, "
        f"whose error {judged}. That took {second.seconds:.2g} s after {first.seconds:.2g} s{once}"
        "; [reduction] inertia = false omits this."
    )
