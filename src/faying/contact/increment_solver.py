"""What paths, cases and time steps ask of a solver of increments."""

from typing import Protocol, Self

import numpy as np

from faying._typing import Matrix, Vector
from faying.contact.contact import Contact
from faying.contact.increment import Increment
from faying.contact.laws_at_points import LawsAtPoints


class IncrementSolver(Protocol):
    """Solves increments of one compliance between pairs; it remembers nothing of them."""

    @property
    def contact(self) -> Contact:
        """Gaps, tangential displacements and laws."""
        ...

    @property
    def S(self) -> Matrix:
        """Compliance between pairs (n_relative, n_relative) [length/force]."""
        ...

    def moved_by(self, forces: Vector) -> Vector:
        """Return S p (n_relative,) [length] of forces between the pairs."""
        ...

    @property
    def laws(self) -> LawsAtPoints:
        """What the contact points answer."""
        ...

    def about(self, state: Increment) -> Self:
        """Return the solver of many increments about a state."""
        ...

    def solve(self, free: Vector, offset: Matrix, start: Increment | None = None) -> Increment:
        """Solve one increment.

        Without contact forces pairs move by ``free`` (n_relative,). The offset z₀ (3, n_point)
        [length] is the initial gap, and minus the slip so far (:meth:`.Contact.offset`). The start
        is the increment before, or a similar one; by default all points close and stick at first.

        Raises
        ------
        ConvergenceError
            If the increment is not solved.
        """
        ...


def displaced(solver: IncrementSolver, free: Vector, forces: Matrix) -> Vector:
    """Return the relative displacements (n_relative,) under forces (3, n_point).

    Without them they are ``free`` (n_relative,) [length].
    """
    pressed = solver.contact.at_pairs(forces[0], forces[1:])
    return np.asarray(free + solver.moved_by(pressed))
