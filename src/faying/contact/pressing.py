"""Frictionless contact as a problem for forces, for points that are hard or nearly so."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.active_set import ActiveSetSpace, Balance, solve_complementarity
from faying.contact.between_solver import BetweenSolver
from faying.contact.contact import Contact
from faying.contact.forced_springs import ForcedSprings
from faying.contact.increment import Increment, check_gaps, displaced
from faying.exceptions import ConvergenceError


@dataclass(frozen=True, eq=False, kw_only=True)
class PressingContact(BetweenSolver):
    """Active-set solver of contact problems without friction.

    Attributes
    ----------
    space
        The flexibility between points.
    """

    space: ActiveSetSpace

    def about(self, state: Increment) -> "PressingContact":  # noqa: ARG002
        """Return the solver itself: active sets need no reference state."""
        return self

    def solve(self, free: Vector, offset: Matrix, start: Increment | None = None) -> Increment:
        """Solve one problem; see :meth:`.IncrementSolver.solve`.

        Raises
        ------
        ModelError
            If the gap holds NaN or infinity.
        ConvergenceError
            If there is no solution: the compliance is not positive semidefinite, or contact is
            hard at more points than a reduced model has modes, which the message says.
        """
        return self._solved(free, offset, start, Balance.of_nothing(self.contact.n_points))[0]

    def loosened(self, springs: ForcedSprings) -> "LoosenedPressing":
        """Return the solver with springs of prescribed force."""
        return LoosenedPressing(solver=self, springs=springs)

    def _solved(
        self, free: Vector, offset: Matrix, start: Increment | None, balance: Balance
    ) -> tuple[Increment, Vector]:
        """Return the contact state, and the initial forces of the balance."""
        g_free = self.contact.interpolation @ free + offset[0]
        check_gaps(g_free)
        with _naming_few_modes(self.contact):
            active = None if start is None else start.forces[0] > 0
            solution = solve_complementarity(self.space, g_free, active, balance)
        forces, slack = np.zeros(offset.shape), np.zeros(offset.shape)
        forces[0], slack[0] = solution.forces, solution.slack
        increment = Increment(
            forces=forces,
            slack=slack,
            moved=displaced(self, free, forces),
            iterations=solution.iterations,
            residual=0.0,
        )
        return increment, solution.initial


@dataclass(frozen=True, eq=False, kw_only=True)
class LoosenedPressing:
    """Frictionless contact with springs of prescribed force."""

    solver: PressingContact
    springs: ForcedSprings

    @cached_property
    def _closing(self) -> Matrix:
        return np.asarray(self.solver.contact.interpolation @ self.springs.columns.T)

    def solve(
        self,
        free: Vector,
        offset: Matrix,
        elongations: Vector,
        about: Vector,
        start: Increment | None = None,
    ) -> tuple[Increment, Vector]:
        """Solve one increment; see :meth:`.ForcedContact.solve`."""
        balance = Balance(
            closing=self._closing,
            yields=self.springs.yields,
            elongations=elongations,
            about=about,
        )
        increment, initial = self.solver._solved(free, offset, start, balance)
        moved = increment.moved - initial @ self.springs.columns
        return replace(increment, moved=moved), initial


@contextmanager
def _naming_few_modes(contact: Contact) -> Iterator[None]:
    """Add to an error of no solution that the model has fewer modes than hard points, if so."""
    try:
        yield
    except ConvergenceError as error:
        hard = int(np.isinf(contact.penalty).sum())
        modes = int(contact.relative_operator.shape[1])
        if contact.residual_compliance is not None or hard <= modes:
            raise
        message = (
            f"contact is hard at {hard} points, but the model has {modes} degrees of freedom: its "
            "gaps depend on each other, and no contact forces close all that are pressed; keep the "
            "residual compliance (method 'compliance', reduce(..., compliance=True)), take a "
            "penalty, or a basis of more modes than contact points"
        )
        raise ConvergenceError(message) from error
