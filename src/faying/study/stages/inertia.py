"""Inertia for the interface of transients whose estimated error asks for it.

``docs/theory/transient_accuracy.md`` says what a run does then.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from faying.assessment.transient_error import REMEDY
from faying.joint.model import Model
from faying.joint.system import System
from faying.reduction.attachment import attachment_modes
from faying.reduction.basis import Basis
from faying.reduction.projection import projected
from faying.reduction.reduced_model import ReducedModel
from faying.study.results.second_solution import PROJECTION, SHAPES, Remedy, Tried
from faying.study.results.values import Response
from faying.study.stages.books import Books

CURED = "compliance"
"""Method that lacks the inertia."""


@dataclass(eq=False, kw_only=True)
class InertiaWhenNeeded:
    """The reduced model with inertia at the interface, built when a transient asks for it.

    Attributes
    ----------
    model
        The full one.
    classic
        Basis of the study's classic methods.
    books
        Of the run.
    models
        Those of the study's methods; the one with inertia among them where the study names it.
    allowed
        Whether the study lets a run build it unasked.
    built
        The model that was built unasked; None where none was.
    """

    model: Model
    classic: Basis
    books: Books
    models: Mapping[str, Mapping[int, System]]
    allowed: bool = True
    built: ReducedModel | None = None

    @property
    def named(self) -> bool:
        """Whether the study names the method, so that it is compared in any case."""
        return REMEDY in self.models

    @property
    def system(self) -> System:
        """The reduced model with inertia.

        Raises
        ------
        FayingError
            If the shapes of the interface do not fit in memory.

        Notes
        -----
        One back-substitution for each contact pair and more, as
        :func:`~faying.reduction.attachment.attachment_modes`, once for all load cases.
        """
        if self.named:
            return self.models[REMEDY][0]
        if self.built is None:
            with self.books.stage(SHAPES):
                basis = attachment_modes(self.model, classic=self.classic)
            with self.books.stage(PROJECTION):
                self.built = projected(self.model, basis)
        return self.built

    def wanted(self, response: Response, tolerance: float) -> bool:
        """Say whether the estimated error of a transient is too large to be left as it is."""
        estimate = response.estimate
        return self.allowed and estimate is not None and estimate.max_relative_error > tolerance


def remedy_of(
    first: tuple[str, Response], second: tuple[str, Response], tolerance: float
) -> Remedy:
    """Return the record of a transient that was solved by one model and then by another."""
    return Remedy(first=_tried(*first), taken=_tried(*second), tolerance=tolerance)


def _tried(method: str, response: Response) -> Tried:
    estimate = response.estimate
    return Tried(
        method=method,
        estimate=None if estimate is None else estimate.max_relative_error,
        seconds=response.seconds,
    )
