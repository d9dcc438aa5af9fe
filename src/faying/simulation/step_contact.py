"""Contact in a time step: an increment whose laws hold at its end, or for the mean over it.

A step is an increment of ``docs/theory/friction.md`` with the compliance of the step: it has the
same local law, and the slip so far as state.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol, cast

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.between_pairs import between
from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.contact.increment import Increment, IncrementSolver, displaced
from faying.contact.laws_at_points import LawsAtPoints
from faying.contact.state import ContactState
from faying.digits import ROUND_OFF, SOLVED
from faying.linalg.sparse_compliance import Compliance
from faying.simulation.path_steps import PathStep


class StepContact(Protocol):
    """The contact law in the balance of a time step."""

    def solve(
        self, free: Matrix, states: Sequence[ContactState], last: Matrix
    ) -> tuple[Matrix, Sequence[PathStep], Sequence[ContactState]]:
        """Return contact forces of the balance, steps and contact states at the end, of all cases.

        Forces have all components, (n_case, components * n_point), as ``last`` at the start of the
        step. Without them pairs move by ``free`` (n_case, n_relative).
        """


@dataclass(frozen=True, eq=False)
class EndContact:
    """The law holds at the end of the step, and the forces there enter the balance."""

    condensed: CondensedContact

    def solve(
        self,
        free: Matrix,
        states: Sequence[ContactState],
        last: Matrix,  # noqa: ARG002
    ) -> tuple[Matrix, Sequence[PathStep], Sequence[ContactState]]:
        """Solve one increment for each case."""
        solver, contact = self.condensed.increments, self.condensed.contact
        acting, ends, states_after = [], [], []
        for relative, state in zip(free, states, strict=True):
            offset = contact.offset(state.slip)
            increment = solver.solve(relative, offset, _start(solver, relative, state))
            slip = state.slip + increment.slack[1:]
            ends.append(_step_end(relative, increment, increment.dissipation, slip))
            acting.append(increment.forces[: contact.components].ravel())
            states_after.append(_contact_state(ends[-1], increment))
        return np.array(acting), ends, states_after


@dataclass(frozen=True, eq=False)
class MeanContact:
    """The mean forces of a step obey the law, and their work is bounded by the stored energy.

    With W = D + G R Gᵀ, the compliance of laws and residual, and γ the relative displacements at
    the points without it, minus the slip at the start, 2 λ̄ solves an increment with

        z = γ₁ + W (2 λ̄ − λ₀).                                                                 (F4)

    λ₁ is 2 λ̄ − λ₀ if that obeys the law too, else the force of the law at γ₁ with the slip after
    the mean. Where a point stays closed λ̄ is the mean of its forces at both ends; where it
    opens, the force at half the step; where it closes, half the force at the end. Hard contact
    without residual compliance has no force at an instant: the mean over the step stands for
    the force at its end, half a step late.

    Raises
    ------
    ModelError
        If contact has friction and is hard, or the closure of a law is not proportional to force.
    """

    condensed: CondensedContact

    def __post_init__(self) -> None:
        self.condensed.contact.check_mean_forces()

    def solve(
        self, free: Matrix, states: Sequence[ContactState], last: Matrix
    ) -> tuple[Matrix, Sequence[PathStep], Sequence[ContactState]]:
        """Solve one increment for each case, and the law at the end where that is violated."""
        solver, contact = self.condensed.increments, self.condensed.contact
        means, ends, states_after = [], [], []
        k = contact.components
        last_forces = np.zeros((3, contact.n_points))
        for relative, state, acted in zip(free, states, last, strict=True):
            last_forces[:k] = acted.reshape(k, -1)
            offset = contact.offset(state.slip) - self._given_way(last_forces)
            mean = solver.solve(relative, offset, _start(solver, relative, state))
            end = self._at_end(mean, mean.forces - last_forces)
            slip = state.slip + mean.slack[1:] + end.slack[1:]
            dissipated = 0.5 * mean.dissipation + end.dissipation
            means.append(mean.forces[:k].ravel())
            ends.append(_step_end(relative, end, dissipated, slip))
            states_after.append(_contact_state(ends[-1], mean))
        return np.array(means), ends, states_after

    def _at_end(self, mean: Increment, forces: Matrix) -> Increment:
        """Return the increment at the end: forces, and the slip beyond that of the mean."""
        none = np.zeros_like(forces)
        opened = np.concatenate([mean.slack[:1], none[1:]])
        D = self._laws.closure(none)[1]
        hard = D[0] == 0
        if self._is_admissible(forces) and not (self._residual is None and hard.any()):
            return replace(mean, forces=forces, slack=opened)
        z_free = opened - self._given_way(forces)
        if self._residual is not None:
            still = np.zeros(len(mean.moved))
            begun = replace(mean, forces=forces, moved=displaced(self._law, still, forces))
            end = self._law.solve(still, z_free, begun)
            return replace(end, iterations=mean.iterations + end.iterations)
        stuck = np.divide(-z_free, D, out=none, where=D > 0)
        elastic = np.where(hard, 0.5 * mean.forces, self._laws.admissible(stuck))
        return replace(mean, forces=elastic, slack=z_free + self._laws.closure(elastic)[0])

    def _is_admissible(self, forces: Matrix) -> bool:
        """Return whether forces 2 λ̄ − λ₀ are admissible: compression within friction limits."""
        rubbing, largest = self.condensed.contact.rubbing, np.abs(forces).max()
        limit = self.condensed.contact.friction * forces[0, rubbing] + ROUND_OFF * largest
        return not (forces[0] < 0).any() and not (np.hypot(*forces[1:, rubbing]) > limit).any()

    def _given_way(self, forces: Matrix) -> Matrix:
        """Return W λ (3, n_point)."""
        contact, R = self.condensed.contact, self._residual
        way = self._laws.closure(forces)[0]
        return (
            way if R is None else way + contact.moved(R @ contact.at_pairs(forces[0], forces[1:]))
        )

    @property
    def _laws(self) -> LawsAtPoints:
        return self.condensed.increments.laws

    @cached_property
    def _law(self) -> IncrementSolver:
        """The solver of the law with laws and residual compliance as the only compliance."""
        alone: Contact = replace(self.condensed.contact, residual_compliance=None)
        residual = cast("Compliance", self._residual)
        return CondensedContact(contact=alone, compliance=between(residual)).increments

    @cached_property
    def _residual(self) -> Compliance | None:
        """R; None where contact is hard and R is round-off."""
        R, contact = self.condensed.contact.residual_compliance, self.condensed.contact
        if not isinstance(R, np.ndarray) or (contact.flexibility > 0).all():
            return R
        whole = np.diagonal(self.condensed.total)
        return R if np.diagonal(R).max() > SOLVED * whole.max() else None


def _step_end(free: Vector, increment: Increment, dissipation: float, slip: Matrix) -> PathStep:
    """Return the step at its end, with the slip so far (2, n_point)."""
    return PathStep(
        relative=free,
        increment=increment,
        slip=slip,
        iterations=increment.iterations,
        dissipation=dissipation,
    )


def _contact_state(end: PathStep, begin: Increment) -> ContactState:
    """Return the contact state after a step; the next one starts at the increment ``begin``."""
    active = end.increment.forces[0] > 0
    return ContactState(active=active, slip=end.slip, forces=begin.forces, moved=begin.moved)


def _start(solver: IncrementSolver, free: Vector, state: ContactState) -> Increment | None:
    """Return the start of a step: the contact state after the one before."""
    if state.forces is None:
        return None
    return Increment(
        forces=state.forces,
        slack=np.zeros_like(state.forces),
        moved=displaced(solver, free, state.forces) if state.moved is None else state.moved,
        iterations=0,
        residual=0.0,
    )
