"""The contact forces of a step: those at its end, or their mean over it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol, final

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.condensed import CondensedContact
from faying.contact.forces import ContactForces
from faying.contact.state import ContactState
from faying.linalg.compressed import Compliance
from faying.simulation.increment_step import IncrementEnd, IncrementMean

ROUND_OFF = 1e-9
"""Residual compliance below this share of the compliance of a step is round-off of the basis."""


class StepContact(Protocol):
    """How contact enters the balance of a step."""

    def solve(
        self, free: Matrix, states: Sequence[ContactState], last: Matrix
    ) -> tuple[Matrix, Sequence[ContactForces], Sequence[ContactState]]:
        """Return the new forces of the balance, contact at the end, and its state, of all cases.

        Forces have all components, (n_case, components * n_point), as ``last`` at the start of the
        step. Without them pairs move by ``free`` (n_case, n_relative).
        """
        ...


@final
@dataclass(frozen=True, eq=False)
class EndContact:
    """The contact law holds at the end of the step, for forces as unknowns."""

    condensed: CondensedContact

    def solve(
        self,
        free: Matrix,
        states: Sequence[ContactState],
        last: Matrix,  # noqa: ARG002
    ) -> tuple[Matrix, Sequence[ContactForces], Sequence[ContactState]]:
        """Solve one contact problem for each case."""
        gaps = self.condensed.free_gap(free)
        contacts, states_after = zip(*map(self.condensed.solve, gaps, states), strict=True)
        return np.array([contact.forces for contact in contacts]), contacts, states_after


@final
@dataclass(frozen=True, eq=False)
class MeanContact:
    """The mean force of a step, an unknown, is no tension and adds no energy to that of contact.

    With W = D + N R Nᵀ, by which penalty and residual compliance give way, and γ the gap without
    that, the mean λ̄ ≥ 0 obeys

        s = γ₁ + W (2 λ̄ − λ₀) ≥ 0,     λ̄ᵀ s = 0:

    a contact problem for 2 λ̄, with the compliance of half the force. Where a point stays closed,
    λ̄ is the mean of its forces at both ends; where it opens, the force half way; where it closes,
    half the force at the end. λ₁ then follows from the contact law at γ₁.
    """

    condensed: CondensedContact

    def solve(
        self, free: Matrix, states: Sequence[ContactState], last: Matrix
    ) -> tuple[Matrix, Sequence[ContactForces], Sequence[ContactState]]:
        """Solve one contact problem for each case, and the law at the end where forces would pull.

        Hard contact without residual compliance has no force that belongs to an instant: the mean
        over the step stands for that at its end, half a step late.
        """
        gaps = self.condensed.free_gap(free)
        solved = map(self.condensed.solve, gaps - self._given_way(last), states)
        means, states_after = zip(*solved, strict=True)
        begun = [state.at_end for state in states]
        ends, stands = zip(*map(self._at_end, means, last, begun), strict=True)
        ahead = [
            replace(state, at_end=end) for state, end in zip(states_after, stands, strict=True)
        ]
        return np.array([mean.forces for mean in means]), ends, ahead

    def _at_end(
        self, mean: ContactForces, last: Vector, stands: ContactState | None
    ) -> tuple[ContactForces, ContactState | None]:
        """Return contact at the end of a step, and where its own problem stands."""
        D = self.condensed.contact.flexibility
        forces = mean.forces - last
        pulling = np.minimum(forces, 0.0)
        if self._law is None:
            forces = np.where(D == 0, 0.5 * mean.forces, forces - pulling)
            slack = mean.slack - D * pulling
            return replace(mean, forces=forces, slack=slack, active=forces > 0), stands
        if not pulling.any():
            return replace(mean, forces=forces, active=forces > 0), stands
        gap = mean.slack - self._given_way(forces[None])[0]
        guess = ContactState(active=forces > 0)
        begin = guess if stands is None else replace(stands, active=guess.active)
        end, state_after = self._law.solve(gap, begin)
        iterations, error = mean.iterations + end.iterations, max(mean.error, end.error)
        return replace(end, iterations=iterations, error=error), state_after

    def _given_way(self, forces: Matrix) -> Matrix:
        """W λ of each case (n_case, n_point)."""
        contact = self.condensed.contact
        way: Matrix = contact.flexibility * forces
        if self._residual is not None:
            to_pairs, _ = contact.transposed
            way = way + (contact.interpolation @ (self._residual @ (to_pairs @ forces.T))).T
        return way

    @cached_property
    def _residual(self) -> Compliance | None:
        """R, unless contact is hard and R no more than what round-off leaves."""
        R, contact = self.condensed.contact.residual_compliance, self.condensed.contact
        if not isinstance(R, np.ndarray) or (contact.flexibility > 0).all():
            return R
        whole = np.diagonal(np.asarray(self.condensed.total))
        return R if np.diagonal(R).max() > ROUND_OFF * whole.max() else None

    @cached_property
    def _law(self) -> CondensedContact | None:
        """The contact law where it couples points: gaps of W alone."""
        if self._residual is None:
            return None
        alone = replace(self.condensed.contact, residual_compliance=None)
        return CondensedContact(contact=alone, compliance=self._residual)


def end_contact(condensed: CondensedContact) -> StepContact:
    """Return the contact law at the end of a step."""
    return EndContact(condensed) if condensed.cases is None else IncrementEnd(condensed)


def mean_contact(condensed: CondensedContact) -> StepContact:
    """Return the law of the mean contact force of a step.

    Raises
    ------
    ModelError
        If contact has friction and is hard, or a law closes otherwise than in proportion to force.
    """
    condensed.contact.check_proportional()
    return MeanContact(condensed) if condensed.cases is None else IncrementMean(condensed)
